"""The limit of memory is kept: python3 memory_limit_test.py RAYCONE MESH_DIRECTORY [--long]

For every command and format: no more is resident than --memory-limit allows, code and libraries included, and the status is 0,
or 4 with one line that names the limit. With --long all limits from 32M to 4G, more threads, and a mesh of a million faces (some
minutes): prints the runs that came nearest to their limits, for docs/robustness.md.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import time

LONG = "--long" in sys.argv
RAYCONE, MESHES = (os.path.abspath(path) for path in [word for word in sys.argv[1:] if word != "--long"][:2])
UNITS = {"k": 1 << 10, "M": 1 << 20, "G": 1 << 30}
LIMITS = ["32M", "64M", "128M", "256M", "512M", "1G", "2G", "4G"] if LONG else ["32M", "64M"]
THREADS = [1, 2, 8, 64] if LONG else [1, 64]
CASES = [(limit, threads) for limit in LIMITS for threads in THREADS] if LONG else [("32M", 64), ("64M", 1)]
# One run at least must come this near to its limit: else the limits would prove nothing.
NEAR = 0.7


def bytes_of(limit):
    return int(limit[:-1]) * UNITS[limit[-1]]


def write_sheets(path, count):
    """Large triangles behind each other: each ray crosses all of them."""
    with open(path, "w", encoding="utf-8") as file:
        for i in range(count):
            file.write(f"v {i / count} 0 0\nv {i / count} 1 0\nv {i / count} 0 1\nf {3 * i + 1} {3 * i + 2} {3 * i + 3}\n")


def write_sphere(path, rings):
    """A closed sphere of 4 * rings^2 faces."""
    slices = 2 * rings
    with open(path, "w", encoding="utf-8") as file:
        for i in range(rings + 1):
            for j in range(slices):
                t, p = math.pi * i / rings, 2 * math.pi * j / slices
                file.write(f"v {math.sin(t) * math.cos(p):.9g} {math.sin(t) * math.sin(p):.9g} {math.cos(t):.9g}\n")
        for i in range(rings):
            for j in range(slices):
                a, b = i * slices + j + 1, i * slices + (j + 1) % slices + 1
                file.write(f"f {a} {a + slices} {b + slices} {b}\n")


def commands(mesh, resolution, points, out):
    for name in ("vdb", "csv", "npy", "vti"):
        yield name, ["lattice", mesh, "-o", out + "." + name, "--resolution", resolution]
    yield "npy to a device", ["lattice", mesh, "-o", "/dev/null", "--format", "npy", "--resolution", resolution]
    yield "sdf", ["lattice", mesh, "-o", out + ".vti", "--field", "sdf", "--resolution", "48"]
    yield "diagnostics", ["lattice", mesh, "-o", out + ".csv", "--field", "inside", "--diagnostics", "--resolution", "12"]
    if "sheets" not in mesh:  # they wind around all of a lattice, and so have no surface in it
        yield "surface", ["surface", mesh, "-o", out + ".ply", "--resolution", "48", "--orient", "auto"]
    # What is inside of turned sheets ends a little beyond them.
    yield "solid", ["lattice", mesh, "-o", out + ".npy", "--field", "solid", "--resolution", "48", "--orient", "auto",
                    "--padding", "20%"]
    yield "points", ["points", mesh, points, "-o", out + ".npy"]
    yield "sample", ["points", mesh, "--sample", "uniform=20000", "-o", out + ".npz"]
    yield "slice", ["slice", mesh, "--axis", "x", "--size", "128", "-o", out + ".png"]
    yield "info", ["info", mesh]


class Run:
    def __init__(self, name, arguments, limit, threads):
        self.name, self.limit, self.threads = name, limit, threads
        begin = time.monotonic()
        command = [RAYCONE, *arguments, "--memory-limit", limit, "--threads", str(threads), "--quiet"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.message = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.stderr.close()
        self.status = process.returncode = os.waitstatus_to_exitcode(status)
        self.seconds = time.monotonic() - begin
        self.peak = usage.ru_maxrss * 1024
        self.share = self.peak / bytes_of(limit)

    def is_right(self):
        if self.status == 0:
            said = self.message == ""
        else:
            said = self.status == 4 and self.message.count("\n") == 1 and "the limit is " in self.message
        return said and self.share <= 1

    def __str__(self):
        return (f"| {self.name} | {self.limit} | {self.threads} | {self.peak / 2**20:.0f} MB | {self.share:.2f} | {self.status} "
                f"| {self.seconds:.2f} s |")


def check_told_at_once(mesh, out):
    """A lattice to VDB is told the same number whatever the limit is, and half as much again suffices."""
    words = ["lattice", mesh, "-o", out + ".vdb", "--resolution", "120"]
    first, told = None, []
    for limit in (22, 40):
        told += re.findall(r"needs about (\d+) MB of memory, but", Run("told", words, f"{limit}M", 1).message)
    if len(told) == 2 and abs(int(told[0]) - int(told[1])) < 5:  # memory in use differs from run to run
        first = Run("told", words, f"{3 * int(told[0]) // 2}M", 1)
    return [] if first and first.status == 0 else [f"told: {told} MB, and {first}"]


def near_limits(mesh, out, count):
    """Limits from what is told to what suffices, where memory ends anywhere, also in libraries: level sets to VDB."""
    words = ["lattice", mesh, "-o", out + ".vdb", "--field", "sdf", "--resolution", "300"]
    return [Run("near limits", words, f"{(60 << 10) + (10 << 10) * n // count}k", 2) for n in range(count)]


def check_bytes_near_limits(mesh, out):
    """Whatever a limit is, a run that says that it succeeded has written all: where memory ends while the file is
    written, too."""
    words = ["lattice", mesh, "-o", out + ".vdb", "--field", "sdf", "--resolution", "160"]

    def contents():
        with open(out + ".vdb", "rb") as file:
            return file.read()

    step = 256  # kilobytes
    low, high = (16 << 10) // step, (256 << 10) // step  # too little, and enough
    if Run("bytes", words, f"{high * step}k", 1).status != 0:
        return ["bytes: too little memory"]
    whole = contents()
    while high - low > 1:
        middle = (low + high) // 2
        if Run("bytes", words, f"{middle * step}k", 1).status == 0:
            high = middle
        else:
            low = middle
    wrong, made = [], 0
    for n in range(high - 2, high + 16):
        run = Run("bytes", words, f"{n * step}k", 1)
        made += run.status == 0
        if not run.is_right() or run.status == 0 and contents() != whole:
            wrong.append(f"{run} {run.message}, {len(contents())} bytes of {len(whole)}")
    return wrong if made > 8 else wrong + [f"bytes: only {made} runs from {high * step} kB on have succeeded"]


def check_batch(meshes, limit, out, runs):
    """Per worker, as its row says; a mesh that does not fit costs only its row."""
    process = subprocess.run([RAYCONE, "batch", *meshes, "--out-dir", out, "--format", "npy", "--resolution", "64", "--quiet",
                              "--memory-limit", limit], capture_output=True, text=True, check=False)
    if process.returncode not in (0, 5):
        return [f"batch: status {process.returncode}: {process.stderr}"]
    wrong, count = [], 0
    with open(os.path.join(out, "results.csv"), encoding="utf-8") as file:
        header = file.readline().strip().split(",")
        for line in file:
            row = dict(zip(header, line.strip().split(",")))
            count += 1
            if row["status"] not in ("ok", "memory") or int(row["peak_memory_bytes"] or 0) > bytes_of(limit):
                wrong.append("batch: " + line)
    runs[0] += count
    if count != len(meshes):
        wrong.append(f"batch within {limit}: {count} rows of {len(meshes)} meshes")
    return wrong


def main():
    with tempfile.TemporaryDirectory() as directory:
        sheets, sphere, points = (os.path.join(directory, name) for name in ("sheets.obj", "sphere.obj", "points.csv"))
        write_sheets(sheets, 200)
        write_sphere(sphere, 500 if LONG else 40)
        with open(points, "w", encoding="utf-8") as file:
            file.writelines(f"{i % 7 / 5},{i % 11 / 9},{i % 13 / 11}\n" for i in range(20000))
        teapot = os.path.join(MESHES, "teapot.obj")
        meshes = [("sheets", sheets, "2,512,512" if LONG else "2,256,256"), ("sphere", sphere, "256" if LONG else "64")]
        if LONG:
            meshes += [("open box", os.path.join(MESHES, "open_box.obj"), "100"), ("teapot", teapot, "64")]
        runs = [Run(f"{of} {name}", arguments, limit, threads)
                for of, mesh, resolution in meshes
                for limit, threads in CASES
                for name, arguments in commands(mesh, resolution, points, os.path.join(directory, "out"))]
        runs += near_limits(teapot, os.path.join(directory, "out"), 200 if LONG else 6)
        count = [len(runs)]
        wrong = [f"{run} {run.message}" for run in runs if not run.is_right()]
        wrong += check_told_at_once(teapot, os.path.join(directory, "out"))
        wrong += check_bytes_near_limits(os.path.join(MESHES, "cube.obj"), os.path.join(directory, "out"))
        for limit in LIMITS:
            wrong += check_batch([sheets, sphere, teapot], limit, os.path.join(directory, "batch" + limit), count)
    nearest = sorted(runs, key=lambda run: -run.share)
    if nearest[0].share < NEAR:
        wrong.append(f"no run came near its limit, which proves nothing: {nearest[0]}")
    if not any(run.status == 4 for run in runs) or not any(run.status == 0 for run in runs):
        wrong.append("all runs ended alike")
    if LONG:
        slowest = sorted((run for run in runs if run.status == 4), key=lambda run: -run.seconds)
        print("nearest to their limits:", *nearest[:8], "refused, the slowest:", *slowest[:4], sep="\n")
    print(count[0], "runs,", sum(run.status == 4 for run in runs), "refused")
    for line in wrong:
        print("WRONG:", line)
    return 1 if wrong else 0


sys.exit(main())
