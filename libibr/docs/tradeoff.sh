#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures the figures of libibr/docs/tradeoff.md: sh libibr/docs/tradeoff.sh APPS DATASETS OUT [SCENE…]
# APPS: folder of the built programs, such as build/release/apps (batch/ibr and lab/ibr-lab are run).
# DATASETS: folder with drone_brighton, hall-pano and street. OUT: folder for scenes and reports.
# SCENE: measures only these. Environment: ROUNDS, rounds of time measurements [5].
# The same command resumes an interrupted run. Run nothing else on the machine meanwhile. Afterwards:
# python3 libibr/docs/tradeoff.py OUT --write
set -eu
apps=$(realpath "$1") data=$(realpath "$2") out=$3
ibr=$apps/batch/ibr lab=$apps/lab/ibr-lab
photographs=$(realpath "$(dirname "$0")/../../examples/photographs")
shift 3
for program in "$ibr" "$lab"; do
  [ -x "$program" ] || { echo "tradeoff.sh: $program is missing; give the folder apps of a build" >&2; exit 1; }
done
scenes=${*:-cathedral lane hall drone street}
rounds=${ROUNDS:-5}
mkdir -p "$out"
cd "$out"
# Links give relative paths: reports and figures contain the command, which must not name folders of this machine.
ln -sfn "$data" datasets
ln -sfn "$photographs" photographs

build() {
  [ -f "$scene/scene/scene.gltf" ] || "$ibr" build "$@" -o "$scene/scene" -q
}

measure() {
  "$ibr" tradeoff "$scene/scene" --truth "$@" --repeat "$rounds" --walk 1500 -o "$scene/report" |
    tee "$scene/report.txt"
}

for scene in $scenes; do
  mkdir -p "$scene"
  case $scene in
    cathedral)
      build photographs/cathedral --exclude 02.jpg --max-size 700
      measure photographs/cathedral --only 02.jpg --shrink 4 ;;
    lane)
      build photographs/lane --exclude 04.jpg 08.jpg --max-size 500
      measure photographs/lane --only 04.jpg 08.jpg --shrink 4 ;;
    hall)
      build datasets/hall-pano --panoramas datasets/hall-pano/panoramas.json --max-size 1024
      measure datasets/hall-pano/gt --only gt00.png gt03.png --shrink 3 ;;
    drone)
      build datasets/drone_brighton/images --model datasets/drone_brighton/sparse --max-size 500 \
        --exclude DJI_0023.jpg DJI_0029.jpg
      measure datasets/drone_brighton --only DJI_0023.jpg DJI_0029.jpg --shrink 4 ;;
    street)
      build datasets/street/images --model datasets/street/sparse --max-size 384
      [ -f street/swept/sweep.json ] || "$lab" sweep street/scene --truth datasets/street/gt --views gt00.png \
        --instances 16 64 --radius 1 5 20 --decay 0.5 1 --threshold 0.005 --rigidity 0 1 10 -q -o street/swept
      measure datasets/street/gt --only gt00.png gt12.png --shrink 3 --sweep street/swept/sweep.json ;;
    *)
      echo "tradeoff.sh: unknown scene $scene; choose from cathedral, lane, hall, drone, street" >&2
      exit 1 ;;
  esac
done
