#!/usr/bin/python3
"""Measures --orient auto on damaged meshes, and writes the tables of docs/orientation.md.

    /usr/bin/python3 tests/orientation/measure.py [--all] [--meshes DIR] [--build DIR] [--only TEXT] [--keep DIR]

Takes the closed, consistently oriented meshes of DIR (../shared/meshes) with at most 6 000 faces (--all: with any
number), damages each in eight ways, and compares `raycone points --field inside --orient auto` with the original. The
baseline, raycone_raycast_voting, turns the same meshes. --only: meshes whose names contain TEXT; --keep: leaves the
damaged meshes there. It needs numpy, and the targets raycone, raycone_dump_mesh and raycone_raycast_voting.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile
import zlib

import numpy as np

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = REPOSITORY / "docs" / "orientation.md"
EXTENSIONS = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"}
POINTS, MOST_FACES = 10_000, 6_000

# --- Meshes: vertices (n, 3), no two equal, and faces (m, 3)


def closed_and_consistent(raycone, path, most_faces):
    run = subprocess.run([raycone, "info", "--json", path], capture_output=True, check=False)
    if run.returncode != 0:
        return False
    facts = json.loads(run.stdout)
    return (facts["closed"] and facts["inconsistent_edges"] == 0 and 4 <= facts["faces"] <= most_faces
            and (facts["signed_volume"] or 0) > 0)


def load(dump, path):
    text = subprocess.run([dump, "--cut"], input=str(path) + "\n", capture_output=True, text=True, check=True).stdout
    numbers = [float.fromhex(word) for word in text.split()[2:]]
    corners = np.array(numbers).reshape(-1, 3) + 0.0  # no -0
    vertices, indices = np.unique(corners, axis=0, return_inverse=True)
    return vertices, indices.reshape(-1, 3).astype(np.int32)


def write_ply(path, vertices, faces):
    rows = np.zeros(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(vertices))
        file.write(b"property double x\nproperty double y\nproperty double z\n")
        file.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces))
        file.write(vertices.astype("<f8").tobytes() + rows.tobytes())


def face_pairs(faces):
    """Faces that share an edge, as two arrays; of an edge of several faces, one after the other."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    owners = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    return owners[order[1:]][same], owners[order[:-1]][same]


def components(faces):
    """The number of each face's component, joined across edges."""
    one, other = face_pairs(faces)
    label = np.arange(len(faces))
    while True:
        least = label.copy()
        np.minimum.at(least, one, label[other])
        np.minimum.at(least, other, label[one])
        least = least[least]
        if (least == label).all():
            return np.unique(label, return_inverse=True)[1]
        label = least


