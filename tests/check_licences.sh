#!/bin/sh
# Checks that what is included of some libraries, directly or not, is under a licence that programs of other licences
# may use: CGAL's headers under LGPL or BSL-1.0, not GPL alone, Draco's under Apache-2.0, tinygltf's under MIT:
# sh tests/check_licences.sh [SOURCE-DIRECTORY]. CXX is the compiler.
set -eu
cd "${1:-$(dirname "$0")/..}"

status=0
flags="-DTINYGLTF_NO_STB_IMAGE -DTINYGLTF_NO_STB_IMAGE_WRITE"  # of io/mesh/CMakeLists.txt

# check LIBRARY INCLUDED HEADERS LICENCES: of the headers whose paths match HEADERS in the files that include INCLUDED,
# each must match LICENCES.
check() {
  sources=$(find core io app -name '*.cpp' -o -name '*.h')
  files=$(grep -lE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$2" $sources) ||
    { echo "check_licences: no file includes $1" >&2; exit 1; }
  for file in $files; do
    headers=$("${CXX:-g++}" -std=c++20 -I. $flags -x c++ -M "$file" | tr ' \\' '\n\n' | grep "$3" | sort -u)
    [ -n "$headers" ] || { echo "check_licences: $file: no header of $1 found" >&2; exit 1; }
    others=$(grep -LE "$4" $headers || true)
    if [ -n "$others" ]; then
      echo "check_licences: $file: neither of these licences: $4:" $others >&2
      status=1
    fi
  done
}

check CGAL CGAL /CGAL/ 'SPDX-License-Identifier: .*(LGPL-3\.0|BSL-1\.0)'
# All but draco_features.h, a list of macros that Draco's build writes.
check Draco draco/ '/draco/.*/' 'Licensed under the Apache License, Version 2\.0'
check tinygltf tiny_gltf /tiny_gltf 'The MIT License'
exit "$status"
