"""Small hostile files of every format that raycone reads: what it must answer to each.

TABLE holds rows (name, bytes, status, fragment): the exit status, and what the one line on standard error contains. The
extension of the name chooses how the file is read: .csv, .txt and .npy as points, .vdb by --like, all else as a mesh.
Status 0 stands for files that only look hostile. Nothing here is larger than a few kilobytes but for a long line.
"""

import base64
import gzip
import io
import json
import struct
import zipfile

VERTICES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
TABLE = []


def add(name, content, status, fragment=""):
    TABLE.append((name, content.encode() if isinstance(content, str) else content, status, fragment))


# --- OBJ

V = "".join("v %d %d %d\n" % v for v in VERTICES)
OBJ = V + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in FACES)
zipped = io.BytesIO()
with zipfile.ZipFile(zipped, "w", zipfile.ZIP_DEFLATED) as archive:
    archive.writestr(zipfile.ZipInfo("bomb.obj"), OBJ + "#" * 1000000, zipfile.ZIP_DEFLATED)

add("empty.obj", "", 2, "the file is empty")
add("comment_only.obj", "# nothing\n", 2, "no triangles")
add("no_faces.obj", V, 2, "no triangles")
add("only_short_faces.obj", V + "f 1 2\nf 1\nf\n", 2, "no triangles")
add("no_vertices.obj", "f 1 2 3\n", 2, ":1: face index 1, but the file has only 0 vertices")
add("index_zero.obj", V + "f 0 1 2\n", 2, ":5: face index 0, but OBJ counts vertices from 1")
add("index_beyond.obj", V + "f 1 2 5\n", 2, ":5: face index 5, but the file has only 4 vertices")
add("index_before.obj", V + "f -1 -2 -5\n", 2, ":5: face index -5, but only 4 vertices precede it")
add("index_2_to_32.obj", V + "f 1 2 4294967297\n", 2, "face index 4294967297")
add("index_2_to_64.obj", V + "f 1 2 18446744073709551617\n", 2, "face index 9223372036854775807")
add("index_least.obj", V + "f 1 2 -99999999999999999999\n", 2, "face index -9223372036854775808")
add("index_fraction.obj", V + "f 1 2 3.5\n", 2, ":5: expected a vertex index, found '3.5'")
add("index_word.obj", V + "f a b c\n", 2, "expected a vertex index, found 'a'")
add("index_glued.obj", V + "f 1 2 3x\n", 2, "expected a vertex index, found '3x'")
add("index_hex.obj", V + "f 1 2 0x3\n", 2, "expected a vertex index, found '0x3'")
add("index_slash_first.obj", V + "f /1 2 3\n", 2, "expected a vertex index, found '/1'")
add("index_sign_only.obj", V + "f 1 2 -\n", 2, "expected a vertex index, found '-'")
add("vertex_short.obj", "v 1 2\n" + OBJ, 2, ":1: expected a coordinate, found the end of the line")
add("vertex_word.obj", "v 1 2 x\n" + OBJ, 2, ":1: expected a coordinate, found 'x'")
add("vertex_comma.obj", "v 1,5 2 3\n" + OBJ, 2, ":1: expected a coordinate, found '1,5'")
add("vertex_hex.obj", "v 0x10 2 3\n" + OBJ, 2, "expected a coordinate, found '0x10'")
add("vertex_two_signs.obj", "v +-1 2 3\n" + OBJ, 2, "expected a coordinate, found '+-1'")
add("vertex_at_end.obj", OBJ + "v 1 2", 2, "expected a coordinate, found the end of the file")
add("nan_used.obj", V + "v nan 0 0\nf 1 2 5\n", 2, ":5: a vertex that faces use has a coordinate that is not finite")
add("inf_used.obj", V + "v 0 -inf 0\nf 1 2 5\n", 2, ":5: a vertex that faces use")
add("microsoft_nan_used.obj", V + "v 0 0 1.#QNAN\nf 1 2 5\n", 2, ":5: a vertex that faces use")
add("overflow_used.obj", V + "v 1e400 0 0\nf 1 2 5\n", 2, ":5: a vertex that faces use")
add("overflow_by_digits.obj", V + "v 1%s 0 0\nf 1 2 5\n" % ("0" * 400), 2, ":5: a vertex that faces use")
add("exponent_overflow.obj", V + "v 1e99999999999999999999 0 0\nf 1 2 5\n", 2, ":5: a vertex that faces use")
add("exponent_underflow.obj", "v 1e-99999999999999999999 0 0\n" + OBJ, 0)
add("nan_unused.obj", OBJ + "v nan inf 1e400\n", 0)
add("utf16_little.obj", b"\xff\xfe" + OBJ.encode("utf-16-le"), 2, "UTF-16")
add("utf16_big.obj", b"\xfe\xff" + OBJ.encode("utf-16-be"), 2, "UTF-16")
add("utf8_mark.obj", b"\xef\xbb\xbf" + OBJ.encode(), 0)
add("mixed_line_ends.obj", OBJ.replace("\n", "\r\n", 3), 0)
add("old_mac_line_ends.obj", OBJ.replace("\n", "\r"), 0)
add("nul_in_face.obj", V + "f 1 2\0 3\n", 2, "expected a vertex index, found '2?'")
add("nul_in_keyword.obj", "\0" + V + "f 1 2 3\n", 0)
add("control_bytes.obj", "v \x1b[31m 0 0\n" + OBJ, 2, "expected a coordinate, found '?[31m'")
add("random_bytes.obj", bytes(range(256)) * 4, 2, "no triangles")
add("zip_bomb.obj", zipped.getvalue(), 2, "no part _rels/.rels, expected a 3MF package")
add("gzip.obj", gzip.compress(OBJ.encode(), mtime=0), 0)
add("gzip_twice.obj.gz", gzip.compress(gzip.compress(OBJ.encode(), mtime=0), mtime=0), 2, "is compressed twice, expected once")
add("gzip_cut.obj.gz", gzip.compress(OBJ.encode(), mtime=0)[:-9], 2, "the compressed data end too early")
add("gzip_of_nothing.obj.gz", gzip.compress(b"", mtime=0), 2, "the file is empty")
add("gzip_two.obj.gz", gzip.compress(V.encode(), mtime=0) + gzip.compress(OBJ[len(V):].encode(), mtime=0), 0)
add("gzip_padded.obj.gz", gzip.compress(OBJ.encode(), mtime=0) + bytes(512), 0)
add("gzip_tail.obj.gz", gzip.compress(OBJ.encode(), mtime=0) + b"x", 2, "something other than compressed data")
add("gzip_header_only.obj.gz", b"\x1f\x8b", 2, "the compressed data end too early")
add("gzip_no_method.obj.gz", b"\x1f\x8b\x07" + bytes(60), 2, "damaged compressed data")
add("gzip_checksum.obj.gz", gzip.compress(OBJ.encode(), mtime=0)[:-8] + bytes(8), 2, "damaged compressed data")
add("zstd_header_only.obj.zst", b"\x28\xb5\x2f\xfd", 2, "the compressed data end too early")
add("zstd_damaged.obj.zst", b"\x28\xb5\x2f\xfd" + b"\xff" * 60, 2, "damaged compressed data")
add("html.obj", "<!DOCTYPE html><html><body>404</body></html>\n", 2, "no triangles")
add("pointer_of_git_lfs.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", 2, "no triangles")
add("endless_continuation.obj", OBJ + "f 1 \\\n" * 300, 2, "expected a vertex index, found 'f'")
add("long_line.obj", OBJ + "# " + "x" * 3000000 + "\n", 0)
add("long_number.obj", "v 0." + "3" * 100000 + " 0 0\n" + OBJ, 0)
add("long_word.obj", "v " + "x" * 100000 + "\n", 2, "found '" + "x" * 120 + "...'")
add("long_object_many_groups.obj", "o " + "x" * 300000 + "\n" + "g y\n" * 100000 + OBJ, 0)
add("many_groups.obj", "".join("g %x\n" % n for n in range(30000)) + OBJ, 0)
add("nul_in_group.obj", "g a\0b\x1b[31m\xff\n" + OBJ, 0)
add("group_of_backslashes.obj", "g \\ \\\\ a\\\n\\\n\n" + OBJ, 0)
add("degenerate.obj", V + "f 1 1 1\nf 1 2 1\n", 0)

