"""Lattices whose axes point anywhere: python3 like_test.py RAYCONE MESH_DIRECTORY

--like takes the grid of a scan, which may be turned, mirrored, sheared and anisotropic. The oracles are positions by
numpy, values by `raycone points` there, and what other programs say of the files: nibabel and pyopenvdb, where they are
installed.
"""

import itertools
import json
import os
import shutil
import struct
import sys
import warnings
import xml.etree.ElementTree
import zipfile

from command_case import CommandCase, mesh, numpy_or_skip, read, read_json, run, run_tests, write

numpy = numpy_or_skip()
CUBE, TEAPOT, OPEN_BOX = map(mesh, ("cube", "teapot", "open_box"))


def rotation(seed):
    """Of no special angle."""
    matrix, _ = numpy.linalg.qr(numpy.random.default_rng(seed).normal(size=(3, 3)))
    return matrix * numpy.sign(numpy.linalg.det(matrix))


def places(origin, steps, first, counts):
    """Of all samples, i fastest: ((origin + i a) + j b) + k c, each product and sum rounded."""
    k, j, i = (n.ravel()[:, None].astype(float) for n in numpy.meshgrid(
        *(numpy.arange(f, f + c) for f, c in zip(first[::-1], counts[::-1])), indexing="ij"))
    return ((numpy.array(origin, float) + i * steps[0]) + j * steps[1]) + k * steps[2]


def write_points(name, points):
    write(name, "".join(",".join(repr(float(n)) for n in point) + "\n" for point in points))


def write_nrrd(name, origin, steps, counts, space="right-anterior-superior"):
    text = " ".join("(%s)" % ",".join(repr(float(n)) for n in step) for step in steps)
    write(name, "NRRD0005\ntype: uint8\ndimension: 3\nspace: %s\nsizes: %d %d %d\nspace directions: %s\n"
                "encoding: raw\nspace origin: (%s)\n\n"
                % (space, *counts, text, ",".join(repr(float(n)) for n in origin)))


SHEAR = numpy.array([[0.2, 0.05, 0], [-0.1, 0.3, 0.07], [0.02, 0, 0.25]])
TURNED = (("turned", 0.2 * rotation(1)), ("turned and mirrored", 0.2 * rotation(2) * [[1], [1], [-1]]),
          ("of three spacings", rotation(3) * [[0.1], [0.2], [0.4]]), ("sheared", SHEAR))
SIGNED_PERMUTATIONS = [numpy.eye(3)[list(order)] * numpy.array(signs)[:, None]
                       for order in itertools.permutations(range(3)) for signs in itertools.product((1, -1), repeat=3)]


class Like(CommandCase):
    def table(self, words):
        return numpy.array([line.split(b",") for line in self.works(words).split(b"\n")[1:-1]])

    def lattice_around(self, steps, counts=(9, 8, 7), middle=(0.5, 0.5, 0.5)):
        """A grid with these steps that has `middle` in its middle, as g.nrrd; its places."""
        origin = numpy.array(middle) - (numpy.array(counts) - 1) / 2 @ steps
        write_nrrd("g.nrrd", origin, steps, counts)
        return places(origin, steps, (0, 0, 0), counts)

    def expect_points(self, mesh, fields, points):
        """Both CSV files digit by digit: places and values."""
        got = self.table("lattice %s --like g.nrrd -o - --format csv %s" % (mesh, fields))
        write_points("p.csv", points)
        expected = self.table("points %s p.csv %s" % (mesh, fields))
        self.assertEqual(got.shape[0], expected.shape[0])
        self.assertTrue((got[:, 3:].astype(float) == expected.astype(float)).all())
        return got[:, 6:]


