#!/usr/bin/env python3
"""Draws a run of scale.py: python3 tests/bench/plot_scale.py RUN.json PICTURE.svg"""

import json
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "raycone"  # the same picture from the same data
import matplotlib.pyplot as plt  # noqa: E402: the backend first

run_path, picture = sys.argv[1:]
with open(run_path, encoding="utf-8") as file:
    run = json.load(file)

PANELS = {  # series: axis, exponent and name of the slope drawn for comparison
    "samples": ("samples N along a side, closed mesh of 80 000 faces, to VDB", 3, "all samples, N³"),
    "faces": ("faces, closed mesh, 128³", 1, "faces"),
    "exterior_edges": ("exterior edges, 64³", 1, "edges"),
    "points": ("points, closed mesh of 80 000 faces", 1, "points"),
}
PARTS = ("read", "prepare", "evaluate", "write", "total")

figure, axes = plt.subplots(2, len(PANELS), figsize=(18, 8), sharex="col")
for column, (series, (label, exponent, name)) in enumerate(PANELS.items()):
    rows = [row for row in run["rows"] if row["series"] == series]
    numbers = [row["number"] for row in rows]
    times, memory = axes[0][column], axes[1][column]
    for part in PARTS:
        seconds = [max(row["seconds"][part], 1e-5) for row in rows]
        times.loglog(numbers, seconds, marker="o", linewidth=2.5 if part == "total" else 1, label=part)
    memory.loglog(numbers, [row["peak_memory_bytes"] / 1e6 for row in rows], marker="o", label="peak memory")
    if series != "points":
        memory.loglog(numbers, [row["output_bytes"] / 1e6 for row in rows], marker=".", label="file")
    if series == "samples":
        megabytes = rows[-1]["peak_memory_bytes"] / 1e6
        memory.loglog(numbers, [megabytes * (n / numbers[-1]) ** 2 for n in numbers], "k:", label="as surface, N²")
    memory.set_ylim(0.1, 10_000)
    last = rows[-1]["seconds"]["total"]
    times.loglog(numbers, [last * (n / numbers[-1]) ** exponent for n in numbers], "k:", label=f"as {name}")
    times.set_ylabel("seconds, one thread")
    memory.set_ylabel("MB")
    memory.set_xlabel(label)
    for axis in (times, memory):
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small")
figure.suptitle(f"raycone {run['commit']}, {run['cpu']}, {run['cpus']} CPUs")
figure.tight_layout()
figure.savefig(picture, metadata={"Date": None})
