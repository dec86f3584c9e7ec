#!/usr/bin/env python3
"""Makes the three pictures at the top of README.md: python3 docs/readme_pictures.py RAYCONE [DIRECTORY]

They show the bundled teapot with faces cut out: the mesh with its boundary edges marked, its winding number in a slice,
and what is inside of it as a solid. Every number comes from the tool; this script only shades. It needs numpy.
"""

import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
# Faces whose middle is in one of these balls are cut out: centre and radius.
HOLES = [((0.45, -1.7, 1.15), 0.58), ((0.8, -0.2, 2.5), 0.45), ((-1.65, -0.3, 0.25), 0.52), ((1.72, -0.25, 1.95), 0.45)]

WIDTH, HEIGHT, SAMPLES = 600, 400, 2  # SAMPLES per pixel and direction
BOX = (-3.3, -2.3, -0.775, 3.75, 2.3, 3.925)  # x to the right, z up; 7.05 wide, 4.7 high
VOXELS = 384  # along the box's longest side
ELEVATION = np.radians(24)

BACKGROUND, FRONT, BACK = np.array([250, 250, 248]), np.array([205, 214, 224]), np.array([104, 112, 124])
MARK, SOLID = np.array([222, 40, 62]), np.array([222, 118, 92])  # boundary edges; the solid, the slice's red
LIGHT = np.array([-0.45, -0.75, 0.9]) / np.linalg.norm([-0.45, -0.75, 0.9])

# The axes of the picture in space: to the right, up, and towards the viewer.
RIGHT = np.array([1.0, 0.0, 0.0])
UP = np.array([0.0, np.sin(ELEVATION), np.cos(ELEVATION)])
VIEWER = np.array([0.0, -np.cos(ELEVATION), np.sin(ELEVATION)])
MIDDLE = np.array([(BOX[0] + BOX[3]) / 2, 0.0, 1.42])
PIXEL = (BOX[3] - BOX[0]) / (WIDTH * SAMPLES)


def read(path):
    rows = [line.split() for line in path.read_text(encoding="ascii").splitlines()]
    vertices = np.array([row[1:] for row in rows if row[0] == "v"], float)
    return vertices, np.array([row[1:] for row in rows if row[0] == "f"], int) - 1


def without_holes(vertices, triangles):
    middles = vertices[triangles].mean(axis=1)
    distances = [np.linalg.norm(middles - centre, axis=1) / radius for centre, radius in HOLES]
    return triangles[np.min(distances, axis=0) >= 1]


def write_mesh(path, vertices, triangles):
    lines = ["v %.9g %.9g %.9g" % tuple(vertex) for vertex in vertices]
    lines += ["f %d %d %d" % tuple(triangle + 1) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def boundary_edges(triangles):
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    unique, first, counts = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[first[counts == 1]]


def to_picture(points):
    """Column, row and height above the picture's plane."""
    moved = points - MIDDLE
    column = moved @ RIGHT / PIXEL + WIDTH * SAMPLES / 2
    return np.stack([column, HEIGHT * SAMPLES / 2 - moved @ UP / PIXEL, moved @ VIEWER], axis=-1)


def shade(colors, normals):
    """Colours lit from LIGHT, with a highlight; normals are unit vectors towards the viewer."""
    diffuse = 0.46 + 0.6 * np.clip(normals @ LIGHT, 0, 1)
    halfway = (LIGHT + VIEWER) / np.linalg.norm(LIGHT + VIEWER)
    shine = 70 * np.clip(normals @ halfway, 0, 1) ** 40
    return np.clip(colors * diffuse[..., None] + shine[..., None], 0, 255)


def vertex_normals(vertices, triangles):
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], faces)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def draw_triangle(image, depth, corners, normals):
    """Corners as of to_picture(); the nearer of two points wins."""
    low = np.maximum(np.floor(corners[:, :2].min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners[:, :2].max(axis=0)), [WIDTH * SAMPLES - 1, HEIGHT * SAMPLES - 1]).astype(int)
    (ax, ay), (bx, by), (cx, cy) = corners[:, :2]
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area == 0 or (low > high).any():
        return
    x, y = np.meshgrid(np.arange(low[0], high[0] + 1) + 0.5, np.arange(low[1], high[1] + 1) + 0.5)
    b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
    c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
    weights = np.stack([1 - b - c, b, c], axis=-1)
    z = weights @ corners[:, 2]
    rows, columns = slice(low[1], high[1] + 1), slice(low[0], high[0] + 1)
    visible = (weights.min(axis=-1) >= -1e-9) & (z > depth[rows, columns])
    normal = weights @ normals
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    front = area < 0  # rows point down
    color = shade(FRONT if front else BACK, normal if front else -normal)
    depth[rows, columns] = np.where(visible, z, depth[rows, columns])
    image[rows, columns] = np.where(visible[..., None], color, image[rows, columns])


def draw_edge(image, depth, start, end, radius):
    """A thick line, hidden where the mesh is in front of it."""
    length = int(np.ceil(np.abs(end - start)[:2].max())) + 1
    reach = np.arange(-radius, radius + 1)
    disk = [(dx, dy) for dx in reach for dy in reach if dx * dx + dy * dy <= radius * radius]
    for x, y, z in start + np.linspace(0, 1, length)[:, None] * (end - start):
        row, column = int(y), int(x)
        if 0 <= row < HEIGHT * SAMPLES and 0 <= column < WIDTH * SAMPLES and z + 0.05 >= depth[row, column]:
            for dx, dy in disk:
                image[row + dy, column + dx] = MARK


