"""Makes surfaces of meshes, checks them again with `raycone info`, and prints the tables of docs/surfaces.md.

usage: python3 tests/surfaces/measure.py RAYCONE MESH-DIRECTORY [--resolution N] [--most-bytes B] [--timeout S]

Each mesh is written as PLY and as STL. A mesh that cannot be read, or of which no sample is inside, is counted and left
out. The exit status is 1 where a surface is refused by `info --require`, or where raycone reports an error of its own.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

REQUIRED = "closed,oriented,outward,manifold,embedded"
EXTENSIONS = ("obj", "ply", "stl", "off", "glb", "gltf")


def meshes_in(directory, most_bytes):
    for top, _, names in sorted(os.walk(directory)):
        for name in sorted(names):
            path = os.path.join(top, name)
            if name.lower().rsplit(".", 1)[-1] in EXTENSIONS and os.path.getsize(path) <= most_bytes:
                yield path


def measured(words):
    """The exit status, standard error, seconds of user and system time, and the peak of memory in MB."""
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return process.returncode, errors.read().strip(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def print_percentiles(rows):
    print("\n| of %d meshes | median | 90 %% | 95 %% | largest |" % len(rows))
    print("|---|---|---|---|---|")
    for name, number_format in (("surface faces", "%.0f"), ("max. distance, voxels", "%.2g"), ("holes, %", "%.2g"),
                                ("dropped, %", "%.2g"), ("CPU, s", "%.2f"), ("peak, MB", "%.0f")):
        numbers = sorted(row[name] for row in rows)
        at = [numbers[int(part * (len(numbers) - 1))] for part in (0.5, 0.9, 0.95, 1)]
        print("| %s | %s |" % (name, " | ".join(number_format % number for number in at)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raycone")
    parser.add_argument("directory")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--most-bytes", type=int, default=1_000_000)
    parser.add_argument("--timeout", type=int, default=60)
    arguments = parser.parse_args()
    refused, failed, limits, rows, left_out, made = [], [], [], [], 0, 0
    print("| mesh | faces | boundary edges | surface faces | parts | max. distance, voxels | holes, % | "
          "dropped, % | CPU, s | peak, MB |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as work:
        for path in meshes_in(arguments.directory, arguments.most_bytes):
            report = os.path.join(work, "report.json")
            for ending in ("ply", "stl"):
                out = os.path.join(work, "out." + ending)
                status, errors, seconds, memory = measured(
                    [arguments.raycone, "surface", path, "-o", out, "--report", report, "--orient", "auto",
                     "--resolution", str(arguments.resolution), "--timeout", str(arguments.timeout), "--quiet"])
                if status == 4:
                    limits.append((path, ending, errors))
                    print(*limits[-1], file=sys.stderr, flush=True)
                    break
                if status == 2:
                    left_out += 1
                    break
                if status != 0:
                    failed.append((path, ending, errors))
                    print(*failed[-1], file=sys.stderr, flush=True)
                    continue
                made += 1
                checked = subprocess.run([arguments.raycone, "info", out, "--require", REQUIRED], capture_output=True)
                if checked.returncode != 0:
                    refused.append((path, ending, checked.stderr.decode().strip()))
                    print(*refused[-1], file=sys.stderr, flush=True)
                if ending == "stl":
                    continue
                with open(report) as file:
                    run = json.load(file)
                area = json.loads(subprocess.run([arguments.raycone, "info", path, "--json"], capture_output=True,
                                                 check=True).stdout)["surface_area"]
                surface = run["surface"]
                voxel = min(run["lattice"]["spacing"])
                row = {"surface faces": surface["faces"], "parts": surface["components"],
                       "max. distance, voxels": surface["max_distance"] / voxel,
                       "holes, %": 100 * surface["hole_area"] / area,
                       "dropped, %": 100 * surface["dropped_area"] / area, "CPU, s": seconds, "peak, MB": memory}
                rows.append(row)
                print("| %s | %d | %d | %d | %d | %.2g | %.2g | %.2g | %.1f | %.0f |" % (
                    os.path.relpath(path, arguments.directory), run["faces"], run["exterior_edges"], *row.values()),
                      flush=True)
    if rows:
        print_percentiles(rows)
    print("\n%d surfaces made, %d refused by `info --require`, %d errors; %d meshes have no inside or cannot be read, %d "
          "met a limit." % (made, len(refused), len(failed), left_out, len(limits)))
    return 1 if refused or failed else 0


if __name__ == "__main__":
    sys.exit(main())
