"""Mesh readers against a writer and readers that share nothing with them.

    python3 read_mesh_oracle_test.py RAYCONE_DUMP_MESH [SHARED_MESHES] [--count N] [--seed S] [--long]

Writes random meshes in random dialects of all formats, whose triangles it knows, and reads real OBJ, OFF, PLY and STL
files (those of up to 50 kB; all of them with --long) by plain readers of its own. What read_mesh makes of them must be
the same, bit for bit. N and S: how many meshes are written (300), from which seed (1).
"""

import argparse
import base64
import json
import os
import random
import struct
import subprocess
import sys
import tempfile

# --- Meshes


def rounded_to_float(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def random_mesh(r):
    """Vertices of one kind of number, and polygons of three and more corners."""
    kind = r.choice(["int8", "float", "double"])
    make = {"int8": lambda: float(r.randint(-128, 127)),
            "float": lambda: rounded_to_float(r.choice([r.uniform(-1, 1), r.uniform(-1e30, 1e30), r.gauss(0, 1e-30)])),
            "double": lambda: r.choice([r.uniform(-1, 1), r.uniform(-1e300, 1e300), r.gauss(0, 1e-300), 5e-324])}[kind]
    vertices = [(make(), make(), make()) for _ in range(r.randint(3, 30))]
    polygons = [[r.randrange(len(vertices)) for _ in range(r.choice([3, 3, 3, 4, 5, 8]))] for _ in range(r.randint(1, 20))]
    return kind, vertices, polygons


def fan(polygon):
    return [(polygon[0], polygon[i], polygon[i + 1]) for i in range(1, len(polygon) - 1)]


def triangles_of(vertices, polygons):
    return [tuple(vertices[i] for i in t) for p in polygons for t in fan(p)]


# --- Text


def number(r, x):
    """A decimal that reads back as x."""
    text = r.choice([repr, lambda v: "%.17g" % v, lambda v: "%.20e" % v, lambda v: "%.16E" % v])(x)
    if r.random() < 0.2 and not text.startswith("-"):
        text = "+" + text
    if r.random() < 0.1 and text.startswith("0."):
        text = text[1:]
    if r.random() < 0.1 and "e" not in text.lower():
        text = text + "000" if "." in text else text + "."
    return text


def point(r, v):
    return r.choice([" ", "  ", "\t", " \t "]).join(number(r, x) for x in v)


def with_line_ends(r, text):
    return text.replace("\n", r.choice(["\n", "\n", "\r\n", "\r"])).encode()


def obj(r, kind, vertices, polygons):
    lines, written, attributes = ["# a comment \\", "mtllib a.mtl", "o thing"], 0, 0
    rows = []
    for p in polygons:
        if r.random() < 0.3 or max(p) >= written + 3:
            while written <= max(p) and r.random() < 0.95:
                lines.append("v " + point(r, vertices[written]) + r.choice(["", " 1", " .5 .5 .5", " # here"]))
                written += 1
        if r.random() < 0.2:
            lines += ["vt 0 1", "vn 0 0 1", r.choice(["g a b", "s off", "usemtl x", "l 1 2", "", "curv 0 1 \\\nf 9 9 9"])]
        form = r.choice(["%s", "%s/1", "%s//1", "%s/1/1", "%s/-1/-1", "%s//"])
        corners = []
        for i in p:
            relative = i - written
            corners.append(form % (relative if relative < 0 and r.random() < 0.5 else i + 1))
        glue = r.choice([" ", "  ", "\t", " \\\n", "\\\n "])
        rows.append(p)
        lines.append("f " + glue.join(corners) + r.choice(["", " ", " # end", "\\\n"]))
        if r.random() < 0.1:
            lines.append(r.choice(["f 1 2", "f 1", "f"]))  # skipped
    lines += ["v " + point(r, v) for v in vertices[written:]]
    text = "\n".join(lines) + r.choice(["", "\n"])
    return "obj", r.choice([b"", b"\xef\xbb\xbf"]) + with_line_ends(r, text), triangles_of(vertices, polygons)


def off(r, kind, vertices, polygons):
    word = r.choice(["OFF", "COFF", "NOFF", "STOFF", "CNOFF"])
    gap = r.choice(["\n", " ", "\n# comment\n\n"])
    text = word + gap + "%d %d%s\n" % (len(vertices), len(polygons), r.choice(["", " 0", " 7 # edges"]))
    blank = lambda: r.choice(["", "", "", "\n", "# a comment\n"])
    for v in vertices:
        text += blank() + point(r, v) + r.choice(["", " 1 0 0 255", " # there"]) + "\n"
    for p in polygons:
        text += blank() + "%d %s%s\n" % (len(p), "  ".join(map(str, p)), r.choice(["", " 255 0 0", " .1 .2 .3 1"]))
    return "off", with_line_ends(r, text), triangles_of(vertices, polygons)


def stl_ascii(r, kind, vertices, polygons):
    case = r.choice([str.lower, str.upper, str.title])
    name = r.choice(["", " a b", " facet", " facet normal", " C:\\models\\", " # 1"])
    words = [case("solid") + name]
    for p in polygons:
        facet = case("facet normal") + r.choice([" 0 0 1", " nan -nan(ind) 1.#QNAN", " a # c"]) + "\n" + case("outer loop")
        facet += "".join("\n" + case("vertex") + " " + point(r, vertices[i]) for i in p)
        words.append(facet + "\n" + case("endloop") + "\n" + case("endfacet"))
        if r.random() < 0.1:
            words.append(case("endsolid") + name + r.choice(["\n", " "]) + case("solid") + name)
    words.append(r.choice(["", case("endsolid") + name]))
    if r.random() < 0.3 and "#" not in name:
        text = " ".join(words).replace("\n", " ")
    else:
        text = ("\n" + r.choice(["", " ", "\t"])).join(words)
    return "stl", r.choice([b"", b" \n"]) + with_line_ends(r, text), triangles_of(vertices, polygons)


def stl_binary(r, kind, vertices, polygons):
    vertices = [tuple(map(rounded_to_float, v)) for v in vertices] if kind != "double" else [(0., 1., 2.)] * len(vertices)
    triangles = triangles_of(vertices, polygons)
    header = r.choice([b"solid x", b"OFF 3 3", b"plywood", b"{", bytes(r.randrange(256) for _ in range(80))])
    content = header.ljust(80, b" ")[:80] + struct.pack("<I", len(triangles))
    for t in triangles:
        content += struct.pack("<12fH", 0, 0, float("nan"), *t[0], *t[1], *t[2], r.randrange(65536))
    return "stl", content, triangles


# --- PLY

PLY_TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
             "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
             "float64": "d"}


