#!/bin/sh
# raycone's files in the programs they are for: sh tests/clients.sh
# Installs Blender, ParaView, pyopenvdb and numpy where they are missing, as root, and runs
# tests/clients/clients_test.py, of which nothing may then be skipped. Needs the dev build.
set -eu
cd "$(dirname "$0")/.."
packages='blender python3-paraview python3-openvdb python3-numpy'

if ! dpkg-query --show $packages >/dev/null 2>&1; then
  apt-get -qq update
  DEBIAN_FRONTEND=noninteractive apt-get -qq -y install --no-install-recommends $packages >/dev/null
fi
/usr/bin/python3 tests/clients/clients_test.py build/dev/app/raycone data/meshes
