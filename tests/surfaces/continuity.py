"""Whether --field solid is continuous across the holes of real meshes, which sdf is not.

usage: /usr/bin/python3 tests/surfaces/continuity.py RAYCONE MESH... [--resolution N] [--pictures DIRECTORY]

Of each mesh the largest difference between neighbouring samples, along axes and diagonals, in voxels, with --band all.
The exit status is 1 where solid jumps by more than 1.8 voxels; neighbours are 1.74 apart at most. With --pictures, the
cross-section through the largest jump of sdf is drawn as PPM: sdf, and solid beside it.
"""
import argparse
import itertools
import os
import subprocess
import sys
import tempfile

import numpy

MOST = 1.8


def jumps(values):
    """At each sample, the largest difference from a neighbour."""
    largest = numpy.zeros(values.shape)
    for step in itertools.product((-1, 0, 1), repeat=3):
        here, there = (tuple(slice(max(s * d, 0), min(s * d, 0) or None) for d in step) for s in (1, -1))
        largest[here] = numpy.maximum(largest[here], abs(values[here] - values[there]))
    return largest


def colours(values, voxel):
    """Blue outside, red inside, darker lines every four voxels, black at 0; the first axis goes right, the second
    up."""
    bands = 0.75 + 0.25 * (abs(values) / (4 * voxel) % 1 > 0.2)
    image = numpy.where((values < 0)[..., None], (235, 110, 90), (110, 150, 235)) * bands[..., None]
    image[abs(values) < 0.5 * voxel] = 0
    return image.astype("u1").transpose(1, 0, 2)[::-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raycone")
    parser.add_argument("meshes", nargs="+", metavar="MESH")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--pictures")
    arguments = parser.parse_args()
    wrong = 0
    print("| mesh | samples | largest jump of sdf, voxels | of solid |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as work:
        out = os.path.join(work, "out.npz")
        for path in arguments.meshes:
            subprocess.run([arguments.raycone, "lattice", path, "-o", out, "--field", "sdf,solid", "--band", "all",
                            "--dtype", "f64", "--orient", "auto", "--resolution", str(arguments.resolution), "--quiet",
                            "--verify", "20"], check=True)
            found = numpy.load(out)
            voxel = found["spacing"][0]
            at = {field: jumps(found[field]) / voxel for field in ("sdf", "solid")}
            print("| %s | %d | %.3f | %.3f |" % (os.path.basename(path), found["sdf"].size, at["sdf"].max(),
                                                 at["solid"].max()), flush=True)
            wrong += at["solid"].max() > MOST
            if arguments.pictures:
                layer = numpy.unravel_index(at["sdf"].argmax(), at["sdf"].shape)[2]
                image = numpy.concatenate([colours(found[field][:, :, layer], voxel) for field in at], axis=1)
                image = image.repeat(5, axis=0).repeat(5, axis=1)
                with open(os.path.join(arguments.pictures, os.path.basename(path) + ".ppm"), "wb") as file:
                    file.write(b"P6 %d %d 255\n" % (image.shape[1], image.shape[0]) + image.tobytes())
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
