#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the Debian packages of this working tree and checks them with lintian.
#
#   packages.sh OUT     folder for the packages; a missing one is created
#
# Installs missing packages that the build needs (only this needs root or sudo). Takes as long as a release build: about
# half an hour on two cores. Packages of debug symbols are built with DEB_BUILD_OPTIONS=.
set -eu
[ $# -eq 1 ] || { echo "usage: packages.sh OUT" >&2; exit 2; }
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
out=$(cd "$1" && pwd)
. "$root/examples/packages.sh"
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_PYTHON $IBR_PACKAGES_DEBIAN
# The same folder and cache each time, so that a second run is quick: debhelper sets HOME to a folder of the package.
export CCACHE_DIR="${CCACHE_DIR-$HOME/.cache/ccache}"
work=$out/libibr
rm -rf "$work" "$out"/*.deb "$out"/*.buildinfo "$out"/*.changes
mkdir "$work"
# Files of the working tree that Git does not ignore; --ignore-failed-read: a removed file may still be tracked.
git -C "$root" ls-files -z --cached --others --exclude-standard |
  tar -C "$root" --null --ignore-failed-read --files-from=- -cf - | tar -C "$work" -xf -
cd "$work"
cp -r cmake/debian debian
rm debian/packages.sh debian/try.sh
DEB_BUILD_OPTIONS=${DEB_BUILD_OPTIONS-noautodbgsym} dpkg-buildpackage --build=binary --no-sign
cd "$out"
rm -rf "$work"
lintian --fail-on error --tag-display-limit 0 "$out"/*.changes
for package in "$out"/*.deb; do
  printf '%8d KiB  ' "$(($(stat -c %s "$package") / 1024))"
  dpkg-deb --show --showformat='${Package} ${Version}, installed ${Installed-Size} KiB, depends on ${Depends}\n' "$package"
done
