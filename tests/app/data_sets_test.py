"""Data sets as training pipelines and scanners take and give them: python3 data_sets_test.py RAYCONE MESH_DIRECTORY

NPZ of lattices and points, types and bits, --like, --normalize, points on the surface, compressed inputs. The oracle is
numpy, the same values as CSV, and the definitions.
"""

import gzip
import io
import json
import os
import shutil
import subprocess
import zipfile

from command_case import PATIENCE, RAYCONE, CommandCase, mesh, numpy_or_skip, read, read_json, run, run_tests, write

numpy = numpy_or_skip()
CUBE, TEAPOT, OPEN_BOX = map(mesh, ("cube", "teapot", "open_box"))


def bits_of(archive):
    shape = archive["inside_shape"]
    return numpy.unpackbits(archive["inside"])[: shape.prod()].reshape(shape).astype(bool)


class DataSets(CommandCase):
    def csv(self, words):
        text = self.works(words + " -o - --format csv").decode()
        return numpy.genfromtxt(io.StringIO(text), delimiter=",", names=True)

    def points(self, words):
        self.works("points " + words + " -o points.npz")
        return numpy.load("points.npz")


class Lattices(DataSets):
    def test_npz_holds_what_csv_does_with_its_place(self):
        # Large enough for slabs across y, whose pieces do not follow one another in the file.
        words = "lattice %s --resolution 2,280,240 --padding 2v --field winding,inside" % OPEN_BOX
        rows = self.csv(words)
        self.works(words + " -o a.npz --double --report a.json")
        with zipfile.ZipFile("a.npz") as archive:
            self.assertIsNone(archive.testzip())
        values = numpy.load("a.npz")
        lattice = read_json("a.json")["lattice"]
        index = numpy.stack([rows[name].astype(int) - first for name, first in zip("ijk", values["index_min"])])
        for name, column in (("w", "w"), ("inside", "inside")):
            self.assertTrue((values[name][tuple(index)] == rows[column]).all(), name)
        for name in ("origin", "spacing", "index_min"):
            self.assertEqual(values[name].tolist(), lattice[name])
        self.assertTrue((values["direction"] == numpy.eye(3)).all() and (values["transform"] == numpy.eye(4)).all())
        self.assertEqual([values[name].dtype for name in ("w", "inside")], ["f8", "bool"])

    def test_diagnostics_have_arrays_of_their_own(self):
        words = "lattice %s --resolution 5 --diagnostics" % OPEN_BOX
        rows = self.csv(words)
        self.works(words + " -o a.npz")
        values = numpy.load("a.npz")
        for name, dtype in (("crossings", "i8"), ("degenerate", "i8"), ("on_surface", "bool"), ("error_bound", "f8")):
            self.assertEqual(values[name].dtype, dtype)
            self.assertTrue((values[name].transpose().ravel() == rows[name]).all(), name)

    def test_types_and_bits(self):
        words = "lattice %s --resolution 33 --padding 2v --field winding,inside,sdf" % OPEN_BOX
        loaded = {}
        for dtype in ("f16", "f32", "f64"):
            self.works("%s -o %s.npz --dtype %s --pack-bits" % (words, dtype, dtype))
            loaded[dtype] = numpy.load(dtype + ".npz")
        exact = loaded["f64"]
        inside = bits_of(exact)
        self.works(words.replace("winding,inside,sdf", "inside") + " -o plain.npy")
        self.assertTrue((numpy.load("plain.npy") == inside).all() and inside.any() and not inside.all())
        for dtype, digits in (("f16", 11), ("f32", 24)):
            values = loaded[dtype]
            self.assertEqual(values["w"].dtype, dtype.replace("f16", "f2").replace("f32", "f4"))
            # Half a unit of the last place; another one where the nearest is across the threshold.
            allowed = 2.0 ** -digits * 3 * numpy.maximum(abs(exact["w"]), 2.0 ** -14)
            self.assertTrue((abs(values["w"].astype("f8") - exact["w"]) <= allowed).all(), dtype)
            self.assertTrue(((values["w"] >= 0.5) == inside).all(), dtype)
            self.assertTrue((values["sdf"] == exact["sdf"].astype(values["sdf"].dtype)).all(), dtype)
            self.assertTrue((bits_of(values) == inside).all())
        for dtype in ("f16", "f32", "f64"):
            self.works("lattice %s --resolution 33 --padding 2v -o w.npy --dtype %s" % (OPEN_BOX, dtype))
            self.assertTrue((numpy.load("w.npy") == loaded[dtype]["w"]).all())
        for end in ("npy", "npz", "vdb"):  # before anything is evaluated
            self.refused("lattice %s -o a.%s --field sdf --dtype f16 --scale 1e7" % (CUBE, end), 3,
                         "distances of up to 476190 are beyond 65504, the range of 16 bits; expected --dtype f32")
        self.works("lattice %s -o all.npy --field sdf --dtype f16 --scale 3e4 --band all --resolution 5" % CUBE)
        self.refused("lattice %s -o a.npy --field sdf --dtype f16 --scale 1e7 --band all" % CUBE, 3, "beyond 65504")
        self.works("batch %s --out-dir measured --format none --field sdf --scale 1e40" % CUBE)
        for end in ("npy", "npz", "vdb", "vti", "nrrd"):
            self.refused("lattice %s -o a.%s --field sdf --scale 1e40" % (CUBE, end), 3, "the range of 32 bits")
            self.assertFalse(os.path.exists("a." + end))
        self.works("lattice %s -o a.npy --field sdf --scale 1e40 --resolution 5 --double" % CUBE)
        self.assertTrue(numpy.isfinite(numpy.load("a.npy")).all())
        self.refused("points %s --sample uniform=5 -o a.npz --field sdf --dtype f32 --scale 1e40" % CUBE, 4, "32 bits")
        for dtype, scale, next_dtype in (("f16", "1e-3", "f32"), ("f32", "1e-37", "f64")):
            words = "lattice %s -o tiny_%s.npy --field sdf --resolution 33 --scale %s --dtype " % (CUBE, dtype, scale)
            self.refused(words + dtype, 3, "lose digits; expected --dtype " + next_dtype)
            self.assertFalse(os.path.exists("tiny_%s.npy" % dtype))
            self.works(words + next_dtype)
            self.works(words.replace("sdf", "winding") + dtype)

    def test_what_is_inside_has_a_negative_distance(self):
        """Also where 16 or 32 bits round it to 0."""
        write("p.csv", "x,y,z\n" + "".join("0.5,0.5,%g\n" % z for z in (1e-8, 1e-12, 1e-44, 1e-50, 1e-150, 0.25)))
        for dtype in ("f16", "f32", "f64"):
            self.works("points %s p.csv -o p.npz --field sdf,inside --dtype %s" % (CUBE, dtype))
            values = numpy.load("p.npz")
            self.assertTrue(((values["sdf"] < 0) == (values["inside"] == 1)).all() and values["inside"].all(), dtype)

    def test_like_takes_the_lattice_again(self):
        self.works("lattice %s -o a.npz --voxel-size .1,.2,.3 --centers --field winding,inside" % TEAPOT)
        self.works("lattice %s -o b.npz --like a.npz --field winding,inside" % TEAPOT)
        self.works("lattice %s -o bits.npz --like b.npz --field inside --pack-bits" % TEAPOT)
        self.works("lattice %s -o c.npz --like bits.npz --field winding,inside" % TEAPOT)
        expected = numpy.load("a.npz")
        for name in ("b.npz", "c.npz"):
            values = numpy.load(name)
            self.assertEqual(values.files, expected.files)
            for array in set(expected.files) - {"raycone"}:  # which says what was asked for
                self.assertTrue((values[array] == expected[array]).all(), name + array)
        self.works("points %s --sample uniform=3 -o points.npz" % CUBE)
        self.refused("lattice %s -o d.npz --like points.npz" % CUBE, 2, "has no array 'origin'")
        whole = read("a.npz")
        for cut in (3, 30, 700, len(whole) - 5):
            write("cut.npz", whole[:cut])
            self.assertEqual(run("lattice %s -o d.npz --like cut.npz" % CUBE).returncode, 2, cut)