# --- OFF

OFF_BODY = "".join("%d %d %d\n" % v for v in VERTICES) + "".join("3 %d %d %d\n" % f for f in FACES)
OFF = "OFF\n4 4 6\n" + OFF_BODY
add("empty.off", "", 2, "the file is empty")
add("keyword_only.off", "OFF", 2, "expected the number of vertices, found the end of the file")
add("keyword_line_only.off", "OFF\n", 2, "expected the number of vertices, found the end of the file")
add("no_counts.off", "OFF\nx\n", 2, ":2: expected the number of vertices, found 'x'")
add("one_count.off", "OFF\n4\n" + OFF_BODY, 2, ":2: expected the number of faces, found the end of the line")
add("negative_count.off", "OFF\n-4 4 0\n" + OFF_BODY, 2, ":2: expected 0 or more vertices, found -4")
add("fractional_count.off", "OFF\n4.5 4 0\n" + OFF_BODY, 2, ":2: expected the number of vertices, found '4.5'")
add("billions_of_vertices.off", "OFF\n4000000000 4 0\n" + OFF_BODY, 2, "4000000000 vertices announced, but only")
add("vertices_2_to_64.off", "OFF\n18446744073709551615 4 0\n" + OFF_BODY, 2, "vertices announced, but only")
add("billions_of_faces.off", "OFF\n4 4000000000 0\n" + OFF_BODY, 2, "4000000000 faces announced, but only")
add("too_few_vertices.off", "OFF\n9 1 0\n" + OFF_BODY, 2, "the file ends after 8 of 9 vertices")
add("too_few_faces.off", "OFF\n4 9 6\n" + OFF_BODY, 2, "the file ends after 4 of 9 faces")
add("too_many_faces.off", "OFF\n4 3 6\n" + OFF_BODY, 0, "lines after the last face ignored")
add("cut_in_vertices.off", OFF[: OFF.index("0 1 0")], 2, "4 vertices announced, but only 12 bytes follow")
add("cut_in_face.off", OFF[:-4], 2, ": expected a vertex index, found")
add("index_beyond.off", OFF.replace("3 2 0 3", "3 2 0 4"), 2, "face index 4, but there are only 4 vertices")
add("index_negative.off", OFF.replace("3 2 0 3", "3 2 0 -1"), 2, "face index -1, but there are only 4 vertices")
add("index_2_to_32.off", OFF.replace("3 2 0 3", "3 2 0 4294967296"), 2, "face index 4294967296")
add("corners_negative.off", OFF.replace("3 2 0 3", "-3 2 0 3"), 2, "expected 0 or more corners, found -3")
add("corners_billions.off", OFF.replace("3 2 0 3", "4000000000 2 0 3"), 2, "expected a vertex index, found the end of the")
add("nan_used.off", OFF.replace("0 0 1\n", "0 nan 1\n"), 2, ":6: a vertex that faces use")
add("overflow_used.off", OFF.replace("0 0 1\n", "0 1e999 1\n"), 2, ":6: a vertex that faces use")
add("binary.off", b"OFF BINARY\n" + struct.pack(">3i", 4, 4, 6), 2, "binary OFF is not supported")
add("four_dimensions.off", OFF.replace("OFF", "4OFF"), 2, "4OFF is not supported")
add("n_dimensions.off", "nOFF\n3\n" + OFF_BODY, 2, "nOFF is not supported")
add("utf16.off", b"\xff\xfe" + OFF.encode("utf-16-le"), 2, "UTF-16")
add("other_keyword.off", "OOF\n" + OFF_BODY, 2, "expected 'OFF', found 'OOF'")
add("nul.off", OFF.replace("0 0 1\n", "0 \0 1\n"), 2, "expected a coordinate, found '?'")

# --- PLY


def ply(form, body, vertices="4", faces="4", properties="property float x\nproperty float y\nproperty float z\n",
        listed="property list uchar int vertex_indices\n", magic="ply\n"):
    header = (magic + "format %s 1.0\nelement vertex %s\n%selement face %s\n%send_header\n"
              % (form, vertices, properties, faces, listed))
    return header.encode() + body


PLY_TEXT = OFF_BODY.encode()
PLY_LITTLE = b"".join(struct.pack("<3f", *v) for v in VERTICES) + b"".join(struct.pack("<B3i", 3, *f) for f in FACES)
PLY_BIG = b"".join(struct.pack(">3f", *v) for v in VERTICES) + b"".join(struct.pack(">B3i", 3, *f) for f in FACES)
LITTLE, BIG = "binary_little_endian", "binary_big_endian"
add("good_ascii.ply", ply("ascii", PLY_TEXT), 0)
add("good_little.ply", ply(LITTLE, PLY_LITTLE), 0)
add("good_big.ply", ply(BIG, PLY_BIG), 0)
add("magic_only.ply", "ply\n", 2, "expected 'end_header', found the end of the file")
add("no_format.ply", "ply\nelement vertex 0\nend_header\n", 2, "format")
add("unknown_format.ply", ply("binary_middle_endian", PLY_LITTLE), 2, "binary_middle_endian")
add("version_2.ply", ply("ascii", PLY_TEXT).replace(b"1.0", b"2.0"), 0)
add("no_end_of_header.ply", ply("ascii", PLY_TEXT).replace(b"end_header\n", b""), 2, "expected 'element', 'property' or 'end_header', found '0'")
add("header_cut.ply", ply("ascii", PLY_TEXT)[:60], 2, "expected 'end_header', found the end of the file")
add("unknown_type.ply", ply("ascii", PLY_TEXT, properties="property quad x\nproperty float y\nproperty float z\n"), 2, "quad")
add("list_of_floats_counted_by_float.ply",
    ply("ascii", PLY_TEXT, listed="property list float int vertex_indices\n"), 0)
