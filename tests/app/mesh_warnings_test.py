#!/usr/bin/env python3
"""Warnings about meshes: python3 tests/app/mesh_warnings_test.py RAYCONE DUMP_MESH MESHES

Each warning on a mesh that has it, in every place that tells it, and on near misses; then those of all shared meshes
against volumes in integers, which have no rounding, and edges counted one by one.
"""

import csv
import itertools
import json
import math
import os
import subprocess
import sys
import tempfile

raycone, dump_mesh, meshes = sys.argv[1:]
failures = []


def expect(condition, mesh, what):
    if not condition:
        failures.append(f"{mesh}: {what}")


def run(*arguments, **options):
    return subprocess.run([raycone, *arguments], capture_output=True, text=True, check=False, **options)


def box(lower, upper, flip=False, without=()):
    """Triangles of a cube, outward unless flipped; without those of some numbers."""
    corners = list(itertools.product(*[(lower, upper)] * 3))
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    triangles = [tuple(corners[v] for v in face) for face in faces]
    return [t[::-1] if flip else t for n, t in enumerate(triangles) if n not in without]


def obj(triangles):
    lines = [f"v {x!r} {y!r} {z!r}" for t in triangles for x, y, z in t]
    return "\n".join(lines + [f"f {3 * n + 1} {3 * n + 2} {3 * n + 3}" for n in range(len(triangles))]) + "\n"


CUBE = box(0.0, 1.0)
SPIKE = [((0.0, 0.0, 0.0), (1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0))]
CELLS = CUBE + [tuple((x + 1.0, y, z) for x, y, z in t) for t in CUBE]  # two, with a wall between them
CASES = {  # name: (triangles, options, warnings)
    "good": (CUBE, [], []),
    "hollow": (box(0.0, 9.0) + box(4.0, 5.0, True), [], []),
    "open": (box(0.0, 1.0, False, (0, 1)), [], []),
    "reversed": (box(0.0, 1.0, True), [], ["reversed", "empty"]),
    "two": (box(0.0, 1.0) + box(2.0, 3.0, True), [], ["reversed"]),
    "inconsistent": ([CUBE[0][::-1]] + CUBE[1:], [], ["inconsistent"]),
    "double": (CUBE + box(0.0, 1.0, True), [], ["opposite-duplicates", "empty"]),
    "twice": (CUBE + CUBE, [], []),
    "wall": (CUBE + [CUBE[3][::-1], CUBE[3]], [], ["opposite-duplicates"]),
    "cells": (CELLS, [], ["opposite-duplicates"]),
    "cells kept once": (CELLS, ["--orient", "auto"], ["walls"]),
    "double, kept once": (CUBE + box(0.0, 1.0, True), ["--orient", "auto"], []),
    "face and back": (CUBE + [CUBE[3][::-1]], ["--orient", "auto"], []),
    "collapsed": (CUBE + SPIKE, ["--weld", "1e-3"], ["weld-collapsed"]),
    "kept": (CUBE + SPIKE, ["--weld", "1e-9"], []),
    "bubble": (box(0.0, 9.0, False, (0, 1)) + box(4.0, 5.0, True), [], ["reversed"]),
    "cavity": (box(0.0, 9.0, False, (0, 1)) + box(4.0, 5.0, True), ["--orient", "auto"], []),
    "flat": ([((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))], [], []),
    "huge": (box(-1e300, 1e300, True), [], ["reversed", "empty"]),
    "tiny": (box(0.0, 1e-300, True), [], ["reversed", "empty"]),
    "zeros": (CUBE + [tuple(tuple(-0.0 if c == 0 else c for c in p) for p in t) for t in box(0.0, 1.0, True)], [],
              ["opposite-duplicates", "empty"]),
}
DEFAULT_RULE = ["--field", "inside", "--resolution", "8"]


def named_on(stderr, path):
    start = f"raycone: warning: {path}: "
    return [line[len(start):].split(":")[0] for line in stderr.splitlines() if line.startswith(start)]


