# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2034 # the lists are for who sources this
# What libibr needs of Debian 12, and how it gets there. Sourced by examples/demo.sh and tests/run.sh.

# To build the library and its programs, and to run them on any machine: mesa-vulkan-drivers has a Vulkan device that
# needs no graphics card.
IBR_PACKAGES_BUILD="g++ cmake ninja-build ccache libglm-dev libfmt-dev nlohmann-json3-dev libvulkan-dev glslang-tools
  libjpeg-dev libpng-dev libtiff-dev liblcms2-dev libopenexr-dev libopencv-dev libcgal-dev libceres-dev libcli11-dev libssl-dev libglfw3-dev libimgui-dev
  libopenxr-dev mesa-vulkan-drivers"
# The demo's contact sheets and videos, and the program that estimates poses of your own photographs.
IBR_PACKAGES_DEMO="ffmpeg colmap"
# To build and run the tests. nodejs runs the Khronos glTF validator where tests/run.sh finds it (npm package
# gltf-validator, not in Debian), python3-jsonschema checks scenes against our schema. The viewer is driven by xdotool in
# a display of Xvfb that openbox manages, its window is looked at through libx11.
IBR_PACKAGES_TEST="catch2 clang-format-14 clang-tidy-14 vulkan-validationlayers locales python3-jsonschema nodejs python3-pil xvfb xdotool
  openbox libx11-dev"

# To build the OpenXR runtime that programs for headsets are tested on (tests/xr/runtime.sh). Its newer driver of Mesa
# wants what the installed one wants.
IBR_PACKAGES_XR="g++ cmake ninja-build pkg-config python3 glslang-tools xz-utils libvulkan-dev libeigen3-dev
  libxcb-randr0-dev libx11-xcb-dev mesa-vulkan-drivers"

# missing_packages PACKAGE…: names those that are not installed.
missing_packages() {
  for package in "$@"; do
    case $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) in
      installed) ;;
      *) printf ' %s' "$package" ;;
    esac
  done
}

# install_packages PACKAGE…: installs those that are missing. Needs no network where none is.
install_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This is no Debian: if something is missing below, it is what these packages of Debian 12 hold:" >&2
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
    echo "These packages are missing; install them as root:" >&2
    echo "  apt-get install --no-install-recommends$missing" >&2
    return 1
  fi
  echo "Installing$missing" >&2
  # A stale package list is no reason to stop: what is missing may still be found.
  $as_root DEBIAN_FRONTEND=noninteractive apt-get -q update </dev/null >&2 || true
  # shellcheck disable=SC2086 # a list of words
  $as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $missing </dev/null >&2
}
