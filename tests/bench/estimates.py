"""What `raycone info` estimates beside what evaluation takes: python3 tests/bench/estimates.py RAYCONE MESH...

One row for each of its two lattices that it estimates to take 0.1 to 20 seconds on one thread, where it does not tell a
bound ("at most"): seconds to prepare and evaluate. Then the geometric mean of estimated / measured, and how many are
off by more than a factor of two.
"""

import json
import math
import os
import re
import subprocess
import sys
import tempfile

MOST = 20  # seconds


def estimates(raycone, mesh):
    """Samples along each axis, and seconds, of both lattices; none of what is no mesh."""
    text = subprocess.run([raycone, "info", mesh, "--threads", "1"], capture_output=True, text=True).stdout
    for seconds, counts in re.findall(r" about ([\d.]+) s for (\d+ x \d+ x \d+) samples", text):
        yield [int(count) for count in counts.split(" x ")], float(seconds)


def measured(raycone, mesh, resolution, directory):
    report = os.path.join(directory, "report.json")
    subprocess.run([raycone, "lattice", mesh, "--resolution", str(resolution), "--threads", "1", "--quiet",
                    "-o", os.path.join(directory, "out.npy"), "--report", report], check=True)
    with open(report, encoding="utf-8") as file:
        seconds = json.load(file)["seconds"]
    return seconds["prepare"] + seconds["evaluate"]


def main(raycone, meshes):
    print("| mesh | samples | estimated s | measured s | ratio |\n|---|---:|---:|---:|---:|")
    ratios = []
    with tempfile.TemporaryDirectory() as directory:
        for mesh in meshes:
            for counts, seconds in estimates(raycone, mesh):
                if seconds > MOST:
                    continue
                truth = measured(raycone, mesh, max(counts), directory)
                ratios.append(seconds / truth)
                name = os.path.splitext(os.path.basename(mesh))[0]
                print("| %s | %d x %d x %d | %.2f | %.2f | %.2f |" % (name, *counts, seconds, truth, ratios[-1]),
                      flush=True)
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios)) if ratios else math.nan
    off = sum(not 0.5 <= ratio <= 2 for ratio in ratios)
    print("\n%d estimates, %.2f on average, %d off by more than a factor of two." % (len(ratios), mean, off))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
