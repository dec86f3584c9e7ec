"""Labels of parts: python3 labels_test.py RAYCONE MESH_DIRECTORY [SHARED_MESHES]

The oracle: each part as a file of its own, evaluated alone with --field inside on the same lattice, put together by
numpy.
"""

import base64
import gzip
import json
import os
import struct
import sys

from command_case import CommandCase, numpy_or_skip, read, read_json, run_tests, write

numpy = numpy_or_skip()
SHARED = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
BOX = " --bounds -.25,-.25,-.25,3.25,1.75,1.75 --resolution 15,9,9"


def box(corner, size=1.0, flipped=False, lid=True):
    """Vertices and quads of a cube, outward unless flipped; without lid it is open."""
    vertices = [[corner[a] + size * c[a] for a in range(3)] for c in ((x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1))]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    quads = quads if lid else quads[:-1]
    return vertices, [quad[::-1] if flipped else quad for quad in quads]


def obj(parts):
    """Of {name: (vertices, quads)}; a name is a group, or lines as they are."""
    text, before = "", 1
    for name, (vertices, quads) in parts.items():
        text += "".join("v %r %r %r\n" % tuple(v) for v in vertices)
        text += name if "\n" in name else "g %s\n" % name if name else ""
        text += "".join("f %d %d %d %d\n" % tuple(before + i for i in quad) for quad in quads)
        before += len(vertices)
    return text


def stl(parts):
    text = ""
    for name, (vertices, quads) in parts.items():
        text += "solid %s\n" % name
        for a, b, c, d in quads:
            for corners in ((a, b, c), (a, c, d)):
                text += "facet normal 0 0 0\nouter loop\n"
                text += "".join("vertex %r %r %r\n" % tuple(vertices[i]) for i in corners)
                text += "endloop\nendfacet\n"
        text += "endsolid %s\n" % name
    return text


def gltf(parts):
    """One mesh for each; the last one is shown by two nodes."""
    data = b""
    accessors, views, meshes, nodes = [], [], [], []

    def accessor(content, component, kind, count):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content)})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "type": kind, "count": count})
        data += content
        return len(accessors) - 1

    for name, (vertices, quads) in parts.items():
        corners = [i for a, b, c, d in quads for i in (a, b, c, a, c, d)]
        position = accessor(struct.pack("<%df" % (3 * len(vertices)), *sum(vertices, [])), 5126, "VEC3", len(vertices))
        index = accessor(struct.pack("<%dI" % len(corners), *corners), 5125, "SCALAR", len(corners))
        meshes.append({"name": name, "primitives": [{"attributes": {"POSITION": position}, "indices": index}]})
        nodes.append({"mesh": len(meshes) - 1})
    meshes[0]["name"] = 5  # no string: no name
    nodes.append({"mesh": len(meshes) - 1, "translation": [0, 0, 0.5]})
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": len(data)}],
                       "bufferViews": views, "accessors": accessors, "meshes": meshes, "nodes": nodes,
                       "scenes": [{"nodes": list(range(len(nodes)))}]})


PARTS = {"left lobe": box((0, 0, 0)), "right": box((0.5, 0.5, 0.5)), "open": box((2, 0, 0), lid=False),
         "turned": box((1.25, 0.125, 0.125), 0.75, flipped=True)}


class Labels(CommandCase):
    def setUp(self):
        super().setUp()
        for name, part in PARTS.items():
            write(name.replace(" ", "_") + ".obj", obj({"": part}))
        self.files = " ".join(name.replace(" ", "_") + ".obj" for name in PARTS)
        write("groups.obj", obj(PARTS))

    def lattice(self, words, options="", place=BOX):
        self.works("lattice %s -o labels.npy --field label%s%s" % (words, place, options))
        return numpy.load("labels.npy")

    def single_jobs(self, files, options="", place=BOX):
        """What is inside of each file."""
        arrays = []
        for name in files.split():
            self.works("lattice %s -o single.npy --field inside%s%s" % (name, place, options))
            arrays.append(numpy.load("single.npy"))
        return arrays


def labels_of(arrays, first=False):
    """Label by label, of the last array, or the first one, that holds a sample."""
    labels = numpy.zeros(arrays[0].shape, "i4")
    for number, inside in enumerate(arrays, 1):
        labels[inside & (labels == 0) if first else inside] = number
    return labels