def strips_of(r, count):
    """Indices of strips with -1 between them, and their triangles."""
    row, triangles = [], []
    for _ in range(r.randint(1, 4)):
        strip = [r.randrange(count) for _ in range(r.randint(1, 7))]
        row += strip + [-1]
        for i in range(len(strip) - 2):
            triangles.append((strip[i + 1], strip[i], strip[i + 2]) if i % 2 else tuple(strip[i:i + 3]))
    return row[:-1] if r.random() < 0.5 else row, triangles


class Ply:
    """A header and a body, in one encoding, to which elements are added. A property is (type, name, whether it is a
    list)."""

    def __init__(self, r, encoding):
        self.r, self.encoding = r, encoding
        self.count_type = r.choice(["uchar", "int8", "uint", "int", "float32"])
        self.surplus = encoding == "ascii" and r.random() < 0.2  # words behind the numbers of a row
        self.split = encoding == "ascii" and not self.surplus and r.random() < 0.2  # into lines
        self.header, self.body = "", b""

    def add(self, element, properties, rows):
        """`rows`: what readers ask for, by name; anything for all other properties."""
        self.header += "element %s %d\n" % (element, len(rows))
        for kind_of, name, is_list in properties:
            self.header += "property " + ("list %s " % self.count_type if is_list else "") + "%s %s\n" % (kind_of, name)
        for own in rows:
            self.add_row(properties, own)

    def add_row(self, properties, own):
        numbers = []
        for kind_of, name, is_list in properties:
            if is_list:
                numbers += [(self.count_type, len(own.get(name, (1, 2))))] + [(kind_of, i) for i in own.get(name, (1, 2))]
            else:
                numbers.append((kind_of, own[name] if name in own else self.r.randrange(100)))
        if self.encoding == "ascii":
            text = [number(self.r, x) if isinstance(x, float) else str(x) for _, x in numbers]
            glue = self.r.choice([" ", "\n"]) if self.split else self.r.choice([" ", "\t", "  "])
            self.body += (glue.join(text) + (" 1 2 red" if self.surplus and self.r.random() < 0.3 else "") + "\n").encode()
            return
        sign = "<" if self.encoding == "binary_little_endian" else ">"
        for kind_of, x in numbers:
            code = PLY_TYPES[kind_of]
            self.body += struct.pack(sign + code, float(x) if code in "fd" else int(x))

    def content(self):
        comment = self.r.choice(["", "comment made by hand\n", "obj_info 3\n", "units mm\n"])
        lines = "ply\nformat %s 1.0\n%s%send_header\n" % (self.encoding, comment, self.header)
        end = self.r.choice(["\n", "\r\n", "\r"])
        body = self.body.replace(b"\n", end.encode()) if self.encoding == "ascii" else self.body
        return lines.replace("\n", end).encode() + body


