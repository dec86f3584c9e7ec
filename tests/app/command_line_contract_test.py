"""The command line as the contract has it: python3 command_line_contract_test.py RAYCONE MESH_DIRECTORY

What holds for all commands, what does not exist yet, what is suggested where a word is misspelt, and what is written
to a terminal.
"""

import csv
import fcntl
import gzip
import json
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import termios
import time
import unittest

from command_case import MESHES, PATIENCE, RAYCONE, enter_empty_folder, read, read_json, run_tests, write

CUBE = os.path.join(MESHES, "cube.obj")

# Command lines that work, by command.
WORKING = {
    "lattice": ["lattice", CUBE, "-o", "out.csv", "--resolution", "3"],
    "points": ["points", CUBE, "points.csv", "-o", "out.csv"],
    "slice": ["slice", CUBE, "-o", "out.png", "--size", "4"],
    "surface": ["surface", CUBE, "-o", "out.ply", "--resolution", "3"],
    "info": ["info", CUBE],
    "batch": ["batch", CUBE, "--out-dir", "batch", "--resolution", "3"],
    "report": ["report", "done"],
}

# Of a misspelt word: the command line, what is named, what is suggested (nothing: the help).
SUGGESTIONS = [
    ("lattice m.obj -o o.vdb --resolutoin 5", "unknown option --resolutoin", "--resolution"),
    ("--resolutoin 5 lattice m.obj -o o.vdb", "unknown option --resolutoin", "--resolution"),
    ("lattice m.obj -o o.vdb --Voxelsize 5", "unknown option --Voxelsize", "--voxel-size"),
    ("lattice m.obj -o o.vdb --res 5", "unknown option --res", "--resolution"),
    ("lattice m.obj --ouput o.vdb", "unknown option --ouput", "--output"),
    ("slice m.obj -o o.png --valeus o.npy", "unknown option --valeus", "--values"),
    ("info m.obj --jsno", "unknown option --jsno", "--json"),
    ("batch m --outdir o", "unknown option --outdir", "--out-dir"),
    ("batch m -o o", "unknown option -o", "--out-dir"),
    ("report o --ouptut o.html", "unknown option --ouptut", "--output"),
    ("info m.obj --resolution 5", "unknown option --resolution", None),
    ("lattice m.obj -o o.vdb --entirely-else 5", "unknown option --entirely-else", None),
    ("lattice m.obj -o o.vdb -x", "unknown option -x", None),
    ("latice m.obj -o o.vdb", "unknown command latice", "lattice"),
    ("inof m.obj", "unknown command inof", "info"),
    ("hlep", "unknown command hlep", "help"),
    ("help slcie", "unknown command slcie", "slice"),
    ("mesh.obj", "unknown command mesh.obj", None),
    ("lattice m.obj -o o.vdb --field insied", "--field insied: expected", "inside"),
    ("lattice m.obj -o o.vdb --field winding,densty", "--field winding,densty: expected", "density"),
    ("lattice m.obj -o o.vdb --field inside --rule treshold=1", "--rule treshold=1: expected", "threshold="),
    ("lattice m.obj -o o.vdb --field inside --rule ood", "--rule ood: expected", "odd"),
    ("lattice m.obj -o o --format vbd", "--format vbd: expected", "vdb"),
    ("info m.obj --weld exat", "--weld exat: expected", "exact"),
    ("info m.obj --mesh-format gtlf", "--mesh-format gtlf: expected", "gltf"),
    ("info m.obj --progress alwyas", "--progress alwyas: expected", "always"),
    ("info m.obj --up y-to-x", "--up y-to-x: expected", "y-to-z"),
    ("batch m --out-dir o --format noen", "--format noen: expected", "none"),
    ("points m.obj p.csv --raw f46", "--raw f46: expected", "f64"),
    ("info m.obj --weld thick", "--weld thick: expected", None),
    ("info m.obj --threads two", "--threads two: expected", None),
]


