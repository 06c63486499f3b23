# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2034 # scripts that source this file use the lists
# Packages of Debian 12 and 13 that libibr needs, and functions that install them. Sourced by examples/demo.sh and
# tests/run.sh.

# Packages to build the library and its programs, and to run them on any machine: mesa-vulkan-drivers has a Vulkan
# device that needs no graphics card.
IBR_PACKAGES_BUILD="g++ cmake ninja-build ccache libglm-dev libfmt-dev nlohmann-json3-dev libvulkan-dev glslang-tools
  libjpeg-dev libpng-dev libtiff-dev zlib1g-dev liblcms2-dev libopenexr-dev libheif-dev libraw-dev libwebp-dev pkg-config
  libopencv-dev libcgal-dev libceres-dev libpugixml-dev libcli11-dev libssl-dev libglfw3-dev libimgui-dev libopenxr-dev mesa-vulkan-drivers"
# Programs for the demo's contact sheets and videos, and for pose estimation of your own photographs.
IBR_PACKAGES_DEMO="ffmpeg colmap"
# Packages to build the Python packages ibr and ibr.author, and to use them.
IBR_PACKAGES_PYTHON="pybind11-dev python3-dev python3-numpy"
# Packages to build and run the tests. nodejs runs the Khronos glTF validator (npm package gltf-validator, not in
# Debian) if tests/run.sh finds it. python3-jsonschema checks scenes against our schema. xdotool drives the viewer in an
# Xvfb display that openbox manages; libx11 reads the viewer's window. mypy checks the types of the Python packages, and
# python3-matplotlib draws the plot of their example. libheif-examples, libavif-bin and webp encode photographs,
# ffmpeg videos; colmap converts models. doxygen makes the documentation, and groff checks man pages.
IBR_PACKAGES_TEST="catch2 vulkan-validationlayers locales python3-jsonschema nodejs python3-pil xvfb xdotool
  openbox libx11-dev libvulkan-volk-dev mypy
  python3-matplotlib libheif-examples libavif-bin webp ffmpeg colmap doxygen groff-base"
# Packages that check the sources' format and style. Their results depend on the version, which only Debian 12 has.
IBR_PACKAGES_STYLE="clang-format-14 clang-tidy-14"
# Debian 13 has the codecs of HEIC and AVIF in packages of their own.
# shellcheck source=/dev/null
if [ "$(. /etc/os-release 2>/dev/null && echo "${VERSION_CODENAME-}")" = trixie ]; then
  IBR_PACKAGES_BUILD="$IBR_PACKAGES_BUILD libheif-plugin-libde265 libheif-plugin-dav1d"
  IBR_PACKAGES_TEST="$IBR_PACKAGES_TEST libheif-plugin-x265 libheif-plugin-aomenc"
  IBR_PACKAGES_STYLE=
fi

# Packages to build the OpenXR runtime of the headset tests (tests/xr/runtime.sh). The runtime's newer Mesa driver has
# the same dependencies as the installed one.
IBR_PACKAGES_XR="g++ cmake ninja-build pkg-config python3 glslang-tools xz-utils libvulkan-dev libeigen3-dev
  libxcb-randr0-dev libx11-xcb-dev mesa-vulkan-drivers"

# Packages to build and try Debian packages (cmake/debian).
IBR_PACKAGES_DEBIAN="git dpkg-dev debhelper dh-python lintian fakeroot mmdebstrap"

# missing_packages PACKAGE…: prints the names of packages that are not installed.
missing_packages() {
  for package in "$@"; do
    case $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) in
      installed) ;;
      *) printf ' %s' "$package" ;;
    esac
  done
}

# install_packages PACKAGE…: installs the missing packages. If none is missing, no network is needed.
install_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "not a Debian system: if a later step fails, install what these Debian 12 packages contain:" >&2
    echo "  $*" >&2
    return 0
  fi
  missing=$(missing_packages "$@")
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" = 0 ]; then
    as_root="env"
  elif command -v sudo >/dev/null; then
    as_root="sudo env"
  else
    echo "packages are missing; install them as root:" >&2
    echo "  apt-get install --no-install-recommends$missing" >&2
    return 1
  fi
  echo "installing$missing" >&2
  # A failed update is not fatal: a stale package list may still have the packages.
  $as_root DEBIAN_FRONTEND=noninteractive apt-get -q update </dev/null >&2 || true
  # shellcheck disable=SC2086 # a list of words
  $as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $missing </dev/null >&2
}
