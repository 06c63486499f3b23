#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds with warnings as errors, and runs every test.
#   IBR_DATASETS=DIR          also runs the tests that want more than the bundled photographs
#   IBR_REQUIRE_DEVICE=1      a machine without a Vulkan device fails instead of skipping
set -eu
cd "$(dirname "$0")/.."
. examples/packages.sh
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_TEST

cmake --preset ci
cmake --build --preset ci
ctest --preset ci -j2 "$@"
