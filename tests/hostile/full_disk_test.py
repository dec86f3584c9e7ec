"""A small disk that is full or read-only: python3 full_disk_test.py RAYCONE MESH_DIRECTORY

Every command, on a file system of its own (tmpfs in a namespace of users and mounts) with ever more room, until it succeeds:
before that status 3, one line, the earlier outputs and nothing else; of several outputs some may be complete. Status 77 where
no such namespace may be made.
"""

import json
import os
import subprocess
import sys
import tempfile

from runs import EARLIER, MESHES, OPEN, RAYCONE, contents, fail, failures, report

NAMESPACE = ["unshare", "--user", "--map-root-user", "--mount"]
CUBE = os.path.join(MESHES, "cube.obj")
DISK = 4 << 20

# Arguments, and the outputs among them.
COMMANDS = [
    (["lattice", OPEN, "--resolution", "12", "-o", "out.vdb", "--report", "out.json"], ["out.vdb", "out.json"]),
    (["lattice", OPEN, "--resolution", "12", "-o", "out.csv", "--depfile", "out.d"], ["out.csv", "out.d"]),
    (["lattice", OPEN, "--resolution", "24", "-o", "out.npy"], ["out.npy"]),
    (["lattice", OPEN, "--resolution", "24", "--field", "sdf", "-o", "out.vti"], ["out.vti"]),
    (["points", OPEN, "--sample", "uniform=2000", "-o", "out.npz"], ["out.npz"]),
    (["points", OPEN, "--sample", "uniform=2000", "-o", "samples.csv"], ["samples.csv"]),
    (["slice", OPEN, "--size", "64", "-o", "out.png", "--values", "values.npy"], ["out.png", "values.npy"]),
    (["report", "batch", "-o", "page.html"], ["page.html"]),
]


def run(arguments):
    quiet = [] if arguments[0] == "report" else ["--quiet"]
    return subprocess.run([RAYCONE, *arguments, *quiet], capture_output=True, timeout=300)


def empty():
    if os.path.exists("filler"):
        os.unlink("filler")


# Fills the disk but for so many bytes.
def leave(room):
    empty()
    free = os.statvfs(".").f_bavail * os.statvfs(".").f_bsize
    with open("filler", "wb") as file:
        file.write(bytes(free - room))


# Of a run that failed: those that were replaced, and by what.
def replaced(outputs):
    return [(path, contents(path)) for path in outputs if contents(path) != EARLIER]


def is_complete(path, content):
    if path.endswith(".json"):  # it tells times, which vary
        return content.endswith(b"}\n") and "seconds" in json.loads(content)
    return content == contents(path)


# Whether it succeeded; else `left` grows by what it left in place of earlier outputs.
def run_once(arguments, outputs, expected, left):
    before = set(os.listdir())
    result = run(arguments)
    what = " ".join(arguments)
    if set(os.listdir()) != before:
        fail("%s left %s" % (what, set(os.listdir()) - before), result.returncode, result.stderr)
    if result.returncode == 0:
        return True
    message = result.stderr.decode()
    if result.returncode != 3 or message.count("\n") != 1 or not message.startswith("raycone: ") or expected not in message:
        fail(what, result.returncode, result.stderr)
    left += replaced(outputs)
    return False


# From a page on, which is what a tmpfs counts in, to enough.
def sweep_room(arguments, outputs):
    refusals, room, left = 0, 0, []
    while True:
        empty()
        for path in outputs:
            with open(path, "wb") as file:
                file.write(EARLIER)
        leave(room)
        if run_once(arguments, outputs, "No space left on device", left):
            break
        if room > DISK // 2:
            return failures.append("%s: no room is enough" % " ".join(arguments))
        refusals += 1
        room += 4096 if room < 16384 else 65536
    for path, content in left:  # now that the last run has made the complete ones
        if len(outputs) == 1 or not is_complete(path, content):
            failures.append("%s: %s neither the earlier nor the complete one" % (" ".join(arguments), path))
    if len(replaced(outputs)) < len(outputs):
        failures.append("%s: succeeded without all outputs" % " ".join(arguments))
    if refusals == 0:
        failures.append("%s: had room on a full disk" % " ".join(arguments))