class Images(DataSets):
    WORDS = "lattice %s --voxel-size .25,.5,.125 --padding 2v --field " % TEAPOT

    def expected(self, field):
        """Values with x fastest, the spacing and the place of the first sample."""
        self.works(self.WORDS + field + " -o a.npz" + ("" if field == "inside" else " --dtype f64"))
        values = numpy.load("a.npz")
        name = {"winding": "w"}.get(field, field)
        return values[name], values["spacing"], values["origin"] + values["index_min"] * values["spacing"]

    def test_nrrd_is_what_its_head_says(self):
        for field, dtype, kind, stored in (("winding", "", "float", "<f4"), ("inside", "", "uint8", "u1"),
                                           ("density", " --dtype f64", "double", "<f8")):
            values, spacing, first = self.expected(field)
            for compress in ("", " --compress"):
                self.works(self.WORDS + field + " -o a.nrrd" + dtype + compress)
                head, _, data = read("a.nrrd").partition(b"\n\n")
                lines = head.decode().split("\n")
                self.assertEqual(lines[0], "NRRD0005")
                entries = dict(line.split(": ", 1) for line in lines[2:] if ":=" not in line)
                about = dict(line.split(":=", 1) for line in lines[2:] if ":=" in line)
                self.assertEqual((entries["type"], entries["dimension"]), (kind, "3"))
                self.assertEqual([int(n) for n in entries["sizes"].split()], list(values.shape))
                self.assertEqual(entries["encoding"], "gzip" if compress else "raw")
                rows = [json.loads("[%s]" % row.strip("()")) for row in entries["space directions"].split(" ")]
                self.assertEqual(rows, numpy.diag(spacing).tolist())
                self.assertEqual(json.loads("[%s]" % entries["space origin"].strip("()")), first.tolist())
                self.assertEqual(about["raycone_field"], field)
                self.assertEqual(json.loads(about["raycone"])["fields"], [field])
                array = numpy.frombuffer(gzip.decompress(data) if compress else data, stored)
                array = array.reshape(values.shape, order="F")
                self.assertTrue((array == values.astype(stored)).all() and array.any(), field)

    def test_nifti_is_what_its_head_says(self):
        for field, dtype, code, stored in (("winding", "", 16, "<f4"), ("inside", "", 2, "u1"),
                                           ("density", " --dtype f64", 64, "<f8")):
            values, spacing, first = self.expected(field)
            for name in ("a.nii", "a.nii.gz"):
                self.works(self.WORDS + field + " -o " + name + dtype)
                data = gzip.decompress(read(name)) if name.endswith("gz") else read(name)
                self.assertEqual((data[344:348], int.from_bytes(data[:4], "little")), (b"n+1\0", 348))
                dim = numpy.frombuffer(data, "<i2", 8, 40)
                self.assertEqual(dim.tolist(), [3, *values.shape, 1, 1, 1, 1])
                self.assertEqual(numpy.frombuffer(data, "<i2", 2, 70).tolist(), [code, 8 * numpy.dtype(stored).itemsize])
                form = numpy.frombuffer(data, "<f4", 12, 280).reshape(3, 4)
                self.assertEqual(form.tolist(), numpy.c_[numpy.diag(spacing), first].astype("f4").tolist())
                array = numpy.frombuffer(data, stored, values.size, 352).reshape(values.shape, order="F")
                self.assertTrue((array == values.astype(stored)).all() and array.any(), field)
                self.assertEqual(len(data), 352 + array.nbytes)
                self.check_with_nibabel(name, array, form)
        self.refused("lattice %s -o b.nii --resolution 40000,2,2" % CUBE, 3, "do not fit in the 16 bits of NIfTI-1")
        self.refused("lattice %s -o b.nii --resolution 2 --scale 1e40" % CUBE, 3, "do not fit in the 32 bits")
        # Far from the origin 32 bits would shift the volume. On an eighth, or with all digits, nothing is lost.
        for place, status in (("100000.1", 3), ("1000.1", 0), ("100000.125", 0)):
            words = "lattice %s -o b.nii --bounds %s,0,0,%s,1,1 --resolution 65" % (CUBE, place, float(place) + 1)
            if status:
                self.refused(words, 3, "the 32 bits of NIfTI-1 would displace samples by 0.")
            else:
                self.works(words)
                os.remove("b.nii")
        self.assertFalse(os.path.exists("b.nii"))

    def check_with_nibabel(self, name, array, form):
        try:
            import nibabel
        except ImportError:
            return
        image = nibabel.load(name)
        self.assertTrue((image.get_fdata() == array).all())
        for affine in (image.affine, image.get_qform(), image.get_sform()):
            self.assertTrue(abs(affine[:3] - form).max() < 1e-6)

    def test_images_are_the_same_whatever_the_slabs(self):
        words = "lattice %s --resolution 60 --field sdf -o %s --threads %d --memory-limit %s"
        for end in ("nrrd --compress", "nii.gz"):
            name = "a." + end.split()[0]
            self.works(words % (TEAPOT, "a." + end, 1, "4G"))
            first = read(name)
            self.works(words % (TEAPOT, "a." + end, 3, "150M"))
            self.assertEqual(read(name), first)


