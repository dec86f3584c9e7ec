"""`raycone info` about files of values: python3 volume_info_test.py RAYCONE MESH_DIRECTORY

The oracle is the report of the run that made the file. Damaged files are refused in one line.
"""

import itertools
import json
import os
import random
import zipfile

from command_case import CommandCase, mesh, read, read_json, run, run_tests, write

CUBE, TEAPOT = map(mesh, ("cube", "teapot"))
TURNED = """NRRD0004
dimension: 3
space: LPS
sizes: 4 5 6
space directions: (.3,.1,0) (-.1,.3,0) (0,0,-.5)
space origin: (0,0,1)

"""


class VolumeInfo(CommandCase):
    def info(self, words):
        return self.works("info " + words).decode()

    def facts(self, name):
        return json.loads(self.info("%s --json" % name))

    def test_what_each_format_says(self):
        write("turned.nrrd", TURNED)
        for lattice in ("--voxel-size .25,.5,.125 --padding 2v", "--like turned.nrrd"):
            for name, form, array in (("a.vdb", "OpenVDB", ("inside", "bool")), ("a.npz", "NPZ", ("inside", "|b1")),
                                      ("a.nrrd", "NRRD", ("inside", "uint8")), ("a.nii", "NIfTI-1", ("", "uint8")),
                                      ("a.nii.gz", "NIfTI-1", ("", "uint8"))):
                words = "lattice %s -o %s --field inside --rule abs=.5 --scale 2 --report r.json %s"
                self.works(words % (CUBE, name, lattice))
                report = read_json("r.json")
                facts = self.facts(name)
                self.assertEqual(facts["format"], form)
                self.assertEqual((facts["arrays"][0]["name"], facts["arrays"][0]["type"]), array)
                expected = report["lattice"]
                if form in ("OpenVDB", "NPZ"):
                    # Directions are rounded.
                    self.expect_near(facts["lattice"], expected, 1e-15)
                else:  # index 0 is the first sample there; NIfTI has 32 bits
                    self.assertEqual(facts["lattice"]["index_min"], [0, 0, 0])
                    self.expect_near(facts["lattice"]["spacing"], expected["spacing"], 1e-7)
                made = facts["made"]
                if form == "NIfTI-1":
                    self.assertEqual(made["description"], "raycone %s inside" % report["version"])
                    continue
                for key in ("sha256", "transform"):
                    self.assertEqual(made[key], report[key], name)
                self.assertEqual((made["raycone_version"], made["rule"]), (report["version"], "abs=0.5"))
                options = made["options"] if form != "OpenVDB" else made["options"].split(" ")
                self.assertEqual(options, report["options"])

    def test_options_that_results_depend_on_are_told(self):
        common = ["--field=inside", "--rule=odd", "--tolerance=1e-6", "--scale=2", "--up=y-to-z", "--normalize=cube:3",
                  "--orient=auto", "--weld=0.001"]
        for name, more in (("a.vdb", ["--padding=5%", "--resolution=7"]), ("a.npz", ["--pack-bits", "--resolution=7"]),
                           ("a.nrrd", ["--centers", "--resolution=7"]),
                           ("p.npz", ["--sample=uniform=9,near=3:0.1", "--seed=7", "--dtype=f16"])):
            options = common + more
            words = "%s %s -o %s %s --threads 1 --report r.json" % (
                "points" if name == "p.npz" else "lattice", CUBE, name, " ".join(options))
            self.works(words)
            report = read_json("r.json")
            self.assertEqual(report["command"], words.split() + ["--quiet"], name)
            made = self.facts(name)["made"]
            told = made["options"] if name != "a.vdb" else made["options"].split(" ")
            self.assertEqual(sorted(told), sorted(options), name)
            self.assertEqual(made["transform"], report["transform"], name)
            text = self.info(name)
            for option in options:
                self.assertIn(option, text, name)

    def expect_near(self, got, expected, tolerance):
        if isinstance(expected, dict):
            self.assertEqual(got.keys(), expected.keys())
            got, expected = list(got.values()), list(expected.values())
        if isinstance(expected, list):
            self.assertEqual(len(got), len(expected))
            for pair in zip(got, expected):
                self.expect_near(*pair, tolerance)
        else:
            self.assertLessEqual(abs(got - expected), tolerance)

    def test_text_and_several(self):
        self.works("lattice %s -o a.vdb --field winding,inside --rule odd --resolution 3" % CUBE)
        self.works("points %s --sample uniform=5 -o p.npz" % CUBE)
        text = self.info("a.vdb p.npz")
        for line in ("  grids                winding float\n                       inside bool\n",
                     "  samples              3 x 3 x 3\n", "  spacing              (0.5, 0.5, 0.5) world units\n",
                     "  axes                 those of the world\n", "  rule                 odd\n",
                     "  mesh                 cube.obj\n", "  fields               winding inside\n", "\np.npz\n", "  arrays               points <f8 (5, 3)\n"):
            self.assertIn(line, text)
        several = json.loads(self.info("%s a.vdb p.npz --json" % CUBE))
        self.assertEqual([entry.get("mesh", entry.get("file")) for entry in several], [CUBE, "a.vdb", "p.npz"])
        self.assertIsNone(several[2]["lattice"])
        self.assertEqual(several[2]["made"]["options"], ["--sample=uniform=5"])
        for option in ("--csv", "--require closed", "--intersections", "--mark m.ply", "--scale 2", "--orient auto"):
            self.refused("info %s a.vdb %s" % (CUBE if "mark" not in option else "", option), 1,
                         "raycone: %s: has no effect on a.vdb, which is no mesh" % option.split()[0])

    def test_labels_are_told(self):
        for fields, name in (("label", "a.nrrd"), ("label", "a.npz"), ("label", "a.vdb"), ("winding,label", "b.vdb")):
            self.works("lattice %s %s -o %s --field %s --resolution 9" % (CUBE, TEAPOT, name, fields))
            made = self.facts(name)["made"]
            self.assertEqual(made["labels"], ["cube", "teapot"], name)
            told = made["fields"] if name.endswith(".vdb") else " ".join(made["fields"])
            self.assertEqual(told, fields.replace(",", " "), name)

    def test_a_file_without_a_place_has_no_lattice(self):
        write("a.nrrd", "NRRD0004\ntype: float\ndimension: 2\nsizes: 4 5\nencoding: raw\n\n")
        facts = self.facts("a.nrrd")
        self.assertEqual((facts["arrays"], facts["lattice"], facts["made"]),
                         ([{"name": "", "type": "float", "shape": [4, 5]}], None, {}))
        self.assertIn("no lattice           not a readable volume: dimension, expected", self.info("a.nrrd"))

    def test_structured_arrays_are_listed(self):
        kind = "[('shape', '<f8'), ('a]', [('fortran_order', '<i4', (2,))])]"
        head = "{'descr': %s, 'fortran_order': False, 'shape': (2,), }\n" % kind
        with zipfile.ZipFile("s.npz", "w") as archive:
            archive.writestr("s.npy", b"\x93NUMPY\x01\0" + len(head).to_bytes(2, "little") + head.encode() + bytes(32))
        self.assertEqual(self.facts("s.npz")["arrays"],
                         [{"name": "s", "type": kind, "shape": [2]}])

    def test_numbers_of_nrrd_may_have_tabs_and_plus_signs(self):
        write("plain.nrrd", TURNED)
        write("a.nrrd", TURNED.replace("sizes: 4 5 6", "sizes: 4\t+5\t6").replace("(.3,.1,0)", "(+.3,+1e-1,\t0)"))
        facts = self.facts("a.nrrd")
        self.assertEqual(facts["arrays"][0]["shape"], [4, 5, 6])
        self.assertEqual(facts["lattice"], self.facts("plain.nrrd")["lattice"])
        write("a.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 1 2 3\nspacings: +1.0\t1 +2e0\n\n")
        self.assertEqual(self.facts("a.nrrd")["lattice"]["spacing"], [1, 1, 2])

    def test_archives_of_others(self):
        with zipfile.ZipFile("a.npz", "w") as archive:
            archive.writestr("a.txt", "text")
        self.refused("info a.npz", 2, "a.npz: has no arrays, expected an NPZ archive")
        os.rename("a.npz", "a.zip")
        self.assertNotEqual(run("info a.zip").returncode, 0)

    def test_what_files_say_of_themselves_is_not_trusted(self):
        deep = "[" * 100000
        for made in ("{}", "[1, 2]", "{", "\xff\xfe", deep, '{"a": %s%s}' % (deep, "]" * 100000), '{"a": 1e999}',
                     '{"a": [%s]}' % ",".join(["{}"] * 200000),
                     "{%s}" % ",".join('"%d": 0' % n for n in range(60000)),
                     '{"\x1b[31m": "\x1b[2J\\n\\u001b"}', '{"a": {"b": {"c": [1, "d"]}}}',
                     '{"transform": null, "a": NaN}'):
            write("a.nrrd", b"NRRD0004\ntype: float\x1b[31m\ndimension: 3\nsizes: 1 2 3\nspacings: 1 1 1\nraycone:=" +
                            made.encode("latin1") + b"\n\n")
            self.assertEqual(self.facts("a.nrrd")["lattice"]["index_max"], [0, 1, 2], made[:40])
            text = self.info("a.nrrd")
            self.assertNotIn("\x1b", text)
            self.assertLess(len(text), 10000 + (len(made) if made.startswith('{"a": [{}') else 0))
        self.assertEqual(self.facts("a.nrrd")["made"], {})

    def test_damaged_files(self):
        """Bytes changed, and ends cut off: facts, or one line."""
        chance = random.Random(3)
        self.works("lattice %s -o a.vdb --field winding,inside --resolution 3" % CUBE)
        self.works("lattice %s -o a.npz --resolution 3" % CUBE)
        self.works("lattice %s -o a.nrrd --resolution 3" % CUBE)
        self.works("lattice %s -o a.nii --resolution 3" % CUBE)
        outcomes = set()
        names = ("a.vdb", "a.npz", "a.nrrd", "a.nii")
        for name in names:
            whole = read(name)
            for n in range(12):
                longest = len(whole) if n else 8  # the first one ends before it says what it is
                content = bytearray(whole[: chance.randrange(longest)] if n % 3 == 0 else whole)
                for _ in range(chance.randrange(1, 5) if n % 3 else 0):
                    place = chance.randrange(min(len(content), 900))
                    content[place] = chance.choice((0, 255, 127, chance.randrange(256)))
                write("b" + name[1:], content)
                result = run("info b%s --json" % name[1:])
                self.assertIn(result.returncode, (0, 2), (result.stderr, bytes(content)))
                self.assertEqual(result.stderr.count(b"\n"), 1 if result.returncode else 0, result.stderr)
                if result.returncode == 0:
                    json.loads(result.stdout)
                outcomes.add((name, result.returncode))
        self.assertEqual(outcomes, set(itertools.product(names, (0, 2))))  # both ends are met, by each format
        self.refused("info missing.npz", 2, "missing.npz")


if __name__ == "__main__":
    run_tests()
