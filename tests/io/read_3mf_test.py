"""3MF against a composition of its own: python3 read_3mf_test.py RAYCONE_DUMP_MESH RAYCONE

Packages made with zipfile. Triangles are compared as numbers; transforms are sums of few powers of two, so that neither
side rounds. Then what is refused, and how the message begins.
"""

import csv
import io
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
import unittest
import warnings
import zipfile

DUMP, RAYCONE = (os.path.abspath(path) for path in sys.argv[1:3])
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
EXTENSIONS = {name: f"http://schemas.microsoft.com/3dmanufacturing/{uri}" for name, uri in
              {"p": "production/2015/06", "s": "slice/2015/07", "b": "beamlattice/2017/02", "m": "material/2015/02",
               "sc": "securecontent/2019/04", "pa": "production/alternatives/2021/04"}.items()}
MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"


def relations(*targets, kind=MODEL):
    rows = "".join(f'<Relationship Id="r{i}" Type="{kind}" Target="{t}"/>' for i, t in enumerate(targets))
    return f'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">{rows}</Relationships>'


def model(resources, build="", attributes='unit="millimeter"'):
    namespaces = "".join(f' xmlns:{name}="{uri}"' for name, uri in EXTENSIONS.items())
    return (f'<?xml version="1.0" encoding="UTF-8"?>\n<model xmlns="{CORE}"{namespaces} {attributes}>\n'
            f"<metadata name='Title'>x &lt; y</metadata><resources>{resources}</resources><build>{build}</build></model>")


def mesh_object(number, vertices, triangles, attributes=""):
    rows = "".join(f'<vertex x="{x!r}" y=" {y!r}" z="{z:.17e} "/>\n' for x, y, z in vertices)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}" pid="1"/>\n' for a, b, c in triangles)
    return (f'<object id="{number}" type="model" {attributes}><mesh><vertices>{rows}</vertices>'
            f"<triangles>{faces}</triangles></mesh></object>")


# `parts`: names and texts, as a dictionary or, where a name is there twice, as pairs; or the model's text.
def package(parts, compression=zipfile.ZIP_DEFLATED, root=relations("/3D/3dmodel.model")):
    if isinstance(parts, str):
        parts = {"3D/3dmodel.model": parts}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        archive.writestr("[Content_Types].xml", "<Types/>")
        if root is not None:
            archive.writestr("_rels/.rels", root)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of zipfile, about names that are there twice
            for name, text in parts.items() if isinstance(parts, dict) else parts:
                archive.writestr(name, text)
    return buffer.getvalue()


VERTICES = [(0.1, 0.2, 0.3), (1, 0, 0), (0, 1e-300, 0), (0, 0, 123456789.12345678)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
TETRAHEDRON = mesh_object(1, VERTICES, FACES, 'name="a &amp; b"')
ITEM = '<item objectid="1"/>'


def dump(path):
    result = subprocess.run([DUMP], input=path + "\n", capture_output=True, text=True, timeout=60)
    kind, _, rest = result.stdout.strip().partition(" ")
    if kind == "error":
        return rest
    words = rest.split()
    numbers = [float.fromhex(word) for word in words[1:]]
    points = list(zip(*[iter(numbers)] * 3))
    return list(zip(*[iter(points)] * 3))


# The row vector (x, y, z, 1) times the matrix.
def moved(point, matrix):
    return tuple(sum(point[row] * matrix[3 * row + column] for row in range(3)) + matrix[9 + column]
                 for column in range(3))


def product(inner, outer):
    rows = [moved(inner[3 * i : 3 * i + 3], outer[:9] + [0, 0, 0]) for i in range(3)]
    return [x for row in rows for x in row] + list(moved(inner[9:], outer))


def determinant(m):
    return (m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6])
            + m[2] * (m[3] * m[7] - m[4] * m[6]))


