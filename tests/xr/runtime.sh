#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds an OpenXR runtime for tests without a headset: sh tests/xr/runtime.sh [DIR]
#
# Builds Monado from Debian's source archive. On Debian 12, adds a newer Mesa: the software device of its own Mesa draws
# every view of a multiview pass into the first layer. Debian 13 uses its installed Mesa. Only DIR is changed. The
# default DIR is a folder of the user's cache with a hash of this file and of the release in its name, so that a changed
# recipe gets a new folder. An existing runtime is reused. Progress goes to stderr, the name of the folder to stdout.
# Needs the packages IBR_PACKAGES_XR of examples/packages.sh, but not root.
#
# DIR/environment contains lines NAME=value, which programs need to use the runtime. The caller also chooses a
# compositor: XRT_COMPOSITOR_NULL=1 (no display) or XRT_COMPOSITOR_FORCE_XCB=1 (a window of DISPLAY).
set -eu

monado=25.0.0
monado_sha256=ddfa1899078173bea3db98034dc8b990df727a169f490896570ff6e3bda72113

say() { echo "OpenXR runtime: $*" >&2; }
die() { say "$*"; exit 1; }

here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=/dev/null
debian=$(. /etc/os-release 2>/dev/null && echo "${VERSION_CODENAME-}") || true
recipe=$({ cat "$here/runtime.sh"; echo "$debian"; } | sha256sum | cut -c1-16)
dir=${1-${XDG_CACHE_HOME:-$HOME/.cache}/libibr/xr-$recipe}
made_by() { [ "$(cat "$dir/recipe" 2>/dev/null)" = "$recipe" ]; }
if made_by; then
  echo "$dir"
  exit 0
fi
if [ -d "$dir" ] && [ ! -e "$dir/recipe" ] && [ -n "$(ls -A "$dir")" ]; then
  die "$dir: contains other files; give another folder"
fi

case $debian in
  bookworm) release='bookworm|oldstable' ;;
  trixie) release='trixie|stable' ;;
  *) die "Debian 12 or 13 is needed" ;;
esac
# shellcheck source=examples/packages.sh disable=SC1091
. "$here/../../examples/packages.sh"
# shellcheck disable=SC2086 # a list of words
missing=$(missing_packages $IBR_PACKAGES_XR)
[ -z "$missing" ] || die "packages are missing; install$missing"