def winding_numbers(vertices, faces, points):
    values = np.zeros(len(points))
    for n, point in enumerate(points):
        a, b, c = (vertices[faces[:, k]] - point for k in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        top = np.einsum("ij,ij->i", a, np.cross(b, c))
        bottom = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        values[n] = np.arctan2(top, bottom).sum() / (2 * np.pi)
    return values


def outermost(vertices, faces, labels):
    """For each face the component that is outermost around its own; components that merely overlap are not inside."""
    count = labels.max() + 1
    parts = [faces[labels == n] for n in range(count)]
    lower = np.array([vertices[part].min(axis=(0, 1)) for part in parts])
    upper = np.array([vertices[part].max(axis=(0, 1)) for part in parts])
    volume = (upper - lower).prod(axis=1)
    around = np.arange(count)
    for n in range(count):
        inside = (lower < lower[n]).all(axis=1) & (upper > upper[n]).all(axis=1)
        probe = vertices[np.unique(parts[n])[:20]]
        for other in sorted(np.nonzero(inside)[0], key=lambda m: -volume[m]):
            if (np.abs(winding_numbers(vertices, parts[other], probe)) > 0.5).all():
                around[n] = other
                break
    return around[labels]


# --- Damage: each takes (vertices, faces, labels of outermost components, generator) and returns faces, or None where
# the mesh has nothing to damage. The second result holds the same faces, rightly oriented.


def reversed_where(faces, chosen):
    return np.where(chosen[:, None], faces[:, ::-1], faces)


def whole(faces, outer, chance):
    return faces[:, ::-1], faces


def half_of_components(faces, outer, chance):
    names = np.unique(outer)
    if len(names) < 2:
        return None
    return reversed_where(faces, np.isin(outer, chance.choice(names, len(names) // 2, replace=False))), faces


def at_random(share):
    def damage(faces, outer, chance):
        count = max(round(share * len(faces)), 1)
        return reversed_where(faces, np.isin(np.arange(len(faces)), chance.permutation(len(faces))[:count])), faces
    return damage


def doubled(faces, outer, chance):
    both = np.concatenate([faces, faces[:, ::-1]])
    return both[chance.permutation(len(both))], faces


def doubled_and_removed(faces, outer, chance):
    count = max(round(0.03 * len(faces)), 1)
    left = faces[np.sort(chance.permutation(len(faces))[count:])]
    return doubled(left, outer, chance)[0], left


def removed_in_patches(faces, chance):
    """Three patches of one face in a hundred each, grown breadth-first from a random face; of few faces 3 % singly."""
    one, other = face_pairs(faces)
    neighbours = {}
    for a, b in zip(one.tolist(), other.tolist()):
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    size = max(round(0.01 * len(faces)), 1)
    removed = set()
    for _ in range(3 if len(faces) >= 100 else max(round(0.03 * len(faces)), 1)):
        patch = [int(chance.integers(len(faces)))]
        seen = set(patch)
        for face in patch:
            if len(patch) >= size:
                break
            fresh = [f for f in dict.fromkeys(neighbours.get(face, [])) if f not in seen]
            patch.extend(fresh)
            seen.update(fresh)
        removed.update(patch[:size])
    return np.array([face for n, face in enumerate(faces) if n not in removed])


def reversed_and_removed_in_patches(faces, outer, chance):
    left = removed_in_patches(faces, chance)
    return at_random(0.2)(left, outer, chance)[0], left


DAMAGES = {
    "reversed as a whole": whole,
    "half of the outermost components reversed": half_of_components,
    "5 % of the faces reversed": at_random(0.05),
    "20 % of the faces reversed": at_random(0.2),
    "50 % of the faces reversed": at_random(0.5),
    "doubled with the reverse, shuffled": doubled,
    "doubled, 3 % removed": doubled_and_removed,
    "20 % reversed, 3 % removed": reversed_and_removed_in_patches,
}
REMOVED = list(DAMAGES)[6:]

# --- Measurement


class Tools:
    def __init__(self, build, work):
        self.raycone = build / "app" / "raycone"
        self.dump = build / "tests" / "raycone_dump_mesh"
        self.voting = build / "tests" / "raycone_raycast_voting"
        self.work = work

    def inside(self, mesh, points, orient, timeout=600):
        out, report = mesh.with_suffix(".npy"), mesh.with_suffix(".json")
        subprocess.run([self.raycone, "points", mesh, points, "-o", out, "--field", "inside", "--orient", orient,
                        "--threads", "1", "--quiet", "--report", report], check=True, timeout=timeout)
        facts = json.loads(report.read_text())
        return np.load(out) > 0.5, facts

    def voted(self, mesh, vertices, faces):
        raw, flips = mesh.with_suffix(".raw"), mesh.with_suffix(".flips")
        with open(raw, "wb") as file:
            file.write(np.array([len(vertices), len(faces)], "<i8").tobytes())
            file.write(vertices.astype("<f8").tobytes() + faces.astype("<i4").tobytes())
        run = subprocess.run([self.voting, raw, flips], capture_output=True, text=True, check=True)
        turned = reversed_where(faces, np.frombuffer(flips.read_bytes(), np.uint8) == 1)
        return turned, float(run.stdout)


def points_around(vertices, faces, path):
    lower, upper = vertices[faces].min(axis=(0, 1)), vertices[faces].max(axis=(0, 1))
    margin = 0.1 * (upper - lower).max()
    chance = np.random.default_rng(15)
    np.save(path, chance.uniform(lower - margin, upper + margin, (POINTS, 3)))


def share(one, other):
    return float((one == other).mean())


def measure(tools, name, path):
    """One row for each damage."""
    vertices, faces = load(tools.dump, path)
    stem = tools.work / name.replace("/", "__")
    points = stem.with_suffix(".points.npy")
    points_around(vertices, faces, points)
    original = pathlib.Path(str(stem) + ".original.ply")
    write_ply(original, vertices, faces)
    expected, _ = tools.inside(original, points, "keep")
    untouched, _ = tools.inside(original, points, "auto")
    outer = outermost(vertices, faces, components(faces))
    rows = [{"mesh": name, "damage": "none", "faces": len(faces), "auto": share(untouched, expected)}]
    for number, (damage, function) in enumerate(DAMAGES.items()):
        result = function(faces, outer, np.random.default_rng([number, zlib.crc32(name.encode())]))
        if result is None:
            continue
        damaged, right = result
        mesh = pathlib.Path(f"{stem}.{number}.ply")
        write_ply(mesh, vertices, damaged)
        auto, with_auto = tools.inside(mesh, points, "auto")
        kept, with_keep = tools.inside(mesh, points, "keep")
        voted_faces, voting_seconds = tools.voted(mesh, vertices, damaged)
        write_ply(mesh, vertices, voted_faces)
        voted, _ = tools.inside(mesh, points, "keep")
        best = expected
        if damage in REMOVED:
            write_ply(mesh, vertices, right)
            best, _ = tools.inside(mesh, points, "keep")
        write_ply(mesh, vertices, damaged)
        seconds = [report["seconds"] for report in (with_auto, with_keep)]
        rows.append({"mesh": name, "damage": damage, "faces": len(damaged), "auto": share(auto, expected),
                     "keep": share(kept, expected), "voting": share(voted, expected), "best": share(best, expected),
                     "patches": with_auto["patches"], "read": seconds[1]["read"], "prepare": seconds[1]["prepare"],
                     "orient": seconds[0]["prepare"] - seconds[1]["prepare"], "voting_seconds": voting_seconds})
    return rows


def soup_time(tools):
    """Seconds to prepare 100 000 separate triangles on a sphere, turned at random: with auto and without."""
    chance = np.random.default_rng(5)
    middles = chance.normal(size=(100_000, 3))
    middles /= np.linalg.norm(middles, axis=1)[:, None]
    sides = chance.normal(size=(100_000, 2, 3)) * 0.003
    corners = np.stack([middles, middles + sides[:, 0], middles + sides[:, 1]], axis=1).reshape(-1, 3)
    mesh, points = tools.work / "soup.ply", tools.work / "soup.points.npy"
    write_ply(mesh, corners, np.arange(300_000, dtype=np.int32).reshape(-1, 3))
    np.save(points, np.zeros((1, 3)))
    try:
        runs = [tools.inside(mesh, points, orient, 60)[1] for orient in ("auto", "keep")]
        return ["%.1f s" % run["seconds"]["prepare"] for run in runs]
    except subprocess.TimeoutExpired:
        return ["more than 60 s", "little"]


# --- Tables


def percent(value):
    return "100 %" if value == 1 else "%.2f %%" % min(100 * value, 99.99)


def summary(rows):
    yield ("| damage | meshes | mean | worst | exactly | voting: mean | worst | exactly | as stored: mean "
           "| best: mean | worst |")
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for damage in DAMAGES:
        of = [row for row in rows if row["damage"] == damage]
        if not of:
            continue
        auto, voting, keep, best = (np.array([row[key] for row in of]) for key in ("auto", "voting", "keep", "best"))
        yield "| %s | %d | %s | %s | %d | %s | %s | %d | %s | %s | %s |" % (
            damage, len(of), percent(auto.mean()), percent(auto.min()), (auto == 1).sum(), percent(voting.mean()),
            percent(voting.min()), (voting == 1).sum(), percent(keep.mean()), percent(best.mean()), percent(best.min()))


def times(rows):
    damaged = [row for row in rows if row["damage"] != "none" and row["prepare"] >= 0.005]
    yield "| patches | meshes | auto / prepare: median | largest | auto: largest | voting: largest |"
    yield "|---|---|---|---|---|---|"
    for low, high in ((0, 10), (10, 100), (100, 1000), (1000, 10**9)):
        of = [row for row in damaged if low < row["patches"] <= high]
        if not of:
            continue
        ratios = [row["orient"] / row["prepare"] for row in of]
        yield "| %s | %d | %.2f | %.2f | %.2f s | %.2f s |" % (
            f"{low + 1} to {high}" if high < 10**9 else "more", len(of), np.median(ratios), max(ratios),
            max(row["orient"] for row in of), max(row["voting_seconds"] for row in of))


def worst(rows):
    yield "| mesh | damage | faces | patches | auto | voting | best |"
    yield "|---|---|---|---|---|---|---|"
    damaged = [row for row in rows if row["damage"] != "none" and row["auto"] < 1]
    for row in sorted(damaged, key=lambda row: (row["auto"], row["mesh"]))[:20]:
        yield "| %s | %s | %d | %d | %s | %s | %s |" % (row["mesh"], row["damage"], row["faces"], row["patches"],
                                                    percent(row["auto"]), percent(row["voting"]), percent(row["best"]))


def write_tables(rows, soup):
    text = PAGE.read_text(encoding="utf-8")
    rows = sorted(rows, key=lambda row: row["mesh"])
    undamaged = [row for row in rows if row["damage"] == "none"]
    kept = sum(row["auto"] == 1 for row in undamaged)
    missed = sorted({row["mesh"] for row in rows if row["damage"] not in ("none", *REMOVED) and row["auto"] < 1})
    tables = {
        "agreement": [*summary(rows), "", f"Undamaged, {kept} of {len(undamaged)} meshes keep all values.", "",
                      "Below 100 % although no face was removed:", "", *("- " + mesh for mesh in missed)],
        "time": [*times(rows), "", "A soup of 100 000 separate triangles takes %s to prepare with `auto`, %s "
                 "without." % tuple(soup)],
        "worst": list(worst(rows)),
    }
    for name, lines in tables.items():
        begin, end = f"<!-- {name}: made by tests/orientation/measure.py -->", f"<!-- end of {name} -->"
        before, rest = text.split(begin)
        text = before + begin + "\n\n" + "\n".join(lines) + "\n\n" + end + rest.split(end)[1]
    PAGE.write_text(text, encoding="utf-8")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--all", action="store_true")
    arguments.add_argument("--meshes", type=pathlib.Path, default=REPOSITORY / ".." / "shared" / "meshes")
    arguments.add_argument("--build", type=pathlib.Path, default=REPOSITORY / "build" / "dev")
    arguments.add_argument("--only", default="")
    arguments.add_argument("--keep", type=pathlib.Path)
    arguments.add_argument("--rows", type=pathlib.Path, help="a JSON file for all that was measured")
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = options.keep or pathlib.Path(temporary)
        work.mkdir(exist_ok=True)
        tools = Tools(options.build, work)
        most = 10**9 if options.all else MOST_FACES
        paths = [path for path in sorted(options.meshes.rglob("*")) if path.suffix.lower() in EXTENSIONS
                 and path.relative_to(options.meshes).parts[0] != "derived"]  # one mesh in many encodings
        paths = [path for path in paths if options.only in str(path) and
                 closed_and_consistent(tools.raycone, path, most)]
        print(len(paths), "meshes", file=sys.stderr)
        names = [str(path.relative_to(options.meshes)) for path in paths]
        rows = []
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            runs = [pool.submit(measure, tools, *pair) for pair in zip(names, paths)]
            for run in concurrent.futures.as_completed(runs):
                found = run.result()
                rows.extend(found)
                if options.rows:
                    options.rows.write_text(json.dumps(rows, indent=1))
                bad = [(row["damage"], row["auto"]) for row in found if row["auto"] < 1]
                print(found[0]["mesh"], found[0]["faces"], bad or "all 100 %", file=sys.stderr, flush=True)
        soup = soup_time(tools)
    if not options.only:
        write_tables(rows, soup)


if __name__ == "__main__":
    main()
