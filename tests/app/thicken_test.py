"""raycone surface --thicken T: python3 thicken_test.py RAYCONE MESH_DIRECTORY

The oracles: distances of the surface's points from the mesh, as raycone measures distances to any mesh; the volumes of
boxes and plates that have grown, by Steiner's formula; and `info --require`.
"""

import json
import math

from command_case import SURFACE, CommandCase, mesh, numpy_or_skip, read, read_json, run, run_tests, write

numpy = numpy_or_skip()
CUBE, TEAPOT, MOEBIUS, SOUP = map(mesh, ("cube", "teapot", "moebius", "soup"))


class Thicken(CommandCase):
    def setUp(self):
        super().setUp()
        write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")

    def test_progress_makes_room_for_warnings(self):
        # Two plates, one of them thinner than a voxel.
        plates = "".join("v 0 0 %g\nv 2 0 %g\nv 2 2 %g\nv 0 2 %g\n" % (z, z, z, z) for z in (0.0, 1.0, 1.5, 1.501))
        for n in (0, 8):
            for face in ("4 3 2 1", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8"):
                plates += "f %s\n" % " ".join(str(int(corner) + n) for corner in face.split())
        write("plates.obj", plates)
        result = run("surface plates.obj -o a.ply --resolution 8 --progress always")
        self.assertEqual(result.returncode, 0)
        # Each write of a line begins by erasing the one before.
        lines = [line.rsplit(b"\x1b[K", 1)[-1] for line in result.stderr.splitlines()]
        self.assertTrue(any(line.startswith(b"raycone: warning: plates.obj: thin-parts: ") for line in lines), lines)

    def surface(self, words, output="a.ply"):
        """Its part of the report, and its volume."""
        self.works("surface %s -o %s --report report.json" % (words, output))
        self.works("info %s --require %s" % (output, SURFACE))
        surface = read_json("report.json")["surface"]
        return surface, json.loads(self.works("info %s --json" % output))["signed_volume"]

    def test_volumes_are_steiners(self):
        t = 0.15
        quarter, ball = math.pi * t * t / 4, 4 / 3 * math.pi * t**3
        expected = {"sheet.obj": 2 * t + 4 * 2 * quarter + ball, CUBE: 1 + 6 * t + 12 * quarter + ball}
        for mesh, volume in expected.items():
            # Chords of a rounded edge lose a part of (h / t)^2 / 12 of it; edges are a fifth of what is added.
            surface, got = self.surface("%s --thicken %r --resolution 24" % (mesh, t))
            self.assertLess(abs(got - volume), 0.005 * volume, mesh)
            self.assertAlmostEqual(surface["max_distance"], t, delta=1e-9)
            self.assertEqual((surface["hole_area"], surface["dropped_area"], surface["components"]), (0, 0, 1), mesh)

    def test_no_point_is_elsewhere(self):
        for mesh in (MOEBIUS, SOUP, TEAPOT + " --orient auto"):
            self.surface("%s --thicken .05 --resolution 20 --rule abs=1e9" % mesh)  # nothing but what is near
            data = read("a.ply")
            count = int(data.split(b"element vertex ")[1].split()[0])
            begin = data.index(b"end_header\n") + 11
            points = numpy.frombuffer(data[begin : begin + 24 * count]).reshape(-1, 3)
            numpy.save("points.npy", points)
            self.works("points %s points.npy -o distances.npy --field sdf" % mesh.split()[0])
            distances = abs(numpy.load("distances.npy"))
            # Roots are good to 2^-34 of an edge, and points keep off nodes by 2^-30 of it: edges are below 0.5.
            self.assertLess(abs(distances - 0.05).max(), 1e-9, mesh)

    def test_each_axis_grows_by_its_own_voxels(self):
        self.surface("sheet.obj --thicken .1 --voxel-size .05,.2,.01")
        lattice = read_json("report.json")["lattice"]
        # A layer around the sheet's box, [0, 1] x [0, 1] x 0, and what .1 takes.
        self.assertEqual(lattice["index_min"], [-3, -2, -11])
        self.assertEqual(lattice["index_max"], [23, 7, 11])

    def test_sheets_survive_that_do_not_without(self):
        words = "surface sheet.obj -o a.ply --resolution 7"
        self.assertEqual(run(words + " --rule abs=.6").returncode, 2)
        for t in ("1e-6", "1e-3", ".3"):
            surface, volume = self.surface("sheet.obj --resolution 7 --rule abs=.6 --thicken " + t)
            self.assertEqual(surface["components"], 1)
            self.assertGreater(volume, 0)

    def test_formats_scales_and_simplifying(self):
        self.surface(MOEBIUS + " --thicken .1 --resolution 16", "a.stl")
        self.surface(MOEBIUS + " --thicken 1e9 --scale 1e10 --resolution 16", "a.ply")
        self.surface(MOEBIUS + " --thicken 1e-11 --scale 1e-10 --resolution 16 --simplify 1e-12", "a.off")
        self.surface("sheet.obj --thicken .1 --voxel-size .0625 --padding 2v", "a.obj")
        self.surface("sheet.obj --thicken .1 --resolution 12,9,5 --bounds 0,0,-1,1,1,1", "a.obj")
        self.surface(CUBE + " --thicken 1e-300 --resolution 6")

    def test_the_same_for_any_threads(self):
        written = []
        for threads in ("1", "3"):
            self.surface("%s --resolution 16 --thicken .1 --threads %s" % (MOEBIUS, threads))
            written.append(read("a.ply"))
        self.assertEqual(*written)

    def test_what_is_no_thickness(self):
        for text in ("0", "-1", "nan", "1e999", "some"):
            result = run("surface sheet.obj -o a.ply --thicken " + text)
            self.assertEqual(result.returncode, 1, text)
            self.assertIn("--thicken %s: expected a positive number" % text, result.stderr.decode())
        result = run("surface sheet.obj -o a.ply --thicken 1e300")
        self.assertEqual(result.returncode, 4)
        self.assertIn("--thicken is more than a million voxels", result.stderr.decode())

    def test_layers_beyond_double_precision_name_the_file(self):
        write("huge.obj", "v -8.9e307 0 0\nv 8.9e307 0 0\nv 0 8.9e307 0\nv 0 0 8.9e307\n"
                          "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        for words in ("surface huge.obj -o a.ply --resolution 8",
                      "lattice huge.obj -o a.npy --field solid --dtype f64 --resolution 8"):
            result = run(words)
            self.assertEqual(result.returncode, 4)
            self.assertIn("huge.obj: the lattice is too large for double precision", result.stderr.decode())


run_tests()
