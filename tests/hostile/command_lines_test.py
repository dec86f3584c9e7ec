"""Random command lines: python3 command_lines_test.py RAYCONE MESH_DIRECTORY [--long] [--seed N]

Options in any combination, with numbers of all magnitudes. Every run ends with a documented status, none of them 6 (which
is also --verify's for a wrong value), says what is wrong in one line and leaves nothing else behind; a run that succeeds
gives the same bytes with another number of threads, engine and instruction set. --long: 3000 command lines in place of 80.
"""

import collections
import os
import random
import subprocess
import sys
import tempfile

from runs import MESHES, RAYCONE, contents, fail, report

RUNS = 3000 if "--long" in sys.argv else 80
SEED = int(sys.argv[sys.argv.index("--seed") + 1]) if "--seed" in sys.argv else 1
LIMITS = ["--memory-limit", "1G", "--timeout", "60"]
chance = random.Random(SEED)
choose = chance.choice
seen = collections.Counter()


# --- Values of options

# The range of floats. Samples farther than 1e120 times the mesh's size are evaluated in 113 bits, which takes minutes.
def number():
    kind = chance.random()
    if kind < 0.3:
        return choose(["0", "1", "-1", "2", "0.5", "3", "10"])
    if kind < 0.6:
        return repr(chance.uniform(-3, 3))
    return "%s%de%d" % (choose(["", "-"]), chance.randint(1, 9), choose([-45, -38, -20, -10, -3, -1, 0, 1, 3, 10, 20, 38]))


def magnitude():
    return number().lstrip("-")


def numbers(count):
    return ",".join(number() for _ in range(count))


def spacing():
    return choose(["0.5", "1,0.7,2", "1e38", "1e-38", magnitude() + ",1,1"])


def box():
    lower = [float(number()) for _ in range(3)]
    sides = [float(magnitude()) for _ in range(3)] if chance.random() < 0.5 else [float(magnitude())] * 3
    return ",".join(map(repr, lower + [a + b for a, b in zip(lower, sides)]))


def one_of(*values):
    return lambda: choose([value() if callable(value) else value for value in values])


def with_number(text):
    return lambda: text % number()


def with_magnitude(text):
    return lambda: text % magnitude()


def fields(*names):
    return lambda: ",".join(chance.sample(names, choose([1, 1, 2, len(names)])))


# Of each option what makes its value, or None where it takes none.
MESH = {"--weld": one_of("exact", "none", magnitude), "--scale": number, "--up": one_of("y-to-z"),
        "--orient": one_of("keep", "flip", "auto"), "--normalize": one_of("cube", "sphere", with_magnitude("cube:%s"))}
EVALUATION = {
    "--field": fields("winding", "inside", "density", "sdf", "gradient", "label"),
    "--parts": one_of("group", "component", "file"),
    "--priority": None,
    "--rule": one_of("nonzero", "positive", "odd", with_number("threshold=%s"), with_number("abs=%s")),
    "--tolerance": one_of("0", "1e-3", magnitude),
    "--diagnostics": None,
    "--verify": one_of("8"),
    "--dtype": one_of("f16", "f32", "f64"),
    "--pack-bits": None,
}
LATTICE = {"--bounds": box, "--padding": one_of(number, "2v", "-1v", with_number("%sv")), "--centers": None}
# Those that must not change a value.
EFFORT = {"--threads": one_of("1", "2", "3", "17"), "--engine": one_of("auto", "scan", "embree"), "--simd": one_of("auto", "sse4")}
OPTIONS = {
    "lattice": {
        **MESH,
        **EVALUATION,
        **LATTICE,
        "--field": fields("winding", "inside", "density", "sdf", "solid", "gradient", "label"),
        "--band": one_of("1", "3", "0.5", "all", magnitude),
        "--compress": None,
        "--double": None,
        "--half": None,
    },
    "points": {**MESH, **EVALUATION},
    "points of a sample": {
        **MESH,
        **EVALUATION,
        "--bounds": box,
        "--padding": number,
        "--seed": one_of("1", "2", "9223372036854775807"),
    },
    "slice": {
        **MESH,
        "--bounds": box,
        "--padding": one_of(number, "2v"),
        "--axis": one_of("x", "y", "z"),
        "--at": one_of(number, "0%", "100%", with_number("%s%%")),
        "--normal": lambda: numbers(3),
        "--origin": lambda: numbers(3),
        "--no-legend": None,
        "--field": one_of("winding", "inside", "sdf", "label"),
        "--parts": one_of("group", "component"),
        "--rule": one_of("odd", "abs=0.5"),
        "--tolerance": one_of("0", magnitude),
    },
    "surface": {
        **MESH,
        **LATTICE,
        "--rule": EVALUATION["--rule"],
        "--thicken": one_of("0.1", magnitude),
        "--simplify": one_of("0", "none", "0.01", magnitude),
    },
}