def picture_of_mesh(vertices, triangles):
    image = np.tile(BACKGROUND.astype(float), (HEIGHT * SAMPLES, WIDTH * SAMPLES, 1))
    depth = np.full(image.shape[:2], -np.inf)
    placed, normals = to_picture(vertices), vertex_normals(vertices, triangles)
    for triangle in triangles:
        draw_triangle(image, depth, placed[triangle], normals[triangle])
    for start, end in boundary_edges(triangles):
        draw_edge(image, depth, placed[start], placed[end], 3)
    return image


def smoothed(mask):
    """The mask as a smooth field: cubes of side 1 have no shading."""
    field = mask.astype(np.float32)
    for axis in range(3):
        for _ in range(9):  # each a quarter, a half, a quarter
            field = (np.roll(field, 1, axis) + np.roll(field, -1, axis)) / 4 + field / 2
    return field


def interpolated(field, places):
    corner = np.clip(np.floor(places).astype(int), 0, np.array(field.shape) - 2)
    part = np.clip(places - corner, 0, 1)
    total = np.zeros(len(places))
    for offset in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(offset, part, 1 - part), axis=1)
        total += weight * field[tuple((corner + offset).T)]
    return total


def first_hits(field, starts, step):
    """Where rays first meet field >= 1/2, in voxels; and which rays do."""
    length = int(np.linalg.norm(field.shape)) + 2
    active, hits = np.arange(len(starts)), np.zeros(starts.shape)
    found = np.zeros(len(starts), bool)
    for number in range(length):
        places = starts[active] + number * step
        index = np.rint(places).astype(int)
        within = ((index >= 0) & (index < field.shape)).all(axis=1)
        index = np.where(within[:, None], index, 0)
        met = within & (field[tuple(index.T)] >= 0.5)
        hits[active[met]], found[active[met]] = places[met], True
        active = active[~met]
    outer, inner = hits[found] - 2 * step, hits[found] + 2 * step
    for _ in range(8):
        middle = (outer + inner) / 2
        is_inside = (interpolated(field, middle) >= 0.5)[:, None]
        outer, inner = np.where(is_inside, outer, middle), np.where(is_inside, middle, inner)
    return inner, found


def picture_of_solid(mask, origin, spacing):
    field = smoothed(mask)
    rows, columns = np.mgrid[0 : HEIGHT * SAMPLES, 0 : WIDTH * SAMPLES].reshape(2, -1) + 0.5
    right, up = (columns - WIDTH * SAMPLES / 2) * PIXEL, (HEIGHT * SAMPLES / 2 - rows) * PIXEL
    starts = MIDDLE + right[:, None] * RIGHT + up[:, None] * UP + 4.5 * VIEWER
    hits, found = first_hits(field, (starts - origin) / spacing, -VIEWER)
    slopes = [interpolated(field, hits - side) - interpolated(field, hits + side) for side in 1.5 * np.eye(3)]
    normals = np.stack(slopes, axis=-1)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    image = np.tile(BACKGROUND.astype(float), (len(starts), 1))
    image[found] = shade(SOLID, normals)
    return image.reshape(HEIGHT * SAMPLES, WIDTH * SAMPLES, 3)


def write_png(path, image):
    """The mean of each pixel's samples, in a PNG whose rows are stored as differences from the row above."""
    pixels = image.reshape(HEIGHT, SAMPLES, WIDTH, SAMPLES, 3).mean(axis=(1, 3)).round().astype(np.uint8)
    rows = pixels.reshape(HEIGHT, -1)
    differences = np.concatenate([rows[:1], rows[1:] - rows[:-1]])
    data = np.concatenate([np.full((HEIGHT, 1), 2, np.uint8), differences], axis=1).tobytes()
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, body in [
            (b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)),
            (b"IDAT", zlib.compress(data, 9)),
            (b"IEND", b""),
        ]:
            file.write(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)))


def main(raycone, directory):
    vertices, triangles = read(REPOSITORY / "data" / "meshes" / "teapot.obj")
    triangles = without_holes(vertices, triangles)
    box = ",".join(map(str, BOX))
    with tempfile.TemporaryDirectory() as work:
        mesh, mask = pathlib.Path(work) / "broken.obj", pathlib.Path(work) / "inside.npy"
        write_mesh(mesh, vertices, triangles)
        plane = ["--normal", "0,-1,0", "--origin", "0,0,0", "--up", "0,0,1", "--bounds", box, "--size", str(WIDTH)]
        subprocess.run([raycone, "slice", mesh, "-o", directory / "readme-slice.png", *plane], check=True)
        lattice = ["--field", "inside", "--bounds", box, "--resolution", str(VOXELS)]
        subprocess.run([raycone, "lattice", mesh, "-o", mask, *lattice], check=True)
        spacing = max(BOX[3] - BOX[0], BOX[5] - BOX[2]) / (VOXELS - 1)
        solid = picture_of_solid(np.load(mask), np.array(BOX[:3]), spacing)
    write_png(directory / "readme-mesh.png", picture_of_mesh(vertices, triangles))
    write_png(directory / "readme-solid.png", solid)


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else REPOSITORY / "docs" / "images")
