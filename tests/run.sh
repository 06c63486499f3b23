#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds with warnings as errors, checks the runtime with clang-tidy (not on Debian 13), and
# runs all tests.
# Arguments are passed to ctest.
#   IBR_DATASETS=DIR          also runs the tests that need more than the bundled photographs
#   IBR_REQUIRE_DEVICE=1      tests fail instead of being skipped on a machine without a Vulkan device
#   IBR_GLTF_VALIDATOR=DIR    folder of the npm package gltf-validator; without it the validator's test is skipped
#   IBR_XR_RUNTIME=DIR        OpenXR runtime that tests/xr/runtime.sh has built; by default one is built in the user's
#                             cache. If the build fails, the headset tests are skipped
#   IBR_REQUIRE_XR=1          a missing OpenXR runtime is an error
#   IBR_NO_SANITIZERS=1       leaves out the second build, which tests file readers with sanitizers
set -eu
cd "$(dirname "$0")/.."
began=$(date +%s)
# part NAME: ends a part of the script and prints its duration.
part() {
  now=$(date +%s)
  echo "part: $1: $((now - began)) s"
  began=$now
}
. examples/packages.sh
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_PYTHON $IBR_PACKAGES_TEST $IBR_PACKAGES_STYLE
part packages

# shellcheck disable=SC2086 # a list of words
if [ -z "${IBR_XR_RUNTIME-}" ] && ! { install_packages $IBR_PACKAGES_XR && IBR_XR_RUNTIME=$(sh tests/xr/runtime.sh); }; then
  [ -z "${IBR_REQUIRE_XR-}" ] || exit 1
  echo "no OpenXR runtime: headset tests are skipped" >&2
fi
export IBR_XR_RUNTIME
part "OpenXR runtime"

cmake --preset ci
cmake --build --preset ci
part build
if [ -n "$IBR_PACKAGES_STYLE" ]; then
  python3 tests/check_tidy.py build/ci
  part clang-tidy
fi
if [ -z "${IBR_NO_SANITIZERS-}" ]; then
  cmake --preset readers
  cmake --build --preset readers
  part "build with sanitizers"
fi

# Folder for a locale with a decimal comma, which some tests use. A folder of the build needs no root access.
LOCPATH=$PWD/build/locale
if [ ! -e "$LOCPATH/de_DE.UTF-8" ]; then
  mkdir -p "$LOCPATH"
  localedef -i de_DE -f UTF-8 "$LOCPATH/de_DE.UTF-8" || echo "no locale de_DE.UTF-8" >&2
fi
export LOCPATH
if [ -z "${IBR_NO_SANITIZERS-}" ]; then
  echo "file readers, with sanitizers:"
  IBR_FUZZ_MIB=3000 ctest --preset readers -j2 --quiet --output-log build/readers/tests.log ||
    { cat build/readers/tests.log; exit 1; }
  part "tests with sanitizers"
fi
status=0
ctest --preset ci -j2 "$@" || status=$?
part tests
exit "$status"