def samples():
    return choose([["--resolution", choose(["1", "2", "8", "16", "1,1,1", "2,3,4", "1,7,1"])], ["--voxel-size", spacing()]])


def draw():
    return choose(["uniform=50", "surface=50", "near=50:" + magnitude(), "uniform=10,surface=5,near=10:0.1"])


ALWAYS = {
    "lattice": samples,
    "points": lambda: ["points.csv"],
    "points of a sample": lambda: ["--sample", draw()],
    "slice": lambda: ["--size", choose(["64", "70", "330"])],
    "surface": samples,
}
OUTPUTS = {
    "lattice": ["out.vdb", "out.csv", "out.npy", "out.npz", "out.vti", "out.nrrd", "out.nii", "out.nii.gz"],
    "points": ["out.csv", "out.npy", "out.npz"],
    "points of a sample": ["out.csv", "out.npz"],
    "slice": ["out.png"],
    "surface": ["out.ply", "out.stl", "out.obj", "out.off"],
}


def some_of(options, count):
    words = []
    for name in chance.sample(sorted(options), min(count, len(options))):
        words.append(name if options[name] is None else name + "=" + options[name]())
    return words


# --- Runs

def run(arguments):
    before = set(os.listdir())
    process = subprocess.run([RAYCONE, *arguments, *LIMITS], stdin=subprocess.DEVNULL, capture_output=True, timeout=300)
    status, message = process.returncode, process.stderr
    left = set(os.listdir()) - before
    errors = [line for line in message.splitlines() if not line.startswith(b"raycone: warning: ")]
    told = len(errors) == 1 and errors[0].startswith(b"raycone: ")
    if status not in (0, 1, 2, 3, 4) or not told:
        fail(" ".join(arguments), status, message)
    if any(name.startswith(".") for name in left) or (status != 0 and left):
        fail("%s: left %s" % (" ".join(arguments), left), status, message)
    seen[status] += 1
    return status


def try_one(mesh, directory):
    kind = choose(list(OPTIONS))
    output = directory + choose(OUTPUTS[kind])
    arguments = [kind.split()[0], mesh, *ALWAYS[kind](), "-o", output, *some_of(OPTIONS[kind], choose([0, 1, 2, 3, 4, 6]))]
    effort = {"--threads": EFFORT["--threads"]} if kind in ("slice", "surface") else EFFORT
    first = some_of(effort, len(effort))
    second = first
    while sorted(second) == sorted(first):  # else it would be compared with itself
        second = some_of(effort, len(effort))
    statuses, results = [], []
    for words in (first, second):
        statuses.append(run([*arguments, *words]))
        if statuses[-1] != 0:
            break
        results.append(contents(output))
        os.unlink(output)
    if len(set(statuses)) > 1 or len(set(results)) > 1:
        fail(" ".join(arguments) + ": not the same again", statuses, b"")
    seen["compared"] += statuses == [0, 0]


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    with open("points.csv", "w") as points:
        points.write("0,0,0\n.1,.2,.3\n5,5,5\n1e300,0,0\n1e-300,1e-300,0\n-0.5,0.5,0.5\n")
    meshes = [os.path.join(MESHES, name) for name in sorted(os.listdir(MESHES))]
    for n in range(RUNS):
        try_one(choose(meshes), "missing/" if n % 10 == 9 else "")
    os.chdir("/")
print(", ".join("%s: %d" % (what, count) for what, count in sorted(seen.items(), key=str)))
# Else the command lines would try too little. For 3 one in ten has no directory to write to; many of these are refused.
if seen["compared"] < RUNS // 4 or seen[1] < RUNS // 15 or seen[3] + seen[4] < max(1, RUNS // 150):
    fail("too few that succeed, or that are refused, or that fail", 0, b"")
sys.exit(report())