class Values(Like):
    def test_turned_lattices_have_the_values_of_points_there(self):
        fields = "--field winding,inside,density,gradient --diagnostics"
        for name, steps in TURNED:
            for mesh in (CUBE, OPEN_BOX):
                with self.subTest(name, mesh=os.path.basename(mesh)):
                    points = self.lattice_around(steps)
                    values = self.expect_points(mesh, fields, points)
                    if mesh == CUBE:  # the sign is right, mirrored or not
                        inside = ((points >= 0) & (points < 1)).all(1)
                        self.assertTrue((values[:, 1].astype(int) == inside).all())
                        self.assertGreater(inside.sum(), 10)

    def test_orders_and_directions_of_the_axes_do_not_matter(self):
        """The cube's faces are on samples: its lower ones are inside, its upper ones outside, in the world's axes."""
        self.assertEqual(len(SIGNED_PERMUTATIONS), 48)
        for n, steps in enumerate(SIGNED_PERMUTATIONS):
            points = self.lattice_around(steps * [0.25, 0.5, 0.125], (7, 6, 9), (0.5, 0.75, 0.375))
            mesh, fields = (CUBE, "--field inside") if n % 6 else (OPEN_BOX, "--field winding,inside --diagnostics")
            values = self.expect_points(mesh, fields, points)
            if mesh == CUBE:
                inside = ((points >= 0) & (points < 1)).all(1)
                self.assertTrue((values[:, 0].astype(int) == inside).all(), steps)
                self.assertGreater(inside.sum(), 5)

    def test_other_spaces_of_nrrd(self):
        steps = 0.2 * rotation(7)
        points = self.lattice_around(steps)
        head = read("g.nrrd").decode()
        expected = self.works("lattice %s --like g.nrrd -o - --format csv" % OPEN_BOX)
        for space, signs in (("LPS", (-1, -1, 1)), ("left-anterior-superior", (-1, 1, 1)), ("Scanner-XYZ", (1, 1, 1)),
                             ("3DRH", (1, 1, 1))):
            write_nrrd("g.nrrd", points[0] * signs, steps * signs, (9, 8, 7), space)
            self.assertEqual(self.works("lattice %s --like g.nrrd -o - --format csv" % OPEN_BOX), expected, space)
        write("g.nrrd", head.replace("space: right-anterior-superior", "Space Dimension: 3").replace("sizes", "SIZES"))
        self.assertEqual(self.works("lattice %s --like g.nrrd -o - --format csv" % OPEN_BOX), expected)
        # An axis of colours in front.
        write("g.nrrd", head.replace("dimension: 3", "dimension: 4").replace("sizes: 9", "sizes: 3 9")
                        .replace("directions: ", "directions: none "))
        self.assertEqual(self.works("lattice %s --like g.nrrd -o - --format csv" % OPEN_BOX), expected)
        # Nothing but distances.
        write("g.nrrd", "NRRD0001\ndimension: 3\nsizes: 3 4 5\nspacings: .5 .25 2\n\n")
        self.expect_points(OPEN_BOX, "", places((0, 0, 0), numpy.diag([0.5, 0.25, 2]), (0, 0, 0), (3, 4, 5)))

    def test_distances(self):
        """Cut off at the band, in the world's units."""
        points = self.lattice_around(0.125 * rotation(4), (17, 16, 15))
        write_points("p.csv", points)
        for mesh in (CUBE, OPEN_BOX):
            whole = self.table("points %s p.csv --field sdf" % mesh)[:, 3].astype(float)
            for band in ("2", "all"):
                got = self.table("lattice %s --like g.nrrd -o - --format csv --field sdf --band %s" % (mesh, band))
                got, limit = got[:, 6].astype(float), 0.25 if band == "2" else numpy.inf
                beyond = abs(whole) >= limit
                self.assertTrue((got == whole)[~beyond].all())
                # The length of a voxel is rounded.
                self.assertTrue((abs(got - numpy.copysign(limit, whole))[beyond] < 1e-15).all())
                self.assertEqual(beyond.sum() > 100, band == "2")
        remedy = "expected cubic ones (another --like)"
        for steps, message in ((SHEAR, "not at right angles"), (rotation(4) * [[1], [1], [2]], remedy)):
            self.lattice_around(steps)
            self.refused("lattice %s --like g.nrrd -o - --format csv --field sdf" % CUBE, 1, message)

    def test_verification_and_slabs(self):
        for steps in (TURNED[1][1] / 4, SIGNED_PERMUTATIONS[13] / 24):
            self.lattice_around(steps, (41, 37, 43))
            words = "lattice %s --like g.nrrd --field winding,inside,sdf " % OPEN_BOX
            self.works(words + "--verify 50 -o a.vdb --report r.json")
            report = read_json("r.json")
            self.assertEqual(report["verify"]["samples"], 50)
            self.assertLess(report["verify"]["largest_difference"], 1e-10)
            words += "-o b.npz "
            self.works(words + "--threads 1 --memory-limit 160M")
            first = read("b.npz")
            self.works(words + "--threads 3")
            self.assertEqual(read("b.npz"), first)

    def test_empty_is_told_where_the_grid_reaches_around_the_mesh(self):
        for steps in (TURNED[0][1], SIGNED_PERMUTATIONS[5] * 0.2):
            self.lattice_around(steps, (15, 15, 15))
            self.assertIn(b"no sample is inside", run("lattice %s --like g.nrrd -o a.nrrd --field inside --orient flip"
                                                      % CUBE).stderr)
            self.lattice_around(steps, (15, 15, 15), (2.5, 0, 0))  # half of the mesh is outside
            self.assertNotIn(b"no sample", run("lattice %s --like g.nrrd -o a.nrrd --field inside --orient flip"
                                               % CUBE).stderr)

    def test_surfaces_want_the_axes_of_the_world(self):
        self.lattice_around(SIGNED_PERMUTATIONS[30] * 0.13, (15, 15, 15))
        self.works("surface %s --like g.nrrd -o a.ply" % CUBE)
        self.lattice_around(TURNED[0][1], (15, 15, 15))
        self.refused("surface %s --like g.nrrd -o a.ply" % CUBE, 1, "axes are turned")


