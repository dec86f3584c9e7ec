#!/bin/sh
# Compares the evaluator with the oracle on every mesh that loads in ../shared/meshes (or in the directory given), and
# writes docs/accuracy.md: sh tests/accuracy/run.sh [DIRECTORY]. Takes some minutes. --quick: a tenth of the samples of
# the meshes below 10 000 faces, to standard output only; exit status 77 where the meshes are absent.
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
    if row["expect"].startswith("load") and not (quick and int(row["faces"]) > 10000):
        print(folder + "/" + row["file"])
END

if [ -n "$quick" ]; then
  xargs -d '\n' "$tool" --quick <"$list"
  exit
fi
{
  cat <<'END'
# Accuracy on real meshes

The table compares raycone's winding numbers at `--tolerance 0`, where nothing is left out, with the direct sum over all
triangles in extended precision (64 bits; 113 where that cancels). `sh tests/accuracy/run.sh` makes it.

By default values may be off by 1e-10. At 50³ samples of three large open meshes they then differ from those of
`--tolerance 0` by 2.1e-12 at most (mountain), 2.0e-12 (head) and 3.8e-12 (pedestal), with medians of 3e-14, 3e-13 and
5e-13 (2026-11-26).

A *boundary edge* is an edge whose faces do not cancel; the literature and the code call it an exterior edge. Meshes
without boundary edges are closed, and raycone gives integers exactly. What is shown for them is the rounding of the
direct sum.

| column | meaning |
|---|---|
| edges | boundary edges |
| box | largest difference at 200 random points in the mesh's box |
| near | the same at 100 points at 1e-3 to 1e-9 of the box diagonal from its faces, edges and vertices |
| rays | the same at 100 points whose ray passes exactly through a vertex, or level with the middle of an edge |
| nodes | the same at 2000 random nodes of the lattice of 50³ samples of its box (`--resolution 50,50,50`) |
| mean | the mean difference at these nodes |
| bound | the error bound that `--diagnostics` prints, divided by the true error (see below) |
| rows | how many of the lattice's 2500 rays have ties: edges that are level with the ray, or along it, of triangles whose box it meets |
| on | points exactly on the surface |

Differences are absolute. *bound* is the median over those of 20 points in the box that are off, 0 if none is, with the
true error in 113 bits. A bound that does not hold would be an error of the run. Points exactly on the surface, where
the winding number jumps, are counted and left out of the comparison.

For comparison, the paper reports over Thingi10K a largest difference of 1.46e-7 and a mean of the largest of 2.3e-11.

Other checks, each one command:

- `build/dev/tests/raycone_bounds` compares two million error bounds with 113-bit sums.
- `build/dev/tests/raycone_bounds --far` does so for far fields and blocks of lattices, at tolerances of 1e-4, 1e-7 and
  1e-10. Of 9 898 731 values (2026-11-30) none was beyond its bound or the tolerance; the largest errors were 3.0e-5,
  3.2e-8 and 3.1e-11, and the largest bounds the same to two digits. Blocks of points are checked, too: none of 289 938
  values at these three tolerances was beyond its bound either (2026-11-25).
- `build/dev/tests/raycone_bounds --slice MESH` is the paper's Fig. 4: a mesh with scrambled vertices, a slice of 2000²
  samples by three ways.
- `build/dev/tests/raycone_stress` compares every value of generated meshes with its definition.
- `sh tests/mutants/run.sh` breaks each exactness rule in turn; a test must notice.

## Meshes

END
  status=0
  xargs -d '\n' "$tool" <"$list" || status=$?
} >"$table"
cat "$table" >docs/accuracy.md
tail -n 1 docs/accuracy.md
exit "$status"