class Values(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.directory.name, "m.3mf")

    def tearDown(self):
        self.directory.cleanup()

    def read(self, data):
        with open(self.path, "wb") as file:
            file.write(data)
        return dump(self.path)

    def test_coordinates_keep_all_their_digits(self):
        expected = [tuple(VERTICES[c] for c in face) for face in FACES]
        for compression in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            self.assertEqual(self.read(package(model(TETRAHEDRON, ITEM), compression)), expected)
        with open(self.path, "rb") as file:
            self.assertEqual(subprocess.run([RAYCONE, "info", "-", "--csv"], stdin=file, capture_output=True).returncode, 0)

    def test_transforms_of_items_and_components_are_composed(self):
        chance = random.Random(5)
        vertices = [tuple(float(chance.randrange(-8, 9)) for _ in range(3)) for _ in range(5)]
        faces = list(itertools.combinations(range(5), 3))
        for _ in range(20):
            matrices = []
            for _ in range(4):
                axes = chance.sample(range(3), 3)
                matrix = [0.0] * 12
                for row in range(3):
                    matrix[3 * row + axes[row]] = chance.choice([-2, -1, 0.5, 1, 4])
                    matrix[9 + row] = float(chance.randrange(-4, 5))
                matrices.append(matrix)
            inner, middle, outer, alone = matrices
            text = [" ".join(f"{x:g}" for x in matrix) for matrix in matrices]
            resources = (mesh_object(1, vertices, faces)
                         + f'<object id="2"><components><component objectid="1" transform="{text[0]}"/></components></object>'
                         + f'<object id="3"><components><component objectid="2" transform=" {text[1]}\n"/>'
                         + '<component objectid="1"/></components></object>')
            build = f'<item objectid="3" transform="{text[2]}"/><item objectid="1" transform="{text[3]}"/>'
            expected = []
            for matrix in (product(product(inner, middle), outer), outer, alone):
                flip = determinant(matrix) < 0
                for a, b, c in faces:
                    corners = (a, c, b) if flip else (a, b, c)
                    expected.append(tuple(moved(vertices[corner], matrix) for corner in corners))
            self.assertEqual(self.read(package(model(resources, build))), expected)

    def test_parts_are_found_whatever_the_case_of_their_names(self):
        parts = {"3D/3dModel.model": model(
            '<object id="7"><components><component objectid="1" p:path="/3D/Objects/One.model"/></components></object>',
            '<item objectid="7"/><item objectid="1" p:path="/3D/objects/one.model"/>', 'requiredextensions="p"'),
                 "3D/Objects/one.model": model(TETRAHEDRON)}
        self.assertEqual(len(self.read(package(parts))), 8)

    def test_names_of_parts_are_resolved(self):
        text = model(TETRAHEDRON, ITEM)
        for target in ("/3D/3dmodel.model", "3D/3dmodel.model", "./3D/3dmodel.model", "../3D/3dmodel.model",
                       "/3D/./a/../3dmodel.model", "/3D/3dmodel%2Emodel"):
            self.assertEqual(len(self.read(package(text, root=relations(target)))), 4, target)
        for name in ("my model.model", "my%20model.model", "/my model.model"):
            for target in ("/my model.model", "/my%20model.model"):
                self.assertEqual(len(self.read(package({name: text}, root=relations(target)))), 4, (name, target))

    # As zipfile, numpy and raycone's own reader of NPZ have it.
    def test_the_last_of_two_parts_of_one_name_counts(self):
        one, two = (model(mesh_object(1, VERTICES, FACES[:n]), ITEM) for n in (1, 2))
        name = "3D/3dmodel.model"
        self.assertEqual(len(self.read(package([(name, one), (name, two)]))), 2)
        self.assertEqual(len(self.read(package([(name, two), (name, one)]))), 1)

    def test_each_part_has_its_unit(self):
        far = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 3.0, 0.0)]
        move = "1 0 0 0 1 0 0 0 1 10 0 0"
        group = ('<object id="2"><components><component objectid="1" transform="%s"/></components></object>' % move)
        for own, factor in (("inch", 25.4), ("micron", 1e-3), ("meter", 1e3), ("millimeter", 1.0)):
            parts = {"3D/3dmodel.model": model(group.replace("objectid", 'p:path="/a.model" objectid'),
                                               '<item objectid="1" p:path="/a.model" transform="%s"/>'
                                               '<item objectid="2"/><item objectid="2" p:path="/a.model"/>' % move),
                     "a.model": model(mesh_object(1, far, [(0, 1, 2)]) + group, "", f'unit="{own}"')}
            placed = tuple((factor * x + 10, factor * y, z) for x, y, z in far)
            # In the third one, the part's own component is moved in its own unit.
            third = tuple((factor * x + factor * 10, factor * y, z) for x, y, z in far)
            self.assertEqual(self.read(package(parts)), [placed, placed, third], own)

    def test_comments_of_archives_may_hold_what_looks_like_their_end(self):
        data = package(model(TETRAHEDRON, ITEM))
        self.assertEqual(data[-2:], b"\0\0")
        for comment in (b"PK\5\6" + b"x" * 40, b"a" * 30 + b"PK\5\6", b"PK\5\6" * 20):
            self.assertEqual(len(self.read(data[:-2] + len(comment).to_bytes(2, "little") + comment)), 4)
        self.assertEqual(len(self.read(data + bytes(100))), 4)

    def test_many_components_share_the_name_of_their_part(self):
        name = "3D/" + "x" * 20000 + ".model"
        uses = '<component objectid="1"/>' * 30000
        resources = TETRAHEDRON + f'<object id="2"><components>{uses}</components></object>'
        with open(self.path, "wb") as file:
            file.write(package({name: model(resources, '<item objectid="2"/>')}, root=relations("/" + name)))
        result = subprocess.run([RAYCONE, "info", self.path, "--json", "--memory-limit", "400M"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["faces"], 120000)

    def test_a_part_is_read_once_however_its_name_is_spelt(self):
        items = "".join(f'<item objectid="1" p:path="/{name}"/>' for name in ("a.MODEL", "A.model", "a.model"))
        self.assertEqual(len(self.read(package({"3D/3dmodel.model": model("", items), "a.model": model(TETRAHEDRON)}))), 12)
        lattice = [RAYCONE, "lattice", self.path, "-o", self.path + ".csv", "--resolution", "3", "--report", self.path + ".json"]
        self.assertEqual(subprocess.run([*lattice, "--field", "label", "--parts", "group"], capture_output=True).returncode, 0)
        with open(self.path + ".json", encoding="utf-8") as file:
            self.assertEqual(len(json.load(file)["parts"]), 1)

    def test_tables_of_several_formats_have_the_same_columns(self):
        with open(self.path, "wb") as file:
            file.write(package(model(TETRAHEDRON, ITEM)))
        other = os.path.join(self.directory.name, "m.off")
        with open(other, "w", encoding="utf-8") as file:
            file.write("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        for names in ((other, self.path), (self.path, other)):
            result = subprocess.run([RAYCONE, "info", *names, "--csv"], capture_output=True, text=True)
            rows = list(csv.DictReader(io.StringIO(result.stdout)))
            self.assertEqual([row["mesh"] for row in rows], list(names))
            self.assertNotIn(None, [item for row in rows for pair in row.items() for item in pair])

    def test_what_is_not_built_is_left_out(self):
        other = mesh_object(2, VERTICES, FACES[:1])
        self.assertEqual(len(self.read(package(model(TETRAHEDRON + other, '<item objectid="2"/>')))), 1)
        foreign = '<m:colorgroup id="9"><m:color color="#fff"/><object id="1"/></m:colorgroup>'
        self.assertEqual(len(self.read(package(model(foreign + TETRAHEDRON, ITEM, 'requiredextensions="m s"')))), 4)

    def test_unit_and_names_are_told(self):
        for attributes, unit in (("", "millimeter"), ('unit="inch"', "inch")):  # the first is the format's default
            with open(self.path, "wb") as file:
                file.write(package(model(TETRAHEDRON, ITEM, attributes)))
            result = subprocess.run([RAYCONE, "info", self.path, "--json"], capture_output=True, text=True)
            self.assertEqual(json.loads(result.stdout)["unit"], unit)
            result = subprocess.run([RAYCONE, "info", self.path, "--scale", "25.4"], capture_output=True, text=True)
            self.assertRegex(result.stdout, f"(?m)^ +unit of the file +{unit}$")
        lattice = [RAYCONE, "lattice", self.path, "-o", self.path + ".csv", "--resolution", "3"]
        report = self.path + ".json"
        words = [*lattice, "--report", report, "--field", "label", "--parts", "group", "--quiet"]
        self.assertEqual(subprocess.run(words, capture_output=True).returncode, 0)
        with open(report, encoding="utf-8") as file:
            document = json.load(file)
        self.assertEqual(document["unit"], "inch")
        self.assertIn("a & b", json.dumps(document["parts"]))


    def test_what_is_ignored_is_told(self):
        beams = TETRAHEDRON.replace("</mesh>", "<b:beamlattice minlength='1'><b:beams/></b:beamlattice></mesh>")
        with open(self.path, "wb") as file:
            file.write(package(model(beams.replace("<object", '<object s:slicestackid="4"'), ITEM)))
        result = subprocess.run([RAYCONE, "info", self.path, "--json"], capture_output=True, text=True)
        self.assertEqual(json.loads(result.stdout)["warnings"][:2], ["beam-lattices", "slices"])

    def test_objects_that_may_be_holes_are_told(self):
        hole = mesh_object(2, VERTICES, FACES).replace('type="model"', 'type="other"')
        both = '<object id="3"><components><component objectid="1"/><component objectid="2"/></components></object>'
        with open(self.path, "wb") as file:
            file.write(package(model(TETRAHEDRON + hole + both, '<item objectid="3"/>')))
        result = subprocess.run([RAYCONE, "info", self.path, "--json"], capture_output=True, text=True)
        document = json.loads(result.stdout)
        self.assertEqual((document["warnings"][0], document["faces"]), ("other-objects", 8))

    def test_objects_without_triangles_are_told_once(self):
        """One of a shape of another extension, built twice, and a component with nothing."""
        shape = '<object id="2"><m:shape/></object>'
        empty = '<object id="3"/><object id="4"><components><component objectid="3"/></components></object>'
        items = ITEM + '<item objectid="2"/>' * 2 + '<item objectid="4"/>'
        with open(self.path, "wb") as file:
            file.write(package(model(TETRAHEDRON + shape + empty, items)))
        result = subprocess.run([RAYCONE, "info", self.path, "--json"], capture_output=True, text=True)
        self.assertEqual(json.loads(result.stdout)["warning_lines"][0], "empty-objects: 2 objects without triangles ignored")


REFUSED = {
    "no_relations": (package(model(TETRAHEDRON, ITEM), root=None), "no part _rels/.rels, expected a 3MF package"),
    "no_model": (package(model(TETRAHEDRON, ITEM), root=relations("/x", kind="other")), "no 3D model"),
    "part_missing": (package({"3D/other.model": ""}), "no part 3D/3dmodel.model"),
    "equivalent": (package([("3D/3dmodel.model", model(TETRAHEDRON, ITEM)), ("3D/3DModel.model", "")]),
                   "has the parts 3D/3dmodel.model and 3D/3DModel.model, expected names that differ by more"),
    "encoded": (package([("a b", ""), ("a%20b", ""), ("3D/3dmodel.model", model(TETRAHEDRON, ITEM))]),
                "has the parts a b and a%20b, expected"),
    "encrypted": (package(model(TETRAHEDRON, ITEM), root=relations("/Secure/k.xml", kind="http://x/2019/04/keystore")),
                  "is encrypted"),
    "secure_content": (package(model(TETRAHEDRON, ITEM, 'requiredextensions="sc"')),
                       "requires the extension http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/04"),
    "beams_required": (package(model(TETRAHEDRON, ITEM, 'requiredextensions="p b"')), "beamlattice/2017/02, which is not"),
    "prefix_unknown": (package(model(TETRAHEDRON, ITEM, 'requiredextensions="zz"')), "requires the extension zz"),
    "slices_only": (package(model('<object id="1" s:slicestackid="4"/>', ITEM)), "object 1 has slices only"),
    "coarse": (package(model(mesh_object(1, VERTICES, FACES, 's:slicestackid="4" s:meshresolution="lowres"'), ITEM)),
               "triangles of low resolution"),
    "object_missing": (package(model(TETRAHEDRON, '<item objectid="2"/>')), "no object 2"),
    "object_twice": (package(model(TETRAHEDRON * 2, ITEM)), "a second object 1"),
    "cycle": (package(model('<object id="1"><components><component objectid="1"/></components></object>', ITEM)),
              "components within components, more than 256 deep"),
    "index": (package(model(mesh_object(1, VERTICES, [(0, 1, 4)]), ITEM)), "face index 4, but there are only 4 vertices"),
    "index_negative": (package(model(mesh_object(1, VERTICES, [(0, 1, -1)]), ITEM)), "v3 is '-1', expected an index"),
    "nan": (package(model(mesh_object(1, [(float("nan"), 0, 0)] * 3, [(0, 1, 2)]), ITEM)), "x is 'nan', expected a finite"),
    "line_end": (package(model(TETRAHEDRON.replace('x="', 'x="1&#10;2'), ITEM)), "x is '1?2"),
    "part_of_two_lines": (package(model(TETRAHEDRON, '<item objectid="1" p:path="/a&#10;b"/>')), "no part a?b, expected"),
    "part_too_long": (package(model(TETRAHEDRON, f'<item objectid="1" p:path="/{"x" * 500}"/>')), f"no part {'x' * 120}..., exp"),
    "member_of_two_lines": (package({"a\nb": "<m/>"}, root=relations("/a&#10;b")), ": a?b:1: element m, expected http"),
    "no_coordinate": (package(model(TETRAHEDRON.replace('x="', 'u="'), ITEM)), "no attribute x"),
    "transform_short": (package(model(TETRAHEDRON, '<item objectid="1" transform="1 0 0"/>')), "expected 12 finite"),
    "transform_long": (package(model(TETRAHEDRON, f'<item objectid="1" transform="{"1 " * 13}"/>')), "more than 12"),
    "overflow": (package(model(TETRAHEDRON, f'<item objectid="1" transform="{"1e308 " * 12}"/>')), "not finite once"),
    "not_xml": (package("<model"), "3dmodel.model:1: not well-formed XML"),
    "doctype": (package('<!DOCTYPE m [<!ENTITY a "b">]><m/>'), "a document type, expected none"),
    "long_token": (package(f'<m a="{"x" * (3 << 20)}"/>'), "a tag or comment of more than a megabyte, expected a shorter"),
    "long_comment": (package("<!--" + "x" * (3 << 20) + "--><m/>"), "a tag or comment of more than a megabyte, expected"),
    "old_namespace": (package(model(TETRAHEDRON, ITEM).replace(CORE, CORE.replace("2015/02", "2013/01"))),
                      "expected http://schemas.microsoft.com/3dmanufacturing/core/2015/02|model"),
    "two_meshes": (package(model(TETRAHEDRON.replace("</mesh>", "</mesh><mesh></mesh>"), ITEM)), "a second mesh"),
    "deep": (package(model("<x>" * 300000, ITEM)), "elements within elements, more than 256"),
    "low_resolution": (package(model(mesh_object(1, VERTICES, FACES, 'pa:modelresolution="lowres"'), ITEM)),
                       "object 1 has triangles that stand for its alternatives (lowres), expected its shape"),
    "obfuscated": (package(model(mesh_object(1, VERTICES, FACES, 'pa:modelresolution="obfuscated"'), ITEM)),
                   "that stand for its alternatives (obfuscated)"),
    "unit_unknown": (package(model(TETRAHEDRON, ITEM, 'unit="parsec"')),
                     "unit is 'parsec', expected micron, millimeter, centimeter, inch, foot or meter"),
    "unit_of_another_part": (package({"3D/3dmodel.model": model("", '<item objectid="1" p:path="/a.model"/>'),
                                      "a.model": model(TETRAHEDRON, "", 'unit="furlong"')}),
                             ": a.model:2: unit is 'furlong', expected micron"),
    "unit_of_both": (package({"3D/3dmodel.model": model("", '<item objectid="1" p:path="/a.model"/>', 'unit="mm"'),
                              "a.model": model(TETRAHEDRON, "", 'unit="mm"')}), "unit is 'mm', expected micron"),
    "no_triangles": (package(model(TETRAHEDRON, "")), "no triangles, expected at least one"),
}


class Refusals(unittest.TestCase):
    def refused(self, name, data, message, status=2):
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, name + ".3mf")
            with open(path, "wb") as file:
                file.write(data)
            result = subprocess.run([RAYCONE, "info", path, "--memory-limit", "2G", "--timeout", "60"],
                                    capture_output=True, text=True, errors="replace", timeout=90)
            self.assertEqual((result.returncode, result.stdout), (status, ""), (name, result.stderr))
            self.assertRegex(result.stderr, r"\Araycone: [^\n]*\n\Z", name)
            self.assertIn(message, result.stderr, name)

    def test_bad_packages_are_refused_in_one_line(self):
        self.assertIsInstance(package(model(TETRAHEDRON, ITEM)), bytes)
        for name, (data, message) in REFUSED.items():
            self.refused(name, data, message)

    def test_bytes_that_do_not_match_their_checksum_are_refused(self):
        data = package(model(TETRAHEDRON, ITEM), zipfile.ZIP_STORED)
        self.refused("checksum", data.replace(b"0.2", b"0.7"), "do not match their checksum")

    def test_members_that_share_bytes_are_refused(self):
        parts = {"3D/3dmodel.model": model("", "".join(f'<item objectid="1" p:path="/{n}.model"/>' for n in range(9)))}
        data = bytearray(package({**parts, **{f"{n}.model": model(TETRAHEDRON) * (n == 0) for n in range(9)}}))
        entries = [data.index(b"%d.model" % n, data.index(b"PK\1\2")) - 46 for n in range(9)]
        for entry in entries[1:]:  # sizes, checksum and place of the first
            data[entry + 16 : entry + 28] = data[entries[0] + 16 : entries[0] + 28]
            data[entry + 42 : entry + 46] = data[entries[0] + 42 : entries[0] + 46]
        self.refused("shared", bytes(data), "share bytes")

    # 1000 to the power of 3 copies; and a part of blanks, twice as many as there may be memory, which takes none.
    def test_small_files_cannot_ask_for_everything(self):
        resources = TETRAHEDRON
        for number in range(2, 5):
            resources += (f'<object id="{number}"><components>' + f'<component objectid="{number - 1}"/>' * 1000
                          + "</components></object>")
        self.refused("copies", package(model(resources, '<item objectid="4"/>')), "copies of objects", 4)
        blanks = package(model(TETRAHEDRON, ITEM) + " " * (1 << 27))
        with tempfile.TemporaryDirectory() as directory:
            path = os.path.join(directory, "blanks.3mf")
            with open(path, "wb") as file:
                file.write(blanks)
            result = subprocess.run([RAYCONE, "info", path, "--memory-limit", "64M"], capture_output=True, timeout=60)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_damaged_packages_are_refused_or_read(self):
        chance = random.Random(11)
        for compression in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            whole = package(model(TETRAHEDRON, ITEM), compression)
            for _ in range(40):
                data = bytearray(whole)
                for _ in range(chance.randrange(1, 4)):
                    data[chance.randrange(len(data))] = chance.randrange(256)
                if chance.random() < 0.3:
                    del data[chance.randrange(len(data)) :]
                result = subprocess.run([RAYCONE, "info", "-", "--mesh-format", "3mf"], input=bytes(data),
                                        capture_output=True, timeout=60)
                self.assertIn(result.returncode, (0, 2), result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
