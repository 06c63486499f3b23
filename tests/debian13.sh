#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds and tests this working tree in a root of Debian 13 with tests/run.sh. Debian 12 stays the release that each
# change is tested on.
#
#   debian13.sh ROOT [CTEST-ARGUMENT…]     ROOT: folder of the root; a missing one is created, an existing one reused
#
# Needs root, the Debian package mmdebstrap, 6 GB in ROOT, and about an hour on two cores. A second run builds what
# has changed. ROOT/root/libibr contains the sources and the build. IBR_DATASETS, IBR_REQUIRE_XR and IBR_NO_SANITIZERS
# are passed on to tests/run.sh; a missing device is an error. DEBIAN_MIRROR names a mirror. rm -r removes ROOT: all
# mounts end with this script.
set -eu
[ $# -ge 1 ] || { echo "usage: debian13.sh ROOT [CTEST-ARGUMENT…]" >&2; exit 2; }
[ "$(id -u)" = 0 ] || { echo "debian13.sh: needs root for chroot" >&2; exit 2; }
# Mounts in a namespace of this script end with it, also if it is killed.
[ -n "${IBR_MOUNTS-}" ] || exec env IBR_MOUNTS=own unshare --mount --propagation private sh "$0" "$@"
source=$(cd "$(dirname "$0")/.." && pwd)
root=$1
shift
if [ ! -e "$root/complete" ]; then
  # shellcheck disable=SC2086 # an empty mirror: no argument
  mmdebstrap --variant=apt trixie "$root" ${DEBIAN_MIRROR-}
  touch "$root/complete"
fi
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
cp /etc/resolv.conf "$root/etc/resolv.conf"
datasets=
if [ -n "${IBR_DATASETS-}" ]; then
  datasets=/datasets
  mkdir -p "$root$datasets"
  mount --bind -o ro "$IBR_DATASETS" "$root$datasets"
fi

# Files of the working tree that Git does not ignore. Unchanged files keep their times, so that a second build is short.
copy=$root/root/libibr
git -C "$source" ls-files -z --cached --others --exclude-standard >"$root/root/libibr.files"
mkdir -p "$copy"
find "$copy" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
tar -C "$source" --null --ignore-failed-read --files-from="$root/root/libibr.files" -cf - | tar -C "$copy" -xf -
exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 TERM=dumb \
  IBR_REQUIRE_DEVICE=1 IBR_DATASETS="$datasets" IBR_REQUIRE_XR="${IBR_REQUIRE_XR-}" \
  IBR_NO_SANITIZERS="${IBR_NO_SANITIZERS-}" sh -eu -c 'cd /root/libibr; apt-get -q update; sh tests/run.sh "$@"' run.sh "$@"
