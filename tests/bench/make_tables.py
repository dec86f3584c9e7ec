#!/usr/bin/env python3
"""Prints the markdown tables of a run of raycone_bench: python3 tests/bench/make_tables.py RUN.json

Times are medians over the repetitions. A ratio is the transcription's time divided by raycone's: above 1, raycone is
faster.
"""

import collections
import json
import os
import platform
import re
import statistics
import sys


def medians(run):
    """Name without the "real_time" suffix -> (median milliseconds, counters of the last repetition)."""
    times = collections.defaultdict(list)
    counters = {}
    for entry in run["benchmarks"]:
        if entry["run_type"] == "iteration":
            name = entry["run_name"].removesuffix("/real_time")
            times[name].append(entry["real_time"])
            counters[name] = entry
    return {name: (statistics.median(values), counters[name]) for name, values in times.items()}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---" + "|---:" * (len(header) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def milliseconds(value):
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def cpu_model():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return re.search(r"^model name\s*: (.*)$", lines.read(), re.MULTILINE).group(1)
    except (OSError, AttributeError):
        return platform.processor()


def preparation(results, meshes, threads):
    rows = []
    for mesh in meshes:
        raycone, _ = results[f"prepare/{mesh}/raycone/{threads}"]
        paper, _ = results[f"prepare/{mesh}/paper/{threads}"]
        read, counters = results[f"read/{mesh}"]
        faces = f"{counters['faces']:.0f}"
        rows.append([mesh, faces, *map(milliseconds, (read, raycone, paper)), f"{paper / raycone:.2f}"])
    return table(["mesh", "faces", "read ms", "prepare ms", "paper ms", "ratio"], rows)


def evaluation(results, what, meshes, threads):
    rows = []
    for mesh in meshes:
        raycone, _ = results[f"{what}/{mesh}/raycone/{threads}"]
        paper, check = results[f"{what}/{mesh}/paper/{threads}"]
        edges, samples = check["exterior_edges"], check["samples"]
        preparation_for = "prepare_points" if what == "points" else "prepare"
        prepare, paper_prepare = (
            results[f"{preparation_for}/{mesh}/{method}/{threads}"][0] for method in ("raycone", "paper")
        )
        total = (paper_prepare + paper) / (prepare + raycone)
        per_edge = [f"{1e6 * time / (edges * samples):.2f}" if edges else "-" for time in (raycone, paper)]
        rows.append(
            [mesh, f"{edges:.0f}", milliseconds(raycone), milliseconds(paper), f"{paper / raycone:.2f}"]
            + [f"{total:.2f}", f"{1e6 * raycone / samples:.0f}"]
            + per_edge
            + [f"{check['off_by_turns']:.0f}", f"{check['max_difference']:.1e}"]
        )
    header = ["mesh", "edges", "raycone ms", "paper ms", "ratio", "with prepare", "ns/sample"]
    header += ["ns/edge", "paper's", "off", "difference"]
    return table(header, rows)


def throughput(results, what, baseline):
    rows = []
    for name, (time, counters) in results.items():
        if name.startswith(what + "/"):
            rate = counters["bytes_per_second"] * counters["real_time"] / time
            compared = results.get(name.replace(what, baseline), (None, None))[0]
            rows.append([name.split("/")[1], f"{rate / 1e6:.0f}", f"{time / compared:.1f}" if compared else "-"])
    return rows


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        run = json.load(file)
    results = medians(run)
    context = run["context"]
    meshes = [name.split("/")[1] for name in results if name.startswith("read/")]
    meshes = [mesh for mesh in meshes if f"lattice/{mesh}/raycone/1" in results]
    threads = sorted({int(name.split("/")[3]) for name in results if name.startswith("lattice/")})
    repetitions = max(entry.get("repetitions", 1) for entry in run["benchmarks"])

    print(f"Run of {context['date'][:10]}, commit {context['commit']}, on {cpu_model()}, {os.cpu_count()} CPUs,")
    print(f"with {context['compiler']}.")
    print(f"Medians of {repetitions} repetitions; raw data: {os.path.basename(sys.argv[1])}.\n")
    for count in threads:
        title = "one thread" if count == 1 else f"{count} threads"
        print(f"### Read (always one thread) and prepare, {title}\n\n{preparation(results, meshes, count)}")
        print(f"### Lattice of 50 x 50 x 50 samples, {title}\n\n{evaluation(results, 'lattice', meshes, count)}")
        print(f"### Random points: a million in closed meshes, 100 000 in open ones; {title}\n")
        print(evaluation(results, "points", meshes, count))
    reading = throughput(results, "read_format", "line_ends")
    print("### Reading a mesh of 409 600 faces, one thread\n")
    print(table(["file", "MB/s", "times as long as finding its line ends"], reading))
    print("### Writing eight million samples, or a million points, one thread\n")
    print(table(["file", "MB/s"], [row[:2] for row in throughput(results, "write_format", "")]))


if __name__ == "__main__":
    main()
