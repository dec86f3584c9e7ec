#!/bin/sh
# Builds and runs the benchmarks and writes their tables:
#   sh tests/bench/run.sh [BENCHMARK-OPTION...]     e.g. --benchmark_filter=teapot
# Raw data: docs/benchmarks/DATE-COMMIT.json; tables: the same name with .md. Takes about five minutes on two cores.
set -eu
cd "$(dirname "$0")/../.."

sh app/install_packages.sh --tests
cmake --preset bench >/dev/null
cmake --build --preset bench --target raycone_bench

compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' build/bench/CMakeCache.txt)
commit=$(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
name=docs/benchmarks/$(date -u +%Y-%m-%d)-$commit
[ -z "$(git status --porcelain --untracked-files=no 2>/dev/null)" ] || commit="$commit with local changes"
mkdir -p docs/benchmarks
build/bench/tests/raycone_bench --benchmark_repetitions=3 --benchmark_min_time=0.1 \
  --benchmark_context=commit="$commit" --benchmark_context=compiler="$("$compiler" --version | head -n 1)" \
  --benchmark_out="$name.json" --benchmark_out_format=json "$@"
sed -i '/"host_name"/d' "$name.json"
python3 tests/bench/make_tables.py "$name.json" >"$name.md"
echo "Wrote $name.json and $name.md"
