#!/bin/sh
# Checks who includes what (docs/architecture.md): sh tests/check_layers.sh [SOURCE-DIRECTORY]
# core knows nothing of io and app; io knows core's data, not its evaluators; oracles know neither; each third-party
# library has its files.
set -eu
cd "${1:-$(dirname "$0")/..}"

status=0

# forbid WHAT PATTERN FILE...: no file may include what the extended regular expression matches.
forbid() {
  what=$1
  pattern=$2
  shift 2
  if grep -nE "^[[:space:]]*#[[:space:]]*include[[:space:]]*$pattern" "$@" /dev/null; then
    echo "check_layers: $what" >&2
    status=1
  fi
}

# only_in LIBRARY PATTERN ALLOWED: of core, io and app, only the files ALLOWED (extended regular expression) may.
only_in() {
  others=$(find core io app -name '*.h' -o -name '*.cpp' | grep -vxE "$3" || true)
  forbid "$1 belongs only in $(echo "$3" | tr -d '\\')" "$2" $others
}

forbid 'core must not include io or app' '"(io|app)/' core/*.h core/*.cpp
forbid 'io must not include app' '"app/' io/*.h io/*.cpp

shared='core/(diagnostics|lattice|polygon_fan|threads|triangle_mesh|vec3)\.h'
evaluators=$(find core -name '*.h' | grep -vxE "$shared" | sed 's/\./\\./g' | tr '\n' '|')
forbid 'io may include only the data headers of core, and threads.h' "\"(${evaluators%|})\"" io/*.h io/*.cpp

# An oracle that shares code with what it judges shares its errors.
shared='core/(floating_point|triangle_mesh|vec3)\.h'
judged=$(find core -name '*.h' | grep -vxE "$shared" | sed 's/\./\\./g' | tr '\n' '|')
forbid 'oracles must not include what they judge' "\"(${judged%|})\"" tests/support/direct_* tests/support/exact_* tests/support/quad_*

only_in Embree '[<"]embree' 'core/ray_caster\.cpp'
only_in CGAL '[<"]CGAL' 'core/(predicates|projection)\.cpp'
only_in TBB '[<"](one)?(api/)?tbb' 'core/threads\.cpp'
only_in Highway '[<"]hwy' 'core/(cone_kernel\.cpp|solid_angle_kernel\.cpp|simd\.cpp|product_lanes-inl\.h)'
only_in OpenVDB '[<"]openvdb' 'io/(read|write)_vdb\.cpp'
only_in nlohmann-json '[<"]nlohmann' 'io/bounded_json\.(cpp|h)|io/gltf_document\.cpp|app/json\.cpp'
only_in tinygltf '[<"]tiny_gltf\.h' 'io/(gltf_data|read_gltf)\.cpp'
only_in Draco '[<"]draco/' 'io/gltf_draco\.cpp'
only_in nettle '[<"]nettle' 'io/(base64|read_file)\.cpp'
only_in zlib '[<"]zlib' 'io/zip_writer\.cpp'
only_in libpng '[<"]png\.h' 'io/write_png\.cpp'
only_in CLI11 '[<"]CLI/' 'app/options\.cpp'
exit "$status"
