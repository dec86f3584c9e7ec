"""Every input format as .gz and .zst, from files and pipes: python3 compressed_inputs_test.py RAYCONE MESH_DIRECTORY

What a compressed file says is what the file itself says. Cut anywhere, or damaged, it is refused in one line.
"""

import base64
import gzip
import io
import json
import os
import struct
import subprocess
import threading
import unittest.mock
import zipfile
import zlib

from command_case import PATIENCE, RAYCONE, CommandCase, run_tests, write

# A tetrahedron, and three points in and about it.
VERTICES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
POINTS = [(0.1, 0.2, 0.3), (1, 1, 1), (-0.5, 0, 0)]


def zstd(data):
    """A frame of blocks that are stored as they are (RFC 8878): Debian's Python has no module that compresses."""
    frame = struct.pack("<IBQ", 0xFD2FB528, 0xE0, len(data))
    blocks = [data[n : n + 100_000] for n in range(0, len(data), 100_000)] or [b""]
    for n, block in enumerate(blocks):
        frame += struct.pack("<I", len(block) << 3 | (n == len(blocks) - 1))[:3] + block
    return frame


def rows(numbers, form="%r %r %r\n", before=""):
    return "".join(before + form % tuple(row) for row in numbers)


def ply(head, body):
    text = "ply\nformat %s 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" % head
    text += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    return text.encode() + body


def binary_ply(order):
    body = b"".join(struct.pack(order + "3f", *v) for v in VERTICES)
    return body + b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)


def gltf(uri):
    positions, indices = struct.pack("<12f", *sum(VERTICES, ())), struct.pack("<12H", *sum(FACES, ()))
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0] * 3, "max": [1] * 3},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": 72}],
    }
    data = positions + indices
    if uri:
        document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        return json.dumps(document).encode()
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def model_3mf():
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    mesh = "<mesh><vertices>%s</vertices><triangles>%s</triangles></mesh>" % (
        rows(VERTICES, '<vertex x="%r" y="%r" z="%r"/>'), rows(FACES, '<triangle v1="%r" v2="%r" v3="%r"/>'))
    model = '<model xmlns="%s"><resources><object id="1">%s</object></resources>' % (core, mesh)
    return model + '<build><item objectid="1"/></build></model>'


def three_mf(model=model_3mf()):
    relations = '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
    relations += 'Id="r" Target="/m.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    relations += "</Relationships>"
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("_rels/.rels", relations)
        package.writestr("m.model", model)
    return file.getvalue()


def fixed_codes():
    return zlib.compressobj(9, zlib.DEFLATED, -15, 9, zlib.Z_FIXED)


def deflated_by_fixed_codes(data):
    packing = fixed_codes()
    return packing.compress(data) + packing.flush()


def stl_text():
    corners = ["".join("vertex %r %r %r\n" % VERTICES[i] for i in face) for face in FACES]
    facets = "".join("facet normal 0 0 0\nouter loop\n%sendloop\nendfacet\n" % c for c in corners)
    return ("solid t\n" + facets + "endsolid\n").encode()


def stl_binary():
    return bytes(80) + struct.pack("<I", 4) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *VERTICES[a], *VERTICES[b], *VERTICES[c], 0) for a, b, c in FACES)


def npy(points=POINTS, announced=None):
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, 3), }" % (announced or len(points))
    head += " " * (-(len(head) + 11) % 64) + "\n"
    data = b"".join(struct.pack("<3d", *p) for p in points)
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data


def npz(method=zipfile.ZIP_STORED, array=None):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        archive.writestr("points.npy", array or npy())
    return file.getvalue()


