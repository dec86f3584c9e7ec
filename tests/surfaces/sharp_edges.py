"""Measures how well surfaces keep sharp edges, and prints a table of docs/surfaces.md.

usage: python3 tests/surfaces/sharp_edges.py [--resolution N] [--rotations R] [--contour] RAYCONE [MESH.stl...]

A cube, a wedge, a blade, a cylinder, a fan, a step, a cross and the meshes are turned by R random rotations. Points on
their sharp edges (15 degrees or more) are *resolved* if the tetrahedron of the lattice that holds them has samples of
both kinds. With --contour no faces are merged (--simplify none), so that no mesh is its own surface.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

SPACING = 0.05  # of points along an edge, voxels


def box(size):
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float) * size
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def wedge():
    vertices, faces = box((3, 1, 1))
    vertices[vertices[:, 0] > 1, 2] *= 0.25
    return vertices, faces


def blade():
    """Two faces at 12 degrees."""
    vertices = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, -0.105), (1, 0.105))])
    return vertices, np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)])


def cylinder(sides=32):
    angles = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angles), np.sin(angles)], 1)
    vertices = np.vstack([np.c_[ring, np.zeros(sides)], np.c_[ring, np.full(sides, 1.7)], [[0, 0, 0], [0, 0, 1.7]]])
    faces = []
    for a in range(sides):
        b = (a + 1) % sides
        faces += [(a, b, sides + b), (a, sides + b, sides + a), (2 * sides, b, a), (2 * sides + 1, sides + a, sides + b)]
    return vertices, np.array(faces)


def fan():
    """A prism over arcs of three radii and the steps between them, with a top that is not level: no two corners are
    alike, some edges are convex, some are not, and arcs meet the top at all angles."""
    arcs = [(0, 117, 1.0, 13), (122, 236, 0.5, 9), (241, 354, 0.75, 11)]  # degrees, radius, corners
    polar = np.array([(np.radians(a), r) for first, last, r, n in arcs for a in np.linspace(first, last, n)])
    outline = polar[:, 1:] * np.stack([np.cos(polar[:, 0]), np.sin(polar[:, 0])], 1)
    sides = len(outline)
    top = 0.6 + 0.3 * outline[:, 0] - 0.1 * outline[:, 1]
    vertices = np.vstack([np.c_[outline, np.zeros(sides)], np.c_[outline, top], [[0, 0, 0], [0, 0, 0.6]]])
    faces = []
    for a in range(sides):
        b = (a + 1) % sides
        faces += [(a, b, sides + b), (a, sides + b, sides + a), (2 * sides, b, a), (2 * sides + 1, sides + a, sides + b)]
    return vertices, np.array(faces)


def cubes(cells):
    """The boundary of unit cubes: corners where edges are concave."""
    numbers, faces = {}, []
    for cell in cells:
        for axis in range(3):
            for side in (0, 1):
                beyond = tuple(c + (2 * side - 1) * (a == axis) for a, c in enumerate(cell))
                if beyond in cells:
                    continue
                u, v = [(a, b) for a, b in ((1, 2), (2, 0), (0, 1))][axis][::1 if side else -1]
                quad = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    p = list(cell)
                    p[axis] += side
                    p[u] += du
                    p[v] += dv
                    quad.append(numbers.setdefault(tuple(p), len(numbers)))
                faces += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return np.array(list(numbers), float), np.array(faces)


def read_stl(path):
    data = open(path, "rb").read()
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        corners = np.frombuffer(data, np.dtype([("c", "<f4", (4, 3)), ("a", "<u2")]), offset=84)["c"][:, 1:]
    else:
        rows = (line.split() for line in data.decode("latin-1").lower().splitlines())
        corners = np.array([row[1:4] for row in rows if row and row[0] == "vertex"], float)
    vertices, places = np.unique(corners.reshape(-1, 3).astype(float), axis=0, return_inverse=True)
    return vertices, places.reshape(-1, 3)


def rotation(random):
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def write_obj(path, vertices, faces):
    with open(path, "w") as file:
        file.writelines("v %r %r %r\n" % tuple(map(float, p)) for p in vertices)
        file.writelines("f %d %d %d\n" % tuple(t + 1) for t in faces)


def sharp_edges(vertices, faces):
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    lengths = np.linalg.norm(normals, axis=1)
    uses = {}
    for number, t in enumerate(faces):
        for i in range(3):
            uses.setdefault(tuple(sorted((t[i], t[(i + 1) % 3]))), []).append(number)
    for edge, (f, *others) in uses.items():
        if len(others) == 1 and lengths[f] * lengths[others[0]] > 0:
            cosine = normals[f] @ normals[others[0]] / lengths[f] / lengths[others[0]]
            if cosine < np.cos(np.radians(15)):
                yield edge


def points_along(vertices, edges, step):
    points = []
    for a, b in edges:
        n = int(np.ceil(np.linalg.norm(vertices[b] - vertices[a]) / step))
        parts = (np.arange(n) + 0.5)[:, None] / n
        points.append((1 - parts) * vertices[a] + parts * vertices[b])
    return np.vstack(points)


def is_resolved(points, lattice, inside):
    at = (points - lattice["origin"]) / lattice["spacing"] - lattice["index_min"]
    low = np.floor(at).astype(int)
    order = np.argsort(-(at - low), axis=1)
    node = low.copy()
    kinds = [inside[tuple(node.T)]]
    for step in range(3):
        node[np.arange(len(node)), order[:, step]] += 1
        kinds.append(inside[tuple(node.T)])
    count = np.sum(kinds, axis=0)
    return (count > 0) & (count < 4)


def field(raycone, mesh, points, name, work):
    np.save(os.path.join(work, "points.npy"), points)
    out = os.path.join(work, "values.npy")
    dtype = () if name == "inside" else ("--dtype", "f64")
    subprocess.run([raycone, "points", mesh, os.path.join(work, "points.npy"), "-o", out, "--field", name, *dtype,
                    "--quiet"], check=True)
    return np.load(out).reshape(-1)


def inside_of(raycone, path, lattice, work):
    axes = [lattice["origin"][a] + lattice["spacing"][a] * np.arange(lattice["index_min"][a], lattice["index_max"][a] + 1)
            for a in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    return field(raycone, path, nodes.reshape(-1, 3), "inside", work).reshape(nodes.shape[:3]) > 0


def volume(raycone, path):
    run = subprocess.run([raycone, "info", path, "--json"], check=True, capture_output=True)
    return json.loads(run.stdout)["signed_volume"]


def measure(raycone, vertices, faces, resolution, work, contour=False):
    path, surface, report = (os.path.join(work, name) for name in ("in.obj", "out.ply", "out.json"))
    write_obj(path, vertices, faces)
    subprocess.run([raycone, "surface", path, "-o", surface, "--report", report, "--resolution", str(resolution),
                    "--simplify", "none" if contour else "0", "--quiet"], check=True)
    run = json.load(open(report))
    lattice = {key: np.array(value) for key, value in run["lattice"].items()}
    h = lattice["spacing"].min()
    inside = inside_of(raycone, path, lattice, work)
    points = points_along(vertices, sharp_edges(vertices, faces), SPACING * h)
    off = np.abs(field(raycone, surface, points, "sdf", work)) / h
    resolved = is_resolved(points, lattice, inside)
    before = volume(raycone, path)
    return {"resolved": resolved, "off": off, "back": run["surface"]["max_distance"] / h,
            "volume": abs(volume(raycone, surface) / before - 1) if before else float("nan"),
            "faces": run["surface"]["faces"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raycone")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--resolution", type=int, default=48)
    parser.add_argument("--rotations", type=int, default=3)
    parser.add_argument("--contour", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        shapes = [("cube", box(1)), ("wedge", wedge()), ("blade", blade()), ("cylinder", cylinder()), ("fan", fan()),
                  ("step", cubes([(0, 0, 0), (1, 0, 0), (0, 1, 0)])),
                  ("cross", cubes([(1, 1, 1), (0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2)]))]
        shapes += [(os.path.basename(path), read_stl(path)) for path in arguments.meshes]
        print("| mesh | edges resolved, % | of them kept, % | largest distance, voxels | rms | of all edges kept, % | "
              "largest distance, voxels | rms | of the surface | volume, % | faces |")
        print("|---|---|---|---|---|---|---|---|---|---|---|")
        for name, (vertices, faces) in shapes:
            random = np.random.default_rng(1)
            runs = [measure(arguments.raycone, vertices @ rotation(random).T, faces, arguments.resolution, work,
                            arguments.contour) for _ in range(arguments.rotations)]
            off = np.concatenate([run["off"] for run in runs])
            resolved = np.concatenate([run["resolved"] for run in runs])
            kept = off <= 2e-9
            print("| %s | %.1f | %.1f | %.2g | %.2g | %.1f | %.2g | %.2g | %.2g | %.2g | %d |" % (
                name, 100 * resolved.mean(), 100 * kept[resolved].mean(), off[resolved].max(),
                np.sqrt((off[resolved] ** 2).mean()), 100 * kept.mean(), off.max(), np.sqrt((off ** 2).mean()),
                max(run["back"] for run in runs), 100 * max(run["volume"] for run in runs), runs[0]["faces"]), flush=True)


if __name__ == "__main__":
    main()
