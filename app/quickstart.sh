#!/bin/sh
# From nothing to a winding-number field: sh app/quickstart.sh [MESH]
# Installs the Debian packages that are missing, builds into build/release, evaluates MESH (default: the bundled Utah
# teapot) on a lattice, and leaves raycone-quickstart/NAME.vdb and NAME.csv in the current directory.
set -eu

case "${1-}" in
  -h | --help) sed -n '2,4s/^# //p' "$0"; exit 0 ;;
esac
if [ $# -gt 1 ]; then
  echo "usage: sh app/quickstart.sh [MESH]" >&2
  exit 1
fi

root=$(cd "$(dirname "$0")/.." && pwd)
mesh=${1-$root/data/meshes/teapot.obj}
if [ ! -r "$mesh" ]; then
  echo "quickstart: $mesh: cannot be read" >&2
  exit 2
fi
raycone=$root/build/release/app/raycone

echo "== 1. Packages"
sh "$root/app/install_packages.sh"

echo "== 2. Build (build/release; a few minutes the first time)"
mkdir -p "$root/build"
if ! (cd "$root" && cmake --preset release) >"$root/build/configure.log" 2>&1; then
  cat "$root/build/configure.log" >&2
  exit 1
fi
(cd "$root" && cmake --build --preset release --parallel "$(nproc)")

echo "== 3. The mesh"
"$raycone" info -- "$mesh"

echo "== 4. Its winding numbers, on 64 samples along the longest side"
output=raycone-quickstart
name=$(basename "$mesh")
name=${name%.*}
mkdir -p "$output"
"$raycone" lattice -o "$output/$name.vdb" -- "$mesh"
"$raycone" lattice -o "$output/$name.csv" -- "$mesh"
awk -F, 'NR > 1 { n++; if ($7 >= 0.5) inside++; if (n == 1 || $7 < least) least = $7
  if (n == 1 || $7 > most) most = $7 }
  END { printf "%d samples, %.1f %% of them inside (w >= 0.5), w from %.4f to %.4f\n",
        n, 100 * inside / n, least, most }' "$output/$name.csv"

cat <<TEXT

Done. Written: $output/$name.vdb and $output/$name.csv
Look at them:
  head -n 3 '$output/$name.csv'
  Houdini: File SOP on the .vdb.  Blender: Add > Volume > Import OpenVDB.  Grid: "winding"; inside is w >= 0.5.
  Python (apt-get install python3-openvdb python3-numpy):
    /usr/bin/python3 -c "import pyopenvdb as vdb; print(vdb.read('$output/$name.vdb', 'winding').info())"
The tool: $raycone --help
TEXT
