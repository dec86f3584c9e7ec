#!/usr/bin/env python3
"""Shared meshes through the executable: python3 tests/shared_meshes_test.py RAYCONE MESHES [--all]

Meshes that should load become a VDB whose transform and values, read by pyopenvdb, are those of the CSV; the CSV is the
same, to the byte, by the other engine with the lowest SIMD level, and so are the values of its samples taken as points.
The others get one line on standard error and exit status 2, and leave no output. Exit status 77 where meshes or pyopenvdb are absent.
--all: also those of more than 20 000 faces.
"""

import csv
import math
import os
import struct
import subprocess
import sys
import tempfile

try:
    import pyopenvdb
except ImportError:
    print("no pyopenvdb: skipped")
    sys.exit(77)

raycone, meshes = sys.argv[1:3]
most_faces = math.inf if "--all" in sys.argv else 20000
manifest = os.path.join(meshes, "MANIFEST.csv")
if not os.path.exists(manifest):
    print(f"no {manifest}: skipped")
    sys.exit(77)

OPTIONS = ["--resolution", "12", "--quiet"]
LOADS_ALL_THE_SAME = {"trimesh__notenoughindices.obj",  # one good triangle, and a face of two corners
                      "draco__Box_Draco.glb"}  # refused before Draco was read
MAY_BE_EITHER = {"meshoptimizer__pirate.glb", "pmp-library__beetle.off"}
TOO_SMALL_FOR_VDB = {"derived/spot_tiny_1e-9.obj"}
failures = []


def run(*arguments):
    return subprocess.run([raycone, *arguments], capture_output=True, text=True, check=False)


def expect(condition, mesh, what):
    if not condition:
        failures.append(f"{mesh}: {what}")


def bits_of(number):
    return struct.unpack("I", struct.pack("f", number))[0]


def as_float(value):
    """The nearest float; but a half-integer, where rules decide, stands only for what reaches it
    (io/fields/narrowing.h)."""
    nearest = struct.unpack("f", struct.pack("f", value))[0]
    if abs(nearest) % 1 != 0.5 or nearest == value or 0 < nearest < value:
        return nearest
    towards_zero = abs(nearest) > abs(value)
    return struct.unpack("f", struct.pack("I", bits_of(nearest) + (-1 if towards_zero else 1)))[0]


def compare(mesh, vdb, text):
    grid = pyopenvdb.read(vdb, "winding")
    values = grid.getConstAccessor()
    rows = list(csv.DictReader(text.splitlines()))
    # Position = origin + index * spacing, rounded in another order by OpenVDB: some units in the last place.
    tolerance = 8 * math.ulp(max((abs(float(row[name])) for row in rows for name in "xyz"), default=0.0))
    for row in rows:
        index = (int(row["i"]), int(row["j"]), int(row["k"]))
        if values.getValue(index) != as_float(float(row["w"])):
            return expect(False, mesh, f"value at {index} is {values.getValue(index)}, in the CSV {row['w']}")
        world = grid.transform.indexToWorld(index)
        for axis, name in enumerate("xyz"):
            if abs(world[axis] - float(row[name])) > tolerance:
                return expect(False, mesh, f"position of {index} is {world}, in the CSV {row}")
    return expect(rows, mesh, "empty CSV")


def compare_points(mesh, path, folder, text, options):
    samples = os.path.join(folder, "samples.csv")
    with open(samples, "w", encoding="utf-8") as file:
        file.write(text)
    scale = [option for option in options if option in ("--scale", "1e9")]
    points = run("points", path, samples, "--quiet", *scale)
    expected = [line.split(",")[3:] for line in text.splitlines()]
    expect([line.split(",") for line in points.stdout.splitlines()] == expected, mesh, f"points differ: {points.stderr}")
    os.remove(samples)


def outputs_of_batch(good, folder, *options):
    """Of each mesh its output: one batch, since starts would take most of the time."""
    mesh_list = os.path.join(folder, "meshes")
    with open(mesh_list, "w", encoding="utf-8") as file:
        file.writelines(f"{path}\n" for path in good.values())
    out = os.path.join(folder, "out")
    made = run("batch", "@" + mesh_list, "--out-dir", out, "--full-names", *OPTIONS, *options)
    expect(made.returncode == 0, "batch", f"{made.returncode} {made.stderr}")
    with open(os.path.join(out, "results.csv"), encoding="utf-8") as file:
        outputs = {row["mesh"]: os.path.join(out, row["output"]) for row in csv.DictReader(file)}
    return {mesh: outputs[os.path.basename(path)] for mesh, path in good.items()}


def check_good(good, folder):
    """VDB and the other engine by batches, CSV by `lattice`."""
    texts = {}
    for mesh, path in good.items():
        text = run("lattice", path, "-o", "-", *OPTIONS)
        expect(text.returncode == 0, mesh, f"{text.returncode} {text.stderr}")
        compare_points(mesh, path, folder, text.stdout, OPTIONS)
        texts[mesh] = text.stdout
    with tempfile.TemporaryDirectory() as scratch:
        for mesh, vdb in outputs_of_batch(good, scratch, "--format", "vdb").items():
            compare(mesh, vdb, texts[mesh])
    with tempfile.TemporaryDirectory() as scratch:
        other = ("--format", "csv", "--engine", "embree", "--simd", "sse4")
        for mesh, output in outputs_of_batch(good, scratch, *other).items():
            with open(output, encoding="utf-8", newline="") as file:
                expect(file.read() == texts[mesh], mesh, "Embree's lattice differs")


def check_too_small(mesh, path, folder):
    vdb = os.path.join(folder, "out.vdb")
    refused = run("lattice", path, "-o", vdb, *OPTIONS)
    expect(refused.returncode == 3 and "--scale" in refused.stderr, mesh, f"expected a hint at --scale: {refused}")
    expect(not os.path.exists(vdb), mesh, "refused, but there is output")
    options = [*OPTIONS, "--scale", "1e9"]
    made, text = run("lattice", path, "-o", vdb, *options), run("lattice", path, "-o", "-", *options)
    expect(made.returncode == 0 and text.returncode == 0, mesh, f"{made.returncode} {made.stderr}{text.stderr}")
    compare(mesh, vdb, text.stdout)
    compare_points(mesh, path, folder, text.stdout, options)
    os.remove(vdb)


def check_bad(mesh, path, folder):
    vdb = os.path.join(folder, "bad.vdb")
    result = run("lattice", path, "-o", vdb)
    expect(result.returncode == 2, mesh, f"exit status {result.returncode}, expected 2")
    expect(result.stderr.startswith(f"raycone: {path}"), mesh, f"message {result.stderr!r}")
    expect(result.stderr.count("\n") == 1, mesh, f"expected one line: {result.stderr!r}")
    expect(not os.listdir(folder), mesh, f"left behind: {os.listdir(folder)}")


count, good = 0, {}
with tempfile.TemporaryDirectory() as folder:
    with open(manifest, encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            name = row["file"]
            if name in MAY_BE_EITHER or int(row["faces"] or 0) > most_faces:
                continue
            count += 1
            path = os.path.join(meshes, name)
            if name in TOO_SMALL_FOR_VDB:
                check_too_small(name, path, folder)
            elif row["expect"].startswith("load") or name in LOADS_ALL_THE_SAME:
                good[name] = path
            else:
                check_bad(name, path, folder)
    check_good(good, folder)
print("\n".join(failures))
print(f"{count} meshes, {len(failures)} failures")
sys.exit(1 if failures or not good else 0)