add("no_z.ply", ply("ascii", PLY_TEXT, properties="property float x\nproperty float y\n"), 2, "z")
add("x_twice.ply", ply("ascii", PLY_TEXT, properties="property float x\nproperty float x\nproperty float y\nproperty float z\n"), 2, "expected the end of the line, found '0'")
add("x_is_list.ply", ply("ascii", PLY_TEXT, properties="property list uchar float x\nproperty float y\nproperty float z\n"), 2, "element 'vertex' has no number 'x', expected 'x', 'y' and")
add("property_before_element.ply", b"ply\nformat ascii 1.0\nproperty float x\nend_header\n", 2, "property before the first element")
add("no_vertices.ply", b"ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n", 2, "the header has no element 'vertex'")
add("no_faces.ply", ply("ascii", OFF_BODY.split("3 0")[0].encode(), faces="0"), 2, "no triangles")
add("negative_count.ply", ply("ascii", PLY_TEXT, vertices="-4"), 2, "-4")
add("word_count.ply", ply("ascii", PLY_TEXT, vertices="many"), 2, "many")
add("billions_ascii.ply", ply("ascii", PLY_TEXT, vertices="4000000000"), 2, "4000000000")
add("billions_binary.ply", ply(LITTLE, PLY_LITTLE, vertices="4000000000"), 2, "4000000000")
add("count_2_to_64.ply", ply(LITTLE, PLY_LITTLE, vertices="18446744073709551616"), 2, "byte 188: 9223372036854775807 elements 'vertex' announced,")
add("billions_of_faces.ply", ply(BIG, PLY_BIG, faces="4000000000"), 2, "4000000000")
add("billions_of_nothing.ply", ply("ascii", PLY_TEXT, properties="property float x\nproperty float y\nproperty float z\n"
                                   "element nothing 4000000000\n"), 0)
add("list_count_negative.ply", ply(LITTLE, PLY_LITTLE[:48] + struct.pack("<b3i", -3, 0, 1, 2), faces="1",
                                   listed="property list char int vertex_indices\n"), 2, "-3")
add("list_count_huge.ply", ply(LITTLE, PLY_LITTLE[:48] + struct.pack("<I3i", 4000000000, 0, 1, 2), faces="1",
                               listed="property list uint int vertex_indices\n"), 2, "byte 232: the file ends within an element")
add("list_overflow.ply", ply(LITTLE, PLY_LITTLE[:48] + struct.pack("<I3d", 0x20000001, 0, 1, 2), faces="1",
                             listed="property list uint double vertex_indices\n"), 2, "byte 247: the file ends within an element")
add("index_beyond_ascii.ply", ply("ascii", PLY_TEXT.replace(b"3 2 0 3", b"3 2 0 4")), 2, "face index 4, but there are only 4")
add("index_beyond_little.ply", ply(LITTLE, PLY_LITTLE[:-4] + struct.pack("<i", 4)), 2, "face index 4, but there are only 4")
add("index_negative_big.ply", ply(BIG, PLY_BIG[:-4] + struct.pack(">i", -1)), 2, "face index -1, but there are only 4")
add("index_fraction.ply", ply("ascii", PLY_TEXT.replace(b"3 2 0 3", b"3 2 0 2.5"), listed="property list uchar float vertex_indices\n"), 2, "expected an integer")
add("nan_used.ply", ply(LITTLE, struct.pack("<f", float("nan")) + PLY_LITTLE[4:]), 2, "a vertex that faces use")
add("inf_used.ply", ply(BIG, struct.pack(">f", float("inf")) + PLY_BIG[4:]), 2, "a vertex that faces use")
add("overflow_used.ply", ply("ascii", PLY_TEXT.replace(b"1 0 0", b"1e999 0 0", 1)), 2, "a vertex that faces use")
add("text_declared_binary.ply", ply(LITTLE, PLY_TEXT), 2, "byte 225: the file ends within an element")
add("binary_declared_text.ply", ply("ascii", PLY_LITTLE), 2, "expected a number, found")
add("line_ends_mixed_header.ply", ply("ascii", PLY_TEXT).replace(b"float x\n", b"float x\r\n"), 0)
add("line_ends_of_windows.ply", ply("ascii", PLY_TEXT).replace(b"\n", b"\r\n"), 0)
add("utf8_mark.ply", b"\xef\xbb\xbf" + ply("ascii", PLY_TEXT), 0)
add("utf16.ply", b"\xff\xfe" + ply("ascii", PLY_TEXT).decode().encode("utf-16-le"), 2, "the text is UTF-16, expected UTF-8 or ASCII")
add("row_too_long.ply", ply("ascii", PLY_TEXT.replace(b"1 0 0\n", b"1 0 0 7\n", 1)), 0, "1 row longer than the header announces, what is too much ignored")
add("rows_too_long.ply", ply("ascii", PLY_TEXT.replace(b"\n", b" 7 8\n")), 0, "8 rows longer than the header announces")
add("row_too_short.ply", ply("ascii", PLY_TEXT.replace(b"1 0 0\n", b"1 0\n", 1)), 2, "expected the end of the line")
add("keyword_unknown.ply", ply("ascii", PLY_TEXT).replace(b"element face", b"made_by hand\nelement face"), 0, "1 header line of no known keyword ignored")
add("keyword_misspelled.ply", ply("ascii", PLY_TEXT).replace(b"element face", b"elements face"), 2, ":")
for part, cut, fragment in (("header", 9, "expected 'end_header', found the end of the file"),
                            ("first_vertex", -100, "4 elements 'vertex' announced, but only 0 bytes follow"),
                            ("last_vertex", -53, "4 elements 'vertex' announced, but only 47 bytes follow"),
                            ("first_face", -52, "4 elements 'face' announced, but only 0 bytes follow"),
                            ("in_face", -40, "the file ends within an element"),
                            ("last_index", -4, "the file ends within an element"),
                            ("last_byte", -1, "the file ends within an element")):
    add("cut_%s_little.ply" % part, ply(LITTLE, PLY_LITTLE)[:cut], 2, fragment)
    add("cut_%s_big.ply" % part, ply(BIG, PLY_BIG)[:cut], 2, fragment)
add("cut_faces_ascii.ply", ply("ascii", PLY_TEXT)[:-8], 2, "expected an integer, found the end of the file")
add("cut_number_ascii.ply", ply("ascii", PLY_TEXT)[:-2], 2, "expected an integer, found the end of the file")

# --- STL

FACET = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n"
STL = "solid a\n" + FACET + "endsolid a\n"
RECORD = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def stl(count, body, header=b""):
    return header.ljust(80, b" ") + struct.pack("<I", count) + body


