#!/usr/bin/env python3
"""Makes the meshes of data/meshes: python3 data/make_meshes.py [DIRECTORY]

Output is the same, byte for byte, on each run. Faces are counter-clockwise seen from outside, lengths have no unit,
z points up. The teapot is evaluated in rational arithmetic, so that patches that share an edge share its vertices.

The teapot: Martin E. Newell, "The Utilization of Procedure Models in Digital Image Synthesis", PhD thesis, University
of Utah, 1975; control points as published by Frank Crow, "The Origins of the Teapot", IEEE Computer Graphics and
Applications 7(1), 1987, pp. 8-19, flattened to 3/4 of its height as by Jim Blinn and with the bottom of that article.
"""

import math
import pathlib
import random
import sys
from fractions import Fraction

# Parts of revolution about z: (radius, z) of the four control rows of a patch, from the top down. A patch spans a
# quarter turn; its control points at radius r are (r, 0), (r, k r), (k r, r), (0, r) with k = 0.56, but for the widest
# row of the lid's knob, where Newell rounded 0.448 to 0.45.
LID_KNOB = [("0", "3.15"), ("0.8", "3.15"), ("0", "2.85"), ("0.2", "2.7")]
LID = [("0.2", "2.7"), ("0.4", "2.55"), ("1.3", "2.55"), ("1.3", "2.4")]
RIM = [("1.4", "2.4"), ("1.3375", "2.53125"), ("1.4375", "2.53125"), ("1.5", "2.4")]
BODY_UPPER = [("1.5", "2.4"), ("1.75", "1.875"), ("2", "1.35"), ("2", "0.9")]
BODY_LOWER = [("2", "0.9"), ("2", "0.45"), ("1.5", "0.225"), ("1.5", "0.15")]
BOTTOM = [("1.5", "0.15"), ("1.5", "0.075"), ("1.425", "0"), ("0", "0")]
REVOLVED = [LID_KNOB, LID, RIM, BODY_UPPER, BODY_LOWER, BOTTOM]

# Parts symmetric about the plane y = 0: per control row, from the part's start to its end, the (x, z) of the edge
# curve where it begins and where it ends, and the half width; the four control points of a row are
# (begin, y = 0), (begin, width), (end, width), (end, 0).
HANDLE_UPPER = [
    (("-1.6", "2.025"), ("-1.5", "2.25"), "0.3"),
    (("-2.3", "2.025"), ("-2.5", "2.25"), "0.3"),
    (("-2.7", "2.025"), ("-3", "2.25"), "0.3"),
    (("-2.7", "1.8"), ("-3", "1.8"), "0.3"),
]
HANDLE_LOWER = [
    (("-2.7", "1.8"), ("-3", "1.8"), "0.3"),
    (("-2.7", "1.575"), ("-3", "1.35"), "0.3"),
    (("-2.5", "1.125"), ("-2.65", "0.9375"), "0.3"),
    (("-2", "0.9"), ("-1.9", "0.6"), "0.3"),
]
SPOUT_LOWER = [
    (("1.7", "1.425"), ("1.7", "0.6"), "0.66"),
    (("2.6", "1.425"), ("3.1", "0.825"), "0.66"),
    (("2.3", "2.1"), ("2.4", "2.025"), "0.25"),
    (("2.7", "2.4"), ("3.3", "2.4"), "0.25"),
]
SPOUT_UPPER = [
    (("2.7", "2.4"), ("3.3", "2.4"), "0.25"),
    (("2.8", "2.475"), ("3.525", "2.49375"), "0.25"),
    (("2.9", "2.475"), ("3.45", "2.5125"), "0.15"),
    (("2.8", "2.4"), ("3.2", "2.4"), "0.15"),
]
MIRRORED = [HANDLE_UPPER, HANDLE_LOWER, SPOUT_LOWER, SPOUT_UPPER]

TEAPOT_SUBDIVISIONS = 10  # per patch and direction


class Mesh:
    """Vertices identified by position, and triangles; those with two equal corners are left out."""

    def __init__(self):
        self.vertices = {}
        self.triangles = []

    def vertex(self, point):
        return self.vertices.setdefault(tuple(map(decimal, point)), len(self.vertices) + 1)

    def add(self, *corners):
        """Adds a polygon as a fan of triangles from its first corner."""
        indices = [self.vertex(corner) for corner in corners]
        for second, third in zip(indices[1:], indices[2:]):
            if len({indices[0], second, third}) == 3:
                self.triangles.append((indices[0], second, third))

    def add_grid(self, rows):
        """Adds the quads of a grid of points; seen from the front, rows go down and columns to the right."""
        for upper, lower in zip(rows, rows[1:]):
            for column in range(len(upper) - 1):
                self.add(upper[column], lower[column], lower[column + 1], upper[column + 1])

    def write(self, path, title):
        lines = [f"# {title}", "# Made by data/make_meshes.py"]
        lines += ["v " + " ".join(vertex) for vertex in self.vertices]
        lines += ["f %d %d %d" % triangle for triangle in self.triangles]
        path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def decimal(number):
    """The number rounded to nine decimals, without trailing zeros; never "-0"."""
    scaled = round(number * 10**9)
    digits = str(abs(scaled)).rjust(10, "0")
    text = (digits[:-9] + "." + digits[-9:]).rstrip("0").rstrip(".")
    return "-" + text if scaled < 0 else text


