#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds with warnings as errors, checks the runtime with clang-tidy, and runs every test.
# Arguments go to ctest.
#   IBR_DATASETS=DIR          also runs the tests that want more than the bundled photographs
#   IBR_REQUIRE_DEVICE=1      a machine without a Vulkan device fails instead of skipping
#   IBR_GLTF_VALIDATOR=DIR    where the npm package gltf-validator is; without it that test is skipped
#   IBR_XR_RUNTIME=DIR        an OpenXR runtime as tests/xr/runtime.sh makes it; without it one is made in the user's cache,
#                             and where that cannot be, the tests of headsets are skipped
#   IBR_REQUIRE_XR=1          then they fail instead
#   IBR_NO_SANITIZERS=1       does without the second build, with sanitizers, of what reads files
set -eu
cd "$(dirname "$0")/.."
began=$(date +%s)
# part NAME: prints how long the part took that ends here.
part() {
  now=$(date +%s)
  echo "part: $1: $((now - began)) s"
  began=$now
}
. examples/packages.sh
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_TEST
part packages

# shellcheck disable=SC2086 # a list of words
if [ -z "${IBR_XR_RUNTIME-}" ] && ! { install_packages $IBR_PACKAGES_XR && IBR_XR_RUNTIME=$(sh tests/xr/runtime.sh); }; then
  [ -z "${IBR_REQUIRE_XR-}" ] || exit 1
  echo "There is no OpenXR runtime: the tests of headsets are skipped." >&2
fi
export IBR_XR_RUNTIME
part "OpenXR runtime"

cmake --preset ci
cmake --build --preset ci
part build
python3 tests/check_tidy.py build/ci || [ $? -eq 77 ]
part clang-tidy
if [ -z "${IBR_NO_SANITIZERS-}" ]; then
  cmake --preset readers
  cmake --build --preset readers
  part "build with sanitizers"
fi

# Tests that want a locale with a decimal comma take it from here; nobody need be root for that.
LOCPATH=$PWD/build/locale
if [ ! -e "$LOCPATH/de_DE.UTF-8" ]; then
  mkdir -p "$LOCPATH"
  localedef -i de_DE -f UTF-8 "$LOCPATH/de_DE.UTF-8" || echo "no locale de_DE.UTF-8" >&2
fi
export LOCPATH
if [ -z "${IBR_NO_SANITIZERS-}" ]; then
  echo "What reads files, with sanitizers:"
  IBR_FUZZ_MIB=3000 ctest --preset readers -j2 --quiet --output-log build/readers/tests.log ||
    { cat build/readers/tests.log; exit 1; }
  part "tests with sanitizers"
fi
status=0
ctest --preset ci -j2 "$@" || status=$?
part tests
exit "$status"