add("solid_only.stl", "solid a\nendsolid a\n", 2, "no triangles")
add("no_endsolid.stl", "solid a\n" + FACET, 0)
add("one_line.stl", STL.replace("\n", " "), 0)
add("facet_in_line_of_solid.stl", STL.replace("\n", " ", 1), 0)
add("facet_in_name.stl", "solid facet normal 0 0 1 outer\nendsolid\n", 2, "no triangles")
add("no_vertices.stl", STL.replace("  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n", ""), 2, "no triangles")
add("two_vertices.stl", STL.replace("  vertex 1 0 0\n", ""), 2, "no triangles")
add("vertex_short.stl", STL.replace("vertex 1 0 0", "vertex 1 0"), 2, "expected a coordinate, found 'vertex'")
add("vertex_word.stl", STL.replace("vertex 1 0 0", "vertex 1 0 x"), 2, ":5: expected a coordinate, found 'x'")
add("nan_used.stl", STL.replace("vertex 1 0 0", "vertex 1 nan 0"), 2, ":5: a vertex that faces use")
add("overflow_used.stl", STL.replace("vertex 1 0 0", "vertex 1 1e400 0"), 2, ":5: a vertex that faces use")
add("nan_normal.stl", STL.replace("normal 0 0 1", "normal nan -1.#IND x"), 0)
add("no_loop.stl", STL.replace(" outer loop\n", ""), 2, "expected 'outer', found 'vertex'")
add("no_endloop.stl", STL.replace(" endloop\n", ""), 2, "expected 'vertex' or 'endloop', found 'endfacet'")
add("other_word.stl", STL.replace("endfacet", "endfasset"), 2, ":8: expected 'endfacet', found 'endfasset'")
add("cut_in_vertex.stl", STL[: STL.index("1 0 0") + 3], 2, "expected a coordinate, found the end of the file")
add("cut_in_loop.stl", STL[: STL.index(" endloop")], 2, "expected 'vertex' or 'endloop', found the end of the file")
add("cut_in_normal.stl", "solid a\nfacet normal 0", 2, "found the end of the file")
add("utf16.stl", b"\xff\xfe" + STL.encode("utf-16-le"), 2, "UTF-16")
add("short_header.stl", b"x" * 50, 2, "the file has only 50")
add("header_only.stl", b" " * 80, 2, "the file has only 80")
add("no_triangles.stl", stl(0, b""), 2, "no triangles")
add("billions.stl", stl(4000000000, RECORD), 2, "4000000000 triangles announced, but only 1 follow")
add("one_too_many.stl", stl(3, RECORD * 2), 2, "3 triangles announced, but only 2 follow")
add("cut_record.stl", stl(1, RECORD[:-1]), 2, "1 triangle announced, but only 0 follow")
add("surplus.stl", stl(1, RECORD * 2 + b"x"), 0, "bytes after the announced number of triangles")
add("solid_binary.stl", stl(1, RECORD, b"solid like text"), 0)
add("nan_binary.stl", stl(1, RECORD[:12] + struct.pack("<f", float("nan")) + RECORD[16:]), 2, "byte 96: a vertex that faces use")
add("inf_binary.stl", stl(1, RECORD[:-6] + struct.pack("<f", float("inf")) + RECORD[-2:]), 2, "a vertex that faces use")
add("nan_binary_normal.stl", stl(1, struct.pack("<f", float("nan")) + RECORD[4:]), 0)


def binary_stl(*triangles):
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for corner in t for x in corner), 0) for t in triangles)


# Vertices whose hashes were equal whatever the seed, so that welding them never ended.
add("floats_of_one_hash.stl", binary_stl([(1, 1.5, 0.25), (-1, -1.500003814697265625, 0.25), (0, 0, 0)]), 0)
add("integers_of_one_hash.stl", binary_stl([(10, 262144, 5), (-10, -262145, 5), (0, 0, 0)]), 0)


# --- Polygons

BOW = "v 0 0 0\nv 4 3 0\nv 4 0 0\nv 0 2 0\n"
add("polygon_crossing.obj", BOW + "f 1 2 3 4\n", 0, "bad-polygons: 1 polygon that")
add("polygons_crossing.obj", BOW + "f 1 2 3 4\nf 4 3 2 1\n", 0, "bad-polygons: 2 polygons that")
add("polygon_on_a_line.obj", "v 0 0 0\nv 1 1 1\nv 3 3 3\nv 2 2 2\nf 1 2 3 4\n", 0)
add("polygon_of_one_vertex.obj", V + "f 1 1 1 1 1\n", 0)
add("polygon_twice_around.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n6 0 1 2 0 1 2\n", 0, "bad-polygons: 1 polygon that")
add("polygon_of_extremes.obj", "v 1e308 0 0\nv -1e308 5e-324 0\nv 0 1e308 1e-308\nv 1e308 1e308 -1e308\nf 1 2 3 4\n", 0)
add("polygon_concave.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 1 1 0\nvertex 0 3 0\n"
    "endloop\nendfacet\n", 0)
add("polygon_petals.obj", "v 0 0 0\n" + "".join("v %d %d 0\n" % (i, i * i) for i in range(1, 2001))
    + "f" + "".join(" 1 %d %d" % (i, i + 1) for i in range(2, 2001, 2)) + "\n", 0)

# --- glTF and GLB

POSITIONS = b"".join(struct.pack("<3f", *v) for v in VERTICES)
INDICES = b"".join(struct.pack("<3H", *f) for f in FACES)


def data_uri(content):
    return "data:application/octet-stream;base64," + base64.b64encode(content).decode()


def gltf(change=None, content=POSITIONS + INDICES):
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": 72, "uri": data_uri(content)}]}
    if change:
        change(document)
    return json.dumps(document)


def put(*path_and_value):
    *path, last, value = path_and_value

    def change(document):
        for key in path:
            document = document[key]
        document[last] = value

    return gltf(change)


def glb(document, content, version=2, length=None, magic=b"glTF"):
    text = document.encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(content), b"BIN\0") + content
    return struct.pack("<4sII", magic, version, 12 + len(chunks) if length is None else length) + chunks