# Rows that cannot be written end a batch; an output that cannot costs its mesh.
def sweep_batch():
    statuses, room = [], 0
    while 0 not in statuses:
        subprocess.run(["rm", "-rf", "out"], check=True)
        leave(room)
        result = run(["batch", CUBE, OPEN, "--resolution", "12", "--format", "npy", "--out-dir", "out", "--threads", "1"])
        statuses.append(result.returncode)
        if result.returncode not in (0, 3, 5) or not all(line.startswith(b"raycone: ") for line in result.stderr.splitlines()):
            fail("batch with %d bytes of room" % room, result.returncode, result.stderr)
        for name in os.listdir("out") if os.path.isdir("out") else []:
            if not name.endswith((".csv", ".npy")) or (name.endswith(".npy") and os.path.getsize("out/" + name) != 128 + 4 * 12**3):
                fail("batch with %d bytes of room left %s" % (room, name), result.returncode, result.stderr)
        room += 4096
    if not {3, 5} <= set(statuses):
        failures.append("batch: neither rows nor outputs lacked room: %s" % statuses)


def readable_bytes(count):
    for unit in "bytes", "kB", "MB":
        if count < 1024:
            break
        count /= 1024
    return ("%.2g %s" if count < 10 and unit != "bytes" else "%.0f %s") % (count, unit)


# What cannot fit is refused before work: as soon as the disk lacks the last byte, and with the number.
def sweep_refusals():
    empty()
    for arguments, least in [(["lattice", OPEN, "--resolution", "100", "-o", "new.npy"], 4 * 100**3),
                             (["lattice", OPEN, "--resolution", "100", "--field", "inside", "-o", "new.npy"], 100**3),
                             (["lattice", OPEN, "--resolution", "100", "-o", "new.vti"], 4 * 100**3),
                             (["lattice", OPEN, "--resolution", "60", "-o", "new.csv"], 14 * 60**3),
                             (["points", OPEN, "--sample", "uniform=100000", "--field", "winding,inside", "-o", "new.npz"], 33 * 10**5),
                             (["points", OPEN, "--sample", "uniform=100000", "-o", "new.csv"], 12 * 10**5),
                             (["slice", OPEN, "--size", "500", "-o", "new.png", "--values", "values.npy"], 8 * 500**2)]:
        leave(least - 8192)
        result = run(arguments)
        message = "needs %s or more" % readable_bytes(least)
        if result.returncode != 3 or message not in result.stderr.decode() or result.stderr.count(b"\n") != 1:
            fail("%s without room for %d bytes" % (" ".join(arguments), least), result.returncode, result.stderr)
        empty()
        result = run([word.replace("new.", "made.") for word in arguments])
        if b"needs" in result.stderr:
            fail("control: " + " ".join(arguments), result.returncode, result.stderr)
        for name in os.listdir():
            if name.startswith(("new.", "made.", "values.")):
                os.unlink(name)


def inside(directory):
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%d" % DISK, "tmpfs", directory], check=True)
    os.chdir(directory)
    subprocess.run([RAYCONE, "batch", CUBE, OPEN, "--resolution", "8", "--out-dir", "batch", "--quiet"], check=True)
    sweep_refusals()
    for arguments, outputs in COMMANDS:
        sweep_room(arguments, outputs)
    sweep_batch()
    empty()
    subprocess.run(["mount", "-o", "remount,ro", directory], check=True)
    for arguments, outputs in COMMANDS:
        before = [contents(path) for path in outputs]
        result = run(arguments)
        if [contents(path) for path in outputs] != before:
            fail("read-only, but other outputs: " + " ".join(arguments), result.returncode, result.stderr)
        if result.returncode != 3 or b"Read-only file system" not in result.stderr or result.stderr.count(b"\n") != 1:
            fail("read-only: " + " ".join(arguments), result.returncode, result.stderr)
    os.chdir("/")
    sys.exit(report())


if "--inside" in sys.argv:
    inside(sys.argv[-1])
with tempfile.TemporaryDirectory() as directory:
    mountable = [*NAMESPACE, "mount", "-t", "tmpfs", "tmpfs", directory]
    if subprocess.run(mountable, stderr=subprocess.DEVNULL).returncode != 0:
        print("no namespace for a file system of its own may be made here")
        sys.exit(77)
    sys.exit(subprocess.run([*NAMESPACE, sys.executable, __file__, *sys.argv[1:3], "--inside", directory]).returncode)