class ImagesToFollow(DataSets):
    def lattice_like(self, path):
        self.works("lattice %s -o like.npz --field inside --like %s" % (CUBE, path))
        values = numpy.load("like.npz")
        return values["inside"].shape, values["spacing"].tolist(), values["origin"].tolist()

    def test_what_was_written_is_followed(self):
        for name in ("a.nrrd", "a.nii", "a.nii.gz"):
            self.works("lattice %s -o %s --voxel-size .25,.5,.125 --padding 2v" % (CUBE, name))
            self.assertEqual(self.lattice_like(name), ((9, 7, 13), [0.25, 0.5, 0.125], [-0.5, -1, -0.25]), name)

    def nrrd(self, space="LPS", steps="(-1,0,0) (0,-2,0) (0,0,.5)", **entries):
        entries = {"dimension": 3, "space": space, "sizes": "3 4 5", "space directions": steps,
                   "space origin": "(1, -1, .5)", **entries}
        lines = ["%s: %s\r\n" % entry for entry in entries.items() if entry[1] is not None]
        write("b.nrrd", "NRRD0004\r\n# a comment: with a colon\r\n" + "".join(lines) + "\r\n")

    def test_nrrd_of_others(self):
        self.nrrd()
        self.assertEqual(self.lattice_like("b.nrrd"), ((3, 4, 5), [1, 2, 0.5], [-1, 1, 0.5]))
        for change, message in (({"steps": "(-1,0,0) (0,-2,0)"}, "space directions, expected 3 vectors"),
                                ({"steps": "(-1,0,0) (0,-2,0) (0,0,.5) (0,0,.5)"}, "space directions, expected 3"),
                                ({"steps": "(-1,0,0) (0,-2,0) none"}, "space directions, expected 3 axes"),
                                ({"steps": "(-1,0,0) (0,-2,0) (0,0,.5,1)"}, "space directions, expected 3 vectors"),
                                ({"steps": None}, "it has no space directions"),
                                ({"space origin": None}, "it has no space origin"),
                                ({"space": "RAST"}, "its space, expected"), ({"sizes": None}, "has no sizes"),
                                ({"sizes": "3 0 5"}, "sizes, expected"),
                                ({"sizes": "3 2.5 5"}, "sizes, expected 3 whole"),
                                ({"sizes": "3 4 5 6"}, "sizes, expected 3"),
                                ({"dimension": 4}, "sizes, expected 4"),
                                ({"dimension": 2}, "dimension, expected a number from 3 to 16"),
                                ({"dimension": 17}, "dimension, expected a number from 3 to 16"),
                                ({"space origin": "(nan,0,0)"}, "space origin, expected 3 numbers")):
            self.nrrd(**change)
            self.refused("lattice %s -o c.vdb --like b.nrrd" % CUBE, 2, "b.nrrd: not a readable volume: ")
            self.refused("lattice %s -o c.vdb --like b.nrrd" % CUBE, 2, message)
        for entries, message in (("spacings: 1 2", "spacings, expected 3 numbers"), ("", "it has no spacings"),
                                 ("spacings: 1 2 NaN", "spacings, expected 3 axes"),
                                 ("spacings: 1 2 0", "its axes, expected three directions"),
                                 ("spacings: 1 2 3\naxis mins: 0 0 0", "it has no space directions")):
            write("b.nrrd", "NRRD0001\ndimension: 3\nsizes: 3 4 5\n%s\n\n" % entries)
            self.refused("lattice %s -o c.vdb --like b.nrrd" % CUBE, 2, message)

    def test_nifti_of_others(self):
        self.works("lattice %s -o a.nii --voxel-size .25,.5,.125" % CUBE)
        head = bytearray(read("a.nii"))
        head[254:256] = bytes(2)  # no sform, but the qform that says the same
        write("q.nii", head)
        self.assertEqual(self.lattice_like("q.nii"), self.lattice_like("a.nii"))
        head[252:254] = bytes(2)
        write("none.nii", head)
        self.refused("lattice %s -o c.vdb --like none.nii" % CUBE, 2, "neither sform nor qform")
        write("cut.nii", head[:300])
        self.assertEqual(run("lattice %s -o c.vdb --like cut.nii" % CUBE).returncode, 2)
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel")
        # Big-endian, by another program.
        affine = numpy.array([[0.5, 0, 0, -1], [0, 0.25, 0, -2], [0, 0, 2, -3], [0, 0, 0, 1]])
        image = nibabel.Nifti1Image(numpy.zeros((4, 5, 6), "f4"), affine,
                                    nibabel.Nifti1Header(endianness=">"))
        nibabel.save(image, "big.nii.gz")
        self.assertEqual(self.lattice_like("big.nii.gz"), ((4, 5, 6), [0.5, 0.25, 2], [-1, -2, -3]))


