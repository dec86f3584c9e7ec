"""Files that are input and output at once: python3 same_file_test.py RAYCONE MESH_DIRECTORY.

Every option that names an output is given the name of every file that the command reads, as that name and a hard link, -o
also as other spellings and a symbolic link, and likewise the name of every other output. Status 1, one line, and not a
byte changed.
"""

import itertools
import os
import struct
import subprocess
import sys
import tempfile

RAYCONE, MESHES = (os.path.abspath(path) for path in sys.argv[1:3])
failures, refused = [], 0

GLTF = b"""{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"scene.bin","byteLength":36}]}"""

# The arguments, the files read, the options that name outputs.
COMMANDS = [
    (["lattice", "scene.gltf", "--resolution", "4", "--format", "csv"], ["scene.gltf", "scene.bin"], ["-o", "--report", "--depfile"]),
    (["lattice", "cube.obj", "--like", "grid.vdb", "--format", "csv"], ["cube.obj", "grid.vdb"], ["-o", "--report", "--depfile"]),
    (["points", "scene.gltf", "points.csv", "--format", "csv"], ["scene.gltf", "scene.bin", "points.csv"], ["-o", "--report", "--depfile"]),
    (["points", "cube.obj", "-", "--format", "csv", "< points.csv"], ["points.csv"], ["-o", "--report", "--depfile"]),
    (["lattice", "-", "--mesh-format", "obj", "--resolution", "4", "--format", "csv", "< cube.obj"], ["cube.obj"], ["-o", "--report"]),
    (["slice", "scene.gltf", "--size", "16"], ["scene.gltf", "scene.bin"], ["-o", "--report", "--depfile", "--values"]),
    (["report", "out"], ["out/results.csv", "out/batch-state.csv"], ["-o"]),
]


def write(path, content):
    with open(path, "wb") as file:
        file.write(content)


def contents(path):
    with open(path, "rb") as file:
        return file.read()


