"""Damaged meshes: python3 damaged_meshes_test.py RAYCONE MESH_DIRECTORY [SHARED_MESHES] [--count N] [--seed N]

Meshes of up to 100 kB, those of SHARED_MESHES too where it is there, with some of their numbers, lines or bytes changed:
corners far away or in one place, faces repeated, exchanged or torn off, files cut. Each of N (80) is refused in one line, or
gives values that --verify finds right, and the same bytes by another engine and instruction set and as single points.
"""

import argparse
import collections
import os
import random
import struct
import subprocess
import sys
import tempfile

from runs import MESHES, RAYCONE, contents, fail, report

parser = argparse.ArgumentParser()
parser.add_argument("raycone_and_meshes", nargs=2)
parser.add_argument("shared", nargs="?", default="")
parser.add_argument("--count", type=int, default=80)
parser.add_argument("--seed", type=int, default=1)
options = parser.parse_args()

LARGEST = 100_000
NUMBERS = [0.0, -0.0, 1.0, -7.25, 1e-45, 1e-38, 1e-20, 1e-5, 1e10, -1e30, 3e38]
LIMITS = ["--memory-limit", "1G", "--timeout", "100"]
chance = random.Random(options.seed)
choose = chance.choice
seen = collections.Counter()


def meshes():
    paths = [os.path.join(MESHES, name) for name in os.listdir(MESHES)]
    for directory, _, names in os.walk(options.shared):
        paths += [os.path.join(directory, name) for name in names]
    formats = (".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3mf")
    return sorted(path for path in paths if path.lower().endswith(formats) and os.path.getsize(path) <= LARGEST)


# --- Damage: bytes in, bytes out

def change_bytes(data):
    data, at, length = bytearray(data), chance.randrange(len(data)), chance.randrange(1, 200)
    kind = chance.randrange(4)
    if kind == 0:
        data[at] ^= 1 << chance.randrange(8)
    elif kind == 1:
        del data[at:]
    elif kind == 2:
        del data[at : at + length]
    else:
        data[at : at + length] = data[chance.randrange(len(data)) :][:length]
    return bytes(data)


# A coordinate becomes another number; an index one of its line; or the line is replaced by the next one.
def change_line(data):
    lines = data.split(b"\n")
    at = chance.randrange(len(lines) - 1) if len(lines) > 1 else 0
    words = lines[at].split(b" ")
    place = chance.randrange(len(words))
    if b"." in words[place]:
        words[place] = choose([repr(choose(NUMBERS)).encode(), words[place] + choose([b"1", b"e1", b"e-9", b"e30", b"e-200"])])
    else:
        words[place] = choose(words[1:] or words)
    lines[at] = lines[at + 1] if len(lines) > 1 and chance.random() < 0.2 else b" ".join(words)
    return b"\n".join(lines)


# The like in a binary file, whose numbers lie at even places; headers are mostly spared.
def change_record(data):
    places = range(min(84, len(data) // 2) & ~1, len(data) - 4, 2)
    if not places:
        return change_bytes(data)
    at, other = choose(places), choose(places)
    number = choose([struct.pack("<f", choose(NUMBERS)), data[other : other + 4], data[other : other + 50]])
    return data[:at] + number + data[at + len(number) :]


def damaged(data):
    change = change_record if b"\0" in data else change_line
    for _ in range(choose([1, 1, 2, 3, 5, 10])):
        data = change(data)
    return change_bytes(data) if chance.random() < 0.1 else data


# --- What must hold

def run(*arguments):
    process = subprocess.run([RAYCONE, *arguments, *LIMITS], stdin=subprocess.DEVNULL, capture_output=True, timeout=300)
    return process.returncode, process.stderr


# The columns of a CSV from this one on, without its header.
def columns(path, first, last=None):
    return [line.split(b",")[first:last] for line in contents(path).splitlines()[1:]]


def check(what, mesh, data):
    with open(mesh, "wb") as file:
        file.write(data)
    lattice = ["lattice", mesh, "--diagnostics", "--resolution", choose(["6", "9", "5,4,7"]), "--padding", choose(["0", "2v", "1e3"])]
    status, message = run(*lattice, "-o", "a.csv", "--verify", "20", "--threads", "2")
    errors = [line for line in message.splitlines() if not line.startswith(b"raycone: warning: ")]
    seen[status] += 1
    if status not in (0, 2, 4) or len(errors) != 1 or not errors[0].startswith(b"raycone: "):
        fail(what, status, message)
    if status != 0:
        return
    status, message = run(*lattice, "-o", "b.csv", "--engine", "embree", "--simd", "sse4", "--threads", "3")
    if status != 0 or contents("b.csv") != contents("a.csv"):
        fail(what + ": by another engine", status, message)
    with open("points.csv", "wb") as points:
        points.writelines(b",".join(point) + b"\n" for point in columns("a.csv", 3, 6))
    status, message = run("points", mesh, "points.csv", "--diagnostics", "-o", "c.csv")
    if status != 0 or columns("c.csv", 3) != columns("a.csv", 6):
        fail(what + ": as points", status, message)


with tempfile.TemporaryDirectory() as directory:
    paths = [os.path.abspath(path) for path in meshes()]
    has_shared = os.path.isdir(options.shared)
    os.chdir(directory)
    for i in range(options.count):
        path = choose(paths)
        check("mesh %d of seed %d, %s" % (i, options.seed, os.path.basename(path)), "mesh" + os.path.splitext(path)[1].lower(),
              damaged(contents(path)))
    os.chdir("/")
if not has_shared:
    print("without shared meshes, so that only OBJ is damaged")
print("of %d meshes: %s" % (len(paths), ", ".join("status %d: %d" % item for item in sorted(seen.items()))))
# Else the damage would try too little.
if seen[0] < options.count // 4 or seen[2] < options.count // 10:
    fail("too few that are evaluated, or refused", 0, b"")
sys.exit(report())
