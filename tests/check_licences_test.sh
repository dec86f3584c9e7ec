#!/bin/sh
# No GPL header is included, and tests/check_licences.sh notices one that is planted in a copy.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
sh "$root/tests/check_licences.sh" "$root"

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
# The folder with the plant, and what it includes; the others were looked at above.
mkdir "$copy/core" "$copy/io" "$copy/app"
cp -RL "$root/core/exact" "$root/core/data" "$root/core/machine" "$copy/core"
echo '#include <CGAL/Triangulation_2.h>' >>"$copy/core/exact/projection.cpp"
if output=$(sh "$root/tests/check_licences.sh" "$copy" 2>&1); then
  echo "not noticed: CGAL/Triangulation_2.h in core/exact/projection.cpp" >&2
  exit 1
fi
case $output in
  *core/exact/projection.cpp*CGAL/Triangulation_2.h*) ;;
  *) echo "noticed, but not named: $output" >&2; exit 1 ;;
esac