def make_inputs():
    write("scene.gltf", GLTF)
    write("scene.bin", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
    write("cube.obj", contents(os.path.join(MESHES, "cube.obj")))
    write("points.csv", b"0,0,0\n1,1,1\n")
    run(["lattice", "cube.obj", "--resolution", "4", "-o", "grid.vdb"], 0)
    run(["batch", "cube.obj", "--resolution", "4", "--out-dir", "out"], 0)
    os.mkdir("elsewhere")


def run(words, expected, append=None):
    stdin = open(words[-1][2:], "rb") if words[-1].startswith("< ") else subprocess.DEVNULL
    arguments = words[:-1] if words[-1].startswith("< ") else words
    stdout = open(append, "ab") if append else subprocess.DEVNULL
    result = subprocess.run([RAYCONE, *arguments], stdin=stdin, stdout=stdout, stderr=subprocess.PIPE, timeout=100)
    if result.returncode != expected or (expected and result.stderr.count(b"\n") != 1):
        failures.append("%s >> %s: status %d: %s" % (" ".join(words), append, result.returncode, result.stderr.decode()[:200]))


def snapshot():
    paths = [os.path.join(top, name) for top, _, names in os.walk(".") for name in names]
    return {path: contents(path) if os.path.exists(path) else b"" for path in paths}


# Refused, and nothing changed, also no file added.
def expect_refusal(words, append=None):
    global refused
    before = snapshot()
    run(words, 1, append)
    refused += 1
    after = snapshot()
    if after != before:
        failures.append("%s changed %s" % (" ".join(words), [name for name in before.keys() | after.keys() if before.get(name) != after.get(name)]))
        for name in before.keys() | after.keys():
            if name not in before:
                os.unlink(name)
            elif before[name] != after.get(name):
                write(name, before[name])


# The words with a file for each option: the options of `chosen` by it, others new.
def words_with(arguments, options, chosen):
    files = {option: chosen.get(option, "new%d" % n) for n, option in enumerate(options) if option == "-o" or option in chosen}
    given = [word for option, file in files.items() for word in (option, file)]
    cut = len(arguments) - 1 if arguments[-1].startswith("< ") else len(arguments)
    return arguments[:cut] + given + arguments[cut:]


# All options are compared by the same code, so that one of them may have most of the spellings.
def names_of(path, option):
    yield path
    os.link(path, "hard")
    yield "hard"
    os.unlink("hard")
    if option != "-o":
        return
    yield os.path.join("elsewhere", "..", path)
    yield os.path.abspath(path)
    os.symlink(os.path.abspath(path), "link")
    yield "link"
    os.unlink("link")


def expect_inputs_kept():
    for arguments, inputs, options in COMMANDS:
        for path, option in itertools.product(inputs, options):
            for name in names_of(path, option):
                expect_refusal(words_with(arguments, options, {option: name}))


def expect_outputs_apart():
    for arguments, _, options in COMMANDS:
        for one, other in itertools.combinations(options, 2):
            for first, second in [("same", "same"), ("same", "elsewhere/../same"), ("Same", "sAME")]:
                expect_refusal(words_with(arguments, options, {one: first, other: second}))
    os.symlink("same", "dangling")
    expect_refusal(["lattice", "cube.obj", "--resolution", "4", "--format", "csv", "-o", "same", "--report", "dangling"])
    os.unlink("dangling")


def expect_standard_output_apart():
    expect_refusal(["points", "cube.obj", "-", "< points.csv"], append="points.csv")
    expect_refusal(["points", "cube.obj", "points.csv"], append="points.csv")
    expect_refusal(["lattice", "cube.obj", "--resolution", "4", "-o", "-"], append="cube.obj")
    expect_refusal(["info", "cube.obj"], append="cube.obj")
    expect_refusal(["report", "out", "-o", "-"], append="out/results.csv")


def expect_batches_kept():
    mesh = contents("cube.obj")
    os.makedirs("in/below")
    for name in ("in/a.obj", "in/below/b.obj"):
        write(name, mesh)
    run(["lattice", "cube.obj", "--resolution", "4", "-o", "in/a.vdb"], 0)
    batch = ["batch", "in", "--out-dir", "in", "--resolution", "4"]
    expect_refusal(["batch", "in", "--out-dir", "in", "--like", "in/a.vdb"])
    write("in/a.csv", b"in/a.obj\nin/below/b.obj\n")
    expect_refusal(["batch", "@in/a.csv", "--out-dir", "in", "--format", "csv", "--resolution", "4"])
    expect_refusal(["batch", "@-", "--out-dir", "in", "--format", "csv", "--resolution", "4", "< in/a.csv"])
    write("in/mesh.csv", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")  # known by its content
    expect_refusal(["batch", "in/mesh.csv", "--out-dir", "in", "--format", "csv", "--resolution", "4"])
    os.symlink(os.path.abspath("in/below/b.obj"), "in/a.npy")
    expect_refusal([*batch, "--format", "npy"])
    os.unlink("in/a.npy")
    # Two outputs that links lead to one place: the directory `below` is the one above it.
    os.makedirs("apart")
    os.symlink(".", "apart/below")
    write("in/b.obj", mesh)
    expect_refusal(["batch", "in", "--out-dir", "apart", "--resolution", "4"])
    # Results of shards that are yet to come.
    expect_refusal(["report", "out", "-o", "out/results-3-of-8.csv"])
    expect_refusal(["report", "out", "-o", "elsewhere/../out/batch-state-3-of-8.csv"])
    # Controls: the same without the link, and outputs that are links of each other from outside.
    os.unlink("apart/below")
    run(["batch", "in", "--out-dir", "apart", "--resolution", "4"], 0)
    os.unlink("apart/b.vdb")
    os.link("apart/a.vdb", "apart/b.vdb")
    run(["batch", "in", "--out-dir", "apart", "--resolution", "4", "--scale", "2"], 0)
    run(["report", "out", "-o", "out/page.html"], 0)


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    make_inputs()
    expect_inputs_kept()
    expect_outputs_apart()
    expect_standard_output_apart()
    expect_batches_kept()
    os.chdir("/")
for failure in failures:
    print(failure)
print("%d command lines refused, %d wrong" % (refused, len(failures)))
sys.exit(1 if failures else 0)
