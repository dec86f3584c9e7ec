"""Files in the programs they are for: /usr/bin/python3 clients_test.py RAYCONE MESHES
[Blender|Numpy|ParaView|Pyopenvdb]

Each client opens what raycone wrote; what it then sees is compared with the CSV and the report of the same job. That the
comparison can fail is seen on another mesh's file. Exit status 77 where a client is not installed, which is printed.
"""

import csv
import importlib.util
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

RAYCONE, MESHES = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
HERE = os.path.dirname(os.path.abspath(__file__))
FIELDS = ["winding", "inside", "sdf", "density"]
COLUMNS = dict(zip(FIELDS, ["w", "inside", "sdf", "density"]))
# Cubic voxels for sdf, another count along each axis, an origin that is not 0 and indices that begin below 0.
BOX = ["--bounds=-3,-2,0.5,3,2,3", "--padding", "3v", "--resolution", "21"]
LATTICE = [*BOX, "--field", ",".join(FIELDS)]
# Coordinates are below 4; origin + index * spacing, which other programs round in another order.
ROUNDING = 4 * math.ulp(4.0)


def has_module(name):
    return importlib.util.find_spec(name) is not None


def output_of(*command):
    result = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert result.returncode == 0, (command, result.returncode, result.stdout, result.stderr)
    return result.stdout


def json_from(*command):
    """The line of JSON among what the command prints: Blender greets and takes its leave."""
    return json.loads(next(line for line in output_of(*command).splitlines() if line.startswith("{")))


def table_of(command, mesh, *options):
    """The rows of the CSV, numbers as such."""
    lines = output_of(RAYCONE, command, os.path.join(MESHES, mesh), "-o", "-", *options, "--quiet").splitlines()
    return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]


def index_of(row):
    return tuple(int(row[name]) for name in "ijk")


def as_float(value):
    return struct.unpack("f", struct.pack("f", value))[0]


class Client(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.directory.cleanup)

    @classmethod
    def write(cls, command, mesh, name, *options):
        """The path of the new file `name`, and the lattice in its report."""
        path = os.path.join(cls.directory.name, name)
        mesh = os.path.join(MESHES, mesh)
        output_of(RAYCONE, command, mesh, "-o", path, *options, "--report", path + ".json", "--quiet")
        with open(path + ".json", encoding="utf-8") as report:
            return path, json.load(report)["lattice"]

    def assert_value(self, actual, expected, *where):
        if actual != expected:  # assertEqual takes its time
            self.fail(f"value {actual}, in the CSV {expected}: {where}")

    def assert_close(self, actual, expected, tolerance):
        for pair in zip(actual, expected, strict=True):
            self.assertLessEqual(abs(pair[0] - pair[1]), tolerance, (actual, expected))

    def assert_another_mesh_differs(self, compare, *file):
        with self.assertRaisesRegex(AssertionError, "in the CSV"):
            compare(*file, table_of("lattice", "swiss_roll.obj", *LATTICE))


@unittest.skipUnless(has_module("pyopenvdb"), "no pyopenvdb: apt-get install python3-openvdb")
class Pyopenvdb(Client):
    def compare(self, path, lattice, table):
        import pyopenvdb

        grids = {grid.name: grid for grid in pyopenvdb.readAll(path)[0]}
        self.assertEqual(
            {name: (type(grid).__name__, grid.gridClass) for name, grid in grids.items()},
            {
                "winding": ("FloatGrid", pyopenvdb.GridClass.UNKNOWN),
                "inside": ("BoolGrid", pyopenvdb.GridClass.UNKNOWN),
                "surface": ("FloatGrid", pyopenvdb.GridClass.LEVEL_SET),
                "density": ("FloatGrid", pyopenvdb.GridClass.FOG_VOLUME),
            },
        )
        for field in FIELDS:
            grid = grids["surface" if field == "sdf" else field]
            self.assertEqual(grid.metadata["raycone_index_min"], tuple(lattice["index_min"]))
            self.assertEqual(grid.metadata["raycone_index_max"], tuple(lattice["index_max"]))
            values = grid.getConstAccessor()
            for row in table:
                index = index_of(row)
                expected = as_float(row[COLUMNS[field]])
                if field == "sdf" and not values.isValueOn(index):  # cut off, the band's width being rounded up
                    self.assertLessEqual(abs(abs(expected) - grid.background), math.ulp(grid.background) * 2**29)
                    expected = math.copysign(grid.background, expected)
                self.assert_value(values.getValue(index), expected, field, index)
                self.assert_close(grid.transform.indexToWorld(index), [row[axis] for axis in "xyz"], ROUNDING)

    def test_grids_hold_the_fields_of_the_csv(self):
        file = self.write("lattice", "teapot.obj", "out.vdb", *LATTICE)
        self.compare(*file, table_of("lattice", "teapot.obj", *LATTICE))
        self.assert_another_mesh_differs(self.compare, *file)


