#!/usr/bin/env python3
"""The sign of a distance is the side that `--field inside` says, at every sample: on all shared meshes that load, in the
band and beyond it, by two rules. python3 tests/distance_signs_test.py RAYCONE MESHES [RESOLUTION]

Samples whose distance is zero have no side. Exit status 77 where the meshes are absent.
"""

import array
import csv
import os
import subprocess
import sys
import tempfile

raycone, meshes = sys.argv[1:3]
resolution = sys.argv[3] if len(sys.argv) > 3 else "20"
manifest = os.path.join(meshes, "MANIFEST.csv")
if not os.path.exists(manifest):
    print(f"no {manifest}: skipped")
    sys.exit(77)


def values_of(path, out, *options):
    """Of the lattice's samples: floats, or bytes of 0 and 1."""
    command = [raycone, "lattice", path, "-o", out, "--resolution", resolution, "--padding", "2v", "--quiet", *options]
    subprocess.run(command, check=True)
    with open(out, "rb") as file:
        data = file.read()
    header_end = 10 + int.from_bytes(data[8:10], "little")
    header, body = data[10:header_end], data[header_end:]
    assert b"'<f4'" in header or b"'|b1'" in header, header
    return array.array("f", body) if b"'<f4'" in header else body


def wrong_signs(distances, sides):
    assert len(distances) == len(sides) > 0
    return sum(1 for distance, side in zip(distances, sides) if distance != 0 and (distance < 0) != (side != 0))


def check(path, out):
    """How many samples there are, how many have the wrong sign, and how many have that of the other rule."""
    sides = {rule: values_of(path, out, "--field", "inside", "--rule", rule) for rule in ("threshold=0.5", "odd")}
    samples, wrong, other = 0, 0, 0
    for rule, band in (("threshold=0.5", "3"), ("threshold=0.5", "all"), ("odd", "3")):
        distances = values_of(path, out, "--field", "sdf", "--rule", rule, "--band", band)
        samples += len(distances)
        wrong += wrong_signs(distances, sides[rule])
        if rule == "odd":
            other += wrong_signs(distances, sides["threshold=0.5"])
    return samples, wrong, other


total = [0, 0, 0]
count, failures = 0, 0
with tempfile.TemporaryDirectory() as folder, open(manifest, encoding="utf-8") as lines:
    for row in csv.DictReader(lines):
        if not row["expect"].startswith("load"):
            continue
        numbers = check(os.path.join(meshes, row["file"]), os.path.join(folder, "out.npy"))
        total = [a + b for a, b in zip(total, numbers)]
        count += 1
        if numbers[1] > 0:
            failures += 1
            print(f"{row['file']}: {numbers[1]} of {numbers[0]} samples on the wrong side")
print(f"{count} meshes, {total[0]} samples: {total[1]} on the wrong side, {total[2]} where the rule were another")
# The comparison can fail: rules differ somewhere.
sys.exit(1 if failures or count == 0 or total[2] == 0 else 0)