GLB_JSON = gltf(lambda d: d["buffers"][0].pop("uri"))
GLB = glb(GLB_JSON, POSITIONS + INDICES)
add("good.gltf", gltf(), 0)
add("good.glb", GLB, 0)
add("name_is_a_number.gltf", put("meshes", 0, "name", 5), 0)
add("name_is_long.gltf", put("meshes", 0, "name", "x" * 100000), 0)
add("no_asset.gltf", gltf(lambda d: d.pop("asset")), 2, "document: asset version is missing, expected glTF 2.0")
add("version_1.gltf", put("asset", "version", "1.0"), 2, "1.0")
add("cut.gltf", gltf()[:-1], 2, "while parsing object - unexpected end of input; expected")
add("cut_in_string.gltf", gltf()[:20], 2, "while parsing object separator - unexpected end of input;")
add("array.gltf", "[]", 2, "document is not an object")
add("nested.gltf", '{"asset":{"version":"2.0"},"x":' + "[" * 100000 + "]" * 100000 + "}", 2, "JSON is nested deeper than 256 levels")
add("number_overflow.gltf", put("nodes", 0, "translation", [0, 0, 1]).replace("[0, 0, 1]", "[0, 0, 1e999]"), 2, "number overflow parsing '1e999', expected a glTF document")
add("member_twice.gltf", gltf().replace('"mesh": 0', '"mesh": 0, "mesh": 0'), 2, "JSON with two members 'mesh' in one object, expected one")
add("minimum_version.gltf", put("asset", {"version": "2.0", "minVersion": "2.1"}), 2, "minVersion 2.1, expected glTF 2.0")
add("invisible.gltf", put("nodes", 0, "extensions", {"KHR_node_visibility": {"visible": False}}), 2, "no triangles")
add("invisible_word.gltf", put("nodes", 0, "extensions", {"KHR_node_visibility": {"visible": "no"}}), 2, "visible is \"no\", expected true or false")
add("no_meshes.gltf", put("nodes", 0, {}), 2, "no triangles")
add("scene_beyond.gltf", put("scene", 7), 2, "7")
add("node_beyond.gltf", put("scenes", 0, "nodes", [1]), 2, "1")
add("node_negative.gltf", put("scenes", 0, "nodes", [-1]), 2, "-1")
add("node_cycle.gltf", put("nodes", [{"mesh": 0, "children": [1]}, {"children": [0]}]), 2, "some nodes are their own ancestors, expected a tree")
add("node_own_child.gltf", put("nodes", 0, "children", [0]), 2, "some nodes are their own ancestors, expected a tree")
add("nodes_two_parents.gltf", put("nodes", [{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}]), 0)
add("node_chain.gltf", put("nodes", [{"children": [i + 1]} for i in range(20000)] + [{"mesh": 0}]), 0)
add("child_twice.gltf", put("nodes", [{"children": [1, 1]}, {"mesh": 0}]), 2, "node 0 has the child 1 twice, expected once")
# Each of many nodes or primitives would be compared with a long list: minutes. Sanitizers take as long to read them.
LONG_TO_READ = {"weights_of_many.gltf", "draco_of_many.gltf"}
ZEROS = [0] * 750000
add("weights_of_many.gltf", gltf(lambda d: d.update(
    nodes=[{"children": [150000]}] * 150000 + [{"mesh": 0, "weights": ZEROS}], scenes=[{"nodes": list(range(150000))}],
    meshes=[{**d["meshes"][0], "weights": ZEROS}])), 0)
DRACO = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
add("draco_of_many.gltf", gltf(lambda d: d.update(
    extensionsRequired=["_xmp"] * 800000,
    meshes=[{"primitives": [{**d["meshes"][0]["primitives"][0], "extensions": DRACO}] * 20000}])), 0)
