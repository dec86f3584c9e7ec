#!/bin/sh
# Installs the Debian packages that raycone needs, where some are missing:
#   sh app/install_packages.sh [--tests | --tidy]
# --tests adds what the tests and benchmarks need, --tidy what tests/tidy.sh does. Without apt (not Debian, not Ubuntu)
# it only says what to install.
set -eu

# libboost-iostreams-dev: CMake's find module of Debian's OpenVDB asks for it, the package does not depend on it.
build_packages='g++ cmake ninja-build pkg-config libcgal-dev libcli11-dev libdraco-dev libembree-dev libexpat1-dev
  libhwy-dev
  libopenvdb-dev libboost-iostreams-dev libpng-dev libtbb-dev libtinygltf-dev libzstd-dev nettle-dev nlohmann-json3-dev zlib1g-dev'
test_packages='libfaketime libgtest-dev libbenchmark-dev locales make mandoc python3 python3-nibabel python3-numpy python3-openvdb strace zsh'

tidy_packages='clang-tidy'

packages=$build_packages
case "${1-}" in
  '') ;;
  --tests) packages="$packages $test_packages" ;;
  --tidy) packages="$packages $test_packages $tidy_packages" ;;
  *) echo "usage: sh app/install_packages.sh [--tests | --tidy]" >&2; exit 1 ;;
esac
packages=$(echo $packages)

if ! command -v apt-get >/dev/null 2>&1 || ! command -v dpkg-query >/dev/null 2>&1; then
  echo "No apt-get here: make sure that the equivalents of these Debian packages are installed: $packages" >&2
  exit 0
fi

missing=
for package in $packages; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "Missing packages; as root, run: apt-get install --no-install-recommends$missing" >&2
    exit 1
  fi
  as_root=sudo
fi
echo "Installing:$missing"
$as_root apt-get -qq update
$as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o Dpkg::Use-Pty=0 install --no-install-recommends $missing \
  >/dev/null
