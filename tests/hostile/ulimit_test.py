"""Limits of the shell: python3 ulimit_test.py RAYCONE MESH_DIRECTORY [--long].

Each command runs with little stack, few open files, processes and locked bytes, and files of few bytes (memory:
faults_test.py). It ends as ever, or with a documented status and one line, and leaves the earlier output and nothing else.
"""

import os
import resource
import signal
import sys
import tempfile

from runs import CLOSED, OPEN, RAYCONE, Run, fail, is_sanitized, report

LONG = "--long" in sys.argv
KB = 1024
# What the dynamic linker needs, beside some kilobytes at random, before any line of ours runs.
LINKER_STACK = 32 * KB
# Limits, whether root obeys them, and the values tried.
LIMITS = [
    ("stack", resource.RLIMIT_STACK, [16 * KB, 32 * KB, 64 * KB, 200 * KB, 256 * KB, 1024 * KB]),
    ("open files", resource.RLIMIT_NOFILE, list(range(4, 40)) if LONG else [4, 6, 8, 10, 12, 16, 24]),
    ("processes", resource.RLIMIT_NPROC, [0, 1, 2]),
    ("locked bytes", resource.RLIMIT_MEMLOCK, [0]),
    ("file size", resource.RLIMIT_FSIZE, [0, 1, 512, 4096]),
]


def disturbed(run, kind, soft, hard):
    # The environment lies on the stack, too: one of some kilobytes more would leave the linker nothing.
    process = run.start(preexec_fn=lambda: resource.setrlimit(kind, (soft, hard)), env={"PATH": os.defpath})
    message = process.communicate(timeout=100)[1]
    return process.returncode, message


def started(status, message, stack=None):
    """False where the dynamic linker failed: it says so, or has no stack to say so."""
    if stack is not None and stack < LINKER_STACK and status == -signal.SIGSEGV and not message:
        return False
    return not (status == 127 and b"error while loading shared libraries" in message)


def check(run, what, status, message, stack=None):
    if started(status, message, stack) and (status not in run.STATUSES or (status != 0 and not run.is_told(message))):
        fail("%s, %s" % (run.name, what), status, message)
    run.check(what, status, message, status == 0)


def sweep(run):
    refused = 0
    for name, kind, values in LIMITS:
        for value in values:
            status, message = disturbed(run, kind, value, value)
            stack = value if name == "stack" else None
            check(run, "%d of %s" % (value, name), status, message, stack)
            refused += status != 0
            if stack is not None and stack < 256 * KB and status != 4 and started(status, message, stack):
                fail("%s, a stack of %d bytes" % (run.name, value), status, message)
    # One that may be raised is.
    status, message = disturbed(run, resource.RLIMIT_STACK, LINKER_STACK, resource.RLIM_INFINITY)
    if status != 0:
        fail("%s, a stack that may be raised" % run.name, status, message)
    if refused < 6:
        fail("%s: the limits had no consequence" % run.name, None, b"")
    print("%s: %d refused" % (run.name, refused))


if is_sanitized():
    print("sanitizers need more than small limits leave")
    sys.exit(77)
with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    sweep(Run("to VDB", "lattice", OPEN, "--resolution", "12", output="out.vdb", report="vdb.json"))
    sweep(Run("to NPY", "lattice", CLOSED, "--resolution", "12", output="out.npy"))
    sweep(Run("slice", "slice", OPEN, "--size", "32", output="out.png"))
    os.chdir("/")
sys.exit(report())