def check_case(name, triangles, options, expected, directory):
    path, out, report = (os.path.join(directory, name + end) for end in (".obj", ".npy", ".json"))
    with open(path, "w", encoding="utf-8") as file:
        file.write(obj(triangles))
    done = run("lattice", path, "-o", out, "--report", report, *DEFAULT_RULE, *options)
    expect(done.returncode == 0, name, done.stderr)
    with open(report, encoding="utf-8") as file:
        told = json.load(file)
    expect(named_on(done.stderr, path) == expected, name, f"printed {done.stderr}, expected {expected}")
    expect(told["warnings"] == expected, name, f"reported {told['warnings']}, expected {expected}")
    expect([line.split(":")[0] for line in told["warning_lines"]] == expected, name, told["warning_lines"])
    before = [warning for warning in expected if warning != "empty"]
    info = run("info", path, "--json", *options)
    expect(json.loads(info.stdout)["warnings"] == before, name, f"info: {info.stdout}")
    expect(named_on(info.stderr, path) == before, name, f"info printed {info.stderr}")
    os.remove(out)
    strict = run("lattice", path, "-o", out, "--strict", *DEFAULT_RULE, *options)
    expect(strict.returncode == (2 if expected else 0), name, f"--strict: {strict.returncode} {strict.stderr}")
    expect(os.path.exists(out) == (not expected), name, "--strict and the output")
    if expected:
        expect(f": {expected[0]}: " in strict.stderr, name, f"--strict: {strict.stderr}")
    batch = run("batch", path, "--out-dir", os.path.join(directory, "out-" + name), *DEFAULT_RULE, *options, "--format",
                "npy")
    expect(batch.returncode == 0, name, batch.stderr)
    with open(os.path.join(directory, "out-" + name, "results.csv"), encoding="utf-8") as file:
        row = next(csv.DictReader(file))
    expect(row["warnings"].split() == expected, name, f"results.csv: {row['warnings']}")
    strict = run("batch", path, "--out-dir", os.path.join(directory, "strict-" + name), *DEFAULT_RULE, *options,
                 "--format", "npy", "--strict")
    expect(strict.returncode == (5 if expected else 0), name, f"batch --strict: {strict.returncode} {strict.stderr}")
    with open(os.path.join(directory, "strict-" + name, "results.csv"), encoding="utf-8") as file:
        row = next(csv.DictReader(file))
    expect(row["warnings"].split() == expected[:1], name, f"results.csv, --strict: {row['warnings']}")


def check_empty(directory):
    """What says nothing about the mesh is not `empty`: a lattice beside it, fields without a rule, points."""
    path, out = os.path.join(directory, "reversed.obj"), os.path.join(directory, "e.npy")
    for options in (["--field", "winding"], ["--field", "density"],
                    ["--field", "inside", "--bounds", "5,5,5,6,6,6"], ["--field", "inside", "--rule", "nonzero"]):
        done = run("lattice", path, "-o", out, "--resolution", "8", *options)
        expect(named_on(done.stderr, path) == ["reversed"], "reversed.obj", f"{options}: {done.stderr}")
    done = run("points", path, "-", "--field", "inside", input="0.5 0.5 0.5\n")
    expect(named_on(done.stderr, path) == ["reversed"], "reversed.obj", f"points: {done.stderr}")
    # Drawn points are where the mesh is, unless a box is given. A few may all miss it.
    drawn = os.path.join(directory, "e.npz")
    for options, expected in ((["uniform=900,near=100:0.1"], ["reversed", "empty"]),
                              (["near=1000:0.1", "--field", "sdf"], ["reversed", "empty"]),
                              (["uniform=900,near=100:0.1", "--strict", "--orient", "flip"], []),
                              (["uniform=999,surface=999,near=999:0.3"], ["reversed"]),
                              (["uniform=1000", "--padding", "40%"], ["reversed", "empty"]),
                              (["uniform=1000", "--padding", "60%"], ["reversed"]),
                              (["uniform=1000", "--bounds", "5,5,5,6,6,6"], ["reversed"]),
                              (["uniform=1000", "--field", "winding"], ["reversed"]),
                              (["surface=1000"], ["reversed"])):
        done = run("points", path, "-o", drawn, "--sample", *options)
        expect(done.returncode == 0, "reversed.obj", f"{options}: {done.stderr}")
        expect(named_on(done.stderr, path) == expected, "reversed.obj", f"{options}: {done.stderr}")
    flat = os.path.join(directory, "flat.obj")
    with open(flat, "w", encoding="utf-8") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    done = run("points", flat, "-o", drawn, "--sample", "uniform=1000", "--rule", "threshold=2", "--field", "inside")
    expect(named_on(done.stderr, flat) == [], "flat.obj", done.stderr)
    # Where units differ, that is what is told, and not what helps fine lattices.
    small = os.path.join(directory, "small.obj")
    with open(small, "w", encoding="utf-8") as file:
        file.write(obj(box(0.01, 0.046)))
    for size, hint in ("0.2", "the mesh is 0.036 long, and samples are 0.2 apart; --scale"), ("0.008", "--orient auto"):
        done = run("lattice", small, "-o", out, "--voxel-size", size, "--field", "inside", "--rule", "threshold=2")
        expect(hint in done.stderr, "small.obj", f"{size}: {done.stderr}")