class Files(Like):
    """What is written says where the samples lie, to other programs, and to --like."""

    def setUp(self):
        super().setUp()
        self.counts = (5, 4, 3)

    def cases(self):
        for _, steps in (*TURNED, ("mirrored", numpy.diag([-0.25, 0.5, 0.125])),
                         ("permuted", SIGNED_PERMUTATIONS[22] * 0.25)):
            yield steps, self.lattice_around(steps, self.counts, (3.5, -2.25, 100))

    def like(self, name):
        """The places of the samples of a lattice like that of a file."""
        return self.table("lattice %s --like %s -o - --format csv" % (CUBE, name))[:, 3:6].astype(float)

    def test_nrrd_keeps_every_digit(self):
        for steps, points in self.cases():
            self.works("lattice %s --like g.nrrd -o a.nrrd" % CUBE)
            head = dict(line.split(": ", 1) for line in read("a.nrrd").split(b"\n\n")[0].decode().split("\n")
                        if ": " in line and not line.startswith("raycone"))
            numbers = lambda key: [float(n) for n in head[key].translate(str.maketrans("(),", "   ")).split()]
            self.assertEqual(numbers("space directions"), (steps + 0.0).ravel().tolist())
            self.assertEqual(numbers("space origin"), points[0].tolist())
            self.assertTrue((self.like("a.nrrd") == points).all())

    def test_heads_of_nrrd_may_have_many_labels(self):
        rows = ["v %d %d %d" % (i % 3, i % 5, i % 7) for i in range(12)]
        rows += ["g %d %s\nf %d %d %d" % (n, "x" * 240, *numpy.random.default_rng(n).choice(12, 3, False) + 1)
                 for n in range(3000)]
        write("many.obj", "\n".join(rows) + "\n")
        result = run("lattice many.obj --field label --parts group -o a.nrrd --resolution 3 --quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(read("a.nrrd").index(b"\n\n"), 1 << 20)
        self.assertIsNotNone(json.loads(self.works("info a.nrrd --json"))["lattice"])
        self.works("lattice %s --like a.nrrd -o b.nrrd" % CUBE)
        # A search from the start on for each block would take minutes.
        write("g.nrrd", b"NRRD0004\n" + b"# %s\n" % (b"x" * 64) * (1 << 20))
        self.refused("lattice %s --like g.nrrd -o b.nrrd" % CUBE, 2, "its head, expected an empty line within 64 MB")

    def test_nifti(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel in %s" % sys.executable)
        indices = places((0, 0, 0), numpy.eye(3), (0, 0, 0), self.counts)
        for steps, points in self.cases():
            for name in ("a.nii", "a.nii.gz"):
                self.works("lattice %s --like g.nrrd -o %s" % (CUBE, name))
                image = nibabel.load(name)
                # The matrix has 32 bits: 2^-24 of each entry, up to 100 here.
                for affine in (image.affine, image.get_sform()):
                    got = nibabel.affines.apply_affine(affine, indices)
                    self.assertLess(abs(got - points).max(), 1e-5)
                orthogonal = abs((steps @ steps.T)[~numpy.eye(3, dtype=bool)]).max() < 1e-9
                self.assertEqual(int(image.header["qform_code"]), orthogonal)
                if orthogonal:
                    got = nibabel.affines.apply_affine(image.get_qform(), indices)
                    self.assertLess(abs(got - points).max(), 1e-5)
                self.assertTrue(numpy.allclose(image.header.get_zooms(), numpy.linalg.norm(steps, axis=1), rtol=1e-6))
                # What is read back are these numbers of 32 bits: the same ones again.
                again = self.like(name)
                self.assertTrue((again == places(image.affine[:3, 3], image.affine[:3, :3].T, (0, 0, 0),
                                                 self.counts)).all())
            if orthogonal:  # the quaternion alone, as other programs leave it
                image.header["sform_code"] = 0
                only = nibabel.Nifti1Image(image.get_fdata(), None, image.header)
                nibabel.save(only, "q.nii")
                self.assertLess(abs(self.like("q.nii") - points).max(), 1e-5)

    def test_quaternions_of_right_angles_have_no_rounding(self):
        """Of 32 bits, as scanners leave them: the axes are the world's, so that all commands take them."""
        half = numpy.float32(numpy.sqrt(0.5))
        for quaternion in ((half, 0, 0), (0, -half, 0), (0, 0, half), (.5, .5, .5), (half, half, 0), (1, 0, 0)):
            for factor in (1, -1):
                head = bytearray(352)
                struct.pack_into("<i", head, 0, 348)
                struct.pack_into("<8h", head, 40, 3, 3, 4, 5, 1, 1, 1, 1)
                struct.pack_into("<2h", head, 70, 16, 32)
                struct.pack_into("<4f", head, 76, factor, .5, .75, .625)
                struct.pack_into("<f", head, 108, 352)
                struct.pack_into("<2h", head, 252, 1, 0)
                struct.pack_into("<6f", head, 256, *quaternion, -1, 2, -3)
                struct.pack_into("<4s", head, 344, b"n+1\0")
                write("q.nii", head + bytes(4 * 3 * 4 * 5))
                points = self.like("q.nii")
                self.assertEqual(len(numpy.unique(points, axis=0)), 3 * 4 * 5)
                self.assertTrue((points * 8 % 1 == 0).all(), quaternion)

    def test_nifti_close_to_half_turns(self):
        """What programs decode from the qform is where the sform has it, or there is none."""
        shown = []
        for counts in ((512, 512, 2), (2000, 3, 2)):
            for axis in ((0, 0, 1), (1, 2, 3)):
                for short in (0, 1e-5, 3e-4, 6e-4, 6.4e-4, 8e-4, 3e-3, 0.1):
                    x, y, z = axis / numpy.linalg.norm(axis)
                    cross, angle = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), numpy.pi - short
                    turn = numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross
                    vectors = " ".join("(%r,%r,%r)" % tuple(map(float, column)) for column in turn.T)
                    write("h.nrrd", "NRRD0004\ntype: float\ndimension: 3\nspace: RAS\nsizes: %d %d %d\n" % counts +
                                    "space directions: %s\nspace origin: (0,0,0)\nencoding: raw\n\n" % vectors)
                    self.works("lattice %s --like h.nrrd -o h.nii" % CUBE)
                    head = read("h.nii")
                    if struct.unpack_from("<h", head, 252)[0] == 0:
                        shown.append(0)
                        continue
                    b, c, d = map(float, struct.unpack_from("<3f", head, 256))
                    left = 1 - (b * b + c * c + d * d)  # as in nifti1_io.c
                    length = numpy.sqrt(b * b + c * c + d * d) if left < 1e-7 else 1.0
                    a, b, c, d = 0.0 if left < 1e-7 else numpy.sqrt(left), b / length, c / length, d / length
                    decoded = numpy.array([[a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                                           [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
                                           [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c]])
                    displaced = abs(decoded - turn) @ (numpy.array(counts) - 1)
                    self.assertLess(displaced.max(), 0.0625 + 1e-6, (counts, axis, short))  # 2000 roundings of a spacing of 1
                    shown.append(1)
        self.assertTrue(0 < sum(shown) < len(shown), shown)

    def test_npz(self):
        for steps, points in self.cases():
            self.works("lattice %s --like g.nrrd -o a.npz" % CUBE)
            a = numpy.load("a.npz")
            self.assertTrue(numpy.allclose(a["direction"] * a["spacing"], steps.T, rtol=1e-15, atol=1e-16))
            # Lengths and unit vectors are rounded: some units of the last place of the origin.
            self.assertLess(abs(self.like("a.npz") - points).max(), 1e-13)
            ours = self.like("a.npz")
            arrays = dict(a)
            # Saved by others: in columns, and again behind the first ones, as zip -u and zipfile's "a" do.
            numpy.savez("f.npz", **{**arrays, "direction": numpy.asfortranarray(arrays["direction"])})
            self.assertTrue((self.like("f.npz") == ours).all())
            numpy.savez("t.npz", **{**arrays, "origin": arrays["origin"] + 5.0})
            with zipfile.ZipFile("t.npz", "a") as twice, warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of the second one
                with zipfile.ZipFile("a.npz") as first:
                    twice.writestr("origin.npy", first.read("origin.npy"))
            self.assertTrue((self.like("t.npz") == ours).all())

    def test_npz_of_endless_text(self):
        self.works("lattice %s --resolution 3 -o a.npz" % CUBE)
        text = numpy.array("x" * (1 << 25))
        numpy.savez_compressed("long.npz", **{**dict(numpy.load("a.npz")), "raycone": text})
        facts = json.loads(self.works("info long.npz --json"))
        self.assertEqual(facts["lattice"], json.loads(self.works("info a.npz --json"))["lattice"])
        numpy.savez_compressed("long.npz", **{**dict(numpy.load("a.npz")), "origin": numpy.zeros(1 << 20)})
        self.refused("lattice %s --like long.npz -o b.npz" % CUBE, 2, "long.npz: origin.npy: ")

    def test_vti_and_report(self):
        indices = places((0, 0, 0), numpy.eye(3), (0, 0, 0), self.counts)
        for steps, points in self.cases():
            self.works("lattice %s --like g.nrrd -o a.vti --report r.json" % CUBE)
            text = read("a.vti").split(b"<AppendedData")[0] + b"</VTKFile>"
            image = xml.etree.ElementTree.fromstring(text).find("ImageData").attrib
            lattice = read_json("r.json")["lattice"]
            axes = [numpy.array([float(n) for n in image[key].split()]) for key in ("Origin", "Spacing", "Direction")]
            for origin, spacing, direction in ((*axes[:2], axes[2].reshape(3, 3)),
                                               (lattice["origin"], lattice["spacing"], lattice["direction"])):
                got = numpy.array(origin) + (indices * spacing) @ numpy.array(direction).T
                self.assertLess(abs(got - points).max(), 1e-13)
        self.works("lattice %s --resolution 3 -o a.vti --report r.json" % CUBE)
        self.assertNotIn(b"Direction", read("a.vti"))
        self.assertNotIn("direction", read_json("r.json")["lattice"])

    def test_vdb(self):
        for steps, points in self.cases():
            self.works("lattice %s --like g.nrrd -o a.vdb" % CUBE)
            self.assertTrue((self.like("a.vdb") == points).all())
            shutil.copyfile("a.vdb", "A.VDB")
            self.assertTrue((self.like("A.VDB:winding") == points).all())
            try:
                import pyopenvdb
            except ImportError:
                continue
            grid = pyopenvdb.read("a.vdb", "winding")
            i, j, k = 4, 1, 2
            place = grid.transform.indexToWorld((i, j, k))
            self.assertLess(abs(numpy.array(place) - points[(k * 4 + j) * 5 + i]).max(), 1e-12)

    def test_indices_of_vdb_need_not_begin_at_0(self):
        try:
            import pyopenvdb
        except ImportError:
            self.skipTest("no pyopenvdb in %s" % sys.executable)
        matrix = numpy.eye(4)
        matrix[:3, :3] = SHEAR
        matrix[3, :3] = (0.5, 0.25, 0)
        grid = pyopenvdb.FloatGrid()
        grid.transform = pyopenvdb.createLinearTransform(matrix.tolist())
        grid.fill((-3, 2, -1), (1, 4, 5), 1.0)
        grid.name = "g"
        pyopenvdb.write("in.vdb", grids=[grid])
        got = self.table("lattice %s --like in.vdb -o - --format csv" % CUBE)
        self.assertEqual(got[0, :3].tolist(), [b"-3", b"2", b"-1"])
        points = places(matrix[3, :3], SHEAR, (-3, 2, -1), (5, 3, 7))
        self.assertTrue((got[:, 3:6].astype(float) == points).all())

    def test_a_batch_follows_it_too(self):
        self.lattice_around(TURNED[0][1])
        os.mkdir("in")
        for name, mesh in (("a.obj", CUBE), ("b.obj", OPEN_BOX)):
            os.symlink(mesh, os.path.join("in", name))
        self.works("batch in --out-dir out --like g.nrrd --format nrrd --field inside")
        for name, mesh in (("a", CUBE), ("b", OPEN_BOX)):
            self.works("lattice %s --like g.nrrd -o one.nrrd --field inside" % mesh)
            one, other = (read(path).split(b"\n\n", 1)[1] for path in ("one.nrrd", "out/%s.nrrd" % name))
            self.assertEqual(one, other)

    def test_what_is_no_lattice_is_refused(self):
        for steps, message in ((numpy.zeros((3, 3)), "axes, expected three directions"),
                               ([[1, 0, 0], [0, 1, 0], [1, 1, 0]], "axes, expected three directions"),
                               ([[1e308, 0, 0], [0, 1, 0], [0, 0, 1]], "place, expected finite"),
                               ([[1, 2, 3], [2, 4, 6], [0, 0, 1]], "axes, expected three directions")):
            write_nrrd("g.nrrd", (0, 0, 0), steps, (4, 4, 4))
            self.refused("lattice %s --like g.nrrd -o a.vdb" % CUBE, 2, "g.nrrd: not a readable volume: its " + message)
        write_nrrd("g.nrrd", (0, 0, 0), rotation(5), (4, 4, 4), "LPS\nSpace: RAS")
        self.refused("lattice %s --like g.nrrd -o a.vdb" % CUBE, 2, 'its head has two fields "space"')
        write_nrrd("g.nrrd", (0, 0, 0), 1e-6 * rotation(5), (4, 4, 4))
        self.refused("lattice %s --like g.nrrd -o a.vdb" % CUBE, 3, "voxel volume 1e-18 is below 3e-15")
        self.works("lattice %s --like g.nrrd -o a.nrrd" % CUBE)


if __name__ == "__main__":
    run_tests()
