"""Every option of every command has an effect, or is refused: python3 option_effects_test.py RAYCONE MESH_DIRECTORY

A table of command lines, with what the last option of each does: it changes the result, it is a usage error, or it is
harmless by design (it says how to run, or what must not happen). An option that --help lists must be in the table for
that command, so that a new option cannot be forgotten.
"""

import collections
import csv
import io
import json
import os
import re
import shutil
import struct
import subprocess
import unittest
import zipfile

from command_case import RAYCONE, enter_empty_folder, mesh, read, write

TIMES = re.compile(r" in [0-9.]+ s( \([^)]*\))?|, [^,;\n]*samples/s", re.M)

Row = collections.namedtuple("Row", "words option verdict status", defaults=[0])
CHANGES, REFUSED, HARMLESS = "changes the result", "is refused", "is harmless"
OUTPUT = "changes the output"  # not only reports, tables and messages, which name the lattice in any case

BARE = "lattice cubes.obj -o out/a.csv --report out/report.json"
LATTICE = BARE + " --resolution 5"
FILE = "lattice cubes.obj --report out/report.json --resolution 5 -o out/a."
POINTS = "points cubes.obj points.csv -o out/a.csv --report out/report.json"
SAMPLE = "points cubes.obj -o out/a.npz --report out/report.json --sample uniform=5"
NEAR = "points cubes.obj -o out/a.npz --sample near=5:0.1"
SLICE = "slice cubes.obj -o out/a.png --size 8 --report out/report.json"
SURFACE = "surface cubes.obj -o out/a.ply --resolution 5 --report out/report.json"
CONTOUR = "surface open.obj -o out/a.ply --padding .5 --rule abs=.2"  # of samples; cubes.obj is its own surface
INFO = "info cubes.obj"
BARE_BATCH = "batch good --out-dir out/batch --format csv --jobs 1"  # each worker takes time to start
BATCH = BARE_BATCH + " --resolution 5"
VDB_BATCH = "batch good --out-dir out/batch --resolution 5 --jobs 1"

# Options that say how to run, or what must not happen; no value depends on them.
RUN = ["--threads 1", "--memory-limit 4G", "--timeout 1000", "--progress never", "--quiet", "--strict"]

