"""Memory of points on standard input does not grow with their number: python3 points_memory_test.py RAYCONE MESH

Peaks of memory are those of the report. A batch holds 262 144 points, or those that have come where the next is waited for:
a slow writer's are compared from fewer than a batch on, a file's from several batches on.
"""

import gzip
import json
import os
import subprocess
import sys
import tempfile
import unittest

RAYCONE, MESH = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
ALLOWED_BYTES = 4 << 20  # what the allocator keeps or not as it happens; 900 000 points as numbers would be 21.6 MB
# 262 144 points and their values. Of many points so many come at once where raycone waits for a CPU while awk writes;
# the few may have come in smaller batches.
BATCH_BYTES = 8 << 20
FROM_AWK = """awk -v n="$1" 'BEGIN { for (i = 0; i < n; i++) printf "%.3f %.3f %.3f\\n", i % 7 / 5, i % 11 / 9, i % 13 / 11 }' |
"$2" points "$3" - -o - --report "$4" --quiet | wc -l"""
FROM_A_FILE = '"$2" points "$3" - -o - --report "$4" --quiet <"$5" | wc -l'


class PointsOnStandardInput(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        names = ("report.json", "points.txt", "mesh.obj")
        self.report, self.points, self.mesh = (os.path.join(directory.name, name) for name in names)

    def peak(self, pipeline, count, mesh=MESH):
        """The peak of memory in bytes, every point being answered."""
        command = ["sh", "-c", pipeline, "sh", str(count), RAYCONE, mesh, self.report, self.points]
        lines = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout
        self.assertEqual(int(lines), count + 1)  # and a header
        with open(self.report, encoding="utf-8") as file:
            return json.load(file)["peak_memory_bytes"]

    def peak_from_a_file(self, thousands):
        block = "".join(f"{i % 7 / 5:.3f} {i % 11 / 9:.3f} {i % 13 / 11:.3f}\n" for i in range(1000))
        with open(self.points, "w", encoding="utf-8") as file:
            file.writelines(block for _ in range(thousands))
        return self.peak(FROM_A_FILE, 1000 * thousands)

    def test_those_of_a_slow_writer(self):
        few = self.peak(FROM_AWK, 100_000)
        self.assertLessEqual(self.peak(FROM_AWK, 1_000_000), few + BATCH_BYTES + ALLOWED_BYTES)

    def test_those_of_a_file(self):
        few = self.peak_from_a_file(1000)
        self.assertLessEqual(self.peak_from_a_file(3000), few + ALLOWED_BYTES)

    def make_mesh(self, side, place="{x} {i} {j}"):
        """2 side^2 triangles, of whose grid each takes 112 bytes at least, and 250 or more here."""
        with open(self.mesh, "w", encoding="utf-8") as file:
            vertices = [(i * j % 7, i, j) for i in range(side + 1) for j in range(side + 1)]
            file.writelines(f"v {place.format(x=x, i=i, j=j)}\n" for x, i, j in vertices)
            corners = [i * (side + 1) + j + 1 for i in range(side) for j in range(side)]
            file.writelines(f"f {n} {n + 1} {n + side + 2} {n + side + 1}\n" for n in corners)

    def test_fewer_points_than_faces_take_no_grid(self):
        """Faces look for them."""
        self.make_mesh(200)
        peaks = []
        for count in (2000, 20_000, 300_000):
            sample = [RAYCONE, "points", self.mesh, "--sample", f"uniform={count}", "--field", "inside", "--quiet"]
            output = [*sample, "--threads", "1", "--report", self.report, "-o", f"{self.report}.{count}.npz"]
            subprocess.run(output, timeout=300, check=True)
            with open(self.report, encoding="utf-8") as file:
                peaks.append(json.load(file)["peak_memory_bytes"])
        self.assertLess(peaks[1] - peaks[0], 100 * 2 * 200**2)
        self.assertGreater(peaks[2] - peaks[1], 200 * 2 * 200**2)

    def test_faces_go_on_looking_where_memory_lacks_for_a_grid(self):
        """Of a zigzag along the rays, whose faces meet so many of them that they give up."""
        self.make_mesh(200, "{i} {j} {x}")

        def run(name, *options):
            output = os.path.join(os.path.dirname(self.report), name)
            sample = [RAYCONE, "points", self.mesh, "--sample", "uniform=65000", "--field", "inside", "--tolerance=0"]
            command = [*sample, "--threads=1", "--quiet", "--report", self.report, "-o", output, *options]
            subprocess.run(command, timeout=300, check=True)
            with open(self.report, encoding="utf-8") as report, open(output, "rb") as values:
                return json.load(report)["peak_memory_bytes"], values.read()

        with_grid, expected = run("free.npz")
        limit = with_grid - (4 << 20)
        peak, values = run("limited.npz", "--memory-limit", str(limit))
        self.assertLess(peak, limit)
        self.assertEqual(values, expected)

    def test_packed_points_may_be_many(self):
        """Memory for a grid is asked for where it may be needed, and not of a file that is short for sure."""
        self.make_mesh(500)
        text = "".join(f"{i} {i} 0.5\n" for i in range(100)).encode()
        packed = self.points + ".gz"
        for name, content in (self.points, text), (packed, gzip.compress(text)):
            with open(name, "wb") as file:
                file.write(content)

        def run(points, *options):
            command = [RAYCONE, "points", self.mesh, points, "--quiet", "--report", self.report, *options]
            return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)

        self.assertEqual(run(self.points).returncode, 0)
        with open(self.report, encoding="utf-8") as file:
            limit = json.load(file)["peak_memory_bytes"] + (16 << 20)
        self.assertEqual(run(self.points, "--memory-limit", str(limit)).returncode, 0)
        refused = run(packed, "--memory-limit", str(limit))
        self.assertEqual(refused.returncode, 4, refused.stderr)
        self.assertRegex(refused.stderr, r"mesh\.obj: needs about \d+ MB of memory, but the limit is \d+ MB\n\Z")


if __name__ == "__main__":
    unittest.main()
