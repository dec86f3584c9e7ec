"""Occupancy of uniform points, one thread: the raycone columns of a table of docs/benchmarks.md.
/usr/bin/python3 tests/bench/occupancy.py RAYCONE MESH... [--points N] [--save DIRECTORY]

Seconds are those of preparing and evaluating, the least of three runs. `wrong` counts labels that differ from the
direct sum's. With --save the points (float32, as .npy) and raycone's labels are left there for other programs.
"""

import argparse
import json
import os
import subprocess
import tempfile

import numpy


def run(raycone, words):
    subprocess.run([raycone, *words, "--threads", "1", "--quiet"], check=True)


def occupancy(raycone, mesh, points, directory):
    info = subprocess.run([raycone, "info", mesh, "--json"], check=True, capture_output=True).stdout
    facts = json.loads(info)
    lower, upper = (numpy.array(corner) for corner in facts["bounds"])
    name = os.path.join(directory, os.path.splitext(os.path.basename(mesh))[0])
    drawn = lower + (upper - lower) * numpy.random.default_rng(1).random((points, 3))
    numpy.save(name + ".points.npy", drawn.astype(numpy.float32))
    seconds = []
    for _ in range(3):
        report = name + ".json"
        words = ["points", mesh, name + ".points.npy", "-o", name + ".inside.npy", "--field", "inside"]
        run(raycone, [*words, "--report", report])
        with open(report, encoding="utf-8") as file:
            spent = json.load(file)["seconds"]
        seconds.append(spent["prepare"] + spent["evaluate"])
    run(raycone, ["points", mesh, name + ".points.npy", "-o", name + ".direct.npy", "--tolerance", "0"])
    direct = numpy.load(name + ".direct.npy") >= 0.5
    wrong = numpy.count_nonzero(direct != numpy.load(name + ".inside.npy").astype(bool))
    print("| %s | %d | %d | %.2f | %d |" % (
        os.path.basename(name), facts["faces"], facts["exterior_edges"], min(seconds), wrong), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("raycone")
    parser.add_argument("mesh", nargs="+")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--save")
    given = parser.parse_args()
    print("| mesh | faces | edges | raycone s | wrong |\n|---|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as directory:
        if given.save:
            os.makedirs(given.save, exist_ok=True)
        for mesh in given.mesh:
            occupancy(given.raycone, mesh, given.points, given.save or directory)


if __name__ == "__main__":
    main()