def shuffled_with_others(r, properties):
    """Among up to two that nobody asks for."""
    others = [(r.choice(list(PLY_TYPES)), "extra%d" % i, r.random() < 0.3) for i in range(r.choice([0, 0, 1, 2]))]
    return r.sample(properties + others, len(properties + others))


def ply(r, kind, vertices, polygons):
    encoding = r.choice(["ascii", "binary_little_endian", "binary_big_endian"])
    if encoding == "ascii":
        coordinate = "float"  # which does not round the text
    else:
        coordinate = r.choice({"int8": ["char", "int16", "int", "float32", "float64"], "float": ["float", "double"],
                               "double": ["double"]}[kind])
    index_type = r.choice(["uchar", "int", "uint16", "short", "float", "double"])
    index_name = r.choice(["vertex_indices", "vertex_index"])
    file, triangles = Ply(r, encoding), []
    elements = ["vertex", "face"] + r.choice([[], ["edge"], ["tristrips"], ["tristrips", "edge"]])
    for element in r.sample(elements, len(elements)):
        if element == "vertex":
            file.add(element, shuffled_with_others(r, [(coordinate, axis, False) for axis in "xyz"]),
                     [dict(zip("xyz", v)) for v in vertices])
        elif element == "face":
            file.add(element, shuffled_with_others(r, [(index_type, index_name, True)]),
                     [{index_name: p} for p in polygons])
            triangles += [t for p in polygons for t in fan(p)]
        elif element == "edge":
            file.add(element, [("int", "vertex1", False), ("int", "vertex2", False)], [{}, {}])
        else:
            indices, made = strips_of(r, len(vertices))
            strip_type = r.choice(["int", "short", "int8", "float"])
            file.add(element, [(strip_type, "vertex_indices", True)], [{"vertex_indices": indices}])
            triangles += made
    return "ply", file.content(), [tuple(vertices[i] for i in t) for t in triangles]


# --- glTF

COMPONENTS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}


