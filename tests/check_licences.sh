#!/bin/sh
# Checks that what is included of CGAL, directly or not, is under a licence that programs of other licences may use: LGPL
# or BSL-1.0, not GPL alone: sh tests/check_licences.sh [SOURCE-DIRECTORY]. CXX is the compiler.
set -eu
cd "${1:-$(dirname "$0")/..}"

status=0
files=$(grep -lE '^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]CGAL' $(find core io app -name '*.cpp' -o -name '*.h'))
for file in $files; do
  headers=$("${CXX:-g++}" -std=c++20 -I. -x c++ -M "$file" | tr ' \\' '\n\n' | grep '/CGAL/' | sort -u)
  [ -n "$headers" ] || { echo "check_licences: $file: no header of CGAL found" >&2; exit 1; }
  others=$(grep -LE 'SPDX-License-Identifier: .*(LGPL-3\.0|BSL-1\.0)' $headers || true)
  if [ -n "$others" ]; then
    echo "check_licences: $file: neither LGPL nor BSL:" $others >&2
    status=1
  fi
done
exit "$status"
