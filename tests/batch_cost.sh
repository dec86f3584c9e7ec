#!/bin/sh
# What isolation costs: sh tests/batch_cost.sh [RAYCONE]
# Prints the CPU time of a batch of 300 small meshes at 32^3, all its processes, divided by the time that evaluating them
# takes by the batch's own account (read, prepare, evaluate, write: what one process would spend on them). Fails above 1.5.
set -eu
raycone=${1:-build/dev/app/raycone}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 - "$work/meshes" <<'END'
import math, os, sys
os.makedirs(sys.argv[1])
for i in range(300):
    n = 16 + i % 16  # a torus of 2 n^2 triangles, of which every 40th is missing
    with open(f"{sys.argv[1]}/{i:03}.obj", "w") as f:
        for a in range(n):
            for b in range(n):
                u, v = 2 * math.pi * a / n, 2 * math.pi * b / n
                r = 1 + 0.4 * math.cos(v)
                print("v", r * math.cos(u), r * math.sin(u), 0.4 * math.sin(v), file=f)
        for k, (a, b) in enumerate((a, b) for a in range(n) for b in range(n)):
            p = [1 + (a + x) % n * n + (b + y) % n for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
            print("f", p[0], p[1], p[2], file=f)
            if k % 40: print("f", p[0], p[2], p[3], file=f)
END
python3 - "$raycone" "$work" <<'END'
import csv, resource, subprocess, sys
raycone, work = sys.argv[1:]
subprocess.run([raycone, "batch", f"{work}/meshes", "--out-dir", f"{work}/out", "--resolution", "32", "--threads", "1",
                "--quiet"], check=True)
usage = resource.getrusage(resource.RUSAGE_CHILDREN)
cpu = usage.ru_utime + usage.ru_stime
rows = list(csv.DictReader(open(f"{work}/out/results.csv")))
assert len(rows) == 300
work = sum(float(row[column]) for row in rows for column in ("read_s", "prepare_s", "evaluate_s", "write_s"))
print(f"{cpu / 300 * 1e3:.2f} ms of CPU time per mesh, of which {work / 300 * 1e3:.2f} ms on the mesh itself: {cpu / work:.2f}")
sys.exit(cpu > 1.5 * work)
END