add("exponential_nodes.gltf", put("nodes", [{"children": [i // 2 * 2 + 2, i // 2 * 2 + 3]} for i in range(128)] + [{"mesh": 0}] * 2), 4, "nodes with several parents make too many copies")
add("mesh_beyond.gltf", put("nodes", 0, "mesh", 3), 2, "3")
add("matrix_short.gltf", put("nodes", 0, "matrix", [1, 0, 0]), 2, "node 0: matrix has 3 numbers, expected 16")
add("matrix_words.gltf", put("nodes", 0, "matrix", ["a"] * 16), 2, "node 0: matrix holds \"a\", expected a number")
add("scale_overflow.gltf", put("nodes", 0, "scale", [1e308, 1e308, 1e308]).replace("AACAPw", "AACAfw"), 2, "mesh 0, primitive 0: vertex 1 is (inf, 0.000000, 0.000000),")
add("accessor_beyond.gltf", put("meshes", 0, "primitives", 0, "attributes", "POSITION", 9), 2, "9")
add("accessor_count.gltf", put("accessors", 0, "count", 5), 2, "accessor 0 has 5 elements of 12 bytes at byte 0, more than")
add("accessor_count_billions.gltf", put("accessors", 0, "count", 4000000000), 2, "4000000000")
add("accessor_count_2_to_63.gltf", put("accessors", 0, "count", 9223372036854775807), 2, "accessor 0 has 9223372036854775807 elements of 12 bytes at")
add("accessor_count_negative.gltf", put("accessors", 0, "count", -1), 2, "accessor 0: count is -1, expected a non-negative integer")
add("accessor_offset.gltf", put("accessors", 0, "byteOffset", 4), 2, "accessor 0 has 4 elements of 12 bytes at byte 4, more than")
add("accessor_offset_overflow.gltf", put("accessors", 0, "byteOffset", 18446744073709551612), 2, "accessor 0 has 4 elements of 12 bytes at byte")
add("accessor_type.gltf", put("accessors", 0, "type", "MAT4"), 2, "accessor 0 holds no positions")
add("accessor_component.gltf", put("accessors", 0, "componentType", 5124), 2, "accessor 0 holds no positions")
add("indices_of_floats.gltf", put("accessors", 1, "componentType", 5126), 2, "accessor 1 holds no indices, expected SCALAR of unsigned")
add("index_beyond.gltf", gltf(content=POSITIONS + INDICES[:-2] + struct.pack("<H", 4)), 2, "4")
add("zero_billions.gltf", put("accessors", 0, {"componentType": 5126, "count": 4000000000, "type": "VEC3"}), 4, "would grow to more than")
add("view_beyond.gltf", put("accessors", 0, "bufferView", 5), 2, "5")
add("view_too_long.gltf", put("bufferViews", 0, "byteLength", 4000), 2, "bufferView 0: 4000 bytes at byte 0, but buffer 0 has only 72")
add("view_offset_overflow.gltf", put("bufferViews", 0, "byteOffset", 18446744073709551615), 2, "bufferView 0: 48 bytes at byte 18446744073709551615, but")
add("view_stride_small.gltf", put("bufferViews", 0, "byteStride", 4), 2, "accessor 0 has elements of 12 bytes, more than the")
add("view_stride_large.gltf", put("bufferViews", 0, "byteStride", 252), 2, "accessor 0 has 4 elements of 12 bytes at byte 0, more than")
add("buffer_beyond.gltf", put("bufferViews", 0, "buffer", 5), 2, "5")
add("buffer_short.gltf", put("buffers", 0, "byteLength", 4000), 2, "buffer 0 has 72 bytes, expected 4000")
add("buffer_missing.gltf", put("buffers", 0, "uri", "absent.bin"), 2, "absent.bin")
add("buffer_outside.gltf", put("buffers", 0, "uri", "../outside.bin"), 2, "outside.bin")
add("buffer_outside_encoded.gltf", put("buffers", 0, "uri", "%2e%2e/outside.bin"), 2, "outside.bin")
add("buffer_absolute.gltf", put("buffers", 0, "uri", "/etc/passwd"), 2, "/etc/passwd")
add("buffer_file_scheme.gltf", put("buffers", 0, "uri", "file:///etc/passwd"), 2, "file:///etc/passwd")
add("buffer_http.gltf", put("buffers", 0, "uri", "http://127.0.0.1/a.bin"), 2, "http://127.0.0.1/a.bin")
add("buffer_device.gltf", put("buffers", 0, "uri", "zero"), 2, "zero")
add("buffer_bad_base64.gltf", put("buffers", 0, "uri", "data:;base64,@@@@"), 2, "buffer 0: \"data:;base64\" is not followed by valid base64")
add("buffer_cut_base64.gltf", put("buffers", 0, "uri", data_uri(POSITIONS + INDICES)[:-3]), 2, "buffer 0: \"data:application/octet-stream;base64\" is not")
add("buffer_nul_in_uri.gltf", put("buffers", 0, "uri", "a%00b"), 2, "buffer 0: \"a%00b\" is not a file name")
add("data_uri_bomb.gltf", put("buffers", 0, {"byteLength": 4000000000000, "uri": data_uri(b"x")}), 2, "buffer 0 has 1 byte, expected 4000000000000")
add("draco_required.gltf", gltf(lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"])), 0)


def draco(stream, vertices, corners):
    extension = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}

    def change(document):
        document["extensionsRequired"] = list(extension)
        document["meshes"][0]["primitives"][0]["extensions"] = extension
        document["accessors"] = [{"componentType": 5126, "count": vertices, "type": "VEC3"},
                                 {"componentType": 5125, "count": corners, "type": "SCALAR"}]
        document["bufferViews"] = [{"buffer": 0, "byteLength": len(stream)}]
        document["buffers"] = [{"byteLength": len(stream), "uri": data_uri(stream)}]

    return gltf(change)


# Header, no metadata, varints of faces and points, indices of 8 bits, one attribute of three floats, generic.
DRACO_HEADER = b"DRACO\x02\x02\x01\x00\x00\x00"
DRACO = (DRACO_HEADER + bytes([4, 4, 1]) + bytes(i for f in FACES for i in f) + bytes([1, 1, 0, 9, 3, 0, 0, 0]) + POSITIONS)
add("draco.gltf", draco(DRACO, 4, 12), 0)
add("draco_cut.gltf", draco(DRACO[:-1], 4, 12), 2, "mesh 0, primitive 0: Draco data cannot be decoded")
add("draco_counts.gltf", draco(DRACO, 5, 12), 0)
add("draco_index.gltf", draco(DRACO[:14] + b"\x07" + DRACO[15:], 4, 12), 2, "mesh 0, primitive 0: ")
add("draco_billions.gltf", draco(DRACO_HEADER + b"\xff\xff\xff\xff\x0f\x03" + bytes(50), 4, 12), 4, "claim to hold far more")
add("unknown_required.gltf", gltf(lambda d: d.update(extensionsRequired=["EXT_unheard_of"])), 2, "EXT_unheard_of")
add("sparse_index_beyond.gltf", put("accessors", 0, "sparse", {"count": 1, "indices": {"bufferView": 1, "byteOffset": 22, "componentType": 5123}, "values": {"bufferView": 0}}).replace('"count": 4,', '"count": 3,'), 2, "accessor 0 has sparse index 3, but only 3 elements")
add("sparse_count_billions.gltf", put("accessors", 0, "sparse", {"count": 4000000000, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}), 2, "accessor 0 has 4000000000 elements of 2 bytes at byte 0,")
add("magic_only.glb", "glTF", 2, "byte 4: GLB ends within its header")
add("version_1.glb", glb(GLB_JSON, POSITIONS + INDICES, version=1), 2, "byte 4: GLB version 1, expected 2")
add("length_short.glb", glb(GLB_JSON, POSITIONS + INDICES, length=20), 2, "byte 12: chunk of 464 bytes, but only 0 remain")
add("length_long.glb", glb(GLB_JSON, POSITIONS + INDICES, length=4000000000), 2, "byte 8: GLB announces 4000000000 bytes, but has 564")
add("cut_json.glb", GLB[:60], 2, "byte 8: GLB announces 564 bytes, but has 60")
add("cut_binary.glb", GLB[:-1], 2, "byte 8: GLB announces 564 bytes, but has 563")
add("cut_chunk_header.glb", GLB[:16], 2, "byte 8: GLB announces 564 bytes, but has 16")
add("no_binary.glb", GLB[: 20 + struct.unpack("<I", GLB[12:16])[0]], 2, "byte 8: GLB announces 564 bytes, but has 484")
add("chunk_length.glb", GLB[:12] + struct.pack("<I", 4294967292) + GLB[16:], 2, "byte 12: chunk of 4294967292 bytes, but only 544 remain")
add("binary_first.glb", GLB[:16] + b"BIN\0" + GLB[20:], 2, "byte 16: first chunk of the GLB is not JSON")

# --- Points

add("empty.csv", "", 0)
add("fortran_first.csv", "1D0,2D0,3D0\n1,2,3\n", 2, ":1: column 1 is '1D0', expected a finite number")
add("hexadecimal_first.csv", "0x1,0x2,0x3\n1,2,3\n", 2, ":1: column 1 is '0x1', expected a finite number")
add("empty_first.csv", ",,\n1,2,3\n", 2, ":1: column 1 is empty, expected a finite number")
add("unicode_minus_first.csv", "\u22121,\u22122,\u22123\n1,2,3\n", 2, ":1: column 1 is '???1', expected")
add("header_only.csv", "x,y,z\n", 0)
add("two_columns.csv", "0,0,0\n1,2\n", 2, ":2: found '1,2' with 2 columns, expected at least 3")
add("word.csv", "0,0,0\n1,x,2\n", 2, ":2: column 2 is 'x', expected a finite number")
add("nan.csv", "0,0,0\n1,nan,2\n", 2, ":2: column 2 is 'nan', expected a finite number")
add("inf.csv", "0,0,0\n1,2,-inf\n", 2, ":2: column 3 is '-inf', expected a finite number")
add("overflow.csv", "0,0,0\n1e400,2,3\n", 2, ":2: column 1 is '1e400', expected a finite number")
add("empty_field.csv", "0,0,0\n1,,3\n", 2, ":2: column 2 is empty, expected a finite number")
add("decimal_comma.csv", "1,5;2,5;3,5\n", 2, "column 1 is '1,5', expected a finite number")
add("second_header.csv", "x,y,z\n0,0,0\nx,y,z\n", 2, ":3: column 1 is 'x'")
add("nul.csv", "0,0,0\n1,2\0,3\n", 2, ":2: column 2 is '2?'")
add("binary.csv", bytes(range(256)), 2, "the input is binary, expected text")
add("utf16.csv", b"\xff\xfe" + "0,0,0\n".encode("utf-16-le"), 2, "UTF-16")
add("utf8_mark.csv", b"\xef\xbb\xbf0,0,0\n", 0)
add("long_line.csv", "0" * 3000000, 2, "line of more than 1048576 bytes")
add("endless_quote.csv", '0,0,0\n"1,2,3\n', 2, "2: a quotation mark without its end, expected it in the same line")
add("mixed_line_ends.csv", "0,0,0\r\n1,1,1\n2,2,2\r\n", 0)
add("no_last_line_end.csv", "0,0,0\n1,1,1", 0)
add("cut_in_number.txt", "0 0 0\n1 1", 2, ":2: found '1 1' with 2 columns")
add("zip.txt", zipped.getvalue(), 2, "has no array 'points'")


def npy(header, body=b"", version=(1, 0), length=None):
    text = header.encode()
    prefix = 10 if version[0] == 1 else 12
    text += b" " * (-(prefix + len(text) + 1) % 64) + b"\n"
    size = len(text) if length is None else length
    return b"\x93NUMPY" + bytes(version) + struct.pack("<H" if prefix == 10 else "<I", size) + text + body


def npy_header(shape, descr="<f8", order="False"):
    return "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }" % (descr, order, shape)


DOUBLES = struct.pack("<6d", *range(6))
add("good.npy", npy(npy_header("(2, 3)"), DOUBLES), 0)
add("magic_only.npy", b"\x93NUMPY", 2, "byte 6: the file ends within the NPY header")
add("version_9.npy", npy(npy_header("(2, 3)"), DOUBLES, version=(9, 0)), 2, "NPY version 9, expected 1 to 3")
add("header_cut.npy", npy(npy_header("(2, 3)"), DOUBLES)[:40], 2, "byte 40: the file ends within the NPY header")
add("header_too_long.npy", npy(npy_header("(2, 3)"), DOUBLES, version=(2, 0), length=4000000000), 2, "NPY header of 4000000000 bytes, expected at most 65536")
add("not_a_dictionary.npy", npy("[1, 2, 3]", DOUBLES), 2, "NPY header without a type (descr), expected one")
add("no_shape.npy", npy("{'descr': '<f8', 'fortran_order': False, }", DOUBLES), 2, "NPY header without a shape, expected whole numbers")
add("one_dimension.npy", npy(npy_header("(6,)"), DOUBLES), 2, "NPY shape (6,), expected (n, 3 or more)")
add("two_columns.npy", npy(npy_header("(3, 2)"), DOUBLES), 2, "NPY shape (3, 2), expected (n, 3 or more)")
add("rows_too_many.npy", npy(npy_header("(3, 3)"), DOUBLES), 2, "NPY data of 48 bytes, expected 3 rows of 24")
add("rows_billions.npy", npy(npy_header("(4000000000, 3)"), DOUBLES), 2, "NPY data of 48 bytes, expected 4000000000 rows of 24")
add("shape_overflow.npy", npy(npy_header("(6148914691236517206, 3)"), DOUBLES), 2, "NPY data of 48 bytes, expected 6148914691236517206 rows of")
add("shape_2_to_64.npy", npy(npy_header("(18446744073709551616, 3)"), DOUBLES), 2, "NPY shape (18446744073709551616, 3), expected whole numbers")
add("shape_negative.npy", npy(npy_header("(-2, 3)"), DOUBLES), 2, "NPY shape (-2, 3), expected whole numbers")
add("columns_billions.npy", npy(npy_header("(2, 4000000000)"), DOUBLES), 2, "NPY rows of 4000000000 columns, expected (n, 3)")
add("objects.npy", npy(npy_header("(2, 3)", "|O"), DOUBLES), 2, "|O")
add("complex.npy", npy(npy_header("(1, 3)", "<c16"), DOUBLES), 2, "<c16")
add("text.npy", npy(npy_header("(1, 3)", "<U2"), DOUBLES), 2, "<U2")
add("cut.npy", npy(npy_header("(2, 3)"), DOUBLES[:-1]), 2, "NPY data of 47 bytes, expected 2 rows of 24")
add("nan.npy", npy(npy_header("(2, 3)"), DOUBLES[:-8] + struct.pack("<d", float("nan"))), 2, "byte 168: row 1 has z = nan, expected a finite number")
add("no_rows.npy", npy(npy_header("(0, 3)")), 0)

# --- 3MF

CORE_3MF = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
RELATIONS = '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
MESH_3MF = "<mesh><vertices>%s</vertices><triangles>%s</triangles></mesh>" % (
    "".join('<vertex x="%d" y="%d" z="%d"/>' % v for v in VERTICES), "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % f for f in FACES))
OBJECT_3MF = '<object id="1">%s</object>' % MESH_3MF


def model_3mf(resources=OBJECT_3MF, build='<item objectid="1"/>', more=""):
    return '<model unit="millimeter" xmlns="%s"%s><resources>%s</resources><build>%s</build></model>' % (CORE_3MF, more, resources, build)


def package(model, relations=RELATIONS, method=zipfile.ZIP_DEFLATED, **others):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as parts:
        for name, content in [("_rels/.rels", relations), ("3D/3dmodel.model", model), *others.items()]:
            if content is not None:
                parts.writestr(zipfile.ZipInfo(name), content, method)
    return file.getvalue()


GOOD_3MF = package(model_3mf())
add("good.3mf", GOOD_3MF, 0)
add("stored.3mf", package(model_3mf(), method=zipfile.ZIP_STORED), 0)
add("empty.3mf", "", 2, "the file is empty")
add("text.3mf", OBJ, 2, "not a readable ZIP archive: no directory at its end")
add("cut.3mf", GOOD_3MF[:-30], 2)
add("head_only.3mf", GOOD_3MF[:40], 2)
add("no_parts.3mf", b"PK\x05\x06" + bytes(18), 2, "no part _rels/.rels")
add("no_relations.3mf", package(model_3mf(), None), 2, "no part _rels/.rels, expected a 3MF package")
add("no_model.3mf", package(None), 2, "no part 3D/3dmodel.model, expected a 3MF package")
add("relations_elsewhere.3mf", package(model_3mf(), RELATIONS.replace("/3D/3dmodel.model", "/../../etc/passwd")), 2, "no part ../../etc/passwd")
add("relations_of_nothing.3mf", package(model_3mf(), RELATIONS.replace("3dmodel\"", "thumbnail\"")), 2, "no 3D model in its relationships")
add("encrypted.3mf", package(model_3mf(), RELATIONS.replace("2013/01/3dmodel", "2019/07/encryptedfile")), 2, "is encrypted")
add("model_is_empty.3mf", package(""), 2, "not well-formed XML")
add("model_is_text.3mf", package("hello"), 2, "not well-formed XML")
add("model_is_binary.3mf", package(bytes(range(256)) * 4), 2, "not well-formed XML")
add("model_is_html.3mf", package("<html/>"), 2, "element html, expected")
add("model_cut.3mf", package(model_3mf()[:-9]), 2, "not well-formed XML")
add("two_roots.3mf", package(model_3mf() + model_3mf()), 2, "not well-formed XML")
add("bad_utf8.3mf", package(model_3mf().encode().replace(b"millimeter", b"\xff\xfe")), 2, "not well-formed XML")
add("nul.3mf", package(model_3mf().replace("millimeter", "a\0b")), 2, "not well-formed XML")
add("utf16.3mf", package(model_3mf().encode("utf-16")), 0)
add("unknown_encoding.3mf", package('<?xml version="1.0" encoding="klingon"?>' + model_3mf()), 2, "not well-formed XML")
add("laughs.3mf", package('<!DOCTYPE m [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>' + model_3mf(more=' n="&b;"')), 2, "a document type, expected none")
add("external_entity.3mf", package('<!DOCTYPE m SYSTEM "file:///etc/passwd">' + model_3mf()), 2, "a document type, expected none")
add("no_namespace.3mf", package(model_3mf().replace(' xmlns="%s"' % CORE_3MF, "")), 2, "element model, expected")
add("other_namespace.3mf", package(model_3mf().replace(CORE_3MF, "urn:other")), 2, "element urn:other|model")
add("no_build.3mf", package(model_3mf(build="")), 2, "no triangles")
add("no_objects.3mf", package(model_3mf("", "")), 2, "no triangles")
add("item_of_nothing.3mf", package(model_3mf(build='<item objectid="2"/>')), 2, "no object 2, which a component or an item of the build names")
add("item_without_object.3mf", package(model_3mf(build="<item/>")), 2, "no attribute objectid")
add("object_without_id.3mf", package(model_3mf("<object>%s</object>" % MESH_3MF)), 2, "no attribute id")
add("object_twice.3mf", package(model_3mf(OBJECT_3MF * 2)), 2, "a second object 1")
add("two_meshes.3mf", package(model_3mf('<object id="1">%s</object>' % (MESH_3MF * 2))), 2, "a second mesh of an object, expected one")
add("no_mesh.3mf", package(model_3mf('<object id="1"/>')), 2, "no triangles")
add("id_2_to_32.3mf", package(model_3mf(OBJECT_3MF.replace('"1"', '"4294967296"', 1))), 2, "id is '4294967296', expected an index of 32 bits")
add("id_negative.3mf", package(model_3mf(OBJECT_3MF.replace('"1"', '"-1"', 1))), 2, "id is '-1', expected an index of 32 bits")
add("index_beyond.3mf", package(model_3mf(OBJECT_3MF.replace('v3="1"', 'v3="4"', 1))), 2, "face index 4, but there are only 4 vertices")
add("index_negative.3mf", package(model_3mf(OBJECT_3MF.replace('v3="1"', 'v3="-1"', 1))), 2, "v3 is '-1', expected an index of 32 bits")
add("index_fraction.3mf", package(model_3mf(OBJECT_3MF.replace('v3="1"', 'v3="1.5"', 1))), 2, "v3 is '1.5', expected an index of 32 bits")
add("index_absent.3mf", package(model_3mf(OBJECT_3MF.replace(' v3="1"', "", 1))), 2, "no attribute v3")
add("triangles_first.3mf", package(model_3mf('<object id="1"><mesh><triangles><triangle v1="0" v2="1" v3="2"/></triangles><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/></vertices></mesh></object>')), 0)
add("coordinate_absent.3mf", package(model_3mf(OBJECT_3MF.replace(' z="0"', "", 1))), 2, "no attribute z")
add("coordinate_word.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="a"', 1))), 2, "z is 'a', expected a finite number")
add("coordinate_nan.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="nan"', 1))), 2, "z is 'nan', expected a finite number")
add("coordinate_overflow.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="1e400"', 1))), 2, "z is '1e400', expected a finite number")
add("coordinate_long.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="0.%s"' % ("3" * 100000), 1))), 0)
add("coordinate_hex.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="0x1"', 1))), 2, "z is '0x1', expected a finite number")
add("coordinate_control.3mf", package(model_3mf(OBJECT_3MF.replace('z="0"', 'z="&#x1b;[31m"', 1))), 2, "not well-formed XML")
add("transform_short.3mf", package(model_3mf(build='<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"/>')), 2, "transform: expected 12 finite numbers")
add("transform_long.3mf", package(model_3mf(build='<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 0 5"/>')), 2, "transform: more than 12 numbers")
add("transform_infinite.3mf", package(model_3mf(build='<item objectid="1" transform="inf 0 0 0 1 0 0 0 1 0 0 0"/>')), 2, "transform: expected 12 finite numbers")
add("transform_overflow.3mf", package(model_3mf(build='<item objectid="1" transform="1 0 0 0 1 0 0 0 1 1e308 0 0"/>').replace('x="1"', 'x="1.7e308"')), 2, "is not finite once its transform is applied")
add("transform_of_zeros.3mf", package(model_3mf(build='<item objectid="1" transform="0 0 0 0 0 0 0 0 0 0 0 0"/>')), 0)
add("component_of_itself.3mf", package(model_3mf('<object id="1"><components><component objectid="1"/></components></object>')), 2, "components within components, more than 256 deep")
add("components_in_a_ring.3mf", package(model_3mf('<object id="1"><components><component objectid="2"/></components></object><object id="2"><components><component objectid="1"/></components></object>')), 2, "more than 256 deep")
add("components_that_double.3mf", package(model_3mf(OBJECT_3MF + "".join('<object id="%d"><components>%s</components></object>' % (n, '<component objectid="%d"/>' % (n - 1) * 2) for n in range(2, 41)), '<item objectid="40"/>')), 4, "components make more than 1048576 copies of objects")
add("required_unknown.3mf", package(model_3mf(more=' xmlns:q="urn:quantum" requiredextensions="q"')), 2, "requires the extension urn:quantum, which is not supported")
add("required_undeclared.3mf", package(model_3mf(more=' requiredextensions="q  zz"')), 2, "requires the extension q, which is not supported")
add("deep.3mf", package(model_3mf(more=">" + "<a>" * 100000 + "</a>" * 100000 + "<b /").replace("<b />", "<b/>", 1)), 2, "elements within elements, more than 256")
add("long_tag.3mf", package(model_3mf(more=' n="%s"' % ("x" * 3000000))), 2, "a tag or comment of more than a megabyte")
add("long_comment.3mf", package(model_3mf("<!--" + "x" * 3000000 + "-->" + OBJECT_3MF)), 2, "a tag or comment of more than a megabyte")
add("many_attributes.3mf", package(model_3mf(more="".join(' a%d=""' % n for n in range(20000)))), 0)
add("name_of_backslashes.3mf", package(model_3mf(OBJECT_3MF.replace('id="1"', 'id="1" name="\\\\&#10;&quot;%s"' % ("n" * 5000), 1))), 0)
add("bomb.3mf", package(model_3mf() + " " * 8000000), 0)

# --- Grids for --like

add("empty.vdb", "", 2, "found no bytes, expected OpenVDB, NPZ, NRRD or NIfTI-1")
add("text.vdb", OBJ, 2, "found '%s', expected OpenVDB, NPZ, NRRD or NIfTI-1" % OBJ[:16].replace("\n", "?"))
add("nifti2.vdb", struct.pack("<i8s", 540, b"n+2\0\r\n\x1a\n") + bytes(528), 2, "found NIfTI-2, expected OpenVDB, NPZ")
add("nifti2_big.vdb", struct.pack(">i8s", 540, b"ni2\0\r\n\x1a\n") + bytes(528), 2, "found NIfTI-2, expected OpenVDB, NPZ")
add("magic_only.vdb", struct.pack("<q", 0x56444220), 2, "not a readable OpenVDB file: it ends too early")
add("old_version.vdb", struct.pack("<qI", 0x56444220, 1) + bytes(100), 2, "has no grids")
add("future_version.vdb", struct.pack("<qIII", 0x56444220, 99999, 10, 0) + bytes(100), 2, "not a readable OpenVDB file")
add("grid_count.vdb", struct.pack("<qIIIB", 0x56444220, 224, 10, 0, 1) + b"0" * 36 + struct.pack("<ii", 0, 2000000000), 2, "not a readable OpenVDB file")
add("name_length.vdb", struct.pack("<qIIIB", 0x56444220, 224, 10, 0, 1) + b"0" * 36 + struct.pack("<iiI", 0, 1, 4000000000), 2, "not a readable OpenVDB file: it ends too early")