class Buffer:
    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def view(self, content, stride=None):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        view = {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(content)}
        if stride:
            view["byteStride"] = stride
        self.bytes += content
        self.views.append(view)
        return len(self.views) - 1

    def accessor(self, r, rows, component, kind):
        """Rows of numbers, with stride, offset or sparse replacements where that may be."""
        code = "<%d%s" % (len(rows[0]), COMPONENTS[component])
        size = struct.calcsize(code)
        stride = r.choice([size, size + 4, size + 8]) if kind == "VEC3" else size
        offset = r.choice([0, 4, 8])
        sparse = r.sample(range(len(rows)), r.randint(1, len(rows))) if r.random() < 0.3 else []
        sparse.sort()
        packed = [struct.pack(code, *row) for row in rows]
        dense = [bytes(size) if i in sparse else packed[i] for i in range(len(rows))]
        content = b"\x7f" * offset + b"".join(p.ljust(stride, b"\x55") for p in dense)
        accessor = {"componentType": component, "count": len(rows), "type": kind}
        if len(sparse) < len(rows) or r.random() < 0.5:
            accessor["bufferView"] = self.view(content, stride if stride != size else None)
            accessor["byteOffset"] = offset
        if sparse:
            index_type = r.choice([5121, 5123, 5125])
            indices = struct.pack("<%d%s" % (len(sparse), COMPONENTS[index_type]), *sparse)
            accessor["sparse"] = {"count": len(sparse),
                                  "indices": {"bufferView": self.view(indices), "componentType": index_type},
                                  "values": {"bufferView": self.view(b"".join(packed[i] for i in sparse))}}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def faces_of_mode(mode, corners):
    """Of a primitive: triangles, a strip or a fan."""
    if mode == 4:
        return [tuple(corners[i:i + 3]) for i in range(0, len(corners) - 2, 3)]
    if mode == 5:
        return [(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]) for i in range(len(corners) - 2)]
    return [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]


def shown_by_nodes(r, faces, vertices):
    """Nodes, and the triangles that they show. They scale by powers of two: nothing is rounded."""
    nodes, triangles = [], []
    for _ in range(r.randint(1, 3)):
        scale = [r.choice([1, 2, 0.5, -1, -4]) for _ in range(3)]
        node = {"mesh": 0}
        if r.random() < 0.5:
            node["scale"] = scale
        else:
            node["matrix"] = [scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, scale[2], 0, 0, 0, 0, 1]
        hidden = r.random() < 0.2
        if hidden or r.random() < 0.1:
            node["extensions"] = {"KHR_node_visibility": {"visible": not hidden}}
        nodes.append(node)
        if hidden:
            continue
        flipped = scale[0] * scale[1] * scale[2] < 0
        for a, b, c in faces:
            t = (a, c, b) if flipped else (a, b, c)
            triangles.append(tuple(tuple(x * s + 0.0 for x, s in zip(vertices[i], scale)) for i in t))
    return nodes, triangles


def glb(document, data):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def gltf(r, kind, vertices, polygons):
    buffer = Buffer()
    if kind == "int8":
        component, stored = r.choice([5120, 5122, 5126]), [tuple(map(int, v)) for v in vertices]
    else:
        component, stored = 5126, [tuple(rounded_to_float(x) if abs(x) < 1e38 else 1.0 for x in v) for v in vertices]
    primitive = {"attributes": {"POSITION": buffer.accessor(r, stored, component, "VEC3")}}
    mode = r.choice([4, 5, 6])
    if mode != 4 or r.random() < 0.5:
        primitive["mode"] = mode
    if r.random() < 0.2:
        corners = list(range(len(vertices)))
    else:
        corners = [i for p in polygons for t in fan(p) for i in t] if mode == 4 else [i for p in polygons for i in p]
        primitive["indices"] = buffer.accessor(r, [(i,) for i in corners], r.choice([5121, 5123, 5125]), "SCALAR")
    nodes, triangles = shown_by_nodes(r, faces_of_mode(mode, corners), [tuple(map(float, v)) for v in stored])
    document = {"asset": {"version": "2.0"}, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                "meshes": [{"primitives": [primitive]}], "accessors": buffer.accessors, "bufferViews": buffer.views,
                "buffers": [{"byteLength": len(buffer.bytes)}]}
    if r.random() < 0.5:
        return "glb", glb(document, buffer.bytes), triangles
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(buffer.bytes).decode()
    return "gltf", json.dumps(document, indent=r.choice([None, 1])).encode(), triangles


WRITERS = [obj, off, stl_ascii, stl_binary, ply, gltf]

# --- Readers


