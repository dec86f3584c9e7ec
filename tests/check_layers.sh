#!/bin/sh
# Checks what the build cannot (docs/architecture.md): sh tests/check_layers.sh [SOURCE-DIRECTORY]
# Each third-party library has its files, oracles share no code with what they judge, no include steps out of the
# include paths by "..", and no two types of headers have one name. That folders include only what lies below them is
# the build's job: core/folder.cmake.
set -eu
cd "${1:-$(dirname "$0")/..}"

status=0
include='^[[:space:]]*#[[:space:]]*include[[:space:]]*'
sources=$(find core io app -name '*.h' -o -name '*.cpp')

# forbid WHAT PATTERN FILE...: no file may include what the extended regular expression matches.
forbid() {
  what=$1
  pattern=$2
  shift 2
  if grep -nE "$include$pattern" "$@" /dev/null; then
    echo "check_layers: $what" >&2
    status=1
  fi
}

# only_in LIBRARY PATTERN ALLOWED: of core, io and app, only the files ALLOWED (extended regular expression) may.
only_in() {
  others=$(echo "$sources" | grep -vxE "$3" || true)
  forbid "$1 belongs only in $(echo "$3" | tr -d '\\')" "$2" $others
}

forbid 'includes name the full path' '"([^/"]*"|(.*/)?\.\./)' $sources

# An oracle that shares code with what it judges shares its errors.
shared='core/(machine/floating_point|data/triangle_mesh|data/vec3)\.h'
judged=$(find core -name '*.h' | grep -vxE "$shared" | sed 's/\./\\./g' | tr '\n' '|')
forbid 'oracles must not include what they judge' "\"(${judged%|})\"" \
  tests/support/direct_* tests/support/exact_* tests/support/quad_*

# Two types of one name are one to the linker, which keeps either's destructor for both.
names='^(struct|class|enum class) +([A-Z][A-Za-z0-9]*)( final)?( *:[^{;]*)? *\{'
twice=$(find core io app -name '*.h' -exec sed -nE "s/$names.*/\2/p" {} + | sort | uniq -d)
for name in $twice; do
  grep -nE "^(struct|class|enum class) +$name\b" $(find core io app -name '*.h') >&2
  echo "check_layers: two types are called $name" >&2
  status=1
done

# The second of two headers of one guard is left out.
for guard in $(find core io app -name '*.h' -exec sed -nE 's/^#define (RAYCONE_[A-Z0-9_]*_H_)$/\1/p' {} + | sort | uniq -d); do
  grep -rn "^#define $guard\$" core io app >&2
  echo "check_layers: two headers have the guard $guard" >&2
  status=1
done

only_in Embree '[<"]embree' 'core/crossings/ray_caster\.cpp'
only_in CGAL '[<"]CGAL' 'core/exact/(predicates|projection)\.cpp'
only_in GMP '[<"]gmp' 'core/exact/(exact_integers\.h|integer_memory\.cpp)'
only_in TBB '[<"](one)?(api/)?tbb' 'core/machine/threads\.cpp'
only_in Highway '[<"]hwy' \
  'core/([a-z]+/[a-z_]+(_kernel\.cpp|-inl\.h)|far/shared_corners\.cpp|machine/(simd\.cpp|simd_kernel\.h))'
only_in OpenVDB '[<"]openvdb' 'io/vdb/((read|write)_vdb\.cpp|grid_tree\.h)'
only_in nlohmann-json '[<"]nlohmann' 'io/mesh/(bounded_json\.(h|cpp)|gltf_document\.cpp)|app/report/json\.cpp'
only_in tinygltf '[<"]tiny_gltf' 'io/mesh/(gltf_data|read_gltf)\.cpp'
only_in Expat '[<"]expat' 'io/mesh/xml_reader\.cpp'
only_in Draco '[<"]draco' 'io/mesh/gltf_draco\.cpp'
only_in nettle '[<"]nettle' 'io/files/(base64|read_file)\.cpp'
only_in zlib '[<"]zlib' 'io/files/(gzip_writer|unpack|zip_reader|zip_writer)\.cpp'
only_in Zstandard '[<"]zstd' 'io/files/unpack\.cpp'
only_in libpng '[<"]png\.h' 'io/fields/write_png\.cpp'
only_in CLI11 '[<"]CLI/' 'app/command_line/parse_command_line\.cpp'
exit "$status"
