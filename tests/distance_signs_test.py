#!/usr/bin/env python3
"""The sign of a distance is the side that `--field inside` says, at every sample: on all shared meshes that load, in
the band and beyond it, by two rules. python3 tests/distance_signs_test.py RAYCONE MESHES [RESOLUTION]

Samples whose distance is zero have no side. Exit status 77 where the meshes are absent.
"""

import array
import csv
import os
import shutil
import subprocess
import sys
import tempfile

raycone, meshes = sys.argv[1:3]
resolution = sys.argv[3] if len(sys.argv) > 3 else "20"
manifest = os.path.join(meshes, "MANIFEST.csv")
if not os.path.exists(manifest):
    print(f"no {manifest}: skipped")
    sys.exit(77)


def fields_of(paths, folder, *options):
    """Of each mesh the lattice's samples: floats, or bytes of 0 and 1. A batch: starts would take most of the time."""
    mesh_list, out = os.path.join(folder, "meshes"), os.path.join(folder, "out")
    with open(mesh_list, "w", encoding="utf-8") as file:
        file.writelines(f"{path}\n" for path in paths)
    subprocess.run([raycone, "batch", "@" + mesh_list, "--out-dir", out, "--format", "npy", "--full-names",
                    "--resolution", resolution, "--padding", "2v", "--quiet", *options], check=True)
    with open(os.path.join(out, "results.csv"), encoding="utf-8") as file:
        outputs = {row["mesh"]: os.path.join(out, row["output"]) for row in csv.DictReader(file)}
    values = {path: read_npy(outputs[os.path.basename(path)]) for path in paths}
    shutil.rmtree(out)
    return values


def read_npy(path):
    with open(path, "rb") as file:
        data = file.read()
    header_end = 10 + int.from_bytes(data[8:10], "little")
    header, body = data[10:header_end], data[header_end:]
    assert b"'<f4'" in header or b"'|b1'" in header, header
    return array.array("f", body) if b"'<f4'" in header else body


def wrong_signs(distances, sides):
    assert len(distances) == len(sides) > 0
    return sum(1 for distance, side in zip(distances, sides) if distance != 0 and (distance < 0) != (side != 0))


RULES = ("threshold=0.5", "odd")
with open(manifest, encoding="utf-8") as lines:
    paths = [os.path.join(meshes, row["file"]) for row in csv.DictReader(lines) if row["expect"].startswith("load")]
samples, wrong, other = 0, 0, 0
with tempfile.TemporaryDirectory() as folder:
    sides = {rule: fields_of(paths, folder, "--field", "inside", "--rule", rule) for rule in RULES}
    for rule, band in (("threshold=0.5", "3"), ("threshold=0.5", "all"), ("odd", "3")):
        distances = fields_of(paths, folder, "--field", "sdf", "--rule", rule, "--band", band)
        for path in paths:
            count = wrong_signs(distances[path], sides[rule][path])
            samples += len(distances[path])
            wrong += count
            if count > 0:
                print(f"{path}, {rule}, --band {band}: {count} of {len(distances[path])} samples on the wrong side")
            if rule == "odd":
                other += wrong_signs(distances[path], sides["threshold=0.5"][path])
print(f"{len(paths)} meshes, {samples} samples: {wrong} on the wrong side, {other} where the rule were another")
# The comparison can fail: rules differ somewhere.
sys.exit(1 if wrong or not paths or other == 0 else 0)