def read_obj(content):
    vertices, faces = [], []
    for line in content.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n").replace("\\\n", " ").split("\n"):
        words = line.split("#")[0].split()
        if words[:1] == ["v"]:
            vertices.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            indices = [int(w.split("/")[0]) for w in words[1:]]
            faces.append([i - 1 if i > 0 else len(vertices) + i for i in indices])
    return triangles_of(vertices, faces)


def read_off(content):
    lines = [line.split("#")[0].split() for line in content.decode("latin-1").splitlines()]
    lines = [words for words in lines if words]
    lines[0] = lines[0][0].rpartition("OFF")[2].split() + lines[0][1:]  # "OFF8 6 12" occurs
    lines = lines if lines[0] else lines[1:]
    n, m = int(lines[0][0]), int(lines[0][1])
    vertices = [tuple(map(float, words[:3])) for words in lines[1:n + 1]]
    return triangles_of(vertices, [list(map(int, words[1:1 + int(words[0])])) for words in lines[n + 1:n + 1 + m]])


def read_stl(content):
    count = struct.unpack("<I", content[80:84])[0] if len(content) >= 84 else -1
    if not content.lstrip().lower().startswith(b"solid") or b"\0" in content[:84] or len(content) == 84 + 50 * count:
        rows = [struct.unpack("<12fH", content[84 + 50 * i:134 + 50 * i]) for i in range(count)]
        return [(row[3:6], row[6:9], row[9:12]) for row in rows]
    words, corners, triangles = content.decode("latin-1").split(), [], []
    for i, word in enumerate(words):
        if word.lower() == "vertex":
            corners.append(tuple(map(float, words[i + 1:i + 4])))
        elif word.lower() == "endloop":
            triangles += triangles_of(corners, [range(len(corners))])
            corners = []
    return triangles


def read_ply(content):
    header, _, body = content.partition(b"end_header")
    body = body[2:] if body.startswith(b"\r\n") else body[1:]
    elements, sign = [], None
    for line in header.decode("latin-1").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            sign = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    lines = iter([words for words in (line.split() for line in body.split(b"\n")) if words]) if sign is None else None
    at = 0

    def take(kind):
        nonlocal at
        if lines is not None:
            return float(current.pop(0))
        code = sign + PLY_TYPES[kind]
        at += struct.calcsize(code)
        return struct.unpack(code, body[at - struct.calcsize(code):at])[0]

    vertices, faces = [], []
    for name, count, properties in elements:
        for _ in range(count):
            current = list(next(lines)) if lines is not None and properties else []
            row = {}
            for p in properties:
                row[p[-1]] = [take(p[2]) for _ in range(int(take(p[1])))] if p[0] == "list" else take(p[0])
            if name == "vertex":
                vertices.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                faces.append([int(i) for i in row.get("vertex_indices", row.get("vertex_index"))])
            elif name == "tristrips":
                strip = []
                for i in map(int, row["vertex_indices"]):
                    strip = [] if i == -1 else strip + [i]
                    if len(strip) >= 3:
                        faces.append(strip[-3:] if len(strip) % 2 else [strip[-2], strip[-3], strip[-1]])
    return triangles_of(vertices, faces)


READERS = {".obj": read_obj, ".off": read_off, ".stl": read_stl, ".ply": read_ply}

# Of the shared meshes.
ALIKE = 90
REFUSED = {"assimp__invalid.off", "assimp__malformed.obj", "draco__inf_nan.obj", "obj_nan.obj", "off_truncated.off",
           "ply_index_out_of_range.ply", "ply_truncated.ply", "ply_vertex_count_wrong.ply",
           "pmp-library__beetle.off", "stl_count_too_high.stl", "tinyobjloader__issue-140-zero-face-idx.obj",
           "tinyobjloader__test-nan.obj", "trimesh__empty.obj", "trimesh__empty.stl"}

# --- Comparison


def bits(x):
    return struct.pack("<d", x + 0.0)  # -0 and 0 are one position


