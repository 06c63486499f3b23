#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Stub for the program colmap in tests: prints COLMAP's output and copies models to --output_path. The command mapper
# copies FAKE_COLMAP/models, image_registrator copies FAKE_COLMAP/added. Arguments are appended to FAKE_COLMAP/calls.
# Files in the folder FAKE_COLMAP change the behaviour of a COLMAP command:
#   newer            --help lists the option name of newer versions
#   FAIL-COMMAND     exits with code 3
#   NONE-COMMAND     creates no model
#   SLEEP-COMMAND    sleeps for 600 s; the file sleeper gets the process id
#   AHEAD-COMMAND    creates no model unless forward motion of the initial pair is allowed (init_max_forward_motion 1)
set -eu
command=$1
if [ "${2:-}" = --help ]; then
  [ ! -e "$FAKE_COLMAP/newer" ] || echo "  --FeatureExtraction.use_gpu arg (=1)"
  exit 0
fi
echo "$QT_QPA_PLATFORM $*" >>"$FAKE_COLMAP/calls"
case $command in
  feature_extractor) printf 'Processed file [1/4]\nProcessed file [2/4]\n' ;;
  exhaustive_matcher | matches_importer) echo 'Matching block [1/2, 2/2] in 3.2s' ;;
  sequential_matcher) echo 'Matching image [1/4] in 0.1s' ;;
  mapper) echo 'Registering image #2 (3)' ;;
  image_registrator) echo 'Registering image #5 (4)' ;;
esac
if [ -e "$FAKE_COLMAP/SLEEP-$command" ]; then
  sleep 600 &
  echo $! >"$FAKE_COLMAP/sleeper"
  wait
fi
if [ -e "$FAKE_COLMAP/FAIL-$command" ]; then
  echo "E20250101 mapper.cc:12] no good initial pair" >&2
  exit 3
fi
none=
if [ -e "$FAKE_COLMAP/AHEAD-$command" ]; then
  case "$*" in *"init_max_forward_motion 1 "*) ;; *) none=1 ;; esac
fi
if [ "$none" ] || [ -e "$FAKE_COLMAP/NONE-$command" ]; then
  echo "ERROR: failed to create sparse model"
  exit 1
fi
if [ "$command" = mapper ]; then
  while [ "$1" != --output_path ]; do shift; done
  cp -r "$FAKE_COLMAP/models/." "$2"
elif [ "$command" = image_registrator ]; then
  while [ "$1" != --output_path ]; do shift; done
  cp -r "$FAKE_COLMAP/added/." "$2"
fi
