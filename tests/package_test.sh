#!/bin/sh
# An installation is complete, can be moved, and can be built against: the program of docs/library.md, with nothing but
# the installation: sh tests/package_test.sh BUILD-DIRECTORY COMPILER
set -eu
build=$1 compiler=$2
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "package_test: $*" >&2
  exit 1
}

# block LANGUAGE: the first such block of docs/library.md.
block() {
  awk -v fence="\`\`\`$1" '$0 == fence { inside = 1; next } inside && /^```/ { exit } inside' "$root/docs/library.md"
}
mkdir "$work/example"
block cpp >"$work/example/example.cpp"
block cmake >"$work/example/CMakeLists.txt"
block text >"$work/expected"
for file in example.cpp CMakeLists.txt; do
  cmp "$work/example/$file" "$root/tests/package/$file" || fail "docs/library.md differs from tests/package/$file"
done

cmake --install "$build" --prefix "$work/first" >"$work/log"
mv "$work/first" "$work/prefix"
for file in bin/raycone share/man/man1/raycone.1 share/bash-completion/completions/raycone \
            share/zsh/site-functions/_raycone; do
  [ -f "$work/prefix/$file" ] || fail "$file was not installed"
done
if grep -rlF -e "$build" -e "$root" "$work/prefix/include" "$work/prefix"/lib*/cmake "$work/prefix/share"; then
  fail "names of this machine's directories"
fi
if grep -rhE '^ *# *include +["<]' "$work/prefix/include" | grep -vE '<[a-z_]+>|"raycone/'; then
  fail "a public header includes what belongs to another library, or is not installed"
fi

for header in "$work"/prefix/include/raycone/*.h; do echo "#include <raycone/${header##*/}>"; done >"$work/all.cpp"
cat >>"$work/all.cpp" <<'END'
raycone::DistanceBlocks blocks;
const raycone::ExteriorEdge edge;
END
"$compiler" -std=c++20 -fsyntax-only -I "$work/prefix/include" "$work/all.cpp" || fail "the headers do not compile"
if grep -rhE 'core/[a-z]+/' "$work/prefix/include"; then
  fail "a public header names another one by its place in the repository"
fi

# The library alone needs nothing that only the tool does.
cmake -S "$root" -B "$work/library" -DCMAKE_CXX_COMPILER="$compiler" -DRAYCONE_TOOL=OFF \
  -DCMAKE_DISABLE_FIND_PACKAGE_OpenVDB=ON -DCMAKE_DISABLE_FIND_PACKAGE_EXPAT=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON >"$work/log" 2>&1 || fail "$(cat "$work/log")"

cmake -S "$work/example" -B "$work/build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra -Wshadow -Wconversion -Werror" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
cmake --build "$work/build" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
"$work/build/example" >"$work/printed" || fail "status $? of the example"
cmp "$work/printed" "$work/expected" || fail "the example printed $(cat "$work/printed")"
