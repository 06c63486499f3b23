#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draft: this script has not been run yet.
# Installs the packages that packages.sh has built into a clean Debian 12 root and uses them there: programs, both
# libraries, Python. Prints the time from installing to the first image.
#
#   try.sh OUT [MIRROR]     needs root and mmdebstrap (Debian package)
set -eu
[ $# -ge 1 ] || { echo "usage: try.sh OUT [MIRROR]" >&2; exit 2; }
out=$(cd "$1" && pwd)
mirror=${2-}
here=$(cd "$(dirname "$0")" && pwd)
photographs=$here/../../examples/photographs/cathedral
root=$(mktemp -d)
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
# shellcheck disable=SC2086 # an empty mirror: the host's sources
mmdebstrap --variant=apt --aptopt='Apt::Install-Recommends "false"' bookworm "$root" $mirror
mount -t proc proc "$root/proc"
cp "$out"/*.deb "$root/root/"
cp -r "$photographs" "$root/root/photographs"
cp /etc/resolv.conf "$root/etc/resolv.conf"
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  DEBIAN_FRONTEND=noninteractive sh -eu -c "cd /root; $1"; }

began=$(date +%s)
inside 'apt-get update -q && apt-get install -yq ./ibr-tools_*.deb mesa-vulkan-drivers'
installed=$(date +%s)
inside 'ibr doctor; ibr build photographs -o scene --draft --max-size 480 && ibr render scene --path auto:1 -o frames'
inside 'ls -l frames'
echo "installing the programs: $((installed - began)) s; to the first image: $(($(date +%s) - installed)) s more"

inside 'apt-get install -yq ./libibr0_*.deb ./libibr-dev_*.deb ./libibr-doc_*.deb g++ pkg-config
  g++ -std=c++20 /usr/share/doc/libibr-doc/examples/01_offscreen.cpp -o first $(pkg-config --cflags --libs ibr)
  ./first scene first.ppm'
inside 'apt-get install -yq ./libibr-author-dev_*.deb cmake make && mkdir author'
cp "$here"/../../tests/consumers/author/* "$root/root/author/"
inside 'cmake -S author -B author/build && cmake --build author/build &&
  author/build/consumer photographs photographs/sparse author/scene author.ppm'
inside 'apt-get install -yq ./python3-ibr_*.deb && python3 -c "
import ibr, ibr.author
scene = ibr.load_scene(\"scene\")
print(ibr.__version__, len(scene.nodes), \"photographs\")"'
echo "try.sh: all packages work"