mkdir -p "$(dirname "$dir")"
dir=$(cd "$(dirname "$dir")" && pwd)/$(basename "$dir")
work=$(mktemp -d "$dir.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
log=$work/log
# run COMMAND…: runs a command and shows its output only if it fails.
run() { "$@" >"$log" 2>&1 </dev/null || { tail -n 40 "$log" >&2; die "failed: $*"; }; }

# --- Downloads: by apt, which checks signatures, from this machine's mirror, with separate package lists.
cd "$work"
mkdir -p lists/partial cache/archives/partial debs product/mesa
# shellcheck disable=SC2016 # apt's variables
mirror=$(apt-get indextargets --format '$(RELEASE) $(COMPONENT) $(LABEL) $(REPO_URI)' 'Created-By: Packages' |
  awk -v release="^($release)\$" '$1 ~ release && $2 == "main" && (NF == 3 || $3 == "Debian") { print $NF; exit }')
[ -n "$mirror" ] || die "apt's sources contain no mirror of Debian"
signed='[signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]'
echo "deb-src $signed $mirror trixie main" >sources.list
[ "$debian" = trixie ] || echo "deb $signed $mirror bookworm-backports main" >>sources.list
# separate_apt COMMAND…: runs apt-get with these sources and lists only. APT::Sandbox::User is root, because apt's
# sandbox user may lack access to the folder.
separate_apt() {
  apt-get -q -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts=- -o Dir::State::lists="$work/lists" \
    -o Dir::Cache="$work/cache" -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any -o Acquire::Retries=3 "$@" \
    >"$log" 2>&1 </dev/null || { tail -n 20 "$log" >&2; die "apt-get $* failed; check the network"; }
}
say "fetching Monado $monado"
separate_apt update
separate_apt source --download-only --tar-only monado/trixie
[ "$debian" = trixie ] ||
  (cd debs && separate_apt download mesa-vulkan-drivers/bookworm-backports libdrm2/bookworm-backports)
tarball=monado_$monado+dfsg.orig.tar.xz
echo "$monado_sha256  $tarball" | sha256sum --check --status ||
  die "$tarball is missing or has another checksum; downloaded: $(ls monado_* || true)"

# --- Mesa's software device. On Debian 12 a newer one, unpacked without changing the installed one.
triplet=$(gcc -print-multiarch)
if [ "$debian" = trixie ]; then
  lib=
  driver=$(find /usr/share/vulkan/icd.d -name 'lvp_icd*.json' | head -n 1)
  [ -n "$driver" ] || die "mesa-vulkan-drivers contains no lvp_icd.json"
else
  for deb in debs/*.deb; do run dpkg -x "$deb" product/mesa; done
  lib=$dir/mesa/usr/lib/$triplet
  driver=$dir/lvp.json
  find product/mesa -name 'libvulkan_*.so' ! -name libvulkan_lvp.so -delete
  [ -e "product/mesa/usr/lib/$triplet/libvulkan_lvp.so" ] || die "the package of Mesa contains no libvulkan_lvp.so"
  sed "s#\"libvulkan_lvp#\"./mesa/usr/lib/$triplet/libvulkan_lvp#" product/mesa/usr/share/vulkan/icd.d/lvp_icd*.json \
    >product/lvp.json
fi

# --- Monado's sources, with changes for this build.
tar xJf "$tarball"
source=$work/monado-v$monado
# change FILE SCRIPT: edits a file with sed. A script that changes nothing is an error.
change() {
  cp "$source/$1" before
  sed -i "$2" "$source/$1"
  ! cmp -s before "$source/$1" || die "$1: sed changed nothing"
}
# Monado requires the headers of udev even without using them, and their Debian package needs a newer systemd.
change CMakeLists.txt 's/find_package(udev REQUIRED)/find_package(udev)/'
# xrGetVisibilityMaskKHR calls get_visibility_mask, which is null for the remote headset.
change src/xrt/drivers/remote/r_hmd.c \
  's/rh->base.set_output = .*/&\n\trh->base.get_visibility_mask = u_device_get_visibility_mask;/'
# The scripted headset accepts connections from this machine only.
change src/xrt/drivers/remote/r_hub.c 's/htonl(INADDR_ANY)/htonl(INADDR_LOOPBACK)/'

# --- Monado: the runtime in one library, with the null compositor and the compositor in an X11 window.
off=$(grep -ohE '^option(_with_deps)?\((XRT_BUILD_DRIVER|XRT_HAVE)_[A-Z0-9_]+' "$source/CMakeLists.txt" |
  sed 's/.*(//' | grep -vE '^XRT_HAVE_(VULKAN|XCB)$|_(SIMULATED|REMOTE)$' | sed 's/.*/-D&=OFF/')
say "building Monado (some minutes)"
# shellcheck disable=SC2086 # a list of words
run cmake -S "$source" -B build -G Ninja -DCMAKE_BUILD_TYPE=Release $off -DXRT_FEATURE_SERVICE=OFF -DXRT_MODULE_IPC=OFF \
  -DXRT_MODULE_MONADO_CLI=OFF -DXRT_FEATURE_STEAMVR_PLUGIN=OFF -DXRT_FEATURE_SLAM=OFF -DXRT_FEATURE_RENDERDOC=OFF \
  -DXRT_BUILD_SAMPLES=OFF -DBUILD_TESTING=OFF -DGIT_DESC="$monado"
run nice cmake --build build
strip -o product/libopenxr_monado.so build/src/xrt/targets/openxr/libopenxr_monado.so
cat >product/monado.json <<END
{"file_format_version": "1.0.0", "runtime": {"name": "Monado", "library_path": "./libopenxr_monado.so"}}
END
for library in product/libopenxr_monado.so $(find product/mesa -name libvulkan_lvp.so); do
  absent=$(LD_LIBRARY_PATH=$PWD/product/mesa/usr/lib/$triplet ldd "$library" | grep 'not found' || true)
  [ -z "$absent" ] || die "$library needs libraries that are not installed: $absent"
done

cat >product/environment <<END
XR_RUNTIME_JSON=$dir/monado.json
VK_DRIVER_FILES=$driver
VK_ICD_FILENAMES=$driver
LD_LIBRARY_PATH=$lib
P_OVERRIDE_ACTIVE_CONFIG=remote
END
echo "$recipe" >product/recipe
# Another process may have built the same runtime meanwhile, which is used then.
if ! made_by; then
  rm -rf "$dir"
  mv -T "product" "$dir" 2>/dev/null || made_by || die "cannot make $dir"
fi
say "ready"
echo "$dir"