TABLE = [
    # --- Meshes
    *(Row(words.replace("cubes.obj", "nameless"), "--mesh-format obj", CHANGES)
      for words in (LATTICE, POINTS, SLICE, SURFACE, INFO)),
    Row("batch nameless --out-dir out/batch --resolution 4 --format csv", "--mesh-format obj", CHANGES),
    *(Row(words.replace("cubes.obj", "seam.obj"), "--weld none", CHANGES)
      for words in (LATTICE, POINTS, SLICE, SURFACE, INFO)),
    Row("batch seam.obj --out-dir out/batch --resolution 4 --format csv", "--weld none", CHANGES),
    *(Row(words, option, CHANGES)
      for words in (LATTICE, POINTS, SLICE, SURFACE, INFO, BATCH) for option in ("--scale 2", "--up y-to-z")),
    *(Row(words, "--normalize sphere:3", CHANGES) for words in (LATTICE, POINTS, SLICE, SURFACE, INFO, BATCH, SAMPLE)),
    Row(SLICE + " --normal 1,1,0", "--up 1,0,0", CHANGES),
    Row(SLICE, "--up 1,0,0", REFUSED),
    *(Row(words, "--orient flip", CHANGES) for words in (LATTICE, POINTS, INFO, BATCH, SLICE)),
    Row(SURFACE, "--orient flip", CHANGES, 2),  # nothing is inside then
    # --- Lattices
    *(Row(words, option, OUTPUT)
      for words in (LATTICE, BATCH)
      for option in ("--bounds 0,0,0,2,2,2", "--padding .5", "--padding 5%", "--resolution 6", "--centers")),
    *(Row(words, option, OUTPUT)
      for words in (BARE, BARE_BATCH)
      for option in ("--voxel-size .25", "--like grid.vdb", "--like grid.npz", "--like grid.nrrd",
                     "--like grid.nii.gz")),
    *(Row(LATTICE, option, REFUSED) for option in ("--voxel-size .25", "--like grid.vdb")),
    *(Row(BARE + " --like grid.vdb", option, REFUSED)
      for option in ("--bounds 0,0,0,2,2,2", "--padding .5", "--resolution 5", "--voxel-size 1", "--centers")),
    *(Row("batch good --out-dir out/batch --sample uniform=3", option, REFUSED)
      for option in ("--resolution 5", "--voxel-size 1", "--like grid.vdb", "--centers")),
    # --- Fields
    *(Row(words, "--field inside", CHANGES) for words in (LATTICE, POINTS, SAMPLE, BATCH, "slice cubes.obj -o out/a.png --size 8")),
    *(Row(words, "--field gradient", CHANGES) for words in (LATTICE, POINTS, SAMPLE, BATCH, FILE + "npy")),
    *(Row(words, "--field solid", CHANGES) for words in (LATTICE, BATCH, FILE + "nrrd")),
    *(Row(words, "--field solid", REFUSED)
      for words in (POINTS, SAMPLE, "slice cubes.obj -o out/a.png", "batch good --out-dir out/batch --sample uniform=3")),
    *(Row(FILE + name, "--field gradient", REFUSED) for name in ("nrrd", "nii", "nii.gz")),
    *(Row(words + " --field gradient", "--rule odd", REFUSED) for words in (LATTICE, POINTS, BATCH)),
    *(Row(words + " --field inside", "--rule odd", CHANGES) for words in (LATTICE, POINTS, SAMPLE, BATCH, SLICE)),
    *(Row(words + " --field sdf", "--rule odd", CHANGES) for words in (LATTICE, POINTS, SAMPLE, BATCH)),
    *(Row(words + " --field solid", "--rule odd", CHANGES) for words in (LATTICE, BATCH)),
    Row(SAMPLE, "--rule odd", CHANGES),  # whose fields are winding, inside and sdf
    *(Row(words + fields, "--rule odd", REFUSED)
      for words in (LATTICE, POINTS, BATCH)
      for fields in ("", " --field winding", " --field density", " --field winding,density")),
    Row(SAMPLE + " --field winding", "--rule odd", REFUSED),
    Row("batch good --out-dir out/batch --sample uniform=3 --field density", "--rule odd", REFUSED),
    *(Row(words + fields, "--band 2", CHANGES)
      for words in (LATTICE, BATCH) for fields in (" --field sdf", " --field winding,sdf", " --field solid")),
    *(Row(words + " --field " + field, "--band all", CHANGES) for words in (LATTICE, BATCH) for field in ("sdf", "solid")),
    *(Row(words + fields, "--band 2", REFUSED)
      for words in (LATTICE, BATCH) for fields in ("", " --field inside", " --field winding,density")),
    *(Row(words + " --field sdf", "--band 2", REFUSED)
      for words in (POINTS, SAMPLE, "batch good --out-dir out/batch --sample uniform=3")),
    Row(SLICE + " --field sdf", "--band 2", REFUSED),
    *(Row(words, "--field label", CHANGES) for words in (LATTICE, POINTS, SAMPLE, FILE + "nii.gz")),
    Row(BATCH + " --parts group", "--field label", CHANGES),
    Row(BATCH, "--field label", REFUSED),
    *(Row(words + " --field label --parts group", "--rule abs=2", CHANGES)
      for words in (LATTICE, POINTS, SAMPLE, BATCH)),
    *(Row(words + " --field label", "--parts component", CHANGES)
      for words in (LATTICE, POINTS, SAMPLE, "slice cubes.obj -o out/a.png --size 8")),
    Row(BATCH + " --field label --parts group", "--parts component", CHANGES),
    *(Row(words + " --field label --parts component", "--priority", CHANGES)
      for words in (LATTICE, POINTS, SAMPLE, BATCH, "slice cubes.obj -o out/a.png --size 8")),
    *(Row(words, option, REFUSED)
      for words in (LATTICE, POINTS, SAMPLE, BATCH, SLICE) for option in ("--parts component", "--priority")),
    *(Row(words + " --field label --parts component", "--diagnostics", REFUSED)
      for words in (LATTICE, POINTS, SAMPLE, BATCH)),
    *(Row(words, "--diagnostics", CHANGES) for words in (LATTICE, POINTS, SAMPLE, BATCH)),
    Row(FILE + "npy", "--diagnostics", REFUSED),
    *(Row(words, "--verify 5", CHANGES) for words in (LATTICE, POINTS, SAMPLE)),
    Row(BATCH, "--verify 5", HARMLESS),  # a wrong value fails its mesh
    *(Row(words, option, HARMLESS)
      for words in (LATTICE, POINTS, SAMPLE, BATCH) for option in ("--engine embree", "--simd sse4")),
    *(Row(words, option, HARMLESS)  # of a closed mesh
      for option in ("--tolerance 0", "--tolerance 1e-3") for words in (LATTICE, POINTS, SLICE, SAMPLE, BATCH)),
    # --- Points
    Row(POINTS, "--columns 3,2,1", CHANGES),
    Row(POINTS.replace("points.csv", "points.npy"), "--columns 3,2,1", REFUSED),
    Row(POINTS.replace("points.csv", "points.ply"), "--columns 3,2,1", REFUSED),
    Row(SAMPLE, "--columns 3,2,1", REFUSED),
    Row("points cubes.obj points.raw -o out/a.raw --format csv", "--raw f64", REFUSED),
    Row("points cubes.obj points.raw -o out/a.raw --columns 3,2,1", "--raw f64", REFUSED),
    Row("points cubes.obj points.raw -o out/a.raw", "--raw f64", CHANGES),
    Row("points cubes.obj -o out/a.npz", "--sample uniform=5", CHANGES),
    Row("points cubes.obj -o out/a.npz", "--sample surface=1e1", CHANGES),
    Row("batch good --out-dir out/batch", "--sample uniform=5", CHANGES),
    *(Row(words, option, CHANGES)
      for words in (SAMPLE, "batch good --out-dir out/batch --sample uniform=5")
      for option in ("--seed 2", "--bounds 0,0,0,2,2,2", "--padding .5")),
    *(Row(POINTS, option, REFUSED) for option in ("--seed 2", "--bounds 0,0,0,2,2,2", "--padding .5")),
    *(Row(words, option, REFUSED)
      for words in (NEAR, "batch good --out-dir out/batch --sample near=5:0.1")
      for option in ("--bounds 0,0,0,2,2,2", "--padding .5")),
    Row(NEAR, "--seed 2", CHANGES),
    Row(BATCH, "--seed 2", REFUSED),
    # --- Slices
    Row(SLICE.replace("cubes.obj", "open.obj"), "--axis x", OUTPUT),  # cubes.obj looks the same along all axes
    *(Row(SLICE, option, OUTPUT)
      for option in ("--at 10%", "--normal 1,1,0", "--bounds 0,0,0,2,2,2", "--padding .5", "--size 9",
                     "--values out/v.npy")),
    Row("slice cubes.obj -o out/a.png --size 400", "--no-legend", CHANGES),
    Row(SLICE + " --normal 1,1,0", "--origin .1,.1,.1", CHANGES),
    Row(SLICE, "--origin .1,.1,.1", REFUSED),
    Row(SLICE + " --normal 1,1,0", "--axis x", REFUSED),
    Row(SLICE + " --normal 1,1,0", "--at 10%", REFUSED),
    # --- Surfaces
    *(Row(CONTOUR + " --resolution 9", option, OUTPUT)
      for option in ("--bounds -1,-1,-1,2,2,2", "--padding .75", "--padding 8v", "--resolution 6", "--centers",
                     "--rule abs=.15", "--simplify none", "--simplify .1", "--thicken .1")),
    *(Row(SURFACE, option, OUTPUT) for option in ("--rule odd", "--simplify none", "--thicken .1")),
    *(Row(words, "--simplify 0", HARMLESS) for words in (SURFACE, CONTOUR + " --resolution 9")),  # the default
    Row(SURFACE, "--voxel-size .25", REFUSED),
    Row(SURFACE, "--like grid.vdb", REFUSED),
    Row(CONTOUR, "--voxel-size .25", OUTPUT),
    Row(CONTOUR.replace(" --padding .5", ""), "--like around.vdb", OUTPUT),  # else its box is too small
    # --- Output
    *(Row(re.sub("-o out/a.... ", "", words), "-o out/b" + end, CHANGES)
      for words, end in ((LATTICE, ".csv"), (POINTS, ".csv"), (SAMPLE, ".npz"), (SLICE, ".png"),
                         (SURFACE, ".stl"))),
    *(Row(words, twice, REFUSED)
      for words in (LATTICE, POINTS, SLICE, SURFACE)
      for twice in ("-o out/b.csv", "--output out/b.csv", "--output=out/a.csv")),
    *(Row(words + " --field winding", "--field inside", REFUSED) for words in (LATTICE, POINTS, SAMPLE, BATCH)),
    *(Row(LATTICE, "--format " + name, CHANGES) for name in ("vdb", "npy", "npz", "vti", "nrrd", "nii", "nii.gz")),
    Row(LATTICE, "--format csv", HARMLESS),
    Row(POINTS, "--format npy", CHANGES),
    Row("slice cubes.obj -o out/a --size 8", "--format png", CHANGES),
    *(Row(SURFACE, "--format " + name, CHANGES) for name in ("stl", "obj", "off")),
    *(Row(words.replace("out/a", "old"), "--no-clobber", CHANGES, 3) for words in (LATTICE, POINTS, SLICE, SURFACE)),
    Row("lattice cubes.obj -o - --resolution 2", "--no-clobber", HARMLESS),
    Row(BATCH, "--no-clobber", HARMLESS),
    Row("info cubes.obj", "--no-clobber", REFUSED),
    Row("report done -o old.ply", "--no-clobber", CHANGES, 3),
    Row("info open.obj --mark old.ply", "--no-clobber", CHANGES, 3),
    *(Row(words, option, CHANGES)
      for words in (LATTICE, POINTS, SLICE, SURFACE) for option in ("--report out/r.json", "--depfile out/a.d")),
    *(Row(words, "--depfile out/a.d", REFUSED)
      for words in ("lattice cubes.obj -o - --resolution 2", "points cubes.obj points.csv",
                    "slice cubes.obj -o - --size 8", "surface cubes.obj -o - --resolution 5")),
    *(Row(FILE + end, "--double", CHANGES) for end in ("vdb", "npy", "npz", "vti")),
    *(Row(FILE + end, "--dtype f64", CHANGES) for end in ("vdb", "npy", "npz", "vti")),
    *(Row(FILE + end, "--dtype f16", CHANGES) for end in ("vdb", "npy", "npz")),
    *(Row(FILE + end, "--dtype f16", REFUSED) for end in ("vti", "nrrd", "nii", "nii.gz")),
    *(Row(FILE + end, "--dtype f64", CHANGES) for end in ("nrrd", "nii", "nii.gz")),
    *(Row(words, "--compress", CHANGES) for words in (FILE + "nrrd", BATCH + " --format nrrd")),
    *(Row(words, "--compress", REFUSED)
      for words in (FILE + "vdb", FILE + "nii", FILE + "nii.gz", VDB_BATCH, VDB_BATCH + " --format none")),
    *(Row(FILE + end, "--diagnostics", REFUSED) for end in ("nrrd", "nii")),
    *(Row(words, "--dtype f32", CHANGES)
      for words in (SAMPLE, SAMPLE + " --field inside", POINTS + " --format npy", "batch good --out-dir out/batch --sample uniform=3")),
    *(Row(words, "--dtype f64", REFUSED)
      for words in (FILE + "csv", POINTS, FILE + "npz --field inside", FILE + "npz --double",
                    "points cubes.obj points.raw -o out/a.raw --raw f64", BATCH + " --format none")),
    *(Row(words, "--pack-bits", CHANGES)
      for words in (SAMPLE, FILE + "npz --field inside,winding", BATCH + " --format npz --field inside",
                    POINTS + " --format npz --field inside")),
    *(Row(words, "--pack-bits", REFUSED)
      for words in (FILE + "npz", FILE + "npy --field inside", POINTS + " --field inside",
                    VDB_BATCH + " --field inside", BATCH + " --format none")),
    Row(FILE + "csv", "--double", REFUSED),
    Row(BATCH + " --format csv", "--double", REFUSED),
    *(Row(FILE + end + " --field inside", "--double", REFUSED) for end in ("vdb", "npy", "vti")),
    Row(FILE + "vdb --field inside,density", "--double", CHANGES),
    Row(FILE + "vdb", "--half", CHANGES),
    *(Row(FILE + end, "--half", REFUSED) for end in ("csv", "npy", "vti")),
    Row(FILE + "vdb --field inside", "--half", REFUSED),
    Row(FILE + "vdb --double", "--half", REFUSED),
    Row(FILE + "vdb", "--grid-name w", CHANGES),
    Row(FILE + "vdb --field inside", "--grid-name mask", CHANGES),
    *(Row(FILE + end, "--grid-name w", REFUSED) for end in ("csv", "npy", "vti")),
    Row(FILE + "vdb --field winding,inside", "--grid-name w", REFUSED),
    *(Row(VDB_BATCH, option, CHANGES)
      for option in ("--double", "--half", "--grid-name w", "--format csv", "--format none")),
    *(Row(BATCH + " --format none", option, REFUSED)
      for option in ("--double", "--half", "--grid-name w", "--full-names")),
    # --- info
    Row(INFO, "--json", CHANGES),
    Row(INFO, "--csv", CHANGES),
    Row("info open.obj", "--require closed", CHANGES, 2),
    Row(INFO + " --json", "--intersections", CHANGES),
    Row("info open.obj", "--mark out/mark.ply", CHANGES),
    # --- batch
    Row("batch good --resolution 4 --format csv", "--out-dir out/other", CHANGES),
    Row(BATCH, "--full-names", CHANGES),
    Row("batch @null.txt --out-dir out/batch --resolution 4 --format csv", "--null", CHANGES),
    Row(BATCH, "--null", REFUSED),
    Row(BATCH, "-0", REFUSED),
    Row(BATCH, "--shard 1/2", CHANGES),
    Row(BATCH, "--dry-run", CHANGES),
    Row(BATCH.replace("good", "all"), "--fail-fast", CHANGES, 5),
    Row(BATCH + " --keep-going", "--fail-fast", REFUSED),
    Row(BATCH.replace("good", "all"), "--exit-zero", CHANGES),
    *(Row(BATCH, option, HARMLESS)  # the first run of a batch has neither failures nor rows to drop
      for option in ("--keep-going", "--retry-failed", "--prune")),
    Row(BATCH.replace(" --jobs 1", ""), "--jobs 1", HARMLESS),
    # --- report
    Row("report done", "-o out/page.html", CHANGES),
    Row("report done -o out/page.html", "--output out/other.html", REFUSED),
    *(Row("report done -o out/page.html", option, HARMLESS)
      for option in ("--threads 1", "--memory-limit 4G", "--timeout 1000", "--quiet")),
    *(Row("report done", option, REFUSED) for option in ("--progress never", "--strict")),
    # --- All of them
    *(Row(words, " ".join(RUN), HARMLESS) for words in (LATTICE, POINTS, SAMPLE, SLICE, SURFACE, INFO, BATCH)),
    *(Row(words.replace("cubes.obj", "short.obj"), "--strict", CHANGES, 2)
      for words in (LATTICE, POINTS, SLICE, SURFACE, INFO)),
]


