"""Faults at every stage of a run: python3 faults_test.py RAYCONE MESH_DIRECTORY [--memory|--threads] [--long]

Signals, a full disk, a file that shrinks; with --memory instead memory that runs out (status 77 where RAYCONE is built with
a sanitizer, which ends the process then), with --threads batches of a user who may have few (77 where not root). Whatever happens, a run ends with a documented status and one line, and leaves
the earlier outputs as they were or replaces them by the complete new ones. --long sweeps more finely.
"""

import csv
import math
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

from runs import CLOSED, MESHES, OPEN, RAYCONE, Run, all_runs, contents, fail, is_sanitized, limit, report

LONG = "--long" in sys.argv
FEW_THREADS = "--threads" in sys.argv


# From too little for the program to be loaded (127, the dynamic linker's; it dies of no other signal) to enough.
def sweep_memory(run, kind, of_what, size, step):
    refused, succeeded = 0, 0
    while succeeded < 3:
        process = run.start(preexec_fn=limit(kind, size))
        message = process.communicate(timeout=300)[1]
        status = process.returncode
        what = "%s of %d kB" % (of_what, size >> 10)
        if status == 0:
            succeeded += 1
        elif status == 4 and message.startswith(b"raycone: ") and message.count(b"\n") == 1:
            refused += 1
        elif status != 127:
            fail("%s, %s" % (run.name, what), status, message)
        run.check(what, status, message, status == 0)
        size += step
        if size > 4 << 30:
            return fail(run.name + ": no memory is enough", status, message)
    if refused == 0:
        fail(run.name + ": memory never ran out within the program", 0, b"")


# After any time from start to end; the run dies of the signal unless it was faster. On a machine that others use, too,
# the first run may have taken far longer than those that follow.
def sweep_signals(run, count):
    start = time.monotonic()
    run.start().communicate()
    duration, killed = time.monotonic() - start, 0
    chance = random.Random(7)
    for i in range(count):
        kind = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2)[i % 5]
        start = time.monotonic()
        process = run.start()
        try:
            process.wait(chance.uniform(0, 1.1 * duration))
            duration = min(duration, time.monotonic() - start)
        except subprocess.TimeoutExpired:
            process.send_signal(kind)
        message = process.communicate(timeout=300)[1]
        run.check_signal("signal %d" % kind, kind, process.returncode, message)
        killed += process.returncode == -kind
    if killed < count / 3:
        fail("%s: of %d runs only %d died of their signals" % (run.name, count, killed), None, b"")


# At any byte the disk may be full.
def sweep_disk(run, count):
    run.start().communicate()
    length = os.path.getsize(run.outputs[0])
    for i in range(count):
        size = length * i // count
        process = run.start(preexec_fn=limit(resource.RLIMIT_FSIZE, max(size, 1)))
        message = process.communicate(timeout=300)[1]
        if process.returncode != 3 or message.count(b"\n") != 1 or b": cannot write: File too large" not in message:
            fail("%s, files up to %d bytes" % (run.name, size), process.returncode, message)
        run.check("files up to %d bytes" % size, process.returncode, message, False)


