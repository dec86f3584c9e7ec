#!/usr/bin/env python3
"""Makes a broken scan of the teapot: python3 data/make_broken_scan.py SCAN.obj

What scanners leave: holes where they could not see, noise, and faces twice where two scans overlap. y points up, as in
most OBJ files. Output is the same, byte for byte, on each run and machine.
"""

import pathlib
import random
import sys

# Balls, each a centre and a radius in the teapot's coordinates: faces whose middle is in one are missing.
HOLES = [((1.0, -1.6, 1.3), 0.45), ((-0.9, -1.7, 0.7), 0.35), ((-0.6, 1.7, 1.5), 0.6), ((0.5, -0.8, 2.5), 0.3)]
OVERLAP = ((0.2, -2.0, 0.9), 0.7)  # a ball whose faces are there twice
NOISE = 0.008  # how far a coordinate is moved at most


def read(path):
    vertices, triangles = [], []
    for line in path.read_text(encoding="ascii").splitlines():
        kind, *words = line.split()
        if kind == "v":
            vertices.append(tuple(map(float, words)))
        elif kind == "f":
            triangles.append(tuple(int(word) for word in words))
    return vertices, triangles


def is_in_ball(triangle, vertices, ball):
    centre, radius = ball
    middle = [sum(vertices[corner - 1][axis] for corner in triangle) / 3 for axis in range(3)]
    return sum((m - c) ** 2 for m, c in zip(middle, centre)) < radius**2


def damaged(triangles, vertices):
    kept = [t for t in triangles if not any(is_in_ball(t, vertices, hole) for hole in HOLES)]
    return kept + [t for t in kept if is_in_ball(t, vertices, OVERLAP)]


def noisy(vertices):
    """Each vertex moved; random.Random is specified to give the same numbers everywhere."""
    numbers = random.Random(1)
    return [tuple(c + NOISE * (2 * numbers.random() - 1) for c in vertex) for vertex in vertices]


def main():
    vertices, triangles = read(pathlib.Path(__file__).resolve().parent / "meshes" / "teapot.obj")
    lines = ["# A broken scan of the Utah teapot, y up", "# Made by data/make_broken_scan.py"]
    lines += ["v %.6f %.6f %.6f" % (x, z, -y) for x, y, z in noisy(vertices)]
    lines += ["f %d %d %d" % triangle for triangle in damaged(triangles, vertices)]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