def run(words):
    return subprocess.run([RAYCONE, *words.split()], stdin=subprocess.DEVNULL, capture_output=True, timeout=300)


def options_in_help(command):
    """As tuples of names: ("-o", "--output")."""
    lists = re.findall(r"^  (-[-\w,]+)(?: |$)", run(command + " --help").stdout.decode(), re.M)
    return [tuple(names.split(",")) for names in lists]


def commands_in_help():
    text = run("--help").stdout.decode()
    return re.findall(r"^  (\w+) ", text[text.index("Commands:") : text.index("Examples:")], re.M)


OPTIONS = {command: options_in_help(command) for command in commands_in_help()}


def without_metadata(content):
    """VDB: names and types of grids, and what follows each transform. Metadata has the options, whether or not these
    have an effect."""
    kinds = re.findall(rb"([ -~]+.{4}Tree_\w+)", content, re.S)
    grids = [content[match.start() :] for match in re.finditer(rb"[A-Za-z]+Map", content)]
    return kinds, [grid.split(b"raycone_")[0] for grid in grids]


def without_text(content):
    """PNG: its chunks but those that say in words what is shown."""
    chunks, place = [], 8
    while place < len(content):
        end = place + 12 + struct.unpack_from(">I", content, place)[0]
        if content[place + 4 : place + 8] != b"iTXt":
            chunks.append(content[place:end])
        place = end
    return chunks