@unittest.skipUnless(has_module("numpy"), "no numpy: apt-get install python3-numpy")
class Numpy(Client):
    def compare_lattice(self, path, lattice, table):
        import numpy

        array = numpy.load(path)
        first, last = (numpy.array(lattice[name]) for name in ("index_min", "index_max"))
        self.assertEqual(array.shape, tuple(last - first + 1))
        self.assertEqual(array.size, len(table))
        index = numpy.array([index_of(row) for row in table])
        for row, value in zip(table, array[tuple((index - first).T)], strict=True):
            self.assert_value(value, row["w"], index_of(row))
        positions = lattice["origin"] + index * lattice["spacing"]
        expected = numpy.array([[row[axis] for axis in "xyz"] for row in table])
        self.assertLessEqual(abs(positions - expected).max(), ROUNDING)

    def compare_samples(self, path, _, table):
        import numpy

        with numpy.load(path) as arrays:
            self.assertEqual(set(arrays.files), {"points", "w", "inside", "sdf", "transform", "raycone"})
            lengths = {name: len(arrays[name]) for name in ("points", "w", "inside", "sdf")}
            self.assertEqual(lengths, dict.fromkeys(lengths, len(table)))
            for number, row in enumerate(table):
                seen = [*arrays["points"][number], *(arrays[name][number] for name in ("w", "inside", "sdf"))]
                self.assert_value(seen, list(row.values()), number)

    def test_lattice_is_indexed_as_the_report_says(self):
        file = self.write("lattice", "teapot.obj", "out.npy", *BOX, "--double")
        self.compare_lattice(*file, table_of("lattice", "teapot.obj", *LATTICE))
        self.assert_another_mesh_differs(self.compare_lattice, *file)

    def test_samples_are_those_of_the_csv(self):
        options = ["--sample", "uniform=300,near=200:0.02"]
        file = self.write("points", "teapot.obj", "out.npz", *options)
        self.compare_samples(*file, table_of("points", "teapot.obj", *options))
        with self.assertRaisesRegex(AssertionError, "in the CSV"):
            self.compare_samples(*file, table_of("points", "swiss_roll.obj", *options))


@unittest.skipUnless(has_module("paraview"), "no ParaView: apt-get install python3-paraview")
class ParaView(Client):
    def compare(self, image, lattice, table):
        first, last = lattice["index_min"], lattice["index_max"]
        self.assertEqual(image["extent"], [bound for pair in zip(first, last) for bound in pair])
        self.assertEqual(image["origin"], lattice["origin"])
        self.assertEqual(image["spacing"], lattice["spacing"])
        box = [choose(row[axis] for row in table) for axis in "xyz" for choose in (min, max)]
        self.assert_close(image["bounds"], box, ROUNDING)
        self.assertEqual(image["types"], {**dict.fromkeys(FIELDS, "float"), "inside": "unsigned char"})
        counts = [high - low + 1 for low, high in zip(first, last)]
        for field in FIELDS:
            values = image["values"][field]
            self.assertEqual(len(values), len(table))
            for row in table:
                i, j, k = (at - low for at, low in zip(index_of(row), first))
                value = values[i + counts[0] * (j + counts[1] * k)]  # VTK's numbering of points
                self.assert_value(value, as_float(row[COLUMNS[field]]), field, index_of(row))

    def test_arrays_hold_the_fields_of_the_csv(self):
        path, lattice = self.write("lattice", "teapot.obj", "out.vti", *LATTICE)
        image = json_from(sys.executable, os.path.join(HERE, "paraview_read.py"), path)[path]
        self.compare(image, lattice, table_of("lattice", "teapot.obj", *LATTICE))
        self.assert_another_mesh_differs(self.compare, image, lattice)