class Provenance(DataSets):
    def test_files_say_how_they_were_made(self):
        words = "%s --scale 2 --field inside --rule abs=.5 --threads 2 --report r.json" % CUBE
        for command, options in (("lattice " + words + " --resolution 3", ["--resolution=3"]),
                                 ("points " + words + " --sample uniform=3 --seed 7",
                                  ["--sample=uniform=3", "--seed=7"])):
            given = sorted(["--field=inside", "--rule=abs=.5", "--scale=2", *options])
            self.works(command + " -o a.npz")
            about = json.loads(numpy.load("a.npz")["raycone"].item())
            self.assertEqual(about["options"], given)
            self.assertEqual((about["rule"], about["fields"]), ("abs=0.5", ["inside"]))
            self.assertEqual(about["transform"][0], [2, 0, 0, 0])
            report = read_json("r.json")
            self.assertEqual(report["command"], (command + " -o a.npz --quiet").split())
            self.assertEqual(report["options"], given)
            for key in ("sha256", "transform"):
                self.assertEqual(about[key], report[key])
            whole = read("a.npz")
            self.works(command + " -o a.npz --weld exact --orient keep --engine embree")  # what would hold anyway
            self.assertEqual(read("a.npz"), whole)

    def test_defaults_are_no_options_however_they_are_spelled(self):
        usual = " --tolerance .1e-9 --scale 1.0 --orient keep --weld exact --field winding"
        for command, more in (("lattice %s --resolution 3" % CUBE, " --dtype f32"),
                              ("points %s %s" % (CUBE, "p.csv"), " --dtype f64")):
            write("p.csv", "0,0,0\n1,2,3\n")
            self.works(command + " -o a.npz")
            whole = read("a.npz")
            self.works(command + usual + more + " -o a.npz")
            self.assertEqual(read("a.npz"), whole)
            self.works(command + " --scale 1.5 -o a.npz")
            self.assertNotEqual(read("a.npz"), whole)

    def test_a_default_of_others_is_an_option_of_samples(self):
        for given, options in (([], ["--sample=uniform=3"]),
                               (["--field", "winding"], ["--field=winding", "--sample=uniform=3"])):
            self.works(" ".join(["points", CUBE, "--sample uniform=3 -o a.npz", *given]))
            self.assertEqual(json.loads(numpy.load("a.npz")["raycone"].item())["options"], options)

    def test_vdb_has_options_and_transform(self):
        try:
            import pyopenvdb
        except ImportError:
            self.skipTest("no pyopenvdb")
        self.works("lattice %s -o a.vdb --resolution 3 --normalize cube:4 --grid-name w" % CUBE)
        grid = pyopenvdb.read("a.vdb", "w")
        self.assertEqual(grid["raycone_options"], "--grid-name=w --normalize=cube:4 --resolution=3")
        matrix = numpy.array(grid["raycone_transform"])
        self.assertEqual(matrix.tolist(), [[4, 0, 0, -2], [0, 4, 0, -2], [0, 0, 4, -2], [0, 0, 0, 1]])


