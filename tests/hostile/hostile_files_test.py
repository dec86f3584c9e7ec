"""Walks the table of hostile_files.py: python3 hostile_files_test.py RAYCONE MESH [MEGABYTES]

Each file gets its status, and on failure one line that names it and says what the table says, and no output. Files that
never end and those that links and URIs point to follow behind the table. The longest lines have MEGABYTES (256); 2100 is
more than an int counts. Where there are fewer, files that are long to read are left out.
"""

import os
import subprocess
import sys
import tempfile

from hostile_files import LONG_TO_READ, OBJ, OFF, TABLE, put

RAYCONE, MESH = (os.path.abspath(path) for path in sys.argv[1:3])
USUAL = 256  # megabytes
MEGABYTES = int(sys.argv[3]) if len(sys.argv) > 3 else USUAL
LONGEST = MEGABYTES << 20
failures = []


def expect(name, arguments, status, fragment, output=None, **options):
    result = subprocess.run([RAYCONE, *arguments], capture_output=True, timeout=120, **options)
    message = result.stderr.decode()
    wrong = []
    if result.returncode != status:
        wrong.append("status %d, expected %d" % (result.returncode, status))
    if fragment not in message:
        wrong.append("no %r" % fragment)
    if status != 0 and (message.count("\n") != 1 or not message.startswith("raycone: " + arguments[-1 if output is None else -3])):
        wrong.append("not one line about the file")
    if output is not None and status != 0 and os.path.exists(output):
        wrong.append("output in spite of the error")
    if wrong:
        failures.append("%s: %s: %s" % (name, ", ".join(wrong), message[:300].strip()))


def expect_mesh(path, status, fragment, **options):
    expect(path, ["info", path], status, fragment, **options)


# Refused meshes, many to a run: its start takes longer than all of them.
def expect_refused(rows):
    result = subprocess.run([RAYCONE, "info", *(name for name, _ in rows)], capture_output=True, timeout=600)
    lines = result.stderr.decode().splitlines()
    alike = result.returncode == 2 and not result.stdout and len(lines) == len(rows) and all(
        line.startswith("raycone: " + name) and fragment in line for line, (name, fragment) in zip(lines, rows))
    if not alike:  # each by itself, to tell which
        before = len(failures)
        for name, fragment in rows:
            expect_mesh(name, 2, fragment)
        if len(failures) == before:
            failures.append("together: status %d, expected 2 and a line for each of %s" % (result.returncode, rows))


def walk_table():
    assert len({name for name, *_ in TABLE}) == len(TABLE) >= 150
    refused = []
    for name, content, status, fragment in TABLE:
        if name in LONG_TO_READ and MEGABYTES < USUAL:
            continue
        with open(name, "wb") as file:
            file.write(content)
        if status == 2 and not name.endswith((".vdb", ".csv", ".txt", ".npy")):
            refused.append((name, fragment))
        elif name.endswith(".vdb"):
            expect(name, ["lattice", MESH, "--like", name, "-o", "out.csv"], status, fragment, output="out.csv")
        elif name.endswith((".csv", ".txt", ".npy")):
            expect(name, ["points", MESH, name], status, fragment)
        else:
            expect_mesh(name, status, fragment)
    for first in range(0, len(refused), 40):
        expect_refused(refused[first:first + 40])


# Of zeros, which take no space on most disks.
def walk_longest_lines():
    for name, beginning, status, fragment in [
        ("longest_line.obj", OBJ + "# ", 0, ""),
        ("longest_line.off", "OFF\n4 4 6\n", 2, ":3: expected a coordinate, found '?"),
        ("longest_line.stl", "solid ", 2, "no triangles"),
        ("longest_line.csv", "x,y,z\n", 2, ":2: line of more than"),
    ]:
        with open(name, "w") as file:
            file.write(beginning)
            file.truncate(LONGEST)
        if name.endswith(".csv"):
            expect(name, ["points", MESH, name], status, fragment)
        else:
            expect_mesh(name, status, fragment)
        os.unlink(name)


# What never ends is read until a limit, and no further; as a mesh: faults_test.py --memory.
def walk_devices():
    expect("/dev/zero as points", ["points", "--memory-limit", "200M", MESH, "/dev/zero"], 2, "line of more than")
    expect_mesh("/dev/null", 2, "the file is empty")
    expect_mesh(".", 2, "is a directory")
    expect_mesh("absent.obj", 2, "No such file or directory")


# Links are followed, also those that lie beside a glTF, as git-annex and others make them; what they lead to must be a
# file.
def walk_links():
    os.mkdir("inside")
    with open("outside.bin", "wb") as file:
        file.write(bytes(72))
    os.symlink("../outside.bin", "inside/link.bin")
    os.symlink("loop.obj", "loop.obj")
    os.symlink("mesh.off", "link.off")
    with open("mesh.off", "w") as file:
        file.write(OFF)
    with open("inside/link.gltf", "w") as file:
        file.write(put("buffers", 0, {"byteLength": 72, "uri": "link.bin"}))
    os.symlink("/dev/zero", "inside/zero")
    with open("inside/device.gltf", "w") as file:
        file.write(put("buffers", 0, {"byteLength": 72, "uri": "zero"}))
    with open("fifo.gltf", "w") as file:
        file.write(put("buffers", 0, {"byteLength": 72, "uri": "fifo"}))
    os.mkfifo("fifo")
    expect_mesh("link.off", 0, "")
    expect_mesh("loop.obj", 2, "Too many levels of symbolic links")
    expect_mesh("inside/link.gltf", 0, "")
    expect_mesh("inside/device.gltf", 2, "zero")
    expect_mesh("fifo.gltf", 2, "fifo")


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    walk_table()
    walk_longest_lines()
    walk_devices()
    walk_links()
    os.chdir("/")
for failure in failures:
    print(failure)
print("%d files, %d wrong" % (len(TABLE), len(failures)))
sys.exit(1 if failures else 0)