FACES_FROM_1 = [tuple(i + 1 for i in face) for face in FACES]
MESHES = {
    "text.obj": (rows(VERTICES, before="v ") + rows(FACES_FROM_1, before="f ")).encode(),
    "text.off": ("OFF\n4 4 0\n" + rows(VERTICES) + rows(FACES, before="3 ")).encode(),
    "text.ply": ply("ascii", (rows(VERTICES) + rows(FACES, before="3 ")).encode()),
    "little.ply": ply("binary_little_endian", binary_ply("<")),
    "big.ply": ply("binary_big_endian", binary_ply(">")),
    "text.stl": stl_text(),
    "binary.stl": stl_binary(),
    "text.gltf": gltf(True),
    "binary.glb": gltf(False),
    "package.3mf": three_mf(),
}
POINT_FILES = {
    "p.csv": ("x,y,z\n" + rows(POINTS, "%r,%r,%r\n")).encode(),
    "p.tsv": rows(POINTS, "%r\t%r\t%r\n").encode(),
    "p.npy": npy(),
    "p.npz": npz(),
    "p.ply": ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n" +
              rows(POINTS)).encode(),
}


class Compressed(CommandCase):
    def setUp(self):
        super().setUp()
        write("t.obj", MESHES["text.obj"])

    def packed(self, name, data):
        # pzstd writes a frame that is to be skipped before each frame.
        skipped = struct.pack("<III", 0x184D2A50 + len(data) % 16, 4, len(data))
        return ((name + ".gz", gzip.compress(data)), (name + ".zst", zstd(data)), ("pzstd_" + name + ".zst", skipped + zstd(data)))

    def packed_in_turn(self, files):
        """Each file in one packing, and each packing of several files: what unpacks does not know what it unpacks."""
        for n, (name, data) in enumerate(files.items()):
            yield name, data, *self.packed(name, data)[n % 3]

    def test_meshes_are_the_same(self):
        for name, data, packed_name, packed in self.packed_in_turn(MESHES):
            expected = self.works("info %s --json" % write(name, data))
            self.assertEqual(json.loads(expected)["faces"], 4, name)
            kind = " --mesh-format " + name.split(".")[1]
            self.assertEqual(self.works("info %s --json" % write(packed_name, packed)), expected, packed_name)
            self.assertEqual(self.works("info - --json" + kind, input=packed), expected, packed_name)

    def test_points_are_the_same(self):
        for name, data in POINT_FILES.items():
            expected = self.works("points t.obj %s" % write(name, data))
            self.assertEqual(expected.count(b"\n"), 4, name)
            if name == "p.npz":  # is packed itself, and read from its end on
                self.refused("points t.obj %s" % write("p.npz.gz", gzip.compress(data)), 2, "expected a file that is neither")
                continue
            for packed_name, packed in self.packed(name, data):
                self.assertEqual(self.works("points t.obj %s" % write(packed_name, packed)), expected, packed_name)
        for packed_name, packed in self.packed("p.csv", POINT_FILES["p.csv"]):
            self.assertEqual(self.works("points t.obj -", input=packed), self.works("points t.obj p.csv"), packed_name)

    def test_deflated_members_end_where_a_piece_of_them_does(self):
        """64 KiB of XML are unpacked at a time, 128 of arrays; the byte that ends the data holds the last match,
        too."""
        for n in range(5458, 5475):
            path = write("p.npz", npz(zipfile.ZIP_DEFLATED, npy([(0.0, 0.0, 0.0)] * n)))
            self.assertEqual(self.works("points t.obj " + path).count(b"\n"), n + 1)
        expected = self.works("info %s --json" % write("t.3mf", three_mf()))
        tried = 0
        for length in range(0, 130, 13):
            comment = "<!--%s-->" % "".join(chr(48 + 7 * n % 70) for n in range(length))
            for size in range(1 << 16, (1 << 16) + 258, 10):
                model = (model_3mf() + comment).ljust(size)
                inflating = zlib.decompressobj(-15)
                inflating.decompress(deflated_by_fixed_codes(model.encode()), 1 << 16)
                if inflating.unconsumed_tail or inflating.eof:
                    continue
                tried += 1
                with unittest.mock.patch.object(zipfile, "_get_compressor", lambda *_: fixed_codes()):
                    write("t.3mf", three_mf(model))
                self.assertEqual(self.works("info t.3mf --json"), expected, (length, size))
        self.assertGreater(tried, 0)

    def test_answers_come_as_soon_as_their_points_have(self):
        """256 KiB are read at a time. They end within the last block here, behind which nothing comes before the
        answers."""
        first, last = b"0.1 0.2 0.3\n", b"1 1 1\n"
        frame = bytes.fromhex("28b52ffd0038")  # a window of 128 KiB
        for size, kind, block in ((len(first), 0, first), (1 << 17, 1, b"\n"), ((1 << 17) - 15, 1, b"\n"), (len(last), 0, last)):
            frame += struct.pack("<I", size << 3 | kind << 1)[:3] + block  # kind 1: a byte repeated
        words = [RAYCONE, "points", "t.obj", "-", "--quiet"]
        with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
            hang = threading.Timer(PATIENCE, process.kill)
            hang.start()
            process.stdin.write(frame)
            process.stdin.flush()
            answers = [process.stdout.readline() for _ in range(3)]
            hang.cancel()
            process.stdin.write(bytes((1, 0, 0)))  # an empty block ends the frame
            process.stdin.close()
        self.assertEqual([answer[:4] for answer in answers], [b"x,y,", b"0.1,", b"1,1,"])
        self.assertEqual(process.returncode, 0)

    def test_cut_and_damaged_ones_are_refused(self):
        for name, data, packed_name, packed in self.packed_in_turn({**MESHES, **POINT_FILES}):
            words = "points t.obj bad" if name in POINT_FILES else "info bad --mesh-format " + name.split(".")[1]
            if name in ("p.npy", "p.npz", "p.ply"):
                words = "points t.obj bad." + name.split(".")[1]
            for cut in (len(packed) - 1, len(packed) // 2):
                with self.subTest(packed_name, cut=cut):
                    path = write(words.split()[2 if words.startswith("points") else 1], packed[:cut])
                    self.refused(words, 2, path)
            damaged = bytearray(packed)
            damaged[4 if packed_name.endswith("zst") else 2] ^= 0xFF  # of the frame's head, or the method
            self.refused(words, 2, write(path, damaged))

    def test_meshes_that_are_packed_twice_are_refused(self):
        for _, _, packed_name, packed in self.packed_in_turn(MESHES):
            self.refused("info " + write(packed_name, gzip.compress(packed)), 2, "is compressed twice, expected once")

    def test_rows_that_are_only_announced_are_no_full_disk(self):
        for name, content in self.packed("a.npy", npy(announced=1 << 40)):
            for output in ("o.npy", "o.npz", "o.csv", "-"):
                words = "points t.obj %s --field sdf,inside --format %s -o " % (
                    write(name, content), "npy" if output == "-" else output[2:])
                self.refused(words + output, 2, name + ":byte ")
                self.assertFalse(os.path.exists(output))

    def test_damaged_archives_of_arrays_are_refused(self):
        for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            for array in (npy(), npy().replace(b"'fortran_order': False", b"'fortran_order': True ")):
                if array != npy() and method == zipfile.ZIP_DEFLATED:
                    continue  # needs a file that can be sought
                data = bytearray(npz(method, array))
                self.works("points t.obj %s" % write("good.npz", data))
                checksum = data.index(b"PK\1\2") + 16  # of the directory
                data[checksum] ^= 1
                self.refused("points t.obj %s" % write("bad.npz", data), 2, "its bytes do not match their checksum")
                if method == zipfile.ZIP_STORED:
                    data[checksum] ^= 1
                    data[data.index(struct.pack("<d", POINTS[1][0])) + 6] ^= 1
                    self.refused("points t.obj %s" % write("bad.npz", data), 2, "its bytes do not match their checksum")
        self.works("lattice t.obj -o l.npz --resolution 4")
        with zipfile.ZipFile("l.npz") as archive:
            members = {info.filename: archive.read(info) for info in archive.infolist()}
        for name in ("origin.npy", "spacing.npy", "index_min.npy", "direction.npy"):
            file = io.BytesIO()
            with zipfile.ZipFile(file, "w") as archive:
                for member, content in members.items():
                    archive.writestr(member, content)
            data = bytearray(file.getvalue())
            data[data.index(members[name]) + len(members[name]) - 1] ^= 1
            self.refused("lattice t.obj --like %s -o m.npy" % write("damaged.npz", data), 2, "damaged.npz: %s" % name)
            self.assertFalse(os.path.exists("m.npy"))


if __name__ == "__main__":
    run_tests()
