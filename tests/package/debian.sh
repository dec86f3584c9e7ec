#!/bin/sh
# The Debian package on a bare Debian 12, as root: sh tests/package/debian.sh
# Makes the package, lets lintian judge it (apt-get install lintian debootstrap), installs it into a new system of a
# folder by the commands of the Apptainer definition file, and uses it there. Needs the network for Debian's packages.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
system=$work/system
trap 'umount "$system/proc" 2>/dev/null || true; rm -rf "$work"' EXIT

fail() {
  echo "debian.sh: $*" >&2
  exit 1
}
# section NAME: its lines in the definition file.
section() {
  sed -n "/^%$1$/,/^%/{/^%/d;p}" app/package/raycone.def
}
inside() {
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive chroot "$system" "$@"
}

cmake --workflow --preset debian >"$work/log" 2>&1 || fail "$(tail -n 30 "$work/log")"
package=$(ls -t build/debian/raycone_*.deb | head -n 1)
lintian --allow-root --fail-on error,warning "$package"

debootstrap --variant=minbase bookworm "$system" >"$work/log" || fail "$(tail -n 30 "$work/log")"
mount -t proc proc "$system/proc"
section files | grep . | while read -r source target; do
  [ "$source" = raycone.deb ] || fail "the definition file wants $source"
  cp "$package" "$system$target"
done
cp /etc/resolv.conf "$system/etc"
inside sh -ec "$(section post)" >"$work/log" 2>&1 || fail "$(tail -n 30 "$work/log")"

echo "== Installed: $(inside dpkg-query -W raycone)"
inside sh -ec "$(section test)"
! inside ldd /usr/bin/raycone | grep 'not found' || fail "libraries of the executable are missing"
! inside find /usr/lib -name raycone_vdb.so -exec ldd {} + | grep 'not found' || fail "libraries of the module are missing"
cp data/meshes/teapot.obj "$system/tmp"
for format in vdb csv npy vti; do
  inside raycone lattice /tmp/teapot.obj -o "/tmp/out.$format" --resolution 32
  [ -s "$system/tmp/out.$format" ] || fail "no $format"
done
inside raycone lattice /tmp/teapot.obj -o /tmp/like.csv --like /tmp/out.vdb --quiet
cmp "$system/tmp/like.csv" "$system/tmp/out.csv" || fail "the grid that was written is not the one that was read"
inside raycone slice /tmp/teapot.obj -o /tmp/slice.png --size 64
inside raycone batch /tmp/teapot.obj --out-dir /tmp/fields --resolution 16
inside sh -ec "set -- info /tmp/teapot.obj; $(section runscript)"

for file in man/man1/raycone.1.gz doc/raycone/copyright doc/raycone/changelog.gz bash-completion/completions/raycone \
            zsh/vendor-completions/_raycone; do
  inside dpkg-query -L raycone | grep -qx "/usr/share/$file" || fail "/usr/share/$file is not in the package"
done

# The library, with the packages that its page names and nothing else of what raycone is built from.
packages=$(sed -n 's/.*(Debian: `\(.*\)`).*/\1/p' docs/library.md)
inside apt-get -qq update
inside apt-get -qq -y install --no-install-recommends g++ cmake make $packages >"$work/log" 2>&1 || \
  fail "$(tail -n 30 "$work/log")"
cmake --install build/debian --component development --prefix "$system/opt/raycone" >"$work/log"
cp -R tests/package "$system/tmp/example"
inside sh -ec 'cd /tmp/example; cmake -B build -DCMAKE_PREFIX_PATH=/opt/raycone; cmake --build build; build/example' \
  >"$work/log" 2>&1 || fail "$(tail -n 30 "$work/log")"

inside apt-get -qq -y purge raycone >"$work/log" 2>&1
[ -z "$(find "$system/usr" -name '*raycone*')" ] || fail "purged, but left: $(find "$system/usr" -name '*raycone*')"
echo "== The package is good: $package"
