#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draft: this script has not been run yet.
# Builds the Debian packages of this checkout and checks them with lintian.
#
#   packages.sh OUT     folder for the packages; a missing one is created
#
# Installs missing packages that the build needs (only this needs root or sudo). Takes as long as a release build.
set -eu
[ $# -eq 1 ] || { echo "usage: packages.sh OUT" >&2; exit 2; }
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$1"
out=$(cd "$1" && pwd)
. "$root/examples/packages.sh"
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_PYTHON $IBR_PACKAGES_DEBIAN
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/libibr"
# Files of the working tree, without ignored ones such as build folders.
git -C "$root" ls-files -z --cached --others --exclude-standard |
  tar -C "$root" --null --ignore-failed-read --files-from=- -cf - 2>/dev/null | tar -C "$work/libibr" -xf -
cp -r "$work/libibr/cmake/debian" "$work/libibr/debian"
rm -f "$work/libibr/debian/packages.sh" "$work/libibr/debian/try.sh"
cd "$work/libibr"
dpkg-buildpackage --build=binary --no-sign
mv "$work"/*.deb "$work"/*.buildinfo "$work"/*.changes "$out"
lintian --fail-on error --tag-display-limit 0 "$out"/*.changes
for package in "$out"/*.deb; do
  dpkg-deb --show --showformat='${Package} ${Version}: ${Installed-Size} KiB installed, depends on ${Depends}\n' "$package"
done
