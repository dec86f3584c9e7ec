#!/bin/sh
# Checks that each source of app, core and io compiles alone: builds that take a folder's sources together hide missing
# includes. Nothing is linked, so it takes three minutes on two cores: sh tests/each_alone.sh. CXX=clang++ takes clang,
# which fuzzing needs: of Debian 12 it knows less of C++20 than GCC does.
set -eu
cd "$(dirname "$0")/.."
build=build/each_alone_by_${CXX:-c++}
cmake --preset dev -B "$build" -DRAYCONE_UNITY=OFF -DRAYCONE_WERROR=ON -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG=-fsyntax-only >/dev/null
objects=$(ninja -C "$build" -t targets all | sed -n 's/^\(\(app\|core\|io\)\/.*\.cpp\.o\): .*/\1/p')
# Objects are never made, so each run takes all of them.
exec ninja -C "$build" -k 0 $objects