def without_times(name, content):
    if name.startswith("results") and name.endswith(".csv"):
        rows = csv.DictReader(content.decode().splitlines())
        return [{key: value for key, value in row.items() if not key.endswith(("_s", "_bytes"))} for row in rows]
    if name.endswith(".vdb"):
        return without_metadata(content)
    if name.endswith(".png"):
        return without_text(content)
    if name.endswith(".npz"):
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return {member: archive.read(member) for member in archive.namelist() if member != "raycone.npy"}
    if name.endswith(".json"):
        report = json.loads(content)
        return {key: value for key, value in report.items() if key not in ("command", "options", "seconds", "peak_memory_bytes", "threads")}
    return content


def written():
    """What is in the directory out, but for times."""
    result = {}
    for top, _, names in os.walk("out"):
        for name in names:
            if name.startswith("batch-state"):
                continue
            path = os.path.join(top, name)
            result[path] = without_times(name, read(path))
    return result


def outputs_of(files):
    return {path: content for path, content in files.items() if not path.endswith((".json", "results.csv"))}


def clear():
    shutil.rmtree("out", ignore_errors=True)
    os.mkdir("out")


def result_of(words):
    """Status, standard output, messages and files."""
    clear()
    done = run(words)
    messages = TIMES.sub("", done.stderr.decode())
    return done.returncode, done.stdout, messages, written()