class Names(DataSets):
    def test_files_are_utf8_whatever_bytes_names_have(self):
        mesh = b"caf\xe9.obj"
        shutil.copy(CUBE.encode(), mesh)
        with open(mesh, "ab") as file:
            file.write(b"g wei\xdf\nf 1 2 3\n")
        for words in ("lattice %s -o a.vdb --resolution 3", "slice %s -o a.png --size 8",
                      "lattice %s -o a.nrrd --resolution 3 --field label --parts group --orient auto"):
            name = words.split()[3]
            words = [word.encode() if word != "%s" else mesh for word in words.split()]
            subprocess.run([os.fsencode(RAYCONE), *words, b"--quiet"], check=True, timeout=PATIENCE)
            data = read(name)
            self.assertNotIn(b"caf\xe9", data, name)
            self.assertNotIn(b"wei\xdf", data, name)
            self.assertIn("caf\ufffd".encode() if name != "a.nrrd" else "wei\ufffd".encode(), data, name)


class Points(DataSets):
    def test_npz_goes_in_and_out(self):
        drawn = self.points(CUBE + " --sample uniform=1e3,near=1e2:0.1 --padding 5%")
        os.rename("points.npz", "drawn.npz")
        again = self.points(CUBE + " drawn.npz --field winding,inside,sdf")
        for name in ("points", "w", "inside", "sdf"):
            self.assertTrue((drawn[name] == again[name]).all(), name)
        numpy.savez_compressed("deflated.npz", other=numpy.zeros(3), points=drawn["points"].astype(">f8"))
        numpy.savez("fortran.npz", points=numpy.asfortranarray(drawn["points"]))
        numpy.savez_compressed("both.npz", points=numpy.asfortranarray(drawn["points"]))
        expected = self.works("points %s drawn.npz" % CUBE)
        for name in ("deflated.npz", "fortran.npz", "both.npz"):
            self.assertEqual(self.works("points %s %s" % (CUBE, name)), expected)
        # Sizes that wrap around, packed, so that nothing tells before.
        for rows in (3, 2**61, 6148914691236517206, 2**64 - 1):
            head = ("{'descr': '<f8', 'fortran_order': True, 'shape': (%d, 3), }" % rows).encode()
            head = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head
            with gzip.open("short.npy.gz", "wb") as file:
                file.write(head + bytes(48))
            self.assertEqual(run("points %s short.npy.gz" % CUBE).returncode, 2, rows)
        self.assertEqual(drawn["points"][:1000].min() < 0, True)  # --padding
        self.assertGreaterEqual(drawn["points"][:1000].min(), -0.05)

    def test_of_a_pipe_whose_length_nobody_knows(self):
        text = b"0.5 0.5 0.5\n2 2 2\n0.1 0.1 0.1\n"
        given = self.works("points %s - -o - --format npz --field inside,sdf --pack-bits" % CUBE, input=text)
        values = numpy.load(io.BytesIO(given))
        self.assertEqual(bits_of(values).tolist(), [True, False, True])
        self.assertEqual(values["points"].tolist(), [[0.5] * 3, [2] * 3, [0.1] * 3])
        self.assertTrue(abs(values["sdf"] - [-0.5, 3**0.5, -0.1]).max() < 1e-15)
        empty = numpy.load(io.BytesIO(self.works("points %s - -o - --format npz" % CUBE, input=b"")))
        self.assertEqual((empty["points"].shape, empty["w"].shape), ((0, 3), (0,)))

    def test_archives_of_as_many_members_as_16_bits_count(self):
        """65535 is also what stands for more; then a ZIP64 record says how many."""
        for count in (65534, 65535, 65536):
            with zipfile.ZipFile("many.npz", "w") as archive:
                content = io.BytesIO()
                numpy.save(content, numpy.array([[0.5, 0.5, 0.5]]))
                archive.writestr("points.npy", content.getvalue())
                archive.filelist += [archive.filelist[0]] * (count - 1)
                archive._didModify = True  # so that its directory has them all
            self.assertEqual(self.works("points %s many.npz -o -" % CUBE), b"x,y,z,w\n0.5,0.5,0.5,1\n", count)

    def test_files_that_hold_no_points(self):
        numpy.savez("none.npz", other=numpy.zeros((2, 3)))
        self.refused("points %s none.npz" % CUBE, 2, "none.npz: has no array 'points'")
        numpy.savez("flat.npz", points=numpy.zeros(3))
        self.refused("points %s flat.npz" % CUBE, 2, "flat.npz: points.npy: NPY shape (3,), expected (n, 3 or more)")
        numpy.savez("nan.npz", points=numpy.full((2, 3), numpy.nan))
        self.refused("points %s nan.npz" % CUBE, 2, "expected a finite number")

    def test_points_on_the_surface_have_normals_and_faces(self):
        values = self.points(TEAPOT + " --sample uniform=2,surface=2e3,near=2:0.1 --field sdf,winding")
        off = numpy.r_[0:2, 2002:2004]
        on = slice(2, 2002)
        self.assertTrue((values["faces"][off] == -1).all() and (values["normals"][off] == 0).all())
        vertices, faces = [], []
        for line in read(TEAPOT).decode().splitlines():
            if line.startswith("v "):
                vertices.append([float(word) for word in line.split()[1:4]])
            if line.startswith("f "):
                faces.append([int(word.split("/")[0]) - 1 for word in line.split()[1:4]])
        corners = numpy.array(vertices)[numpy.array(faces)][values["faces"][on]]
        normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        self.assertTrue(abs(values["normals"][on] - normals).max() < 1e-9)  # of a difference of thin triangles
        height = ((values["points"][on] - corners[:, 0]) * normals).sum(axis=1)
        self.assertTrue(abs(height).max() < 1e-13)  # some units of the last place of coordinates up to 3
        self.assertTrue(abs(values["sdf"][on]).max() < 1e-13)
        fewer = self.points(TEAPOT + " --sample uniform=2,surface=1e3 --field sdf")
        self.assertTrue((fewer["points"] == values["points"][:1002]).all())
        self.refused("points %s --sample surface=1.5 -o a.npz" % CUBE, 1, "--sample surface=1.5: expected")

    def test_drawn_points_lie_where_32_bits_say(self):
        for dtype in ("f16", "f32"):
            values = self.points("%s --sample uniform=500,surface=50 --dtype %s" % (TEAPOT, dtype))
            self.assertEqual(values["points"].dtype, "f4")
            numpy.savez("given.npz", points=values["points"])
            again = self.points("%s given.npz --field winding,inside,sdf --dtype %s" % (TEAPOT, dtype))
            for name in ("w", "inside", "sdf"):
                self.assertTrue((values[name] == again[name]).all(), name)
        self.refused("points %s --sample uniform=5 -o a.npz --dtype f32 --scale 1e39" % CUBE, 4,
                     CUBE + ": points are too large for 32 bits")


