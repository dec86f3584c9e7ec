"""The table of docs/benchmarks.md from what raycone_level_set_bench wrote as JSON:
python3 tests/bench/level_set_table.py FILE..."""

import json
import math
import sys


def main(paths):
    rows = {}
    for path in paths:
        with open(path, encoding="utf-8") as file:
            for run in json.load(file)["benchmarks"]:
                side, mesh, method = run["name"].rsplit("/", 2)
                rows.setdefault((mesh, int(side)), {})[method] = run
    print("| mesh | faces | edges | samples | raycone ms | OpenVDB ms | ratio | off by, voxels: raycone | OpenVDB |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    ratios = []
    for (mesh, side), methods in sorted(rows.items()):
        if len(methods) < 2:
            continue
        ours, theirs = methods["raycone"], methods["openvdb"]
        ratios.append(theirs["cpu_time"] / ours["cpu_time"])
        print(f"| {mesh} | {ours['faces']:.0f} | {ours['edges']:.0f} | {side} | {ours['cpu_time']:.0f} | "
              f"{theirs['cpu_time']:.0f} | {ratios[-1]:.1f} | {ours['error']:.0e} | {theirs['error']:.2f} |")
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
    print(f"\nGeometric mean of {len(ratios)} ratios: {mean:.2f}; below 3: {sum(r < 3 for r in ratios)}.")


if __name__ == "__main__":
    main(sys.argv[1:])