def triangles_in(paths):
    """Of each path, None where it cannot be read."""
    dumped = subprocess.run([dump_mesh, "--cut"], input="\n".join(paths), capture_output=True, text=True, check=False)
    lines = dumped.stdout.splitlines()
    expect(len(lines) == len(paths), dump_mesh, f"{len(lines)} lines for {len(paths)} meshes: {dumped.stderr}")
    return map(triangles_of_line, lines)


def triangles_of_line(line):
    if not line.startswith("mesh "):
        return None
    numbers = [float.fromhex(word) + 0.0 for word in line.split()[2:]]
    return [tuple(tuple(numbers[n + 3 * i:n + 3 * i + 3]) for i in range(3)) for n in range(0, len(numbers), 9)]


def determinant(a, b, c):
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0]))


def solid_angles(triangles, q):
    """The winding number, in floating point (Van Oosterom and Strackee 1983)."""
    total = 0.0
    for t in triangles:
        a, b, c = (tuple(x - y for x, y in zip(p, q)) for p in t)
        la, lb, lc = math.hypot(*a), math.hypot(*b), math.hypot(*c)
        dot = lambda u, v: sum(x * y for x, y in zip(u, v))
        total += 2 * math.atan2(determinant(a, b, c),
                                la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    return total / (4 * math.pi)


def parts_of(triangles):
    parent = {}

    def root(p):
        while parent.setdefault(p, p) != p:
            parent[p] = p = parent[parent[p]]
        return p

    for a, b, c in triangles:
        parent[root(b)] = parent[root(c)] = root(a)
    parts = {}
    for t in triangles:
        parts.setdefault(root(t[0]), []).append(t)
    return list(parts.values())


def edges_of(triangles):
    edges = {}
    for t in triangles:
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            if a != b:
                edges.setdefault((min(a, b), max(a, b)), [0, 0])[a < b] += 1
    return edges.values()


def is_closed(triangles):
    return all(back == forth for back, forth in edges_of(triangles))


def volume(triangles):
    """The sign is exact: all coordinates as integers of one unit."""
    unit = max((x.as_integer_ratio()[1] for t in triangles for p in t for x in p), default=1)
    whole = lambda p: tuple(int(n * (unit // d)) for n, d in map(float.as_integer_ratio, p))
    return sum(determinant(*map(whole, t)) for t in triangles)


def is_surrounded(part, others):
    """None where a rounded winding number cannot tell."""
    q = min(p for t in part for p in t)
    numbers = [solid_angles(other, q) for other in others]
    if any(abs(w - round(w)) > 1e-3 for w in numbers):
        return None
    return any(round(w) != 0 for w in numbers)


def names_by_definition(triangles):
    closed = [part for part in parts_of(triangles) if is_closed(part)]
    names, reversed_parts = [], []
    for part in closed:
        if volume(part) < 0:
            reversed_parts.append(is_surrounded(part, [other for other in closed if other is not part]))
    if None in reversed_parts and False not in reversed_parts:
        return None
    if False in reversed_parts or (is_closed(triangles) and volume(triangles) < 0):
        names.append("reversed")
    if any(sorted(uses) == [0, 2] for uses in edges_of(triangles)):
        names.append("inconsistent")
    turned = set()
    for t in triangles:
        first = t.index(min(t))
        turned.add(t[first:] + t[:first])
    if any((a, c, b) in turned for a, b, c in turned if len({a, b, c}) == 3):
        names.append("opposite-duplicates")
    return names


def check_shared():
    compared, warned = 0, 0
    paths = [os.path.join(meshes, name) for name in sorted(os.listdir(meshes))
             if name.lower().endswith((".obj", ".ply", ".stl", ".off", ".glb"))]
    paths = [path for path in paths if os.path.getsize(path) <= 100_000]
    # One start of each program for all of them; `info` leaves out those that it cannot read.
    told_of = {mesh["mesh"]: mesh["warnings"] for mesh in json.loads(run("info", *paths, "--json").stdout)}
    for path, triangles in zip(paths, triangles_in(paths)):
        if not triangles or path not in told_of:
            continue
        expected = names_by_definition(triangles)
        told = [w for w in told_of[path] if w in ("reversed", "inconsistent", "opposite-duplicates")]
        if expected is None:
            continue
        expect(told == expected, os.path.basename(path), f"warnings {told}, expected {expected}")
        compared += 1
        warned += bool(expected)
    print(f"{compared} shared meshes, {warned} with warnings")
    expect(compared > 50, "shared meshes", f"only {compared}")


with tempfile.TemporaryDirectory() as directory:
    for case, (shape, flags, wanted) in CASES.items():
        check_case(case, shape, flags, wanted, directory)
    check_empty(directory)
if os.path.isdir(meshes):
    check_shared()
else:
    print(f"no {meshes}: shared meshes skipped")
print("\n".join(failures))
sys.exit(1 if failures else 0 if os.path.isdir(meshes) else 77)
