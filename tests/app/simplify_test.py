"""raycone surface --simplify E: python3 simplify_test.py RAYCONE MESH_DIRECTORY

The oracle: distances between the surfaces with and without, both ways, at points drawn on them, as raycone measures
distances to any mesh (tests/core/distance_test.cpp has the oracle of those); and `info --require`.
"""

import subprocess

from command_case import RAYCONE, SURFACE, CommandCase, mesh, numpy_or_skip, read, read_json, run_tests

numpy = numpy_or_skip()
TEAPOT, CUBE, MOEBIUS = map(mesh, ("teapot", "cube", "moebius"))


class Simplify(CommandCase):
    def surface(self, words, output):
        """Its faces, and the spacing of the lattice."""
        self.works("surface %s -o %s --report report.json" % (words, output))
        self.works("info %s --require %s" % (output, SURFACE))
        report = read_json("report.json")
        return report["surface"]["faces"], report["lattice"]["spacing"][0]

    def farthest(self, of, to):
        """Of points on one mesh from another."""
        self.works("points %s --sample surface=4000 -o sample.npz --field winding" % of)
        points = numpy.load("sample.npz")["points"]
        numpy.save("points.npy", points)
        self.works("points %s points.npy -o distances.npy --field sdf" % to)
        return abs(numpy.load("distances.npy")).max()

    def test_no_point_moves_farther(self):
        for mesh in (TEAPOT + " --orient auto", MOEBIUS + " --orient auto"):
            words = mesh + " --resolution 13"
            all_faces, voxel = self.surface(words + " --simplify none", "none.ply")
            before, _ = self.surface(words, "0.ply")
            self.assertLess(before, all_faces)
            for voxels in (0.02, 0.2, 1.0):
                most = voxels * voxel
                faces, _ = self.surface(words + " --simplify %r" % most, "some.ply")
                self.assertLess(faces, before, voxels)
                before = faces
                for of, to in (("none.ply", "some.ply"), ("some.ply", "none.ply")):
                    self.assertLessEqual(self.farthest(of, to), most, (mesh, voxels))

    def test_single_precision_and_far_away(self):
        words = TEAPOT + " --orient auto --resolution 14 --simplify 0.05"
        self.surface(words, "a.stl")
        self.surface(words.replace("0.05", "5e8") + " --scale 1e10", "b.ply")
        self.surface(words.replace("0.05", "5e-12") + " --scale 1e-10", "c.obj")

    def test_what_is_too_little_changes_nothing(self):
        self.works("surface %s -o a.ply --resolution 12 --orient auto" % TEAPOT)
        for most in ("0", "-0", "1e-12", "1e-300"):
            self.works("surface %s -o b.ply --resolution 12 --orient auto --simplify %s" % (TEAPOT, most))
            self.assertEqual(read("a.ply"), read("b.ply"), most)

    def test_any_distance_leaves_a_solid(self):
        for most in ("0.3", "10", "1e300"):
            faces, _ = self.surface("%s --resolution 12 --simplify %s" % (CUBE, most), "a.ply")
            self.assertEqual(faces, 12)
            self.surface("%s --resolution 12 --orient auto --simplify %s" % (TEAPOT, most), "a.ply")

    def test_the_same_for_any_threads(self):
        written = []
        for threads in ("1", "3"):
            self.surface("%s --resolution 14 --orient auto --simplify 0.1 --threads %s" % (TEAPOT, threads), "a.ply")
            written.append(read("a.ply"))
        self.assertEqual(*written)

    def test_what_is_no_distance(self):
        for text in ("-1", "nan", "inf", "1e999", "some"):
            result = subprocess.run([RAYCONE, "surface", CUBE, "-o", "a.ply", "--simplify", text], capture_output=True)
            self.assertEqual(result.returncode, 1, text)
            self.assertIn("--simplify %s: expected none, 0 or a distance" % text, result.stderr.decode())


run_tests()
