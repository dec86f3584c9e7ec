"""Makes surfaces of meshes, checks them again with `raycone info`, and prints the tables of docs/surfaces.md.

usage: python3 tests/surfaces/measure.py RAYCONE MESH-DIRECTORY [--resolution N] [--most-bytes B] [--timeout S]

Each mesh is written as PLY and as STL. A mesh that cannot be read, or of which no sample is inside, is counted and left
out. Distances are from random points on one to the other; those on faces that close holes do not count. The exit status
is 1 where a surface is refused by `info --require`, or where raycone reports an error of its own.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

POINTS = 10000  # on either mesh
REQUIRED = "closed,oriented,outward,manifold,embedded"
EXTENSIONS = ("obj", "ply", "stl", "off", "glb", "gltf")


def meshes_in(directory, most_bytes):
    for top, _, names in sorted(os.walk(directory)):
        for name in sorted(names):
            path = os.path.join(top, name)
            if name.lower().rsplit(".", 1)[-1] in EXTENSIONS and os.path.getsize(path) <= most_bytes:
                yield path


def measured(words):
    """The exit status, standard error, and seconds of user and system time."""
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return process.returncode, errors.read().strip(), usage.ru_utime + usage.ru_stime


def sources_of(path):
    """Of each face of a PLY file that raycone surface wrote."""
    with open(path, "rb") as file:
        counts = {}
        while (line := file.readline().split()) != [b"end_header"]:
            if line[0] == b"element":
                counts[line[1]] = int(line[2])
        file.seek(24 * counts[b"vertex"], os.SEEK_CUR)
        faces = np.fromfile(file, np.dtype([("corners", "u1"), ("vertices", "<i4", 3), ("source", "<i4")]))
    assert len(faces) == counts[b"face"]
    return faces["source"]


def distances(raycone, sampled, to, work, sources=None):
    """The largest, and the root of the mean square, of random points on a mesh, on faces with a source, to another."""
    samples, points, values = (os.path.join(work, name) for name in ("samples.npz", "points.npy", "values.npy"))
    subprocess.run([raycone, "points", sampled, "--sample", "surface=%d" % POINTS, "--field", "inside", "-o", samples,
                    "--quiet"], check=True)
    drawn = np.load(samples)
    on_mesh = slice(None) if sources is None else sources[drawn["faces"]] >= 0
    if len(drawn["points"][on_mesh]) == 0:
        return 0.0, 0.0
    np.save(points, drawn["points"][on_mesh])
    subprocess.run([raycone, "points", to, points, "--field", "sdf", "--dtype", "f64", "-o", values, "--quiet"],
                   check=True)
    off = np.abs(np.load(values))
    return off.max(), np.sqrt((off ** 2).mean())


def print_percentiles(rows):
    print("\n| of %d meshes | median | 90 %% | 95 %% | largest |" % len(rows))
    print("|---|---|---|---|---|")
    for name, number_format in (("surface faces", "%.0f"), ("max. distance, voxels", "%.2g"), ("holes, %", "%.2g"),
                                ("dropped, %", "%.2g"), ("CPU, s", "%.2f"), ("peak, MB", "%.0f"),
                                ("surface to mesh, max.", "%.2g"), ("surface to mesh, rms", "%.2g"),
                                ("mesh to surface, max.", "%.2g"), ("mesh to surface, rms", "%.2g")):
        numbers = sorted(row[name] for row in rows)
        at = [numbers[int(part * (len(numbers) - 1))] for part in (0.5, 0.9, 0.95, 1)]
        print("| %s | %s |" % (name, " | ".join(number_format % number for number in at)))


class Measurement:
    """Surfaces made of meshes, what is wrong with them, and a row of the table for each that was made as PLY."""

    def __init__(self, arguments, work):
        self.raycone, self.directory, self.work = arguments.raycone, arguments.directory, work
        self.report = os.path.join(work, "report.json")
        self.options = ["--report", self.report, "--orient", "auto", "--resolution", str(arguments.resolution),
                        "--timeout", str(arguments.timeout), "--quiet"]
        self.refused, self.failed, self.limits, self.rows, self.left_out, self.made = [], [], [], [], 0, 0

    def add(self, path):
        for ending in ("ply", "stl"):
            out = os.path.join(self.work, "out." + ending)
            status, errors, seconds = measured([self.raycone, "surface", path, "-o", out, *self.options])
            if status == 2:
                self.left_out += 1
                return
            if status != 0:
                self.tell(self.limits if status == 4 else self.failed, path, ending, errors)
                if status == 4:
                    return
                continue
            self.made += 1
            checked = subprocess.run([self.raycone, "info", out, "--require", REQUIRED], capture_output=True)
            if checked.returncode != 0:
                self.tell(self.refused, path, ending, checked.stderr.decode().strip())
            if ending == "ply":
                self.add_row(path, out, seconds)

    def tell(self, of_its_kind, *what):
        of_its_kind.append(what)
        print(*what, file=sys.stderr, flush=True)

    def add_row(self, path, out, seconds):
        with open(self.report) as file:
            run = json.load(file)
        facts = subprocess.run([self.raycone, "info", path, "--json"], capture_output=True, check=True).stdout
        area, surface, voxel = json.loads(facts)["surface_area"], run["surface"], min(run["lattice"]["spacing"])
        row = {"surface faces": surface["faces"], "parts": surface["components"],
               "max. distance, voxels": surface["max_distance"] / voxel, "holes, %": 100 * surface["hole_area"] / area,
               "dropped, %": 100 * surface["dropped_area"] / area, "CPU, s": seconds,
               "peak, MB": run["peak_memory_bytes"] / 2**20}
        there = distances(self.raycone, out, path, self.work, sources_of(out))
        back = distances(self.raycone, path, out, self.work)
        names = ("surface to mesh, max.", "surface to mesh, rms", "mesh to surface, max.", "mesh to surface, rms")
        row.update(zip(names, (off / voxel for off in there + back)))
        self.rows.append(row)
        print("| %s | %d | %d | %d | %d | %.2g | %.2g | %.2g | %.1f | %.0f | %.2g | %.2g | %.2g | %.2g |" % (
            os.path.relpath(path, self.directory), run["faces"], run["exterior_edges"], *row.values()), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raycone")
    parser.add_argument("directory")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--most-bytes", type=int, default=1_000_000)
    parser.add_argument("--timeout", type=int, default=60)
    arguments = parser.parse_args()
    print("| mesh | faces | boundary edges | surface faces | parts | max. distance, voxels | holes, % | "
          "dropped, % | CPU, s | peak, MB | surface to mesh, max. | rms | mesh to surface, max. | rms |")
    print("|---" * 14 + "|")
    with tempfile.TemporaryDirectory() as work:
        all_of_them = Measurement(arguments, work)
        for path in meshes_in(arguments.directory, arguments.most_bytes):
            all_of_them.add(path)
    if all_of_them.rows:
        print_percentiles(all_of_them.rows)
    refused, failed = all_of_them.refused, all_of_them.failed
    print("\n%d surfaces made, %d refused by `info --require`, %d errors; %d meshes have no inside or cannot be read, %d "
          "met a limit." % (all_of_them.made, len(refused), len(failed), all_of_them.left_out, len(all_of_them.limits)))
    return 1 if refused or failed else 0


if __name__ == "__main__":
    sys.exit(main())
