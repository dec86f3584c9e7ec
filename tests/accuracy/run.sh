#!/bin/sh
# Compares the evaluator with the oracle on every mesh that loads in ../shared/meshes (or in the directory given), and writes
# docs/accuracy.md: sh tests/accuracy/run.sh [DIRECTORY]. Takes some minutes. --quick: a tenth of the samples of the meshes
# below 40 000 faces, to standard output only; exit status 77 where the meshes are absent.
set -eu
cd "$(dirname "$0")/../.."
quick=
if [ "${1-}" = --quick ]; then
  quick=--quick
  shift
fi
meshes=${1:-../shared/meshes}
tool=${RAYCONE_ACCURACY:-build/dev/tests/raycone_accuracy}
if [ ! -f "$meshes/MANIFEST.csv" ]; then
  echo "no $meshes/MANIFEST.csv: skipped"
  exit 77
fi

list=$(mktemp)
table=$(mktemp)
trap 'rm -f "$list" "$table"' EXIT
python3 - "$meshes" "$quick" >"$list" <<'END'
import csv, sys
folder, quick = sys.argv[1:]
for row in csv.DictReader(open(folder + "/MANIFEST.csv")):
    if row["expect"].startswith("load") and not (quick and int(row["faces"]) > 40000):
        print(folder + "/" + row["file"])
END

if [ -n "$quick" ]; then
  xargs -d '\n' "$tool" --quick <"$list"
  exit
fi
{
  cat <<'END'
# Accuracy on real meshes

Made by `sh tests/accuracy/run.sh`. Largest absolute difference between raycone's winding numbers and the direct sum over all triangles in
extended precision (64 bits; 113 where that cancels), per mesh at

- 200 random points in its box,
- 100 points at 1e-3 to 1e-9 of the box diagonal from its faces, edges and vertices,
- 100 points whose ray passes exactly through a vertex, or level with the middle of an edge,
- 2000 random nodes of the lattice of 50 × 50 × 50 samples of its box (`--resolution 50,50,50`), with the mean there, and how many of the
  lattice's 2500 rays meet an edge or vertex exactly.

*bound / error* is the median, over 20 points in the box, of the error bound that `--diagnostics` prints divided by the true error (in 113 bits); a bound that does not hold is
an error of the run. Points exactly on the surface, where the winding number jumps, are left out of the comparison and counted. For comparison, the paper reports, over Thingi10K, a
largest difference of 1.46e-7 and a mean of the largest of 2.3e-11. Closed meshes (no exterior edges) give integers exactly; what is shown for them is
the rounding of the oracle.

Other checks, each one command: `build/dev/tests/raycone_bounds` (two million error bounds against 113-bit sums), `build/dev/tests/raycone_bounds --slice MESH`
(the paper's Fig. 4: a mesh with scrambled vertices, a slice of 2000² samples by three ways), `build/dev/tests/raycone_stress` (generated meshes, every
value by its definition), `sh tests/mutants/run.sh` (each exactness rule broken in turn).

END
  status=0
  xargs -d '\n' "$tool" <"$list" || status=$?
} >"$table"
cat "$table" >docs/accuracy.md
tail -n 1 docs/accuracy.md
exit "$status"
