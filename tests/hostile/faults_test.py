"""Faults at every stage of a run: python3 faults_test.py RAYCONE MESH_DIRECTORY [--long]

Memory that runs out, signals, a full disk, a file that shrinks. Whatever happens, a run ends with a documented status and
one line, and leaves the earlier output as it was or replaces it by the complete new one. --long sweeps more finely.
"""

import hashlib
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

RAYCONE, MESHES = sys.argv[1:3]
LONG = "--long" in sys.argv
CLOSED, OPEN = (os.path.join(MESHES, name) for name in ("teapot.obj", "open_box.obj"))
failures = []


def fail(what, result, message):
    failures.append("%s: status %d: %s" % (what, result, message.decode()[:300].strip()))


# A run's arguments in a directory of its own, with an earlier output, whose fate is checked.
class Run:
    def __init__(self, name, *arguments, output):
        self.name, self.arguments, self.output = name, [*arguments, "--threads", "2"], output
        subprocess.run([RAYCONE, *self.arguments, "-o", output], check=True, stderr=subprocess.DEVNULL)
        self.complete = self.read()

    def read(self):
        with open(self.output, "rb") as file:
            return hashlib.sha256(file.read()).digest()

    def start(self, **options):
        with open(self.output, "w") as file:
            file.write("earlier")
        self.before = set(os.listdir())
        return subprocess.Popen([RAYCONE, *self.arguments, "-o", self.output], stderr=subprocess.PIPE, **options)

    # `done`: whether the run said that it was.
    def check(self, what, status, message, done):
        debris = set(os.listdir()) - self.before
        if debris:
            fail("%s, %s left %s" % (self.name, what, debris), status, message)
        if self.read() != (self.complete if done else hashlib.sha256(b"earlier").digest()):
            fail("%s, %s: output neither the earlier nor the complete one" % (self.name, what), status, message)


def limit(kind, size):
    return lambda: resource.setrlimit(kind, (size, size))


# From too little for the program to be loaded (127, the dynamic linker's; it dies of no other signal) to enough.
def sweep_memory(run, step):
    size, refused, succeeded = 24 << 20, 0, 0
    while succeeded < 3:
        process = run.start(preexec_fn=limit(resource.RLIMIT_AS, size))
        message = process.communicate(timeout=300)[1]
        status = process.returncode
        what = "address space of %d MB" % (size >> 20)
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


# After any time from start to end; the run dies of the signal unless it was faster.
def sweep_signals(run, count):
    start = time.monotonic()
    run.start().communicate()
    duration = time.monotonic() - start
    chance = random.Random(7)
    for i in range(count):
        kind = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)[i % 3]
        process = run.start()
        time.sleep(chance.uniform(0, 1.1 * duration))
        process.send_signal(kind)
        message = process.communicate(timeout=300)[1]
        # A signal between the renaming and the end finds the output complete, and perhaps the summary printed.
        done = run.read() == run.complete
        if process.returncode not in (0, -kind) or (message and not done):
            fail("%s, signal %d" % (run.name, kind), process.returncode, message)
        run.check("signal %d" % kind, process.returncode, message, done)


# At any byte the disk may be full.
def sweep_disk(run, count):
    length = os.path.getsize(run.output)
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
    chance = random.Random(8)
    for i in range(count):
        with open("shrinking.obj", "wb") as file:
            file.write(whole)
        process = subprocess.Popen([RAYCONE, "info", "shrinking.obj"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        for _ in range(10):
            time.sleep(chance.uniform(0, 0.01))
            os.truncate("shrinking.obj", chance.randrange(len(whole)))
        message = process.communicate(timeout=300)[1]
        if process.returncode not in (0, 2):
            fail("file that shrinks", process.returncode, message)
    os.unlink("shrinking.obj")


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    with open("points.csv", "w") as points:
        points.writelines("%r,%r,%r\n" % (random.random(), random.random(), random.random()) for _ in range(20000))
    runs = [
        Run("closed mesh to VDB", "lattice", CLOSED, "--resolution", "48", output="out.vdb"),
        Run("open mesh to CSV", "lattice", OPEN, "--resolution", "24", "--diagnostics", output="out.csv"),
        Run("points to NPY", "points", CLOSED, "points.csv", output="points.npy"),
    ]
    for run in runs:
        sweep_disk(run, 60 if LONG else 6)
        sweep_signals(run, 300 if LONG else 15)
        if "--no-memory" not in sys.argv:  # sanitizers need terabytes of addresses
            sweep_memory(run, (1 if LONG else 10) << 20)
    sweep_shrinking(200 if LONG else 10)
    os.chdir("/")
for failure in failures:
    print(failure)
print("%d wrong" % len(failures))
sys.exit(1 if failures else 0)
