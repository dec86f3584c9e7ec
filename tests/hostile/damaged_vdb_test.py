"""Damaged VDB files for --like and info: python3 damaged_vdb_test.py RAYCONE MESH [RUNS]

OpenVDB crashes on some of them and allocates what others announce; raycone must end with status 0 or 2 and one line, at
once. Debian's OpenVDB is not built for libFuzzer, which would see nothing of what the bytes make it do: hence mutations at
random, from a fixed seed, of a file by raycone, whose head tells the lattice, and of one whose tree must be read.
"""

import collections
import os
import random
import resource
import subprocess
import sys
import tempfile

RAYCONE, MESH = (os.path.abspath(path) for path in sys.argv[1:3])
RUNS = int(sys.argv[3]) if len(sys.argv) > 3 else 40
MOST_WRITTEN = 2**26  # bytes; damaged files may ask for more than a disk holds, or for hours of writing
PATIENCE = 10.0  # seconds of CPU time; a run takes half a second under sanitizers
failures = []
chance = random.Random(5)


def mutated(content):
    content = bytearray(content)
    kind = chance.randrange(3)
    if kind == 0:
        return content[: chance.randrange(len(content))]
    if kind == 1:
        for _ in range(chance.randrange(1, 9)):
            content[chance.randrange(len(content))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, chance.randrange(256)])
        return content
    place = chance.randrange(len(content) - 4)
    content[place : place + 4] = chance.choice([b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0\0\0\0"])
    return content


# Of all runs so far: other programs on a busy machine do not count.
def cpu_seconds():
    times = os.times()
    return times.children_user + times.children_system


def mutated_and_read(seed, n):
    return outcome(mutated(seed), INFO if n % 3 == 0 else LIKE)


LIKE = ["lattice", MESH, "--like", "like.vdb", "-o", "out.npy", "--quiet", "--memory-limit", "1G"]
INFO = ["info", "like.vdb", "--memory-limit", "1G"]


# The name of what the run came to, for the count.
def outcome(content, arguments=LIKE):
    with open("like.vdb", "wb") as file:
        file.write(content)
    before = cpu_seconds()
    result = subprocess.run([RAYCONE, *arguments], capture_output=True, timeout=120)
    seconds = cpu_seconds() - before
    message = result.stderr.decode(errors="backslashreplace")
    # A lattice of its own that is too large, for memory or disk, is no fault of the file's.
    reasons = {3: "out.npy: cannot write: ", 4: "needs about"}
    too_large = result.returncode in reasons and reasons[result.returncode] in message
    right_status = result.returncode in (0, 2) or too_large
    if not right_status or message.count("\n") != (result.returncode != 0) or seconds > PATIENCE:
        failures.append("status %d after %.1f s: %s: %s" % (result.returncode, seconds, message[:300].strip(), content.hex()))
    if result.returncode == 0:
        return "read"
    return "crashed OpenVDB" if "crashed OpenVDB" in message else "too large" if too_large else "refused"


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_WRITTEN, MOST_WRITTEN))
    subprocess.run([RAYCONE, "lattice", MESH, "-o", "seed.vdb", "--resolution", "4", "--quiet"], check=True)
    with open("seed.vdb", "rb") as file:
        by_head = file.read()
    # Renamed: the lattice that raycone recorded, and OpenVDB's own statistics.
    by_tree = by_head.replace(b"raycone_index_min", b"raycone_index_mix").replace(b"file_bbox_min", b"file_bbox_mix")
    assert len(by_tree) == len(by_head)
    outcomes = collections.Counter()
    # A mask without bits, which aborts OpenVDB 10.
    size = b"__delayedload\x15\0\0\0"
    assert size + b"\1" in by_tree
    outcomes.update([outcome(by_tree.replace(size + b"\1", size + b"\0"))])
    for seed in (by_head, by_tree):
        assert outcome(seed) == "read", failures
        outcomes.update(mutated_and_read(seed, n) for n in range(RUNS // 2))
    os.chdir("/")
# Else the files would be damaged too little, or too much, to prove anything.
failures += ["never: " + name for name in ("read", "refused", "crashed OpenVDB") if outcomes[name] == 0]
for failure in failures:
    print(failure)
print("%s; %d wrong" % (", ".join("%d %s" % (n, name) for name, n in sorted(outcomes.items())), len(failures)))
sys.exit(1 if failures else 0)