def bernstein(t):
    return [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3]


def bezier_grid(control, subdivisions):
    """Points of the bicubic patch with the 4 x 4 control points given, rows first."""
    weights = [bernstein(Fraction(i, subdivisions)) for i in range(subdivisions + 1)]
    return [
        [
            tuple(sum(u[i] * v[j] * control[i][j][axis] for i in range(4) for j in range(4)) for axis in range(3))
            for v in weights
        ]
        for u in weights
    ]


def revolved_patches(rows):
    """The four quarter turns, counter-clockwise seen from above: rows go down, columns to the right."""
    for cos, sin in [(1, 0), (0, 1), (-1, 0), (0, -1)]:
        control = []
        for radius, height in rows:
            r, z = Fraction(radius), Fraction(height)
            k = Fraction("0.45") if radius == "0.8" else Fraction("0.56") * r
            quarter = [(r, 0), (r, k), (k, r), (0, r)]
            control.append([(cos * x - sin * y, sin * x + cos * y, z) for x, y in quarter])
        yield control


def mirrored_patches(rows):
    """The halves y <= 0 and y >= 0, last row first and the second with its columns reversed: outside is the front."""
    halves = [[], []]
    for begin, end, width in reversed(rows):
        (x0, z0), (x1, z1), y = map(Fraction, begin), map(Fraction, end), Fraction(width)
        halves[0].append([(x0, 0, z0), (x0, -y, z0), (x1, -y, z1), (x1, 0, z1)])
        halves[1].append([(x1, 0, z1), (x1, y, z1), (x0, y, z0), (x0, 0, z0)])
    return halves


def teapot():
    mesh = Mesh()
    patches = [patch for part in REVOLVED for patch in revolved_patches(part)]
    patches += [patch for part in MIRRORED for patch in mirrored_patches(part)]
    for patch in patches:
        mesh.add_grid(bezier_grid(patch, TEAPOT_SUBDIVISIONS))
    return mesh


def swiss_roll(turns=3, steps=256, rows=8):
    """A strip of width 2 rolled up about the y axis, radius 0.25 to 1; its front is the convex side."""
    mesh = Mesh()
    spiral = []
    for step in range(steps + 1):
        angle = 2 * math.pi * turns * step / steps
        radius = 0.25 + 0.75 * step / steps
        spiral.append((radius * math.cos(angle), radius * math.sin(angle)))
    mesh.add_grid([[(x, 1 - 2 * row / rows, z) for row in range(rows + 1)] for x, z in spiral])
    return mesh


def moebius(steps=48, rows=4):
    """A Moebius strip about the z axis, radius 1, width 0.8: the seam, where orientation flips, is along +x."""
    mesh = Mesh()
    grid = []
    for step in range(steps + 1):
        angle = 2 * math.pi * step / steps
        line = []
        for row in range(rows + 1):
            offset = 0.8 * (row / rows - 0.5)
            radius = 1 + offset * math.cos(angle / 2)
            line.append((radius * math.cos(angle), radius * math.sin(angle), offset * math.sin(angle / 2)))
        grid.append(line)
    mesh.add_grid(grid)
    return mesh


def box(mesh, lower, upper, lid=True):
    (x0, y0, z0), (x1, y1, z1) = lower, upper
    mesh.add((x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0))
    mesh.add((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))
    mesh.add((x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1))
    mesh.add((x1, y1, z0), (x0, y1, z0), (x0, y1, z1), (x1, y1, z1))
    mesh.add((x0, y1, z0), (x0, y0, z0), (x0, y0, z1), (x0, y1, z1))
    if lid:
        mesh.add((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
    return mesh


def overlapping_cubes():
    mesh = box(Mesh(), (0, 0, 0), (2, 2, 2))
    return box(mesh, (1, 1, 1), (3, 3, 3))


def soup(triangles=200):
    """Unconnected triangles in the unit cube; random.Random is specified to give the same numbers everywhere."""
    numbers = random.Random(1)
    mesh = Mesh()
    for _ in range(triangles):
        centre = [numbers.random() for _ in range(3)]
        mesh.add(*[[c + 0.2 * (numbers.random() - 0.5) for c in centre] for _ in range(3)])
    return mesh


def main():
    directory = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent / "meshes"
    directory.mkdir(parents=True, exist_ok=True)
    teapot().write(directory / "teapot.obj", "The Utah teapot (Newell 1975): open at its seams, self-intersecting")
    swiss_roll().write(directory / "swiss_roll.obj", "A strip rolled up three times: open")
    box(Mesh(), (0, 0, 0), (1, 1, 1)).write(directory / "cube.obj", "The unit cube: closed")
    box(Mesh(), (0, 0, 0), (1, 1, 1), lid=False).write(directory / "open_box.obj", "The unit cube without its lid")
    moebius().write(directory / "moebius.obj", "A Moebius strip: open, cannot be oriented")
    overlapping_cubes().write(directory / "overlapping_cubes.obj", "Two closed cubes: 2 where they overlap")
    soup().write(directory / "soup.obj", "200 unconnected random triangles")


if __name__ == "__main__":
    main()
