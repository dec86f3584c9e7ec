"""System calls that fail: python3 system_calls_test.py RAYCONE MESH_DIRECTORY [--long] [CALL...]

strace(1) makes one call of a run return an error, as the kernel does where disks break, quotas and tables are full and
memory ends, or delivers a signal during it. A run either does not need that call and ends as ever, or ends with a documented
status and one line, and leaves the earlier outputs, or complete new ones; a batch that is run again completes them. In
particular no input that cannot be read to its end is taken for a shorter one. --long tries every call of every run with every
error, else one of each kind with one, of a kind in every other run (of CALLs only, if given).
Status 77 where strace is missing or may not trace, or RAYCONE is built with a sanitizer, which traces itself.
"""

import collections
import os
import random
import re
import signal
import subprocess
import sys
import tempfile

from runs import CLOSED, MESHES, OPEN, RAYCONE, BatchRun, all_runs, fail, report

LONG = "--long" in sys.argv
CHOSEN = [argument for argument in sys.argv[3:] if not argument.startswith("--")]
SAMPLED = 1  # calls of each kind, run and error

ERRORS = {
    "openat": ["EMFILE", "EACCES", "EIO", "EINTR"],
    "read": ["EIO", "EINTR"],
    "pread64": ["EIO", "EINTR"],
    "lseek": ["EIO"],
    "newfstatat": ["EIO"],
    "write": ["ENOSPC", "EDQUOT", "EIO", "EINTR"],
    "fsync": ["EIO", "EDQUOT", "EINTR"],
    "close": ["EIO", "EDQUOT"],
    "rename": ["EDQUOT", "EIO", "EPERM"],
    "fallocate": ["ENOSPC", "EDQUOT", "EOPNOTSUPP", "EINTR"],
    "fstatfs": ["ENOSYS"],
    "flock": ["ENOLCK"],
    "fcntl": ["EINVAL"],
    "readlink": ["EIO"],
    "mmap": ["ENOMEM"],
    "mprotect": ["ENOMEM"],
    "clone": ["EAGAIN"],
    "wait4": ["EINTR"],
    "pipe2": ["EMFILE"],
    "getrandom": ["ENOSYS"],
    "sched_getaffinity": ["EPERM"],
    "ioctl": ["ENOTTY"],
}
SIGNALS = ["openat", "read", "write", "fsync", "close", "rename", "mmap", "clone3"]

# All calls of these fail: threads cannot be started from some time on, not just once. (After those that the tool tries
# before it loads OpenVDB, and before those that OpenVDB's logging library starts, no run survives.)
FROM_FIRST = {"clone3": "EAGAIN"}
# brk(2) is not among them: it reports errors otherwise, which strace cannot imitate.

# What the dynamic linker calls last, on its own behalf, before the program begins.
LAST_OF_LINKER = "prlimit64(0, RLIMIT_STACK"


def strace(call, injection, log):
    return ["strace", "-f", "-qq", "-o", log, "-e", "trace=" + call, "-e", "signal=none", "-e", "inject=%s:%s" % (call, injection)]


def may_trace():
    try:
        return subprocess.run(strace("write", "error=EIO:when=1", "strace.log") + [RAYCONE, "--version"],
                              capture_output=True).returncode == 3
    except FileNotFoundError:
        return False


# The numbers of the calls of each kind in the thread of `run` that makes most of them, but for those that its dynamic
# linker makes before. Of close(2) only those of outputs: strace makes no call that it lets fail, and a pipe must be
# closed.
def numbers_of_calls(run):
    run.start(["strace", "-f", "-qq", "-y", "-o", "strace.log"]).communicate(timeout=300)
    counts, linker, numbers = collections.Counter(), None, collections.defaultdict(list)
    with open("strace.log", errors="replace") as log:
        for line in log:
            call = re.match(r"(\d+) +(\w+)\(", line)
            if not call:
                continue
            counts[call.groups()] += 1
            if linker and counts[call.groups()] > linker[call[2]] and (call[2] != "close" or "/.raycone-" in line):
                numbers[call.groups()].append(counts[call.groups()])
            if linker is None and LAST_OF_LINKER in line:
                linker = collections.Counter({name: count for (_, name), count in counts.items()})
    most = collections.defaultdict(list)
    for (_, call), of_thread in numbers.items():
        most[call] = max(most[call], of_thread, key=len)
    return most


# What of `log` is about standard error, where the line that would tell of the fault goes.
def is_speechless(log):
    with open(log, errors="replace") as file:
        return any(re.search(r"\b(write|close)\(2\b.*INJECTED", line) for line in file)


# Runs with one disturbed call: the status, and what was said; None where the run hangs.
def disturb(run, call, injection):
    process = run.start(strace(call, injection, "strace.log"), start_new_session=True)
    try:
        message = process.communicate(timeout=100)[1]
        return process.returncode, message
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return None, process.communicate()[1]


# `when`: the number of a call, or with a plus sign of it and all after it.
def inject_error(run, call, error, when):
    status, message = disturb(run, call, "error=%s:when=%s" % (error, when))
    what = "%s: %s of call %s" % (call, error, when)
    if status not in run.STATUSES or (status != 0 and not run.is_told(message) and not is_speechless("strace.log")):
        fail("%s, %s" % (run.name, what), status, message)
    run.check(what, status, message, status == 0, may_be_renamed=call == "fsync")
    return status


def inject_signal(run, call, kind, when):
    status, message = disturb(run, call, "signal=%s:when=%d" % (kind.name, when))
    what = "%s during call %d of %s" % (kind.name, when, call)
    run.check_signal(what, kind, status, message)
    return status


def chosen(calls):
    return [call for call in calls if not CHOSEN or call in CHOSEN]


def sweep(run, place, chance):
    calls = numbers_of_calls(run)
    results = collections.Counter()

    def times(call):
        return calls[call] if LONG else chance.sample(calls[call], min(SAMPLED, len(calls[call])))

    def taken(calls):
        return [call for n, call in enumerate(chosen(calls)) if LONG or CHOSEN or (n + place) % 2 == 0]

    for call in taken(ERRORS):
        for error in ERRORS[call] if LONG else [chance.choice(ERRORS[call])]:
            for when in times(call):
                results[inject_error(run, call, error, when)] += 1
    for call in chosen(FROM_FIRST):
        results[inject_error(run, call, FROM_FIRST[call], "1+")] += 1
    for call in taken(SIGNALS):
        for when in times(call):
            results[inject_signal(run, call, signal.SIGTERM, when)] += 1
    # Controls: faults that reach nobody would prove nothing.
    if not CHOSEN and (results[3] == 0 or results[-signal.SIGTERM] == 0):
        fail("%s: no injected error or no signal had a consequence" % run.name, None, b"")
    print("%s: %s" % (run.name, ", ".join("status %s: %d" % item for item in results.most_common())), flush=True)


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    open("strace.log", "w").close()
    if not may_trace():
        print("strace is missing, or may not trace here")
        sys.exit(77)
    batch = BatchRun("batch", CLOSED, OPEN, MESHES + "/cube.obj", "--resolution", "12")
    for place, run in enumerate([*all_runs(), batch]):
        sweep(run, place, random.Random(9))
    os.chdir("/")
sys.exit(report())
