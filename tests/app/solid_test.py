"""--field solid: python3 solid_test.py RAYCONE MESH_DIRECTORY

The oracles: the file that `raycone surface` writes, with distances to it as raycone measures those to any mesh
(tests/core/distance_test.cpp has the oracle of these); and that a distance to one closed surface changes by no more
than one goes.
"""

import itertools
import math
import os

from command_case import CommandCase, mesh, numpy_or_skip, read, read_json, run, run_tests

numpy = numpy_or_skip()
CUBE, CUBES, OPEN_BOX, MOEBIUS, SOUP, TEAPOT = map(
    mesh, ("cube", "overlapping_cubes", "open_box", "moebius", "soup", "teapot"))


def largest_jump(values):
    """Of neighbours along axes and diagonals."""
    jump = 0.0
    for step in itertools.product((-1, 0, 1), repeat=3):
        here, there = (tuple(slice(max(s * d, 0), min(s * d, 0) or None) for d in step) for s in (1, -1))
        jump = max(jump, abs(values[here] - values[there]).max())
    return jump


class Solid(CommandCase):
    def lattice(self, words):
        """Its NPZ, with distances in 64 bits."""
        self.works("lattice %s -o out.npz --dtype f64" % words)
        return numpy.load("out.npz")

    def test_is_the_distance_to_the_surface_of_the_same_lattice(self):
        for options in (CUBE + " --resolution 9", CUBES + " --voxel-size 0.1", OPEN_BOX + " --resolution 8 --centers",
                        TEAPOT + " --orient auto --resolution 24", MOEBIUS + " --rule abs=.3 --resolution 16",
                        SOUP + " --rule abs=.4 --resolution 16", OPEN_BOX + " --rule threshold=.3 --padding .5",
                        TEAPOT + " --orient auto --bounds -4,-3,-1,4,3,4 --resolution 16"):
            self.works("surface %s -o surface.ply" % options)
            found = self.lattice(options + " --field inside,solid --band all")
            axes = (found["origin"][a] + (found["index_min"][a] + numpy.arange(found["solid"].shape[a])) *
                    found["spacing"][a] for a in range(3))
            numpy.save("nodes.npy", numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
            self.works("points surface.ply nodes.npy -o expected.npy --field sdf")
            expected = numpy.load("expected.npy").reshape(found["solid"].shape)
            # Both are sums and differences of the same coordinates. But the lattice of `solid` has more layers, which
            # changes how faces are numbered, and so along which diagonals the faces of a plane are cut when they are
            # merged; their corners are off that plane by up to the margin, of 2^-30 voxels.
            margin = 2.0**-30 * found["spacing"].max()
            self.assertLessEqual(abs(found["solid"] - expected).max(), margin + 1e-12 * abs(expected).max(), options)
            # Nodes may be on faces that are merged.
            off = found["solid"] != 0
            self.assertTrue(((found["solid"] < 0) == found["inside"])[off].all(), options)
            self.assertTrue(found["inside"].any(), options)

    def test_is_of_the_very_surface_where_samples_of_padding_are_asked_for(self):
        for options in (SOUP + " --resolution 34 --orient auto", OPEN_BOX + " --resolution 30 --orient auto"):
            reports = []
            for command in ("surface %s -o surface.ply", "lattice %s -o solid.npy --field solid"):
                self.works((command % options) + " --padding 2v --report report.json")
                reports.append(read_json("report.json")["surface"])
            self.assertEqual(*reports)

    def test_is_continuous_across_holes(self):
        for options in (OPEN_BOX + " --resolution 20", OPEN_BOX + " --resolution 16",
                        MOEBIUS + " --rule abs=.3 --resolution 24"):
            found = self.lattice(options + " --field sdf,solid --band all")
            voxel = found["spacing"][0]
            # Neighbours are sqrt(3) voxels apart at most.
            self.assertLessEqual(largest_jump(found["solid"]), 1.7321 * voxel, options)
            self.assertGreater(largest_jump(found["sdf"]), 1.8 * voxel, options)

    def test_knows_no_walls_within(self):
        found = self.lattice(CUBES + " --voxel-size 0.25 --field sdf,solid --band all")
        self.assertLess(found["solid"].min(), found["sdf"].min() - 0.2)

    def test_bands_and_rooms_are_those_of_sdf(self):
        words = OPEN_BOX + " --resolution 9 --field sdf,solid"
        for band in (3, 1.5):
            found = self.lattice(words + " --band %r" % band)
            self.assertEqual(found["solid"].shape, (9 + 2 * math.ceil(band + 1),) * 3)
            for sign in (1, -1):
                self.assertEqual((sign * found["solid"]).max(), band / 8)
        self.assertEqual(self.lattice(words + " --padding 1v")["solid"].shape, (11,) * 3)
        wide = self.lattice(words + " --band all")["solid"]
        band = self.lattice(words)["solid"]
        self.assertTrue((band == numpy.clip(wide, -3 / 8, 3 / 8)).all())

    def test_bytes_depend_neither_on_threads_nor_on_who_asks(self):
        os.mkdir("meshes")
        for name in (OPEN_BOX, TEAPOT):
            os.symlink(name, os.path.join("meshes", os.path.basename(name)))
        options = "--field solid,inside --resolution 12 --orient auto"
        self.works("batch meshes --out-dir out --threads 2 " + options)
        for name in ("open_box", "teapot"):
            for threads in (1, 3):
                self.works("lattice meshes/%s.obj -o %s.vdb --threads %d %s" % (name, name, threads, options))
                self.assertEqual(read(name + ".vdb"), read("out/%s.vdb" % name), (name, threads))

    def test_every_format_has_it(self):
        for ending in ("csv", "npy", "vti", "nrrd", "nii", "nii.gz", "vdb"):
            self.works("lattice %s -o a.%s --field solid --resolution 6" % (OPEN_BOX, ending))
        self.assertTrue(read("a.csv").startswith(b"i,j,k,x,y,z,solid\n"))

    def test_is_verified_and_reported(self):
        words = " -o a.npz --resolution 9 --field sdf,solid --verify 100 --report report.json"
        for mesh in (OPEN_BOX, CUBE):
            self.works("lattice " + mesh + words)
            report = read_json("report.json")
            self.assertEqual(report["verify"]["samples"], 100)
            self.assertLess(report["verify"]["largest_distance_difference"], 1e-12)
            self.works("surface %s -o a.ply --resolution 9 --report report.json" % mesh)
            self.assertEqual(report["surface"], read_json("report.json")["surface"])
        self.assertLess(abs(report["surface"]["hole_area"]), 1e-12)

    def test_what_has_no_surface_is_refused(self):
        for mesh, options, status, reason in (
                (SOUP, "--resolution 5", 2, "no sample is inside by the rule threshold=0.5"),
                (CUBE, "--resolution 5 --orient flip", 2, "no sample is inside by the rule threshold=0.5: reversed faces (--orient auto), or"),
                (CUBE, "--resolution 5 --rule threshold=-.5", 2, "a larger box (--padding P), faces that agree (--orient auto)"),
                (CUBE, "--resolution 5 --rule threshold=-.5 --orient auto", 2, "a larger box (--padding P), or another"),
                (CUBE, "--resolution 9 --bounds 0,0,0,1,1,.5", 2, "reaches the border of the lattice"),
                (CUBE, "--resolution 5,6,7", 1, "--field solid: voxels of 0.25 x 0.2 x 0.166666667, expected cubic ones"),
                (CUBE, "--resolution 9 --memory-limit 1", 4, "memory")):
            self.refused("lattice %s -o a.vdb --field solid %s --quiet" % (mesh, options), status, reason)
            self.assertFalse(os.path.exists("a.vdb"))
        self.assertEqual(run("batch %s %s --out-dir out --field solid --resolution 5" % (SOUP, CUBE)).returncode, 5)
        self.assertIn(b",invalid,2,", read("out/results.csv"))

    def test_points_and_slices_have_none(self):
        reason = "--field solid: is the distance to a surface between samples of a lattice, expected raycone lattice"
        for words in ("points %s - --field solid", "points %s --sample uniform=5 -o a.npz --field winding,solid",
                      "slice %s -o a.png --field solid", "batch %s --out-dir a --sample uniform=5 --field solid"):
            self.refused(words % CUBE, 1, reason)
            self.assertNotIn(b"solid", run(words.split()[0] + " --help").stdout if "batch" not in words else b"")


run_tests()