class Meshes(DataSets):
    def test_normalize_moves_and_scales_and_says_how(self):
        original = json.loads(self.works("info %s --json" % TEAPOT))
        for kind, size in (("cube", 1), ("cube:3", 3), ("sphere:2", 2)):
            bounds = numpy.array(json.loads(self.works("info %s --json --normalize %s" % (TEAPOT, kind)))["bounds"])
            # Each is a difference times a factor, of half the size: of the two, both are rounded, and the middle is.
            rounding = 2.0**-53 * size
            self.assertTrue(abs(bounds.sum(axis=0)).max() <= 4 * rounding)
            if kind != "sphere:2":
                self.assertLess(abs((bounds[1] - bounds[0]).max() - size), 6 * rounding)  # the side and the factor, too
            values = self.points(TEAPOT + " --sample surface=2e3 --normalize " + kind)
            transform = values["transform"]
            moved = numpy.array(original["bounds"]) @ transform[:3, :3].T + transform[:3, 3]
            self.assertTrue(abs(moved - bounds).max() <= 4 * rounding)  # of the one way, and of the other
            if kind == "sphere:2":
                most = numpy.linalg.norm(values["points"], axis=1).max()
                self.assertTrue(0.9 < most <= 1 + 1e-15, most)
        self.works("slice %s -o a.png --size 8 --normalize cube --report r.json --scale 4 --up y-to-z" % CUBE)
        expected = [[1, 0, 0, -0.5], [0, 0, -1, 0.5], [0, 1, 0, -0.5], [0, 0, 0, 1]]
        self.assertEqual(read_json("r.json")["transform"], expected)

    def test_meshes_that_cannot_be_normalized(self):
        write("point.obj", "v 1 2 3\n" * 3 + "f 1 2 3\n")
        self.refused("info point.obj --normalize cube", 2, "all corners are at one point")
        write("huge.obj", "v -1.7e308 0 0\nv 1.7e308 0 0\nv 0 1 0\nf 1 2 3\n")
        self.refused("info huge.obj --normalize sphere", 4, "beyond what double precision can normalize")
        for value in ("cube:0", "cube:-1", "ball", "cube:", "sphere:x"):
            self.refused("info %s --normalize %s" % (CUBE, value), 1, "--normalize %s: expected" % value)

    def test_compressed_meshes_and_points(self):
        expected = self.works("info %s --json" % TEAPOT)
        write("a.obj.gz", gzip.compress(read(TEAPOT)))
        shutil.copy("a.obj.gz", "plain.obj")  # by content, whatever the name
        names = ["a.obj.gz", "plain.obj"]
        if shutil.which("zstd"):
            subprocess.run(["zstd", "-q", TEAPOT, "-o", "A.OBJ.ZST"], check=True)
            names.append("A.OBJ.ZST")
        for name in names:
            self.assertEqual(self.works("info %s --json" % name), expected, name)
            with open(name, "rb") as file:
                self.assertEqual(self.works("info - --mesh-format obj --json", stdin=file), expected, name)
        write("p.csv.gz", gzip.compress(b"x,y,z\n.5,.5,.5\n2,2,2\n"))
        self.assertEqual(self.works("points %s p.csv.gz" % CUBE), b"x,y,z,w\n0.5,0.5,0.5,1\n2,2,2,0\n")
        self.works("batch . --out-dir out --format npz --resolution 4")
        self.assertEqual(sorted(name for name in os.listdir("out") if name.endswith("npz")),
                         ["A.npz"] * (len(names) - 2) + ["a.npz", "plain.npz"])

    def test_bombs_are_stopped_by_the_memory_limit(self):
        with open("bomb.obj.gz", "wb") as file:
            with gzip.GzipFile(fileobj=file, mode="wb", compresslevel=1) as packed:
                for _ in range(48):
                    packed.write(b"\n" * (4 << 20))
        self.refused("info bomb.obj.gz --memory-limit 128M", 4, "out of memory, the limit is 128 MB")


if __name__ == "__main__":
    run_tests()