def compare(dump, name, expected, answer):
    kind, _, rest = answer.partition(" ")
    if kind != "mesh":
        return None if not expected and "no triangles" in rest else "%s: %s" % (name, answer[:200])
    numbers = [float.fromhex(word) for word in rest.split()[1:]]
    wanted = [x for triangle in expected for corner in triangle for x in corner]
    if len(numbers) != len(wanted):
        return "%s: %d triangles, expected %d" % (name, len(numbers) // 9, len(wanted) // 9)
    for i, (got, want) in enumerate(zip(numbers, wanted)):
        if bits(got) != bits(want):
            return "%s: triangle %d: %r, expected %r" % (name, i // 9, got, want)
    return None


def ask(dump, paths):
    result = subprocess.run([dump], input="".join(path + "\n" for path in paths), capture_output=True, text=True)
    answers = result.stdout.splitlines()
    assert result.returncode == 0 and len(answers) == len(paths), result.stderr
    return answers


def written(dump, count, seed):
    """Yields what is wrong with meshes written here."""
    with tempfile.TemporaryDirectory() as directory:
        for start in range(0, count, 500):
            cases = []
            for i in range(start, min(start + 500, count)):
                r = random.Random("%d %d" % (seed, i))
                writer = WRITERS[i % len(WRITERS)]
                extension, content, triangles = writer(r, *random_mesh(r))
                path = os.path.join(directory, "%d.%s" % (i, extension))
                with open(path, "wb") as file:
                    file.write(content)
                cases.append((path, "mesh %d of seed %d, %s" % (i, seed, writer.__name__), triangles))
            for (path, name, triangles), answer in zip(cases, ask(dump, [path for path, *_ in cases])):
                wrong = compare(dump, name, triangles, answer)
                if wrong:
                    yield wrong
                os.unlink(path)


def real(dump, shared, limit):
    paths = []
    for folder, _, names in os.walk(shared):
        for name in names:
            path = os.path.join(folder, name)
            if os.path.splitext(name)[1].lower() in READERS and os.path.getsize(path) <= limit:
                paths.append(path)
    for path in sorted(paths):
        with open(path, "rb") as file:
            content = file.read()
        try:
            expected = READERS[os.path.splitext(path)[1].lower()](content)
        except (ValueError, IndexError, KeyError, TypeError, StopIteration, struct.error, ZeroDivisionError) as error:
            yield path, "read here: %r" % error, ask(dump, [path])[0]
            continue
        answer = ask(dump, [path])[0]
        yield path, compare(dump, path, expected, answer), answer


def check_the_check():
    """Known triangles must not pass for others."""
    answer = "mesh 0 " + " ".join(float(x).hex() for x in range(9))
    triangle = [((0., 1., 2.), (3., 4., 5.), (6., 7., 8.))]
    assert compare("", "", triangle, answer) is None
    assert compare("", "", [(triangle[0][1], triangle[0][0], triangle[0][2])], answer)
    assert compare("", "", triangle * 2, answer) and compare("", "", [], answer) and compare("", "", triangle, "error x")
    assert compare("", "", [((0., 1., 2.), (3., 4., 5.), (6., 7., 8.000000000000002))], answer)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("dump")
    parser.add_argument("shared", nargs="?")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--long", action="store_true")
    arguments = parser.parse_args()
    check_the_check()
    failures = list(written(arguments.dump, arguments.count, arguments.seed))
    print("%d meshes written" % arguments.count)
    if arguments.shared and os.path.isdir(arguments.shared):
        same, refused = 0, []
        for path, wrong, answer in real(arguments.dump, arguments.shared, 1 << 40 if arguments.long else 50000):
            if answer.startswith("error"):
                refused.append(os.path.basename(path))
            elif wrong:
                failures.append(wrong if wrong.startswith(path) else path + ": " + wrong)
            else:
                same += 1
        print("%d real files alike, refused: %s" % (same, ", ".join(refused) or "none"))
        if same < ALIKE or set(refused) - REFUSED:
            failures.append("at least %d real files are expected to be alike, and only these refused: %s" % (ALIKE, REFUSED))
    for failure in failures:
        print(failure)
    sys.exit(1 if failures else 0)


main()
