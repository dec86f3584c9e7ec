"""Runs of raycone that are disturbed, and what must hold then, for the tests beside this file: TEST RAYCONE
MESH_DIRECTORY."""

import hashlib
import json
import os
import random
import resource
import subprocess
import sys

RAYCONE, MESHES = (os.path.abspath(path) for path in sys.argv[1:3])
CLOSED, OPEN = (os.path.join(MESHES, name) for name in ("teapot.obj", "open_box.obj"))
EARLIER = b"earlier"
failures = []
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # for all that is started here: cores would be left and take long


def fail(what, status, message):
    failures.append("%s: status %s: %s" % (what, status, message.decode()[:300].strip()))


def contents(path):
    with open(path, "rb") as file:
        return file.read()


# A run's arguments, with earlier outputs, whose fate is checked: -o and those of other options.
class Run:
    STATUSES = {0, 2, 3, 4}

    def __init__(self, name, *arguments, output, **others):
        self.name, self.outputs = name, [output, *others.values()]
        self.arguments = [RAYCONE, *arguments, "--threads", "2", "-o", output]
        for option, path in others.items():
            self.arguments += ["--" + option, path]
        subprocess.run(self.arguments, check=True, stderr=subprocess.DEVNULL)
        self.complete = {path: hashlib.sha256(contents(path)).digest() for path in self.outputs}

    def is_complete(self, path):
        content = contents(path)
        if path.endswith(".json"):  # it tells times, which vary
            return content.endswith(b"}\n") and "seconds" in json.loads(content)
        return hashlib.sha256(content).digest() == self.complete[path]

    # Behind the words of `tracer`, if any.
    def start(self, tracer=(), **options):
        for path in self.outputs:
            with open(path, "wb") as file:
                file.write(EARLIER)
        self.before = set(os.listdir())
        return subprocess.Popen([*tracer, *self.arguments], stderr=subprocess.PIPE, **options)

    # `done`: whether the run said that it was. Of several outputs some may have been completed before a fault; an
    # output whose directory cannot be synced has its name already (`may_be_renamed`).
    def check(self, what, status, message, done, may_be_renamed=False):
        debris = set(os.listdir()) - self.before
        if debris:
            fail("%s, %s left %s" % (self.name, what, debris), status, message)
        for path in self.outputs:
            if contents(path) == EARLIER and not done:
                continue
            if not self.is_complete(path) or (not done and len(self.outputs) == 1 and not may_be_renamed):
                fail("%s, %s: %s neither the earlier nor the complete one" % (self.name, what, path), status, message)

    def is_told(self, message):
        return message.startswith(b"raycone: ") and message.count(b"\n") == 1

    # It died of the signal, or was faster. A signal between the renaming and the end finds the output complete, and
    # perhaps the summary printed.
    def check_signal(self, what, kind, status, message):
        done = self.is_complete(self.outputs[0])
        if status not in (0, -kind) or (message and not done):
            fail("%s, %s" % (self.name, what), status, message)
        self.check(what, status, message, done and len(self.outputs) == 1)


# A batch into a directory of its own.
class BatchRun:
    STATUSES = {0, 2, 3, 4, 5}  # 2: rows of an earlier run cannot be read

    def __init__(self, name, *arguments):
        self.name, self.arguments = name, [RAYCONE, "batch", *arguments, "--threads", "2", "--out-dir", "batch"]
        subprocess.run([*self.arguments, "--quiet"], check=True)
        self.complete = self.outputs()

    def outputs(self):
        names = os.listdir("batch") if os.path.isdir("batch") else []
        return {name: contents("batch/" + name) for name in names if not name.endswith(".csv")}  # those tell times

    def start(self, tracer=(), **options):
        subprocess.run(["rm", "-rf", "batch"], check=True)
        return subprocess.Popen([*tracer, *self.arguments], stderr=subprocess.PIPE, **options)

    # What there is is complete, and all of it after another run.
    def check(self, what, status, message, done, may_be_renamed=False):
        left = self.outputs()
        again = subprocess.run([*self.arguments, "--quiet", "--retry-failed"], stderr=subprocess.PIPE, timeout=300)
        if not left.items() <= self.complete.items() or (done and left != self.complete):
            fail("%s, %s left %s" % (self.name, what, list(left)), status, message)
        if again.returncode != 0 or self.outputs() != self.complete:
            fail("%s, run again after %s: %s" % (self.name, what, again.stderr), again.returncode, message)

    def is_told(self, message):
        return message != b"" and all(line.startswith(b"raycone: ") for line in message.splitlines())

    # A worker that is killed before it leaves signals to its supervisor costs its mesh.
    def check_signal(self, what, kind, status, message):
        if status not in (0, 5, -kind):
            fail("%s, %s" % (self.name, what), status, message)
        self.check(what, status, message, status == 0)


# In the current directory, which they fill.
def all_runs():
    with open("points.csv", "w") as points:
        points.writelines("%r,%r,%r\n" % (random.random(), random.random(), random.random()) for _ in range(20000))
    runs = [
        Run("closed mesh to VDB", "lattice", CLOSED, "--resolution", "48", output="out.vdb"),
        Run("open mesh to CSV", "lattice", OPEN, "--resolution", "24", "--diagnostics", output="out.csv"),
        Run("points to NPY", "points", CLOSED, "points.csv", output="points.npy"),
        Run("level set to VTI", "lattice", CLOSED, "--field", "sdf", "--resolution", "24", output="out.vti", depfile="out.d"),
        Run("samples to NPZ", "points", CLOSED, "--sample", "uniform=9000,near=9000:0.01", "--field", "winding,inside,sdf",
            output="out.npz", report="npz.json"),
        Run("slice to PNG", "slice", OPEN, "--size", "150", output="out.png", values="values.npy", report="png.json"),
    ]
    os.rename("out.vdb", "like.vdb")
    runs[0] = Run("closed mesh to VDB", "lattice", CLOSED, "--like", "like.vdb", output="out.vdb", report="vdb.json")
    return runs


def limit(kind, size):
    return lambda: resource.setrlimit(kind, (size, size))


# Sanitizers reserve terabytes of addresses before the program starts, and die where memory runs out.
def is_sanitized():
    limited = limit(resource.RLIMIT_AS, 8 << 30)
    return subprocess.run([RAYCONE, "--version"], capture_output=True, preexec_fn=limited).returncode != 0


def report():
    for failure in failures:
        print(failure)
    print("%d wrong" % len(failures))
    return 1 if failures else 0