def run(words, **options):
    options = {"stdin": subprocess.DEVNULL, "text": True, "timeout": PATIENCE, **options}
    return subprocess.run([RAYCONE, *words], capture_output=True, **options)


def gltf_triangle(uri, nodes):
    """A scene of the first node, whose mesh has its corners there."""
    return json.dumps({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": nodes,
                       "buffers": [{"byteLength": 36, "uri": uri}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
                       "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        enter_empty_folder(cls.addClassCleanup)
        write("points.csv", "0,0,0\n.5,.5,.5\n")
        for name, content in {"cube.STL.ZST": b"\x28\xb5\x2f\xfd",
                              "compressed": gzip.compress(b"solid"), "cube.ply.gz": gzip.compress(b"ply")}.items():
            write(name, content)
        assert run(["batch", CUBE, "--out-dir", "done", "--resolution", "3"]).returncode == 0

    def refused(self, words, expected):
        result = run(words)
        self.assertEqual((result.returncode, result.stdout), (1, ""), (words, result.stderr))
        self.assertRegex(result.stderr, r"\Araycone: [^\n]*\n\Z", words)
        self.assertIn(expected, result.stderr, words)
        return result.stderr

    def works(self, words, **options):
        result = run(words, **options)
        self.assertEqual(result.returncode, 0, (words, result.stderr))
        return result


class Everywhere(Contract):
    def test_limits_threads_and_quiet_hold_for_every_command(self):
        for words in WORKING.values():
            self.works([*words, "--threads", "2", "--memory-limit", "4G", "--timeout", "1000"])
            self.assertEqual(self.works([*words, "--quiet"]).stderr, "")
            poor = ["batch", CUBE, "--out-dir", "poor"] if words[0] == "batch" else words
            self.assertEqual(run([*poor, "--memory-limit", "1"]).returncode, 5 if words[0] == "batch" else 4, words)
            self.refused([*words, "--threads", "0"], "--threads 0: expected")
            self.refused([*words, "--timeout", "-1"], "--timeout -1: expected")

    def test_options_stand_anywhere_and_two_dashes_end_them(self):
        for command, words in WORKING.items():
            self.works([*words[1:], command] if words[1].startswith("-") else ["--quiet", *words, "--quiet"])
            self.refused([*words, "--no-such-option"], "unknown option --no-such-option")
            self.refused([*words, "--quiet=yes"], "--quiet: takes no value")
        self.assertEqual(run(["info", "--", "--json"]).returncode, 2)  # a file of that name, which is not there

    def test_options_of_no_effect_twice(self):
        for command in ("lattice", "points", "slice", "report"):
            for name in ("-o", "--output"):
                self.refused([*WORKING[command], "-o", "a", name, "b"], "--output: given twice, expected once")
        self.works([*WORKING["lattice"], "--resolution", "4", "--quiet", "--quiet", "--threads", "1", "--threads", "2"])

    def test_nothing_but_the_documented_environment_counts(self):
        words = ["lattice", CUBE, "-o", "-", "--resolution", "3", "--padding", "0.25"]
        expected = self.works(words).stdout
        others = {"TMPDIR": "/absent", "HOME": "/absent", "XDG_CONFIG_HOME": "/absent", "OMP_NUM_THREADS": "1", "NO_COLOR": "1"}
        self.assertEqual(self.works(words, env={**os.environ, **others}).stdout, expected)
        of_libraries = dict.fromkeys(("TBB_VERSION", "BLOSC_PRINT_SHUFFLE_ACCEL", "LOG4CPLUS_LOGLOG_DEBUGENABLED"), "1")
        to_vdb = [*words, "--format", "vdb", "--quiet"]
        vdb = self.works(to_vdb, text=False, env={**os.environ, **of_libraries})
        self.assertEqual((vdb.stdout, vdb.stderr), (self.works(to_vdb, text=False).stdout, b""))
        self.assertEqual(run(words, env={**os.environ, "RAYCONE_THREADS": "none"}).returncode, 1)
        self.assertEqual(self.works(words, env={**os.environ, **self.with_decimal_commas()}).stdout, expected)

    def with_decimal_commas(self):
        """An environment in which programs that obey the locale write them. Without its sources the test is skipped."""
        locale = "de_DE.UTF-8"
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", "./" + locale], capture_output=True)
        if made.returncode != 0:
            self.skipTest("no locale de_DE can be made: %s" % made.stderr.decode())
        others = {"LOCPATH": os.getcwd(), "LC_ALL": locale, "LANG": locale, "LC_NUMERIC": locale}
        number = subprocess.check_output(["/usr/bin/printf", "%.1f", "0,5"], env={**os.environ, **others})
        self.assertEqual(number, b"0,5")
        return others

    def test_every_format_goes_to_standard_output(self):
        for name in ("csv", "npy", "npz", "nii", "nii.gz", "nrrd", "vdb", "vti"):
            words = ["lattice", CUBE, "--resolution", "3", "--quiet"]
            self.works([*words, "-o", "out." + name])
            piped = run([*words, "-o", "-", "--format", name], text=False)
            self.assertEqual(piped.stdout, read("out." + name), name)


def write_large_soup(path):
    """Its 9009 boundary edges may round by 1.0002e-12."""
    write(path, "".join("v %d 0 0\nv %d 1 0\nv %d 0 1\nf -3 -2 -1\n" % (n, n, n) for n in range(3003)))


class Tolerances(Contract):
    def test_tolerances_that_count_as_none_are_there(self):
        for tolerance in ("0", "1e-13"):
            self.works([*WORKING["lattice"], "--tolerance", tolerance])
        self.refused([*WORKING["lattice"], "--tolerance", "-1"], "--tolerance -1: expected")

    def test_a_tolerance_that_is_not_kept_is_said(self):
        write_large_soup("soup.obj")

        def warned(mesh, *words):
            result = run(["lattice", mesh, "-o", "out.csv", "--resolution", "3", *words])
            return result.returncode, ": tolerance: values are expected within 1.01e-12 " in result.stderr

        box, cube = (os.path.join(MESHES, name) for name in ("open_box.obj", "cube.obj"))
        self.assertEqual(warned("soup.obj", "--tolerance", "1e-12"), (0, True))
        self.assertEqual(warned("soup.obj", "--tolerance", "1e-12", "--strict"), (2, True))
        for words in ([], ["--tolerance", "0"], ["--tolerance", "2e-12"],
                      ["--tolerance", "1e-12", "--field", "inside"]):
            self.assertEqual(warned("soup.obj", *words), (0, False), words)
        for mesh in (box, cube):
            self.assertEqual(warned(mesh, "--tolerance", "1e-12"), (0, False))

    def test_the_report_bounds_what_a_tolerance_allows(self):
        box = os.path.join(MESHES, "open_box.obj")
        for tolerance, bound in (("0", 1e-12), ("1e-12", 1e-12), ("1e-11", 1e-11), ("1e-4", 1e-4), ("1", 0.0625)):
            self.works(["lattice", box, *WORKING["lattice"][2:], "--tolerance", tolerance, "--report", "report.json"])
            self.assertEqual(read_json("report.json")["largest_error_bound"], bound)

    def test_bands_are_numbers_or_all(self):

        self.refused([*WORKING["lattice"], "--field", "sdf", "--band", "al"], "--band al: expected a positive number")


class Suggestions(Contract):
    def test_misspelt_words(self):
        for line, named, meant in SUGGESTIONS:
            message = self.refused(line.split(), "raycone: " + named)
            if meant:
                self.assertTrue(message.endswith("; did you mean %s?\n" % meant), message)
            else:
                self.assertNotIn("did you mean", message)

    def test_help_and_version(self):
        self.assertEqual(self.works(["help"]).stdout, self.works(["--help"]).stdout)
        for command in [*WORKING, "help"]:
            expected = self.works([command, "--help"])
            self.assertEqual(expected.stderr, "")
            self.assertIn("raycone %s [OPTIONS]" % command, expected.stdout)
            self.assertEqual(self.works(["help", command]).stdout, expected.stdout)
        self.assertEqual(self.works(["-V"]).stdout, self.works(["--version"]).stdout)
        self.refused(["help", "nonsense"], "unknown command nonsense, expected lattice, points")
        self.refused(["help", "lattice", "points"], "unexpected operand points")

    def test_the_help_of_sdf_says_that_the_lattice_grows(self):
        listed = re.sub(r"\s+", " ", self.works(["lattice", "--help"]).stdout)
        self.assertIn("the lattice grows by B + 1 voxels", listed)


class Messages(Contract):
    def test_slices_outside_the_box_are_refused(self):
        for options, message in {
            ("--at", "2"): "--at 2: outside the box, expected 0 to 1; see --bounds and --padding",
            ("--at", "-1e-9"): "--at -1e-09: outside the box, expected 0 to 1",
            ("--at", "101%"): "--at 101% (1.01): outside the box, expected 0 to 1",
            ("--at", "1.6", "--padding", ".5"): "--at 1.6: outside the box, expected -0.5 to 1.5",
            ("--at", ".5", "--bounds", "0,0,2,1,1,3"): "--at 0.5: outside the box, expected 2 to 3",
            ("--axis", "x", "--at", "7"): "--at 7: outside the box, expected 0 to 1",
        }.items():
            self.refused(["slice", CUBE, "-o", "refused.png", *options], message)
            self.assertFalse(os.path.exists("refused.png"))
        for at in ("0", "1", "0%", "100%"):
            self.works([*WORKING["slice"], "--at", at])
        self.works([*WORKING["slice"], "--at", "-.5", "--padding", ".5"])
        # Where 100 % by the formula would be beyond the end: -0.3 + 1 * (0.1 + 0.3) is not 0.1.
        self.works([*WORKING["slice"], "--at", "100%", "--bounds", "-.3,-.3,-.3,.1,.1,.1"])

    def test_slices_are_flat_where_the_box_is(self):
        for options, flat in (("--size 1", False), ("--size 64 --bounds 0,0,0,100,.5,1", False),
                              ("--size 8 --bounds 0,0,0,1,0,1", True)):
            result = run(["slice", CUBE, "-o", "flat.png", *options.split()])
            self.assertEqual((result.returncode, "flat-box" in result.stderr), (0, flat), result.stderr)

    def test_tolerances_that_count_as_0_are_promises_of_nothing(self):
        write_large_soup("soup.obj")
        for words in (["points", "soup.obj", "points.csv"], ["slice", "soup.obj", "-o", "a.png", "--values", "a.npy"]):
            for tolerance, status in (("0", 0), ("9e-13", 0), ("1e-12", 2)):
                result = run([*words, "--tolerance", tolerance, "--strict"])
                self.assertEqual((result.returncode, "tolerance: " in result.stderr), (status, status == 2), words)

    def test_names_that_promise_another_format_are_refused(self):
        self.refused(["info", CUBE, "--mark", "marks.stl"], "--mark marks.stl: expected a name that ends in .ply")
        self.refused(["points", CUBE, "points.csv", "--raw", "f64", "-o", "o.npy"], "o.npy: its extension names a format")

    def test_a_line_feed_is_for_no_rule_of_make(self):
        shutil.copy(CUBE, "a\nb.obj")
        words = ["lattice", "a\nb.obj", "-o", "made.npy", "--resolution", "2"]
        result = run([*words, "--depfile", "made.d"])
        self.assertEqual(result.returncode, 3)
        self.assertIn("Make cannot read names with line feeds", result.stderr)
        self.assertFalse(os.path.exists("made.npy") or os.path.exists("made.d"))
        self.works(words)

    def test_what_overflows_is_no_number(self):
        facts = json.loads(self.works(["info", CUBE, "--scale", "1e150", "--json"]).stdout)
        self.assertEqual((facts["closed"], facts["signed_volume"]), (True, None))
        rows = list(csv.DictReader(self.works(["info", CUBE, "--scale", "1e150", "--csv"]).stdout.splitlines()))
        self.assertEqual((rows[0]["closed"], rows[0]["signed_volume"]), ("true", ""))

    def test_surfaces_of_what_no_number_holds_are_a_limit(self):
        for scale, name in (("1e-320", "a.ply"), ("1e-320", "a.stl"), ("1e-60", "a.stl")):
            result = run(["surface", CUBE, "-o", name, "--scale", scale, "--resolution", "4", "--simplify", "none"])
            self.assertEqual(result.returncode, 4, result.stderr)
            self.assertIn("precision can hold; see --scale", result.stderr)
        tetrahedron = "v 10000 0 0\nv 10001 0 0\nv 10000 1 0\nv 10000 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n"
        write("far.obj", tetrahedron)
        words = ["surface", "far.obj", "--resolution", "12"]
        new_faces = ["--simplify", "none"]
        self.assertIn("see --resolution and --normalize, or write PLY",
                      run([*words, *new_faces, "-o", "far.stl"]).stderr)
        self.works([*words, *new_faces, "-o", "far.stl", "--normalize", "cube"])
        self.works([*words, *new_faces, "-o", "far.ply"])
        # A mesh that is its own surface needs no numbers but its own, with flat holes closed, too.
        self.works([*words, "-o", "far.stl"])
        write("far.obj", tetrahedron + "f 1 4 3\n")
        self.works([*words, "-o", "far.stl"])
        for mesh in (CUBE, os.path.join(os.path.dirname(CUBE), "open_box.obj")):
            self.works(["surface", mesh, "-o", "a.ply", "--scale", "1e-320", "--resolution", "4"])

    def test_counts_agree_with_their_nouns(self):
        write("one.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\n"
                         b"property uchar z\nend_header\n\0")
        write("one.obj", "v 0 0 0\nf 1 1 2\n")
        for name, expected in (("one.ply", "1 element 'vertex' announced, but only 1 byte follows"),
                               ("one.obj", "but the file has only 1 vertex")):
            result = run(["info", name])
            self.assertEqual(result.returncode, 2)
            self.assertIn(expected, result.stderr)
        one = self.works(["lattice", CUBE, "-o", "out.csv", "--resolution", "1", "--verify", "1"]).stderr
        self.assertRegex(one, r"12 faces, 0 exterior edges, 1 sample in .*, verified 1 sample,")
        self.assertIn("the limit is 1 byte\n", run([*WORKING["lattice"], "--memory-limit", "1"]).stderr)
        for words in ([*WORKING["report"]], ["batch", CUBE, "--out-dir", "batch", "--resolution", "3"]):
            self.assertNotRegex(self.works(words).stderr, r"\b1 (meshes|samples|faces|bytes)\b")

    def test_verification_is_a_phase_of_its_own(self):
        words = [*WORKING["lattice"], "--report", "report.json"]
        self.assertNotIn("verify", self.works(words).stderr)
        self.assertEqual(list(read_json("report.json")["seconds"]), ["read", "prepare", "evaluate", "write", "total"])
        teapot = os.path.join(MESHES, "teapot.obj")
        words = ["lattice", teapot, "-o", "out.csv", "--resolution", "8", "--report", "report.json", "--verify", "100",
                 "--threads", "2"]
        self.assertRegex(self.works(words).stderr, r"write [0-9.]+, verify [0-9.]+\) -> ")
        seconds = read_json("report.json")["seconds"]
        self.assertGreater(seconds["verify"], 0.01)  # 100 samples of 6320 triangles at 2.7 us are 1.7 s on one thread
        parts = sum(seconds[name] for name in ("read", "prepare", "evaluate", "write", "verify"))
        self.assertLessEqual(parts, seconds["total"])
        self.assertGreater(parts, 0.5 * seconds["total"])  # little is outside of all phases

    def test_pipes_are_told_of_mesh_format(self):
        with open(CUBE) as file:
            result = run(["info", "/dev/stdin"], stdin=file)
        self.assertEqual(result.returncode, 2)
        self.assertIn("/dev/stdin: not recognised as a mesh", result.stderr)
        self.assertIn("--mesh-format names the format", result.stderr)
        with open(CUBE) as file:
            self.works(["info", "/dev/stdin", "--mesh-format", "obj"], stdin=file)

    def test_report_says_where_it_wrote(self):
        self.assertEqual(self.works(["report", "done"]).stderr, "raycone: done: 1 mesh -> done/report.html\n")
        self.assertEqual(self.works(["report", "done", "-o", "p.html"]).stderr, "raycone: done: 1 mesh -> p.html\n")
        self.assertEqual(self.works(["report", "done", "-o", "-"]).stderr, "raycone: done: 1 mesh -> standard output\n")
        self.assertEqual(self.works(["report", "done", "--quiet"]).stderr, "")


class Limits(Contract):
    def is_limited(self, words, found):
        """Refused before the work, with the number."""
        result = run(words)
        self.assertEqual((result.returncode, result.stdout), (4, ""), words)
        self.assertRegex(result.stderr, found)
        self.assertNotIn("out of memory", result.stderr)

    def test_pixels_that_nobody_can_count(self):
        for padding in ("9223372036854775807v", "-9223372036854775808v"):
            self.is_limited([*WORKING["slice"], "--padding", padding], "too many pixels")

    def test_what_verification_keeps(self):
        words = ["--verify", "1000000000", "--memory-limit", "1G"]
        needs = "needs about [0-9.]+ GB of memory, but the limit is 1 GB"
        self.is_limited(["lattice", CUBE, "-o", "v.npy", "--resolution", "256", *words], needs)
        self.is_limited(["points", CUBE, "--sample", "uniform=20000000", "-o", "v.npz", *words], needs)
        self.works(["points", CUBE, "--sample", "uniform=20", "-o", "v.npz", *words])

    def test_parts_at_points(self):
        parts = ("g %d\nv %d 0 0\nv %d 1 0\nv %d 0 1\nf -3 -2 -1\n" % (n, n, n, n) for n in range(5000))
        write("parts.obj", "".join(parts))
        words = ["points", "parts.obj", "--sample", "uniform=5", "-o", "p.npz", "--field", "label", "--parts", "group"]
        self.is_limited([*words, "--memory-limit", "24M"], "needs about [0-9.]+ MB")
        self.works([*words, "--memory-limit", "100M"])

    def test_scenes_of_thousands_of_nodes(self):
        """Their JSON takes memory also to be destroyed."""
        nodes = [{"mesh": 0, "children": [n + 1]} for n in range(5000)] + [{"mesh": 0}]
        write("many.gltf", gltf_triangle("data:;base64," + "AAAA" * 12, nodes))
        statuses = set()
        for limit in range(10, 60, 2):
            result = run(["info", "many.gltf", "--memory-limit", "%dM" % limit])
            statuses.add(result.returncode)
            if result.returncode:
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(statuses, {0, 4})

    def test_what_no_lattice_is_like(self):
        os.mkfifo("pipe.vdb")
        write("junk.vdb", "junk")
        for grid in ("pipe.vdb", "junk.vdb", "/dev/zero"):
            for more in ([], ["--dry-run"]):
                result = run(["batch", CUBE, "--out-dir", "like", "--like", grid, *more])
                self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)
                self.assertFalse(os.path.exists("like"))


class Pipes(Contract):
    def test_two_outputs_are_not_mixed_in_one(self):
        words = ["lattice", CUBE, "-o", "-", "--format", "csv", "--resolution", "2", "--report", "/dev/stdout"]
        self.refused(words, "/dev/stdout: is output and report")

    def test_an_array_of_meshes_ends_whatever_becomes_of_them(self):
        write("scene.gltf", gltf_triangle("out.json", [{"mesh": 0}]))
        with open("out.json", "wb") as out:
            status = subprocess.run([RAYCONE, "info", CUBE, "scene.gltf", CUBE, "--json"], stdout=out,
                                    stderr=subprocess.DEVNULL, timeout=PATIENCE).returncode
        self.assertEqual((status, len(read_json("out.json"))), (1, 2))

    def test_a_mesh_comes_through_a_pipe_that_does_not_wait(self):
        """As some parents leave standard input."""
        theirs, ours = os.pipe()
        os.set_blocking(theirs, False)
        process = subprocess.Popen([RAYCONE, "info", "-", "--mesh-format", "obj", "--json"], stdin=theirs,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        os.close(theirs)
        for line in read(CUBE).splitlines(keepends=True):
            time.sleep(0.01)
            os.write(ours, line)
        os.close(ours)
        out, err = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, err), (0, b""))
        self.assertIn(b'"faces": 12', out)


class Terminals(Contract):
    def on_terminal(self, words, width=0):
        """Exit status and what a terminal shows of standard output, and standard error."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
        process = subprocess.Popen([RAYCONE, *words], stdin=subprocess.DEVNULL, stdout=theirs, stderr=subprocess.PIPE)
        os.close(theirs)
        shown = b""
        while select.select([ours], [], [], PATIENCE)[0]:
            try:
                part = os.read(ours, 4096)
            except OSError:  # Linux reports that the other end is closed as EIO
                break
            shown += part
        messages = process.communicate(timeout=PATIENCE)[1]
        os.close(ours)
        return process.returncode, shown, messages.decode()

    def test_help_fits_the_terminal(self):
        piped = self.works(["lattice", "--help"]).stdout
        self.assertGreater(max(map(len, piped.splitlines())), 80)
        for width in (0, 80, 100):
            status, shown, messages = self.on_terminal(["lattice", "--help"], width)
            self.assertEqual((status, messages), (0, ""))
            text = shown.decode()
            self.assertEqual(text.split(), piped.split())
            lines = [line for line in text.splitlines() if not line.startswith("  raycone ")]
            self.assertEqual(max(map(len, lines)) <= width, width > 0)

    def test_what_is_no_text_is_refused(self):
        lattice = ["lattice", CUBE, "--resolution", "3", "-o"]
        for words in (
            ["slice", CUBE, "-o", "-", "--size", "4"],
            ["slice", CUBE, "-o", "out.png", "--size", "4", "--values", "-"],
            *([*lattice, "-", "--format", name] for name in ("vdb", "npy", "vti")),
            ["points", CUBE, "points.csv", "--format", "npy"],
            ["points", CUBE, "points.csv", "--raw", "f64"],
            ["points", CUBE, "--sample", "uniform=3", "-o", "-", "--format", "npz"],
        ):
            status, shown, messages = self.on_terminal(words)
            self.assertEqual((status, shown), (1, b""), words)
            expected = "is a terminal, which cannot show this format; expected -o FILE, or a pipe behind"
            self.assertEqual(messages, "raycone: standard output: %s\n" % expected)

    def test_text_is_shown(self):
        for words in (["lattice", CUBE, "--resolution", "3", "-o", "-"], ["points", CUBE, "points.csv"], ["info", CUBE],
                      ["report", "done", "-o", "-"], ["help"]):
            status, shown, messages = self.on_terminal(words)
            self.assertEqual(status, 0, messages)
            self.assertTrue(shown)


if __name__ == "__main__":
    run_tests()
