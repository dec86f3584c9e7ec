#!/bin/sh
# Measures how time and memory grow with samples, faces, exterior edges and points, and draws it:
#   sh tests/bench/scale.sh           measures (minutes; 8 GB of disk, 4 GB of memory) and draws
#   sh tests/bench/scale.sh RUN.json  draws a run that is there
# Raw data: docs/benchmarks/scale-DATE-COMMIT.json; picture: docs/benchmarks/scale.svg.
set -eu
cd "$(dirname "$0")/../.."

if ! /usr/bin/python3 -c 'import matplotlib, numpy' 2>/dev/null; then
  apt-get install -y --no-install-recommends python3-matplotlib python3-numpy >/dev/null
fi
run=${1-}
if [ -z "$run" ]; then
  sh app/install_packages.sh
  cmake --preset release >/dev/null
  cmake --build --preset release
  commit=$(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
  run=docs/benchmarks/scale-$(date -u +%Y-%m-%d)-$commit.json
  mkdir -p docs/benchmarks
  /usr/bin/python3 tests/bench/scale.py build/release/app/raycone "$commit" >"$run"
fi
/usr/bin/python3 tests/bench/plot_scale.py "$run" docs/benchmarks/scale.svg
echo "Wrote $run and docs/benchmarks/scale.svg"
