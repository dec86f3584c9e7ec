"""--field gradient in all formats and commands: python3 gradient_test.py RAYCONE MESH_DIRECTORY

The oracle: differences of the winding numbers that raycone prints itself, and the same numbers as CSV.
"""

import unittest

from command_case import CommandCase, mesh, numpy_or_skip, read, read_json, run_tests, write

numpy = numpy_or_skip()
try:
    import pyopenvdb
except ImportError:
    pyopenvdb = None

CUBE, OPEN_BOX = map(mesh, ("cube", "open_box"))
LATTICE = "lattice %s --resolution 6,5,4 --padding .3 --field gradient -o " % OPEN_BOX


def table(text):
    return numpy.atleast_1d(numpy.genfromtxt(text.decode().splitlines(), delimiter=",", names=True))


def vectors(rows):
    return numpy.stack([rows["gradient_" + axis] for axis in "xyz"], axis=-1)


class Gradient(CommandCase):
    def expected(self):
        """As CSV has them: shape (nx, ny, nz, 3)."""
        rows = table(self.works(LATTICE + "- --format csv"))
        self.assertEqual(rows.dtype.names[3:], ("x", "y", "z", "gradient_x", "gradient_y", "gradient_z"))
        return vectors(rows).reshape(4, 5, 6, 3).transpose(2, 1, 0, 3)

    def test_it_is_the_limit_of_differences(self):
        points = numpy.random.default_rng(5).uniform(-1, 2, (40, 3))
        step = 1e-4  # a sixth of its square, times third derivatives below 1e3, is what differences leave out
        probes = [points]
        for axis in range(3):
            probes += [points + step * numpy.eye(3)[axis], points - step * numpy.eye(3)[axis]]
        numpy.savetxt("points.txt", numpy.concatenate(probes), fmt="%.17g")
        rows = table(self.works("points %s points.txt --field winding,gradient --tolerance 0" % OPEN_BOX))
        w = rows["w"].reshape(7, -1)
        for axis in range(3):
            change = w[1 + 2 * axis] - w[2 + 2 * axis]
            slope = (change - numpy.round(change)) / (2 * step)  # but for jumps
            error = numpy.abs(slope - vectors(rows)[:40, axis])
            self.assertLess(error.max(), 2e-6)

    def test_of_a_closed_mesh_it_is_zero(self):
        rows = table(self.works("lattice %s --resolution 4 --field gradient -o - --format csv" % CUBE))
        self.assertFalse(vectors(rows).any())

    def test_arrays(self):
        expected = self.expected()
        for words, dtype in (("", "<f4"), (" --double", "<f8"), (" --dtype f16", "<f2")):
            self.works(LATTICE + "a.npy" + words)
            array = numpy.load("a.npy")
            self.assertEqual((array.shape, array.dtype.str), ((6, 5, 4, 3), dtype))
            lost = 2.0**-25  # half the least half, near zero
            # A rounding of so many bits.
            tolerance = {"<f8": 0, "<f4": 2.0**-24, "<f2": 2.0**-11}[dtype]
            self.assertTrue((abs(array - expected) <= tolerance * abs(expected) + lost * (dtype == "<f2")).all(), dtype)
        self.works(LATTICE.replace("gradient", "inside,gradient,winding") + "a.npz --double")
        archive = numpy.load("a.npz")
        self.assertEqual(archive["gradient"].shape, (6, 5, 4, 3))
        self.assertTrue((archive["gradient"] == expected).all())
        self.assertEqual(archive["w"].shape, archive["inside"].shape)

    def test_points(self):
        write("points.txt", ".5 .5 1\n.2 .3 .4\n2 2 2\n")
        rows = table(self.works("points %s points.txt --field winding,gradient" % OPEN_BOX))
        self.works("points %s points.txt --field winding,gradient -o a.npy" % OPEN_BOX)
        both = numpy.column_stack([rows["w"], vectors(rows)])
        self.assertTrue((numpy.load("a.npy") == both).all())
        self.works("points %s points.txt --field gradient -o a.npz" % OPEN_BOX)
        self.assertTrue((numpy.load("a.npz")["gradient"] == vectors(rows)).all())
        numpy.column_stack([rows["x"], rows["y"], rows["z"]]).astype("<f8").tofile("points.raw")
        raw = self.works("points %s points.raw --raw f64 --field winding,gradient -o -" % OPEN_BOX)
        self.assertTrue((numpy.frombuffer(raw).reshape(3, 4) == both).all())

    def test_vti(self):
        expected = self.expected().transpose(2, 1, 0, 3)
        self.works(LATTICE + "a.vti --double")
        text = read("a.vti")
        self.assertIn(b'<PointData Vectors="gradient">', text)
        self.assertIn(b'<DataArray type="Float64" Name="gradient" NumberOfComponents="3"', text)
        begin = text.index(b"raw\">\n   _") + 10 + 8
        values = numpy.frombuffer(text[begin : begin + expected.nbytes])
        self.assertTrue((values.reshape(expected.shape) == expected).all())
        self.assertEqual(int.from_bytes(text[begin - 8 : begin], "little"), expected.nbytes)

    @unittest.skipIf(pyopenvdb is None, "no pyopenvdb")
    def test_vdb(self):
        expected = self.expected()
        self.works(LATTICE + "a.vdb")
        grids, _ = pyopenvdb.readAll("a.vdb")
        self.assertEqual([(grid.name, type(grid).__name__) for grid in grids], [("gradient", "Vec3SGrid")])
        accessor = grids[0].getConstAccessor()
        for index in numpy.ndindex(6, 5, 4):
            self.assertEqual(accessor.getValue(index), tuple(expected[index].astype("<f4").tolist()))
        self.assertEqual(grids[0].background, (0.0, 0.0, 0.0))

    def test_it_is_verified(self):
        words = LATTICE + "a.csv --verify 50 --report report.json"
        self.works(words)
        verification = read_json("report.json")["verify"]
        self.assertEqual(verification["samples"], 50)
        self.assertLess(verification["largest_gradient_difference"], 1e-12)
        self.assertGreater(verification["largest_gradient_difference"], 0)

    def test_what_holds_numbers_only_refuses_it(self):
        for name in ("nrrd", "nii", "nii.gz"):
            self.refused(LATTICE + "a." + name, 1, "--field gradient: %s holds one number per sample" % name)
        self.refused(LATTICE + "a.csv --rule odd", 1, "--rule odd: has no effect on winding, density and gradient")
        self.refused("slice %s -o a.png --field gradient" % CUBE, 1, "--field gradient: expected winding, inside, sdf or label")

    def test_batches(self):
        self.works("batch %s --out-dir out --format npy --field gradient --resolution 6,5,4 --padding .3" % OPEN_BOX)
        self.works(LATTICE + "a.npy")
        self.assertTrue((numpy.load("out/open_box.npy") == numpy.load("a.npy")).all())


run_tests()
