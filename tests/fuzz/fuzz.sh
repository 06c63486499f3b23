#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Live fuzzing, started by hand: builds the targets with clang's libFuzzer, AddressSanitizer and UBSan, and runs each
# from its seeds. Failing inputs are written to build/fuzz/found. Fix the reader, then add the input as
# tests/fuzz/corpus/NAME/FAULT.
#   tests/fuzz/fuzz.sh [SECONDS [NAME …]]      seconds per target [60]; clang: apt-get install clang
set -eu
cd "$(dirname "$0")/../.."
seconds=${1-60}
[ $# -eq 0 ] || shift
CC=clang CXX=clang++ cmake -S . -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=None -DIBR_FUZZER=ON \
  -DCMAKE_CXX_FLAGS="-O1 -g1 -fsanitize=fuzzer-no-link -fno-sanitize-recover=all" -DIBR_BUILD_AUTHOR=OFF \
  -DIBR_SANITIZE=address,undefined,float-cast-overflow -DIBR_BUILD_APPS=OFF -DIBR_BUILD_EXAMPLES=OFF
cmake --build build/fuzz --target ibr_fuzz
mkdir -p build/fuzz/found
# shellcheck disable=SC2046 # names without spaces
[ $# -gt 0 ] || set -- $(cd tests/fuzz && ls ./*_fuzz.cpp | sed 's,^./,,; s,_fuzz.cpp$,,')
for name; do
  echo "== $name"
  corpus=build/fuzz/corpus/$name
  mkdir -p "$corpus"
  # The replay program of the preset ci writes the seeds.
  build/ci/tests/fuzz/ibr_fuzz_"$name" --write "$corpus"
  [ ! -d tests/fuzz/corpus/"$name" ] || cp tests/fuzz/corpus/"$name"/* "$corpus"
  TMPDIR=${TMPDIR-/dev/shm} build/fuzz/tests/fuzz/ibr_fuzz_"$name" -max_total_time="$seconds" -timeout=10 \
    -rss_limit_mb=2048 -max_len=65536 -artifact_prefix=build/fuzz/found/"$name"- -print_final_stats=1 "$corpus"
done
