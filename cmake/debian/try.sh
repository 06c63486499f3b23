#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the packages of packages.sh into a clean Debian 12 root and uses them there: the programs, the shared library,
# the author, Python. Prints the time from installing to the first image.
#
#   try.sh OUT [MIRROR]     OUT: folder of the packages; MIRROR: Debian mirror, by default mmdebstrap's
#
# Needs root and the Debian package mmdebstrap. The root, about 2 GB in $TMPDIR, is removed afterwards.
set -eu
[ $# -ge 1 ] && [ $# -le 2 ] || { echo "usage: try.sh OUT [MIRROR]" >&2; exit 2; }
[ "$(id -u)" = 0 ] || { echo "try.sh: needs root for chroot" >&2; exit 2; }
out=$(cd "$1" && pwd)
mirror=${2-}
here=$(cd "$(dirname "$0")" && pwd)
ls "$out"/ibr-tools_*.deb >/dev/null || { echo "try.sh: $out has no packages; packages.sh builds them" >&2; exit 2; }

root=$(mktemp -d)
# --one-file-system: if /proc cannot be unmounted, it stays.
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
# shellcheck disable=SC2086 # an empty mirror: no argument
mmdebstrap --variant=apt bookworm "$root" $mirror
mount -t proc proc "$root/proc"
cp /etc/resolv.conf "$root/etc/resolv.conf"
cp "$out"/*.deb "$root/root/"
cp -r "$here/../../examples/photographs/cathedral" "$root/root/photographs"
cp -r "$here/../../tests/consumers/author" "$root/root/author"
# inside COMMANDS: runs shell commands in the root, with an environment of their own.
inside() {
  chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive sh -eu -c "cd /root; $1"
}
install() { inside "apt-get -o Dpkg::Use-Pty=0 install -yqq --no-install-recommends $* >/dev/null"; }
# part TEXT: ends a part of the script and prints its duration.
part() {
  now=$(date +%s)
  echo "part: $1: $((now - began)) s"
  began=$now
}

began=$(date +%s)
inside 'apt-get update -qq'
install ./ibr-tools_*.deb mesa-vulkan-drivers
part "install the programs and a Vulkan driver"
inside 'ibr build photographs -o scene --draft --max-size 480'
inside 'ibr render scene --path auto:1 -o frames'
part "build a scene and draw its first image"
inside 'ibr doctor; ibr info scene; ls -l frames'
began=$(date +%s)

install ./libibr0_*.deb ./libibr-dev_*.deb ./libibr-doc_*.deb g++ pkg-config
inside 'g++ -std=c++20 /usr/share/doc/libibr-dev/examples/01_offscreen.cpp -o first $(pkg-config --cflags --libs ibr)
  ./first scene first.ppm && ls -l first.ppm'
part "shared library: install, build and run an example"
install ./libibr-author-dev_*.deb cmake ninja-build
inside 'cmake -S author -B author/build -G Ninja && cmake --build author/build
  author/build/consumer photographs photographs/sparse author/scene author.ppm && ls -l author.ppm'
part "author: install, build and run a program"
install ./python3-ibr_*.deb
inside 'python3 - <<END
import ibr
import ibr.author

print("libibr", ibr.__version__)
ibr.author.build(ibr.author.BuildOptions(photographs="photographs", model="photographs/sparse", output="python",
                                            max_size=240))
scene = ibr.load_scene("python")
view = ibr.Camera(ibr.Intrinsics.from_fov(320, 240, 1.0), scene.nodes[0].camera.pose)
picture = ibr.Renderer(scene, (320, 240)).render(view)
print("mean level", picture[..., :3].mean())
assert 60 < picture[..., :3].mean() < 200
END'
part "Python: install, build a scene and draw it"
inside 'apt-get purge -yqq libibr0 libibr-dev libibr-author-dev ibr-tools python3-ibr libibr-doc >/dev/null
  ! find / -xdev -path /root -prune -o -path /proc -prune -o -name "*ibr*" -print | grep -i "/\(lib\)\?ibr"'
echo "try.sh: all packages work, and nothing is left after their removal"
