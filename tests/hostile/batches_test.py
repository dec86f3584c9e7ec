"""Batches disturbed: python3 batches_test.py RAYCONE MESH_DIRECTORY [--seconds S] [--seed N].

One to four batches at a time, of one or of two sets of options, whole or in shards, on this host or on another one (a
namespace of its own), into one directory; each is killed or interrupted at a random moment, or left alone. Then:
- a batch of either set of options, run again alone, ends with status 0, and every output is, byte by byte, that of an
  undisturbed run with these options: no row describes one run beside a file of the other;
- a file of the user that is named almost like a temporary one is there as it was;
- nothing else is left.
"""

import argparse
import collections
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser()
parser.add_argument("raycone")
parser.add_argument("meshes")
parser.add_argument("--seconds", type=float, default=4)
parser.add_argument("--seed", type=int, default=1)
given = parser.parse_args()
RAYCONE, MESHES = os.path.abspath(given.raycone), os.path.abspath(given.meshes)
OPTIONS = {"one": ["--resolution", "20"], "other": ["--resolution", "20", "--scale", "2"]}  # NPY of the same size
OTHER_HOST = ["unshare", "--uts", "--pid", "--fork", "--mount-proc", "sh", "-c", 'hostname elsewhere; exec "$@"', "sh"]
PRECIOUS = ".raycone-notes"
failures, counts = [], collections.Counter()


def contents(path):
    with open(path, "rb") as file:
        return file.read()


def command(kind, out, *more):
    return [RAYCONE, "batch", "in", "--out-dir", out, "--format", "npy", "--threads", "1", "--quiet", *OPTIONS[kind], *more]


def outputs(directory):
    return {name: contents(os.path.join(directory, name)) for name in os.listdir(directory) if name.endswith(".npy")}


def has_other_host():
    return subprocess.run([*OTHER_HOST, "true"], capture_output=True).returncode == 0


def start(chance, elsewhere, kind):
    more = chance.choice([[], [], ["--shard", "1/2"], ["--shard", "2/2"]])
    host = OTHER_HOST if elsewhere and chance.random() < 0.3 else []
    counts["on another host"] += bool(host)
    return subprocess.Popen([*host, *command(kind, "out", *more)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, start_new_session=True)


# Killed are all processes of a batch, or its supervisor alone.
def disturb(chance, process):
    kind = chance.choice([None, signal.SIGKILL, signal.SIGKILL, "all", signal.SIGINT, signal.SIGTERM])
    counts[str(kind)] += 1
    try:
        if kind == "all":
            os.killpg(process.pid, signal.SIGKILL)
        elif kind:
            process.send_signal(kind)
    except ProcessLookupError:
        pass


def finish(process):
    message = process.communicate(timeout=300)[1]
    status = process.returncode
    refused = status == 3 and b"a batch with other options" in message
    counts["refused" if refused else "died of a signal" if status < 0 else "ended"] += 1
    if not refused and status not in (0, -signal.SIGKILL, -signal.SIGINT, -signal.SIGTERM, 137, 130, 143):
        failures.append("status %s: %s" % (status, message.decode()[:300]))


def run_round(chance, complete, elsewhere):
    kinds = chance.choice([["one"], ["other"], ["one", "other"], ["one", "one", "other", "other"], ["one"] * 4])
    batches = [start(chance, elsewhere, kind) for kind in kinds]
    time.sleep(chance.random() * 0.25)
    for batch in batches:
        disturb(chance, batch)
    for batch in batches:
        finish(batch)
    if chance.random() < 0.5:
        return  # the next round finds what this one left
    # Markers of another host's namespace, whose batch was killed, would be waited for ten minutes.
    for name in os.listdir("out"):
        if ".batch-" in name:
            os.utime(os.path.join("out", name), (0, 0))
    kind = chance.choice(["one", "other"])
    result = subprocess.run(command(kind, "out"), capture_output=True, timeout=300)
    counts["checked"] += 1
    if result.returncode != 0 or outputs("out") != complete[kind]:
        wrong = [name for name, content in complete[kind].items() if outputs("out").get(name) != content]
        failures.append("run again with %s: status %d: %s: wrong: %s" % (kind, result.returncode, result.stderr.decode()[:300], wrong))
    left = [name for name in os.listdir("out") if name.startswith(".raycone-") and name != PRECIOUS]
    if left and not elsewhere:
        failures.append("left: %s" % left)
    for name in left:
        os.unlink(os.path.join("out", name))
    if PRECIOUS not in os.listdir("out") or contents(os.path.join("out", PRECIOUS)) != b"precious":
        failures.append("a file of the user was changed")


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    os.mkdir("in")
    for n, name in enumerate(["teapot.obj", "open_box.obj", "cube.obj", "swiss_roll.obj", "moebius.obj", "soup.obj"] * 2):
        os.symlink(os.path.join(MESHES, name), "in/%d.obj" % n)
    complete = {}
    for kind in OPTIONS:
        subprocess.run(command(kind, kind), check=True)
        complete[kind] = outputs(kind)
    os.mkdir("out")
    with open(os.path.join("out", PRECIOUS), "wb") as file:
        file.write(b"precious")
    chance, elsewhere, end = random.Random(given.seed), has_other_host(), time.monotonic() + given.seconds
    while time.monotonic() < end or counts["checked"] < 3:  # rounds take longer on a busy machine
        run_round(chance, complete, elsewhere)
    os.chdir("/")
# Else it would say nothing.
if counts["died of a signal"] == 0 or counts["ended"] == 0:
    failures.append("no batch died of a signal, or none ended")
for failure in failures:
    print(failure)
print(", ".join("%s: %d" % item for item in sorted(counts.items())) + ("" if elsewhere else " (no other host can be had here)"))
print("%d wrong" % len(failures))
sys.exit(1 if failures else 0)