@unittest.skipUnless(shutil.which("blender"), "no Blender: apt-get install blender")
class Blender(Client):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # Blender's box is that of OpenVDB's leaves, 8 samples long.
        options = ["--field", "winding,inside", "--resolution", "24,16,8"]
        cls.teapot = cls.write("lattice", "teapot.obj", "teapot.vdb", *options)
        cls.turned = cls.write("lattice", "teapot.obj", "turned.vdb", *options, "--up", "y-to-z")
        cls.other = cls.write("lattice", "swiss_roll.obj", "other.vdb", *options)
        cls.mesh = os.path.join(MESHES, "teapot.obj")
        cls.marked = [os.path.join(cls.directory.name, name) for name in ("teapot.ply", "swiss_roll.ply")]
        for path in cls.marked:
            mesh = os.path.join(MESHES, os.path.basename(path).replace(".ply", ".obj"))
            output_of(RAYCONE, "info", mesh, "--mark", path, "--quiet")
        cls.seen = json_from(
            *("blender", "-b", "--factory-startup", "-noaudio", "-P", os.path.join(HERE, "blender_import.py"), "--"),
            *(cls.teapot[0], cls.turned[0], cls.other[0], cls.mesh, *cls.marked),
        )

    def compare(self, path, lattice, voxels):
        """The box that Blender sees, with that of the lattice."""
        for corner, name in zip(self.seen[path]["box"], ("index_min", "index_max"), strict=True):
            for axis in range(3):
                spacing = lattice["spacing"][axis]
                expected = lattice["origin"][axis] + lattice[name][axis] * spacing
                self.assertLessEqual(abs(corner[axis] - expected), voxels * spacing, f"{name} of axis {axis}")

    def test_volumes_have_their_grids(self):
        for path, _ in (self.teapot, self.turned, self.other):
            self.assertEqual(self.seen[path]["grids"], {"winding": "FLOAT", "inside": "BOOLEAN"})

    def test_volumes_are_where_the_lattices_are(self):
        # Versions of Blender differ in whether half a voxel around the samples belongs to the box.
        self.compare(*self.teapot, voxels=1)
        self.compare(*self.turned, voxels=1)
        for mistaken in (self.other, self.turned):
            with self.assertRaisesRegex(AssertionError, "of axis"):
                self.compare(mistaken[0], self.teapot[1], voxels=1)

    def test_a_turned_volume_lies_over_the_mesh_that_blender_imports(self):
        # The lattice spans the mesh's box; Blender rounds to single precision.
        self.compare(self.mesh, self.turned[1], voxels=1e-4)
        with self.assertRaisesRegex(AssertionError, "of axis"):
            self.compare(self.mesh, self.teapot[1], voxels=1e-4)

    def test_marked_meshes_have_their_colours(self):
        marks = []
        for path in self.marked:
            with open(path, "rb") as file:
                header, _, rest = file.read().partition(b"end_header\n")
            counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
            faces = rest[27 * counts[0] : 27 * counts[0] + 16 * counts[1]]  # a vertex is 27 bytes, a face 16
            names = [" ".join(map(str, faces[n + 13 : n + 16])) for n in range(0, len(faces), 16)]
            marks.append({name: 3 * names.count(name) for name in set(names)})
            self.assertEqual(self.seen[path]["colours"], marks[-1])
        self.assertGreater(len(marks[0]), 1)  # not only grey
        self.assertNotEqual(*marks)


if __name__ == "__main__":
    outcome = unittest.main(exit=False).result
    for absent in sorted({reason for _, reason in outcome.skipped}):
        print(f"skipped: {absent}")
    sys.exit(1 if not outcome.wasSuccessful() else 77 if outcome.skipped else 0)