class Values(Labels):
    def test_files_are_what_single_jobs_say(self):
        for options in ("", " --rule abs=0.5", " --rule nonzero", " --orient auto", " --rule threshold=0.25",
                        " --rule threshold=-0.5", " --scale 1.5 --up y-to-z", " --weld 0.01", " --tolerance 0"):
            arrays = self.single_jobs(self.files, options)
            for first in (False, True):
                expected = labels_of(arrays, first)
                labels = self.lattice(self.files, options + (" --priority" if first else ""))
                self.assertEqual(labels.dtype, numpy.int32)
                self.assertTrue((labels == expected).all(), (options, first))
            if options == " --orient auto":
                self.assertEqual(sorted(numpy.unique(labels)), [0, 1, 2, 3, 4])
        # A fine lattice has samples just within all faces.
        for place in (" --bounds -.25,.3,.3,3.25,1.7,1.7 --resolution 701,3,3",
                      " --bounds .3,.3,-.25,2.7,1.7,1.75 --resolution 5,3,401"):
            expected = labels_of(self.single_jobs(self.files, place=place))
            self.assertTrue((self.lattice(self.files, "", place) == expected).all())
        # Overlap is there, and decides.
        self.assertFalse((self.lattice(self.files) == self.lattice(self.files, " --priority")).all())

    def test_components_and_groups_are_what_files_are(self):
        expected = self.lattice(self.files, " --orient auto")
        write("solids.stl", stl(PARTS))
        for name, by in (("groups.obj", "group"), ("groups.obj", "component"), ("solids.stl", "group"),
                         ("solids.stl", "component")):
            labels = self.lattice(name, " --parts %s --orient auto" % by)
            self.assertTrue((labels == expected).all(), (name, by))

    def test_polygons_that_become_fewer_triangles_move_the_groups_behind_them(self):
        # An outline with a spike, of six corners, is two triangles; before it and behind it are groups, too.
        write("s.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 2 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 0 1 5\n"
                   "g before\nf 6 7 8\ng spike\nf 1 2 3 4 3 5\ng behind\nf 6 7 8\nf 8 7 6\nf 6 7 1\n")
        self.works("lattice s.obj -o s.csv --field label --parts group --resolution 2 --report r.json")
        self.assertEqual([part["faces"] for part in read_json("r.json")["parts"]], [1, 2, 3])

    def test_meshes_of_gltf(self):
        write("m.gltf", gltf({"a": box((0, 0, 0)), "b": box((1.5, 0, 0))}))
        twice = box((1.5, 0, 0))
        shifted = ([[x, y, z + 0.5] for x, y, z in twice[0]], [tuple(i + 8 for i in quad) for quad in twice[1]])
        write("b.obj", obj({"": (twice[0] + shifted[0], list(twice[1]) + list(shifted[1]))}))
        write("a.obj", obj({"": box((0, 0, 0))}))
        labels = self.lattice("m.gltf", " --parts group --report r.json")
        self.assertTrue((labels == labels_of(self.single_jobs("a.obj b.obj"))).all())
        self.assertEqual([part["name"] for part in read_json("r.json")["parts"]], ["part 1", "b"])

    def test_more_parts_than_a_byte_holds(self):
        parts = {str(n): box((n % 20 / 10, n // 20 / 10, 0), 0.1) for n in range(300)}
        write("many.obj", obj(parts))
        place = " --resolution 20,15,1 --centers"
        labels = self.lattice("many.obj", " --parts group", place)
        self.assertTrue((labels[:, :, 0] == 1 + numpy.arange(300).reshape(15, 20).T).all())
        # Points of many parts are sorted first; some lie on the faces between parts.
        x, y = numpy.meshgrid(numpy.arange(41) / 20, numpy.arange(31) / 20, indexing="ij")
        points = numpy.stack([x.ravel(), y.ravel(), numpy.full(x.size, 0.05)], axis=1)[::-1]
        numpy.save("p.npy", points)
        self.works("points many.obj p.npy -o v.npy --field label --parts group --verify 100")
        self.works("points many.obj p.npy -o w.npy --field inside")
        self.assertTrue(((numpy.load("v.npy") > 0) == (numpy.load("w.npy") > 0)).all())
        names = numpy.load("v.npy")
        centres = (points[:, 0] * 20 % 2 == 1) & (points[:, 1] * 20 % 2 == 1)
        cells = numpy.floor(points[centres] * 10 + 1e-9)
        self.assertTrue((names[centres] == 1 + cells[:, 0] + 20 * cells[:, 1]).all() and centres.sum() == 300)

    def test_points_are_what_lattices_are(self):
        index = numpy.indices((15, 9, 9)).reshape(3, -1).T
        points = numpy.array([-0.25] * 3) + index * 0.25
        numpy.save("p.npy", points)
        write("p.csv", "".join("%r,%r,%r\n" % tuple(p) for p in points.tolist()))
        for options in ("", " --priority", " --rule threshold=-0.5"):
            expected = self.lattice(self.files, options, " --bounds -.25,-.25,-.25,3.25,1.75,1.75 --resolution 15,9,9")
            self.works("points %s p.npy -o v.npy --field label --verify 20%s" % (self.files, options))
            labels = numpy.load("v.npy")
            self.assertEqual(labels.dtype, numpy.int32)
            self.assertTrue((labels.reshape(15, 9, 9) == expected).all(), options)
        text = self.works("points %s - --field label" % self.files, input=read("p.csv")).decode()
        self.assertTrue((numpy.array([row.split(",")[3] for row in text.split()[1:]], "i4") ==
                         self.lattice(self.files).ravel()).all())
        self.works("points %s p.npy -o both.npy --field label,winding" % self.files)
        self.assertTrue((numpy.load("both.npy")[:, 0] == self.lattice(self.files).ravel()).all())

    def test_slices_are_what_single_jobs_say(self):
        for plane in ("--axis z --at 0.45", "--normal 1,2,3 --origin 1,1,.5"):
            place = plane + " --bounds -.25,-.25,-.25,3.25,1.75,1.75 --size 60 --values s.npy -o s.png"
            for options in ("", " --priority", " --orient auto --rule nonzero"):
                self.works("slice %s --field label %s%s" % (self.files, place, options))
                labels = numpy.load("s.npy")
                self.assertGreater(len(numpy.unique(labels)), 2)
                expected = numpy.zeros(labels.shape)
                for number, name in enumerate(self.files.split(), 1):
                    self.works("slice %s --field inside %s%s" % (name, place, options.replace(" --priority", "")))
                    inside = numpy.load("s.npy") != 0
                    expected[inside & (expected == 0) if "priority" in options else inside] = number
                self.assertTrue((labels == expected).all(), (plane, options))

    def test_drawn_points_are_of_all_meshes(self):
        self.works("points %s --field label,inside --sample uniform=500,surface=50 -o s.npz --orient auto" % self.files)
        drawn = numpy.load("s.npz")
        numpy.save("p.npy", drawn["points"])
        self.works("points %s p.npy --field label -o v.npy --orient auto" % self.files)
        self.assertTrue((drawn["label"] == numpy.load("v.npy")).all())
        self.assertEqual(len(drawn["faces"]), 550)
        self.works("points %s --field label --sample uniform=500,surface=50 -o t.npz --orient auto" % self.files)
        self.assertTrue((numpy.load("t.npz")["label"] == drawn["label"]).all())

    def test_other_fields_are_those_of_all_together(self):
        write("all.obj", obj({"a": PARTS["left lobe"], "b": PARTS["right"], "c": PARTS["open"]}))
        for files, words in (("all.obj", "all.obj --parts group"), ("all.obj", "left_lobe.obj right.obj open.obj")):
            self.works("lattice %s -o l.npz --field winding,label,inside --verify 10%s" % (words, BOX))
            self.works("lattice %s -o w.npz --field winding,inside%s" % (files, BOX))
            got, expected = numpy.load("l.npz"), numpy.load("w.npz")
            self.assertTrue((got["w"] == expected["w"]).all() and (got["inside"] == expected["inside"]).all())
            self.assertTrue((got["label"] == self.lattice("left_lobe.obj right.obj open.obj")).all())

    def test_meshes_are_normalized_together(self):
        place = " --bounds -.5,-.5,-.5,.5,.5,.5 --resolution 14"
        labels = self.lattice("left_lobe.obj right.obj open.obj", " --normalize cube --report r.json", place)
        scale = read_json("r.json")["transform"][0][0]
        self.assertAlmostEqual(scale, 1 / 3)
        write("all.obj", obj({"a": PARTS["left lobe"], "b": PARTS["right"], "c": PARTS["open"]}))
        self.assertTrue((labels == self.lattice("all.obj", " --parts group --normalize cube", place)).all())
        self.assertEqual(set(labels.ravel()), {0, 1, 2, 3})

    def test_verification_finds_what_is_right(self):
        message = self.reported("lattice %s -o l.npy --field label --verify 200%s" % (self.files, BOX))
        self.assertIn("verified 200 samples", message)

    def test_reports_are_about_all_fields(self):
        """Corners of left_lobe.obj are samples, so ties and samples on the surface count."""
        words = " --verify 30 --report r.json"
        fields = "winding,sdf,gradient"
        for command, place in (("lattice", " --bounds -1,-1,-1,4,3,3 --resolution 11,9,9 -o o.npz"),
                               ("points", " --sample uniform=40,surface=40 -o o.npz")):
            reports = []
            for names, mesh in ((fields + ",label", self.files), (fields, "groups.obj")):
                self.works("%s %s --field %s%s%s" % (command, mesh, names, place, words))
                report = read_json("r.json")
                reports.append([report[key] for key in ("verify", "on_surface", "degenerate", "exterior_edges")])
            self.assertEqual(reports[0], reports[1], command)
            self.assertIn("largest_gradient_difference", reports[0][0])
            self.assertGreater(reports[0][0]["largest_distance_difference"], 0)
        self.assertGreater(reports[0][1], 0)

    def test_welding_within_a_distance_makes_the_box_of_single_jobs(self):
        """A vertex beside a cube's corner is drawn into it where both are in one file, and the box ends there."""
        cube, beside = box((0, 0, 0)), ([[1.1, 1, 1], [.5, .5, .5], [.5, .2, .8]], [(0, 1, 2, 2)])
        write("w.obj", obj({"a": cube, "b": beside}))
        write("a.obj", obj({"": cube}))
        write("b.obj", obj({"": ([[1.1, 1, 1], [1.1, .5, 1], [1.5, 1, 1]], [(0, 1, 2, 2)])}))
        for mesh, expected, kinds in (("w.obj", [.5, 1], ("inside", "label", "label --parts group",
                                                          "label --parts component", "label,inside --parts group")),
                                      ("a.obj b.obj", [.75, 1.5], ("label", "label --normalize cube", "label,inside"))):
            sides = set()
            for options in kinds:
                self.works("lattice %s --field %s --weld .2 --resolution 3 -o w.npz --report r.json" % (mesh, options))
                lattice = read_json("r.json")["lattice"]
                if "normalize" not in options:
                    sides.add((lattice["spacing"][0], lattice["origin"][0] + 2 * lattice["spacing"][0]))
                if options.split()[0] in ("inside", "label"):
                    self.works("slice %s --field %s --weld .2 --size 8 -o w.png --report r.json" % (mesh, options))
            self.assertEqual(sides, {tuple(expected)}, mesh)

    def test_results_do_not_depend_on_threads_and_engines(self):
        for end in ("npz", "vdb", "nii.gz", "nrrd", "vti", "csv"):
            contents = set()
            for options in (" --threads 1", " --threads 3", " --threads 1"):
                self.works("lattice %s -o l.%s --field label%s%s" % (self.files, end, BOX, options))
                contents.add(read("l." + end) + (read("l.json") if end == "nii.gz" else b""))
            self.assertEqual(len(contents), 1, end)
        labels = self.lattice(self.files)
        for options in (" --engine embree", " --simd sse4"):
            self.assertTrue((self.lattice(self.files, options) == labels).all())

    def test_real_meshes(self):
        names = ["geometry3SharpDemos__bunny_overlap_solids.obj", "assimp__triangle_with_two_solids.stl"]
        if not all(os.path.exists(os.path.join(SHARED, name)) for name in names):
            self.skipTest("no shared meshes")
        for name in names[:1]:
            path = os.path.join(SHARED, name)
            self.works("lattice %s -o l.npz --field label,inside --parts component --resolution 32 --rule nonzero" % path)
            got = numpy.load("l.npz")
            self.assertTrue(((got["label"] > 0) >= got["inside"]).all() and (got["label"] > 0).any())
        self.works("lattice %s -o l.csv --field label --parts group --resolution 2 --report r.json" %
                   os.path.join(SHARED, names[1]))
        self.assertEqual([part["faces"] for part in read_json("r.json")["parts"]], [1, 1])


class Names(Labels):
    def names(self, words):
        self.works("lattice %s -o n.csv --field label --resolution 2 --report r.json" % words)
        return [part["name"] for part in read_json("r.json")["parts"]]

    def test_groups_of_obj(self):
        cubes = [box((n, 0, 0), 0.5) for n in range(6)]
        text = obj(dict(zip(["", "o  Wheel \n", "g rim  of\tsteel # no name\n", "o Wheel2\n", "g Wheel2\n", "o Wheel\ng rim of steel\n"],
                            cubes)))
        write("g.obj", text + "g nothing here\n")
        self.assertEqual(self.names("g.obj --parts group"),
                         ["default", "Wheel", "Wheel/rim of steel", "Wheel2"])
        write("g.obj", obj(dict(zip(["a\n", "g\n", "g a#1\\\n b\n", "g %s\n" % ("x" * 300)], cubes))))
        self.assertEqual(self.names("g.obj --parts group"), ["default", "a#1 b", "x" * 255])

    def test_solids_of_stl(self):
        write("s.stl", stl(dict(zip(["a b", "facet one", ""], [box((n, 0, 0), 0.5) for n in range(3)])))
                   + "solid empty\nendsolid\n")
        self.assertEqual(self.names("s.stl --parts group"), ["a b", "facet one", "part 3"])
        one_line = "solid one facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet"
        write("o.stl", one_line + " endsolid one")
        self.assertEqual(self.names("o.stl --parts group"), ["one"])
        binary = b" " * 80 + struct.pack("<I", 1) + struct.pack("<12fH", *[0] * 6, 1, 0, 0, 0, 1, 0, 0)
        write("b.stl", binary)
        self.assertEqual(self.names("b.stl --parts group"), ["part 1"])

    def test_files(self):
        os.mkdir("bones")
        write("bones/femur.left.obj.gz", gzip.compress(read("right.obj")))
        write("list", "left_lobe.obj\n# no mesh\n\nbones/femur.left.obj.gz\n")
        for words in ("left_lobe.obj bones/femur.left.obj.gz", "@list"):
            self.assertEqual(self.names(words), ["left_lobe", "femur.left"])
        self.assertEqual(self.names("right.obj @list"), ["right", "left_lobe", "femur.left"])
        meshes = read_json("r.json")["meshes"]
        self.assertEqual([mesh["mesh"] for mesh in meshes], ["right.obj", "left_lobe.obj", "bones/femur.left.obj.gz"])
        self.assertEqual(self.works("lattice @- right.obj -o - --format csv --resolution 2 --field label",
                                    input=b"left_lobe.obj\n"),
                         self.works("lattice left_lobe.obj right.obj -o - --format csv --resolution 2 --field label"))
        self.assertEqual(self.works("lattice - right.obj --mesh-format obj -o - --format csv --resolution 2 --field label",
                                    input=read("left_lobe.obj")),
                         self.works("lattice left_lobe.obj right.obj -o - --format csv --resolution 2 --field label"))
        self.works("lattice @list right.obj -o d.csv --resolution 2 --field label --depfile d")
        self.assertEqual(read("d").split(), [b"d.csv:", b"\\", b"left_lobe.obj", b"\\", b"bones/femur.left.obj.gz",
                                             b"\\", b"right.obj", b"\\", b"list"])
        before = read("list")
        for words in ("lattice @list -o list --format npy", "lattice @list -o l.npy --report list",
                      "lattice @list right.obj -o l.npy --depfile list", "slice @list -o list --format png",
                      "points @list --sample uniform=5 -o list --format npz"):
            self.refused(words + " --field label", 1, "list: is input and")
            self.assertEqual(read("list"), before, words)

    def test_names_are_in_files_and_reports(self):
        words = "lattice groups.obj --field label --parts group --orient auto" + BOX
        for end in ("npz", "nrrd", "vdb"):
            self.works("%s -o l.%s" % (words, end))
        about = json.loads(numpy.load("l.npz")["raycone"].item())
        self.assertEqual((about["labels"], about["rule"], about["fields"]), (list(PARTS), "threshold=0.5", ["label"]))
        self.assertIn(b'"labels":["left lobe","right","open","turned"]', read("l.nrrd"))
        pairs = dict(line.split(":=", 1) for line in read("l.nrrd").split(b"\n\n", 1)[0].decode().split("\n") if ":=" in line)
        self.works(words + " -o l.nii")
        for n, label in enumerate(read_json("l.json")["labels"]):
            segment = {key.split("_", 1)[1]: value for key, value in pairs.items() if key.startswith("Segment%d_" % n)}
            colour = segment.pop("Color").split(" ")
            self.assertEqual(segment, {"ID": "Segment_%d" % (n + 1), "Name": label["name"], "LabelValue": str(n + 1),
                                       "Layer": "0", "Extent": "0 14 0 8 0 8"})
            self.assertEqual([round(255 * float(part)) for part in colour], label["color"])
        self.assertNotIn("Segment4_ID", pairs)
        self.works("lattice groups.obj --field inside -o i.nrrd" + BOX)
        self.assertNotIn(b"Segment", read("i.nrrd"))
        self.assertIn(b'["left lobe","right","open","turned"]', read("l.vdb"))
        self.assertIn(b"Tree_int32_5_4_3", read("l.vdb"))
        self.works(words + " -o l.npy --report r.json")
        labels = numpy.load("l.npy")
        report = read_json("r.json")
        self.assertEqual([part["label"] for part in report["parts"]], [1, 2, 3, 4])
        self.assertEqual([part["samples"] for part in report["parts"]], numpy.bincount(labels.ravel())[1:].tolist())
        self.assertEqual([part["exterior_edges"] for part in report["parts"]], [0, 0, 4, 0])
        self.assertEqual(report["exterior_edges"], 4)
        self.assertEqual([part["faces"] for part in report["parts"]], [12, 12, 10, 12])


class Formats(Labels):
    def test_all_formats_hold_the_same(self):
        words = "lattice %s --field label%s -o l." % (self.files, BOX)
        expected = self.lattice(self.files)
        for end in ("npz", "nrrd", "nii", "nii.gz", "vti", "csv"):
            self.works(words + end)
        self.assertTrue((numpy.load("l.npz")["label"] == expected).all())
        self.assertEqual(numpy.load("l.npz")["label"].dtype, numpy.int32)
        flat = expected.transpose().ravel()  # x fastest
        self.assertTrue((numpy.frombuffer(read("l.nrrd").split(b"\n\n", 1)[1], "<i4") == flat).all())
        self.assertIn(b"\ntype: int32\n", read("l.nrrd"))
        head = read("l.nii")
        self.assertEqual(struct.unpack_from("<2h", head, 70), (8, 32))  # DT_INT32
        self.assertTrue((numpy.frombuffer(head[352:], "<i4") == flat).all())
        self.assertEqual(gzip.decompress(read("l.nii.gz")), head)
        vti = read("l.vti")
        self.assertIn(b'type="Int32" Name="label"', vti)
        start = vti.index(b"raw\">\n   _") + 10
        self.assertEqual(struct.unpack_from("<Q", vti, start)[0], 4 * flat.size)
        self.assertTrue((numpy.frombuffer(vti, "<i4", flat.size, start + 8) == flat).all())
        rows = read("l.csv").decode().split()
        self.assertEqual(rows[0], "i,j,k,x,y,z,label")
        self.assertTrue((numpy.array([row.split(",")[6] for row in rows[1:]], "i4") == flat).all())

    def test_values_of_points_without_a_format(self):
        points = numpy.array([[0.25, 0.25, 0.25], [0.75, 0.75, 0.75], [9, 9, 9]])
        for raw, dtype in (("f64", "<f8"), ("f32", "<f4")):
            out = self.works("points %s - --field label --raw %s" % (self.files, raw),
                             input=points.astype(dtype).tobytes())
            self.assertEqual(numpy.frombuffer(out, dtype).tolist(), [1, 2, 0])

    def test_names_lie_beside_nifti(self):
        words = "lattice groups.obj --field label --parts group --orient auto" + BOX
        for name, table in (("a.nii", "a.json"), ("b.NII.GZ", "b.json")):
            self.works("%s -o %s" % (words, name))
            labels = read_json(table)["labels"]
            self.assertEqual([(label["label"], label["name"]) for label in labels], list(enumerate(PARTS, 1)))
            colours = [tuple(label["color"]) for label in labels]
            self.assertEqual(len(set(colours)), len(colours))
            self.assertTrue(all(type(c) is int and 0 <= c <= 255 for colour in colours for c in colour))
        for name in ("c.nrrd", "d.npz"):
            self.works("%s -o %s" % (words, name))
        self.works(words.replace("label", "inside").replace(" --parts group", "") + " -o e.nii")
        self.works(words + " -o - --format nii")
        self.assertEqual(sorted(name for name in os.listdir() if name.endswith(".json")), ["a.json", "b.json"])
        self.works(words + " -o weird --format nii")
        self.assertTrue(os.path.exists("weird.json"))
        self.works(words + " -o a.nii --report a.json")  # which has the names, too
        self.assertEqual([part["name"] for part in read_json("a.json")["parts"]], list(PARTS))
        for report in ("./f.json", os.path.abspath("f.json")):
            self.works(words + " -o f.nii --report " + report)
            self.assertIn("parts", read_json("f.json"))
        self.works(words + " -o A.nii --report a.json")
        self.assertTrue(os.path.exists("A.json"))  # another file
        self.refused(words + " -o a.nii --depfile a.json", 1, "a.json: is depfile and label names")
        self.refused(words + " -o x.nii --no-clobber --memory-limit 1", 4, "limit")
        write("y.json", "mine")
        self.refused(words + " -o y.nii --no-clobber", 3, "y.json")
        self.assertFalse(os.path.exists("y.nii") or os.path.exists("x.nii") or os.path.exists("x.json"))
        self.assertEqual(read("y.json"), b"mine")

    def test_readers_of_images(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel")
        self.works("lattice %s --field label%s -o l.nii.gz" % (self.files, BOX))
        image = nibabel.load("l.nii.gz")
        self.assertEqual(image.get_data_dtype(), numpy.int32)
        self.assertTrue((numpy.asarray(image.dataobj) == self.lattice(self.files)).all())


class Refusals(Labels):
    def test_what_has_no_effect(self):
        words = "lattice left_lobe.obj -o l.npz "
        for options, message in ((" --parts component", "--parts component: has no effect without labels"),
                                 (" --priority", "--priority: has no effect without labels"),
                                 (" --field label --diagnostics", "--diagnostics: has no effect on labels"),
                                 (" --field label --double", "--double: has no effect on inside and label"),
                                 (" --field label --dtype f32", "--dtype f32: has no effect on inside and label"),
                                 (" --field label --parts object", "--parts object: expected file, group or component"),
                                 (" --field label,label", "each field once")):
            self.refused(words + options, 1, message)
        self.refused("lattice left_lobe.obj right.obj -o l.npy", 1,
                     "unexpected operand right.obj, expected one mesh, or --field label")
        for by in ("group", "component"):
            self.refused("lattice left_lobe.obj right.obj -o l.npy --field label --parts " + by, 1,
                         "--parts %s: has no effect on several meshes" % by)
        self.refused("points left_lobe.obj right.obj p.csv", 1, "unexpected operand right.obj")
        self.refused("lattice - - -o l.npy --field label", 1, "standard input cannot be two of the inputs")
        self.refused("lattice - @- -o l.npy --field label", 1, "standard input cannot be two of the inputs")
        self.refused("points left_lobe.obj - - --field label", 1, "standard input cannot be two of the inputs")
        self.refused("points left_lobe.obj p.npy -o l.npy --field label,winding --dtype f16", 1, "--field label: takes")
        self.refused("slice left_lobe.obj -o l.png --field label,inside", 1, "--field label,inside: expected winding")
        self.refused("batch left_lobe.obj --out-dir out --field label", 1, "expected --parts group or component")
        self.refused("lattice left_lobe.obj right.obj -o right.obj --format csv --field label", 1, "is input and output")
        for meshes in ("@", "@ right.obj", "right.obj @"):
            self.refused("lattice %s -o l.npy --field label" % meshes, 1, "MESH: expected a file, not an empty name")
        self.assertEqual([name for name in os.listdir() if name.startswith("l.")], [])

    def test_what_cannot_be_read(self):
        self.refused("lattice left_lobe.obj absent.obj -o l.npy --field label", 2, "absent.obj: cannot be")
        write("points.csv", "0,0,0\n")
        self.refused("points right.obj points.csv -o l.npy --field label --dtype f32", 1, "are no real numbers")
        self.refused("lattice @absent -o l.npy --field label", 2, "absent: cannot be")
        write("empty", "# nothing\n")
        self.refused("lattice @empty -o l.npy --field label", 2, "empty: names no mesh")
        write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.refused("lattice a.off -o l.npy --field label --parts group", 2, "a.off: its format has no groups")
        self.works("lattice a.off -o l.npy --field label --parts component")

    def test_memory_is_refused_before_the_work(self):
        self.refused("lattice %s -o l.npy --field label --resolution 100000 --memory-limit 1G" % self.files, 4, "needs")
        self.assertFalse(os.path.exists("l.npy"))

    def test_what_the_format_cannot_hold_is_refused_before_the_work(self):
        """Which would warn about the reversed part."""
        words = "lattice left_lobe.obj turned.obj --field label -o l."
        self.refused(words + "nii.gz --resolution 40000,2,2", 3, "40000 samples along an axis do not fit")
        self.refused(words + "vdb --resolution 5 --scale 1e-7", 3, "voxel volume")

    def test_warnings_name_their_mesh(self):
        text = self.reported("lattice left_lobe.obj turned.obj right.obj -o l.npy --field label --report r.json" + BOX)
        warnings = [line for line in text.split("\n") if "warning" in line]
        self.assertEqual(len(warnings), 2, text)
        self.assertRegex(warnings[0], r"\Araycone: warning: turned\.obj: reversed: 1 closed")
        self.assertRegex(warnings[1], r"\Araycone: warning: turned\.obj: empty: 1 part has no sample inside by the rule threshold=0\.5 \(turned\)")
        self.assertEqual(read_json("r.json")["warnings"], ["reversed", "empty"])
        self.refused("lattice left_lobe.obj turned.obj -o s.npy --field label --strict" + BOX, 2, "turned.obj: reversed")
        self.assertFalse(os.path.exists("s.npy"))

    def test_a_cavity_is_reversed_only_where_the_rule_cares(self):
        write("hollow.obj", obj({"outer": box((0, 0, 0)), "inner": box((0.25, 0.25, 0.25), 0.5, flipped=True)}))
        words = "lattice hollow.obj -o l.npy --field label --parts component --resolution 9"
        for rule in ("threshold=0.5", "positive"):
            self.assertIn(": reversed: 1 closed", self.reported(words + " --rule " + rule))
        for rule in ("abs=0.5", "odd", "nonzero"):
            self.assertNotIn("warning", self.reported(words + " --rule " + rule))
        self.assertEqual((numpy.load("l.npy") > 0).sum(), 8**3)  # the upper faces are outside


class Batches(Labels):
    def test_each_mesh_has_its_parts(self):
        os.mkdir("in")
        write("in/groups.obj", read("groups.obj"))
        write("in/two.stl", stl({"a": box((0, 0, 0)), "b": box((1.5, 0, 0))}))
        self.works("batch in --out-dir out --field label --parts group --format nii.gz --orient auto --resolution 9")
        for name, words in (("groups", "in/groups.obj"), ("two", "in/two.stl")):
            self.works("lattice %s -o one.nii.gz --field label --parts group --orient auto --resolution 9" % words)
            self.assertEqual(read("one.nii.gz"), read("out/%s.nii.gz" % name))
            self.assertEqual(read("one.json"), read("out/%s.json" % name))
        self.works("batch in --out-dir drawn --field label --parts component --sample uniform=50")
        self.assertEqual(numpy.load("drawn/two.npz")["label"].dtype, numpy.int32)


if __name__ == "__main__":
    run_tests()