class OptionEffects(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        enter_empty_folder(cls.addClassCleanup)
        cubes = read(mesh("overlapping_cubes")).decode()
        corners = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        seam = "".join("v %s\n" % corners[i] for face in faces for i in face)
        seam += "".join("f %d %d %d\n" % (3 * n + 1, 3 * n + 2, 3 * n + 3) for n in range(4))
        texts = {
            "cubes.obj": cubes,
            "nameless": cubes,
            "good/a.obj": cubes,
            "good/b.obj": seam,
            "all/a.obj": "not a mesh",
            "all/b.obj": cubes,
            "seam.obj": seam,
            "short.obj": cubes + "f 1 2\n",
            "open.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "points.csv": ".1,.2,.3\n1.3,1.4,1.5\n2.1,2.2,2.9\n",
            "points.ply": "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                          "property float z\nend_header\n0 0 0\n",
            "null.txt": "good/a.obj\0good/b.obj\0",
            "old.csv": "", "old.png": "", "old.npz": "", "old.ply": "",
        }
        for name, text in texts.items():
            os.makedirs(os.path.dirname(name) or ".", exist_ok=True)
            write(name, text)
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }"
        header += b" " * (117 - len(header)) + b"\n"
        raw = struct.pack("<3d", 0.1, 0.2, 0.3)
        npy = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + raw
        for name, content in {"points.npy": npy, "points.raw": raw}.items():
            write(name, content)
        for words in ("lattice cubes.obj -o grid.vdb --resolution 3", "lattice cubes.obj -o grid.npz --resolution 3",
                      "lattice open.obj -o around.vdb --resolution 5 --padding .5",
                      "lattice cubes.obj -o grid.nrrd --resolution 3", "lattice cubes.obj -o grid.nii.gz --resolution 3",
                      "batch good --out-dir done --resolution 4 --format csv"):
            assert run(words).returncode == 0, words
        cls.baselines = {}

    def without(self, words):
        if words not in self.baselines:
            self.baselines[words] = result_of(words)
        return self.baselines[words]

    def check(self, row):
        line = row.words + " " + row.option
        status, output, messages, files = result_of(line)
        self.assertEqual(status, 1 if row.verdict == REFUSED else row.status, line + messages)
        if row.verdict == REFUSED:
            self.assertEqual(messages.count("\n"), 1, line + messages)
            self.assertEqual(files, {}, line)
            name = re.split("[ =]", row.option)[0]
            self.assertIn({"-0": "--null", "-o": "--output"}.get(name, name), messages)
        elif row.verdict == HARMLESS:
            expected, _, _, others = self.without(row.words)
            self.assertTrue((status, files) == (expected, others), line + " is not harmless: " + messages)
        elif row.verdict == OUTPUT:
            self.assertNotEqual(outputs_of(files), outputs_of(self.without(row.words)[3]), line)
        else:
            changed = (status, output, messages, files) != self.without(row.words)
            self.assertTrue(changed, line + " changes nothing: " + messages)

    def test_each_option_changes_the_result_or_is_refused(self):
        for row in TABLE:
            with self.subTest(row.words + " " + row.option):
                self.check(row)

    def test_the_table_has_all_options(self):
        listed = {(row.words.split()[0], word) for row in TABLE if row.verdict != REFUSED for word in row.option.split()}
        for command, options in OPTIONS.items():
            for names in options:
                if "--help" in names:
                    continue
                self.assertTrue(any((command, name) in listed for name in names), "%s %s" % (command, names))


if __name__ == "__main__":
    unittest.main()
