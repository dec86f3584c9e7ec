#!/bin/sh
# The module for OpenVDB: loaded only where a VDB is read or written, found wherever the installation is moved to, and
# missed with one line: sh tests/vdb_module_test.sh BUILD-DIRECTORY
set -eu
build=$1
mesh=$(cd "$(dirname "$0")/.." && pwd)/data/meshes/cube.obj
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "vdb_module_test: $*" >&2
  exit 1
}

cmake --install "$build" --prefix "$work/first" >"$work/log"
mv "$work/first" "$work/moved"
raycone=$(find "$work/moved" -path '*/bin/raycone')
module=$(find "$work/moved" -name raycone_vdb.so)
[ -x "$raycone" ] && [ -f "$module" ] || fail "incomplete installation"

# loads_openvdb ARGUMENT...: whether this run of raycone loads libopenvdb, as the dynamic linker tells.
loads_openvdb() {
  LD_DEBUG=libs LD_DEBUG_OUTPUT="$work/libs" "$raycone" "$@" --quiet >/dev/null || fail "status $? of raycone $*"
  cat "$work"/libs.* >"$work/loaded"
  rm "$work"/libs.*
  grep -q 'calling init: .*libopenvdb' "$work/loaded"
}

echo '0,0,0' >"$work/points.csv"
loads_openvdb lattice "$mesh" -o "$work/out.vdb" --resolution 4 || fail "a VDB was written without OpenVDB"
loads_openvdb lattice "$mesh" -o "$work/like.csv" --like "$work/out.vdb" || fail "a VDB was read without OpenVDB"
! loads_openvdb lattice "$mesh" -o "$work/out.csv" --resolution 4 || fail "a CSV needed OpenVDB"
! loads_openvdb lattice "$mesh" -o "$work/out.npy" --resolution 4 || fail "an NPY needed OpenVDB"
! loads_openvdb points "$mesh" "$work/points.csv" || fail "points needed OpenVDB"
! loads_openvdb info "$mesh" || fail "info needed OpenVDB"
! loads_openvdb --version || fail "--version needed OpenVDB"

# expect_error STATUS FILE ARGUMENT...: raycone fails with one line about FILE that names the module.
expect_error() {
  expected=$1 file=$2 status=0
  shift 2
  "$raycone" "$@" 2>"$work/message" || status=$?
  [ "$status" -eq "$expected" ] || fail "status $status instead of $expected without the module"
  [ "$(wc -l <"$work/message")" -eq 1 ] || fail "not one line: $(cat "$work/message")"
  grep -q "^raycone: $file: .*raycone_vdb.so" "$work/message" || fail "message: $(cat "$work/message")"
}

rm "$module"
expect_error 3 "$work/new.vdb" lattice "$mesh" -o "$work/new.vdb" --resolution 4
expect_error 2 "$work/out.vdb" lattice "$mesh" -o "$work/new.csv" --like "$work/out.vdb"
[ ! -e "$work/new.vdb" ] && [ ! -e "$work/new.csv" ] || fail "output in spite of the error"
