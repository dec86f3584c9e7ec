#!/bin/sh
# Third-party libraries keep to their files, and tests/check_layers.sh notices each kind of violation when one is
# planted in a copy.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
sh "$root/tests/check_layers.sh" "$root"

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -RL "$root/core" "$root/io" "$root/app" "$copy"
mkdir "$copy/tests"
cp -RL "$root/tests/support" "$copy/tests"
sh "$root/tests/check_layers.sh" "$copy"

# plant FILE LINE: one more violation, of which the check must name the file and the line.
plant() {
  printf '%s\n' "$2" >>"$copy/$1"
  printf '%s\t%s\n' "$1" "$2" >>"$copy/planted"
}

plant core/mesh/weld.cpp '#include "../exact/predicates.h"'
plant core/mesh/weld.cpp '#  include "weld.h"'
plant core/mesh/weld.cpp '#include <embree3/rtcore.h>'
plant core/mesh/weld.cpp '#include <CGAL/Origin.h>'
plant app/process/exit_code.h '#include <tbb/parallel_for.h>'
plant core/mesh/weld.cpp '#include <hwy/highway.h>'
plant app/process/exit_code.h '#include <openvdb/openvdb.h>'
plant io/mesh/read_mesh.cpp '#include <nlohmann/json.hpp>'
plant io/mesh/gltf_document.cpp '#include <tiny_gltf.h>'
plant io/mesh/gltf_data.cpp '#include <draco/mesh/mesh.h>'
plant io/mesh/read_mesh.cpp '#include <nettle/sha2.h>'
plant app/process/exit_code.h '#include <CLI/CLI.hpp>'
plant app/process/exit_code.h '#include <zlib.h>'
plant io/mesh/read_mesh.cpp '#include <png.h>'
plant io/mesh/read_mesh.cpp '#include <expat.h>'
plant io/mesh/read_mesh.cpp '#include <zstd.h>'
plant core/mesh/weld.cpp '#include <gmpxx.h>'
plant app/process/exit_code.h 'struct Vec3 {};'
plant app/process/exit_code.h '#define RAYCONE_CORE_CHUNK_LANES_INL_H_'
plant tests/support/direct_winding_number.cpp '#include "core/exact/predicates.h"'
plant tests/support/exact_predicates.h '#include "core/exact/direct_sum.h"'

if output=$(sh "$root/tests/check_layers.sh" "$copy" 2>&1); then
  echo "nothing noticed of what was planted" >&2
  exit 1
fi
while IFS="$(printf '\t')" read -r file line; do
  # grep's lines: FILE:NUMBER:LINE
  if ! echo "$output" | grep -F "$file:" | grep -qF ":$line"; then
    echo "not noticed: $line in $file" >&2
    exit 1
  fi
done <"$copy/planted"
