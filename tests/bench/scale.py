#!/usr/bin/env python3
"""Measures how time and memory grow: python3 tests/bench/scale.py RAYCONE COMMIT >RUN.json

Runs the executable with --report on generated meshes: closed spheres and open cylinders. Each series varies one number:
samples along a side, faces, exterior edges, points. One thread, and all threads for the largest lattice.
"""

import json
import os
import platform
import subprocess
import sys
import tempfile

import numpy

raycone, commit = sys.argv[1:]
MILLION = 1_000_000


def write_ply(path, vertices, faces):
    with open(path, "wb") as file:
        file.write(
            b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
            b"property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
            % (len(vertices), len(faces))
        )
        file.write(vertices.astype("<f4").tobytes())
        records = numpy.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
        records["n"], records["v"] = 3, faces
        file.write(records.tobytes())


def rings(count, slices):
    """Triangles between `count` rings of `slices` vertices each."""
    ring, slot = numpy.divmod(numpy.arange((count - 1) * slices), slices)
    a = ring * slices + slot
    b = ring * slices + (slot + 1) % slices
    return numpy.concatenate([numpy.stack([a, b, a + slices], 1), numpy.stack([b, b + slices, a + slices], 1)])


def sphere(path, faces):
    """About `faces` faces: all vertices of the first and of the last ring are at the poles."""
    count = max(int((faces / 4) ** 0.5), 4)
    slices = 2 * count
    theta = numpy.linspace(0, numpy.pi, count + 1)[:, None]
    phi = numpy.arange(slices)[None, :] * 2 * numpy.pi / slices
    radius = numpy.sin(theta)
    radius[[0, -1]] = 0
    vertices = numpy.stack(numpy.broadcast_arrays(radius * numpy.cos(phi), radius * numpy.sin(phi), -numpy.cos(theta)), 2)
    write_ply(path, vertices.reshape(-1, 3), rings(count + 1, slices))


def cylinder(path, edges):
    """Open at both ends: `edges` exterior edges and as many faces."""
    phi = numpy.arange(edges // 2) * 2 * numpy.pi / (edges // 2)
    ring = numpy.stack([numpy.cos(phi), numpy.sin(phi), numpy.zeros_like(phi)], 1)
    write_ply(path, numpy.concatenate([ring, ring + [0, 0, 2]]), rings(2, edges // 2))


def run(folder, series, number, *arguments, threads=1):
    report_path = os.path.join(folder, "report.json")
    output = arguments[arguments.index("-o") + 1]
    subprocess.run(
        [raycone, *arguments, "--report", report_path, "--quiet", "--threads", str(threads)], check=True
    )
    with open(report_path, encoding="utf-8") as file:
        report = json.load(file)
    keys = ("faces", "exterior_edges", "samples", "threads", "peak_memory_bytes", "seconds")
    row = {"series": series, "number": number, "output_bytes": os.path.getsize(output)}
    row.update({key: report[key] for key in keys})
    print(f"{series} {number}: {report['seconds']['total']:.3g} s, "
          f"{report['peak_memory_bytes'] / MILLION:.0f} MB", file=sys.stderr)
    os.remove(output)
    return row


def lattices(folder):
    mesh, output = os.path.join(folder, "mesh.ply"), os.path.join(folder, "out.vdb")
    sphere(mesh, 80_000)
    for n in (64, 128, 256, 512, 1024, 2048):
        yield run(folder, "samples", n, "lattice", mesh, "-o", output, "--resolution", str(n))
    for threads in (1, os.cpu_count()):
        yield run(folder, "threads, closed, 1024^3", threads, "lattice", mesh, "-o", output, "--resolution", "1024",
                  threads=threads)
    cylinder(mesh, 160)
    for threads in (1, os.cpu_count()):
        yield run(folder, "threads, 160 exterior edges, 256^3", threads, "lattice", mesh, "-o", output,
                  "--resolution", "256", threads=threads)


def faces(folder):
    mesh, output = os.path.join(folder, "mesh.ply"), os.path.join(folder, "out.vdb")
    for n in (1_000, 10_000, 100_000, MILLION, 10 * MILLION):
        sphere(mesh, n)
        yield run(folder, "faces", n, "lattice", mesh, "-o", output, "--resolution", "128")


def exterior_edges(folder):
    mesh, output = os.path.join(folder, "mesh.ply"), os.path.join(folder, "out.vdb")
    for n in (10, 30, 100, 300, 1_000, 3_000, 10_000):
        cylinder(mesh, n)
        yield run(folder, "exterior_edges", n, "lattice", mesh, "-o", output, "--resolution", "64")


def points(folder):
    mesh, queries, output = (os.path.join(folder, name) for name in ("mesh.ply", "points.npy", "out.npy"))
    sphere(mesh, 80_000)
    generator = numpy.random.default_rng(1)
    for n in (10_000, 100_000, MILLION, 10 * MILLION, 100 * MILLION):
        array = numpy.lib.format.open_memmap(queries, mode="w+", dtype="<f4", shape=(n, 3))
        for begin in range(0, n, MILLION):
            array[begin : begin + MILLION] = generator.uniform(-1.1, 1.1, (min(MILLION, n - begin), 3))
        del array
        yield run(folder, "points", n, "points", mesh, queries, "-o", output)


def cpu_model():
    with open("/proc/cpuinfo", encoding="utf-8") as lines:
        return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())


with tempfile.TemporaryDirectory() as scratch:
    rows = [row for series in (lattices, faces, exterior_edges, points) for row in series(scratch)]
json.dump({"commit": commit, "cpu": cpu_model(), "cpus": os.cpu_count(), "rows": rows}, sys.stdout, indent=1)
print()