# Inputs that are cut short and grow again while they are read.
def sweep_shrinking(count):
    whole = b"".join(b"v %d 0 %d\n" % (i, i * i) for i in range(200000)) + b"f 1 2 3\n" * 200000
    chance, statuses = random.Random(8), set()
    for i in range(count):
        with open("shrinking.obj", "wb") as file:
            file.write(whole)
        process = subprocess.Popen([RAYCONE, "info", "shrinking.obj"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        while process.poll() is None:
            time.sleep(chance.uniform(0, 0.01))
            os.truncate("shrinking.obj", chance.randrange(len(whole)))
        message = process.communicate(timeout=300)[1]
        statuses.add(process.returncode)
        told = message.startswith(b"raycone: shrinking.obj:") and message.count(b"\n") == 1
        if process.returncode not in (0, 2) or (process.returncode == 2 and not told):
            fail("file that shrinks", process.returncode, message)
    if 2 not in statuses:
        fail("file that shrinks: it never had a consequence", 0, b"")
    os.unlink("shrinking.obj")


# The meshes of a batch fail one by one, or all of it does; what there is afterwards is complete.
def sweep_batch_memory(step):
    arguments = [RAYCONE, "batch", CLOSED, OPEN, "--resolution", "16", "--threads", "2", "--out-dir"]
    subprocess.run([*arguments, "whole"], check=True, stderr=subprocess.DEVNULL)
    complete = {name: contents("whole/" + name) for name in os.listdir("whole") if name.endswith(".vdb")}
    size, statuses = 24 << 20, []
    while statuses.count(0) < 3:
        subprocess.run(["rm", "-rf", "out"], check=True)
        process = subprocess.run([*arguments, "out"], capture_output=True, timeout=300, preexec_fn=limit(resource.RLIMIT_AS, size))
        what = "batch, address space of %d MB" % (size >> 20)
        statuses.append(process.returncode)
        lines = process.stderr.splitlines()
        if process.returncode not in (0, 4, 5, 127) or (process.returncode != 127 and not all(line.startswith(b"raycone: ") for line in lines)):
            fail(what, process.returncode, process.stderr)
        for name in os.listdir("out") if os.path.isdir("out") else []:
            if not name.endswith(".csv") and contents("out/" + name) != complete.get(name):
                fail("%s: %s is not the complete one" % (what, name), process.returncode, process.stderr)
        size += step
        if size > 8 << 30:
            return fail("batch: no memory is enough", process.returncode, process.stderr)


# One row per mesh, and the output of each that is ok. A batch that can start nothing at all (4) may have no rows.
def check_rows(directory, names, status, message):
    table = os.path.join(directory, "results.csv")
    rows = []
    if os.path.exists(table):
        with open(table, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    made = [row["output"] for row in rows if row["status"] == "ok"]
    if [row["mesh"] for row in rows] != names and (status, rows) != (4, []):
        fail("%s: rows of %s" % (directory, [row["mesh"] for row in rows]), status, message)
    if rows and (status == 0) != (len(made) == len(rows)):
        fail("%s: %d of %d rows are ok" % (directory, len(made), len(rows)), status, message)
    if made and not set(made) <= set(os.listdir(directory)):
        fail("%s: not all outputs of rows that are ok: %s" % (directory, made), status, message)


# Processes that load OpenVDB at once take threads from each other. Root has as many as it likes, so another user runs
# this.
def batch_with_few_threads(count):
    def few_threads(threads=12):
        os.setsid()
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)
        resource.setrlimit(resource.RLIMIT_NPROC, (threads, threads))

    os.chmod(".", 0o777)
    try:
        subprocess.run([RAYCONE, "--version"], capture_output=True, check=True, preexec_fn=few_threads)
    except (OSError, subprocess.SubprocessError):
        print("batches with few threads need root, and a build that others may read")
        sys.exit(77)
    names = sorted(os.listdir(MESHES))
    failed = 0
    for i in range(count):
        arguments = [RAYCONE, "batch", MESHES, "--resolution", "6", "--jobs", "4", "--quiet", "--out-dir", "few%d" % i]
        process = subprocess.Popen(arguments, stderr=subprocess.PIPE, preexec_fn=lambda: few_threads(10 + i % 2))
        try:
            message = process.communicate(timeout=60)[1]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return fail("batch with few threads hangs", None, b"")
        if process.returncode not in (0, 4, 5) or not all(line.startswith(b"raycone: ") for line in message.splitlines()):
            fail("batch with few threads", process.returncode, message)
        failed += process.returncode != 0
        check_rows("few%d" % i, names, process.returncode, message)
    if failed == 0:
        fail("batch with few threads: they were enough each time", 0, b"")
    if failed == count:  # ten are too few; eleven are enough where none is left idle by OpenVDB's log library
        fail("batch with few threads: they were never enough", None, b"")


# Meshes that never end are read until the limit, and no further.
def read_endless_meshes():
    for what in (
        "%s info --memory-limit 100M /dev/zero",
        "ulimit -v 1000000; exec %s info /dev/zero",
        "yes 'v 0 0 0' | exec %s info --memory-limit 100M --mesh-format obj -",
    ):
        process = subprocess.run(["sh", "-c", what % RAYCONE], capture_output=True, timeout=300)
        message = process.stderr
        if process.returncode != 4 or message.count(b"\n") != 1 or b"memory" not in message or b"the limit is " not in message:
            fail(what, process.returncode, process.stderr)


# Nor are lists, of which there is no limit but what data may take.
def read_endless_lists():
    for what in (
        "ulimit -d 200000; yes a.obj | exec %s batch @- --out-dir endless",
        "ulimit -d 200000; yes a.obj | exec %s lattice @/dev/stdin --field label -o endless.npy",
        "ulimit -d 200000; exec %s batch @/dev/zero --out-dir endless",
    ):
        process = subprocess.run(["sh", "-c", what % RAYCONE], capture_output=True, timeout=300)
        if process.returncode != 4 or not re.fullmatch(rb"raycone: [^ ]+: larger than \d+ bytes, expected a smaller file\n", process.stderr):
            fail(what, process.returncode, process.stderr)


# What data may take is known from the start.
def refuse_what_data_cannot_hold():
    what = "ulimit -d 200000; exec %s slice %s -o big.png --size 20000" % (RAYCONE, OPEN)
    one_cpu = {min(os.sched_getaffinity(0))}  # stacks of threads are data
    process = subprocess.run(["sh", "-c", what], capture_output=True, timeout=300, preexec_fn=lambda: os.sched_setaffinity(0, one_cpu))
    if process.returncode != 4 or not re.search(rb"needs about 10 GB of memory, but the limit is [12]\d\d MB", process.stderr):
        fail(what, process.returncode, process.stderr)


def write_spheres(path):
    """Four that meet each other: in thousands of points, whose coordinates are integers of GMP."""
    rings, points = 16, 24
    with open(path, "w", encoding="utf-8") as file:
        for number in range(4):
            for i in range(rings + 1):
                for j in range(points):
                    height, turn = math.pi * i / rings, 2 * math.pi * j / points + number
                    x, y, z = math.sin(height) * math.cos(turn), math.sin(height) * math.sin(turn), math.cos(height)
                    file.write("v %r %r %r\n" % (x + 0.3 * number, y + 0.07 * number**2, z - 0.11 * number))
            first = number * (rings + 1) * points + 1
            for i in range(rings):
                for j in range(points):
                    a, b = first + i * points + j, first + i * points + (j + 1) % points
                    file.write("f %d %d %d\nf %d %d %d\n" % (a, a + points, b + points, a, b + points, b))


if ("--memory" in sys.argv or FEW_THREADS) and is_sanitized():
    print("sanitizers do not live within limits of memory and threads")
    sys.exit(77)
with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    for run in [] if FEW_THREADS else all_runs():
        if "--memory" in sys.argv:
            sweep_memory(run, resource.RLIMIT_AS, "address space", 24 << 20, (1 if LONG else 20) << 20)
            sweep_memory(run, resource.RLIMIT_DATA, "data", 1 << 20, (256 if LONG else 6 << 10) << 10)
        else:
            sweep_disk(run, 60 if LONG else 4)
            sweep_signals(run, 300 if LONG else 10)
    if "--memory" in sys.argv:
        surface = Run("surface to PLY", "surface", CLOSED, "--resolution", "30", output="out.ply")  # much of it in GMP
        sweep_memory(surface, resource.RLIMIT_DATA, "data", 10 << 20, (100 if LONG else 1000) << 10)
        write_spheres("spheres.obj")
        surface = Run("surface of spheres", "surface", "spheres.obj", "--resolution", "16", output="out.ply")
        sweep_memory(surface, resource.RLIMIT_DATA, "data", 12 << 20, (50 if LONG else 200) << 10)
        sweep_batch_memory((1 if LONG else 40) << 20)
        read_endless_meshes()
        read_endless_lists()
        refuse_what_data_cannot_hold()
    elif FEW_THREADS:
        batch_with_few_threads(100 if LONG else 10)
    else:
        sweep_shrinking(200 if LONG else 6)
    os.chdir("/")
sys.exit(report())
