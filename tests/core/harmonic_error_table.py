"""Computes the table of core/far/harmonic_error.cpp: what a harmonic fit makes of a dipole, at most.

    python3 tests/core/harmonic_error_table.py DEGREE NODES

docs/method.md, "Blocks of lattices", has the proof of each step. All lengths are in half sides of the cube. Needs
numpy; takes an hour and a half on one core, with OpenBLAS.
"""
import itertools
import math
import sys

import numpy as np

Q_POINTS, Y_POINTS = 96, 192  # Chebyshev points along a side of a face, of the cube and of the dipoles
SERIES = ((1.5, 1.01, 124), (5.2, 1.05, 5))  # distances: first, ratio, count
SIGNS = np.array(list(itertools.product((1.0, -1.0), repeat=3)))
CLASSES = list(itertools.product((0, 1), repeat=3))  # parity along each axis


def solid_harmonics(degree, points):
    """Harmonic polynomials up to a degree at points, by parity class, one a column."""
    x, y, z = (points / 1.5).T
    square = x * x + y * y + z * z
    columns = {parity: [] for parity in CLASSES}
    c, s = np.ones_like(x), np.zeros_like(x)
    for m in range(degree + 1):
        if m > 0:
            c, s = x * c - y * s, x * s + y * c
        before, q = np.zeros_like(x), np.ones_like(x)
        for n in range(m, degree + 1):
            columns[m % 2, 0, (n - m) % 2].append(q * c)
            if m > 0:
                columns[(m - 1) % 2, 1, (n - m) % 2].append(q * s)
            before, q = q, ((2 * n + 1) * z * q - (n + m) * square * before) / (n + 1 - m)
    return {parity: np.stack(values, 1) for parity, values in columns.items()}


def octant(side):
    """The faces at +1 with both other coordinates from `side`."""
    u, v = (a.ravel() for a in np.meshgrid(side, side, indexing="ij"))
    one = np.ones_like(u)
    return np.concatenate([np.stack(p, 1) for p in ((one, u, v), (u, one, v), (u, v, one))])


def chebyshev_half(count):
    return np.cos((2 * np.arange(1, count // 2 + 1) - 1) * np.pi / (2 * count))


def mixed(values):
    """Sums of values[s] over the signs s, with the sign that the class gives them: there and, but for 1/8, back."""
    values = list(values)
    for step in (4, 2, 1):
        for i in range(8):
            if not i & step:
                values[i], values[i | step] = values[i] + values[i | step], values[i] - values[i | step]
    return values


def gradients(points, dipoles):
    """Gradient of 1 / (4 pi |q - y|) by y; [q, y, axis]."""
    d = points[:, None, :] - dipoles[None]
    r = np.sqrt((d * d).sum(-1))
    return d / (4 * np.pi * r * r * r)[..., None]


def fit_matrices(degree, nodes, points):
    """Of each class: values of a function of this parity at the nodes of an octant -> those of its fit at points."""
    at_nodes, at_points = solid_harmonics(degree, nodes), solid_harmonics(degree, points)
    matrices = {}
    for parity in CLASSES:
        scale = np.linalg.norm(at_nodes[parity], axis=0)
        q, r = np.linalg.qr(at_nodes[parity] / scale)
        matrices[parity] = np.linalg.solve(r.T, (at_points[parity] / scale).T).T @ q.T
    return matrices


def lebesgue(matrices, degree):
    """Bound of the largest sum of absolute weights of the nodes at a point of the cube."""
    rows = mixed(matrices[parity] / 8 for parity in CLASSES)
    largest = sum(np.abs(row).sum(1) for row in rows).max()
    return largest / np.cos(np.pi * degree / (2 * Q_POINTS)) ** 2


def largest_error(matrices, nodes, points, distance):
    """The largest error on the two grids, of dipoles of any direction."""
    half = chebyshev_half(Y_POINTS)
    dipoles = np.array([(1.0, a, b) for a in half for b in half if b <= a]) * distance
    largest = 0.0
    for begin in range(0, len(dipoles), 64):
        some = dipoles[begin:begin + 64]
        at_nodes = mixed(gradients(nodes * sign, some) / 8 for sign in SIGNS)
        at_points = mixed(gradients(points * sign, some) / 8 for sign in SIGNS)
        errors = [exact - np.tensordot(matrices[parity], values, 1)
                  for parity, exact, values in zip(CLASSES, at_points, at_nodes)]
        for error in mixed(errors):
            largest = max(largest, np.sqrt((error ** 2).sum(-1)).max())
    return largest


def chebyshev_tail(limit, stretch, points, least, weight):
    """[(factor, tail)] for all degrees: of a function that is analytic next to a side, weight / (4 pi d^2) at most
    where d = limit - stretch * (minor half axis of the ellipse) > 0."""
    rho = np.exp(np.linspace(1e-3, np.arcsinh(limit / stretch), 400)[:-1])
    distance = limit - stretch * (rho - 1 / rho) / 2
    bounds = []
    for degree in range(least, points):
        tail = (2 * weight / (4 * np.pi * distance ** 2) * rho ** (-degree) / (rho - 1)).min()
        bounds.append((1 / np.cos(np.pi * degree / (2 * points)), tail))
    return bounds


def bound(grid, distance, degree, weights):
    """From the largest value on the grids to all of both surfaces: one variable after the other."""
    value = grid
    for options in (chebyshev_tail(distance - 1, distance, Y_POINTS, 1, 1 + weights),
                    chebyshev_tail(distance - 1, 1.0, Q_POINTS, degree, 1.0)):
        for _ in range(2):
            value = min(factor * (value + tail) + tail for factor, tail in options)
    return value


def rounded_up(value):
    """By so much that it makes up for the rounding of the distance, too."""
    return f"{value + 10.0 ** (math.floor(math.log10(value)) - 3):.3e}"


def main():
    degree, m = int(sys.argv[1]), int(sys.argv[2])
    nodes, points = octant(chebyshev_half(2 * m)), octant(chebyshev_half(Q_POINTS))
    matrices = fit_matrices(degree, nodes, points)
    weights = lebesgue(matrices, degree)
    print(f"degree {degree}, {24 * m * m} nodes, weights {weights:.3g}", flush=True)
    for distance in (first * ratio ** i for first, ratio, count in SERIES for i in range(count)):
        grid = largest_error(matrices, nodes, points, distance)
        print(f"{distance:.6f} {grid:.3e} {rounded_up(bound(grid, distance, degree, weights))}", flush=True)


if __name__ == "__main__":
    main()
