#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures what libibr/docs/tradeoff.md tells: sh libibr/docs/tradeoff.sh IBR DATASETS OUT [PLACE…]
# IBR: the program; DATASETS: folder with drone_brighton, hall-pano and street; OUT: for scenes and reports; PLACE: only
# these. ROUNDS: of times. Started again it goes on where it was. Leave the machine to it. Then:
# python3 libibr/docs/tradeoff.py OUT --write
set -eu
ibr=$(realpath "$1") data=$(realpath "$2") out=$3
photographs=$(realpath "$(dirname "$0")/../../examples/photographs")
shift 3
places=${*:-cathedral lane hall drone street}
rounds=${ROUNDS:-5}
mkdir -p "$out"
cd "$out"
# Names without a machine's folders: reports and figures have the command in them.
ln -sfn "$data" datasets
ln -sfn "$photographs" photographs

build() {
  [ -f "$place/scene/scene.gltf" ] || "$ibr" build "$@" -o "$place/scene" -q
}

measure() {
  "$ibr" tradeoff "$place/scene" --truth "$@" --repeat "$rounds" --walk 1500 -o "$place/report" |
    tee "$place/report.txt"
}

for place in $places; do
  mkdir -p "$place"
  case $place in
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
      [ -f street/swept/sweep.json ] || "$ibr" sweep street/scene --truth datasets/street/gt --views gt00.png \
        --instances 16 64 --radius 1 5 20 --decay 0.5 1 --threshold 0.005 --rigidity 0 1 10 -q -o street/swept
      measure datasets/street/gt --only gt00.png gt12.png --shrink 3 --sweep street/swept/sweep.json ;;
    *)
      echo "tradeoff.sh: $place is none of cathedral, lane, hall, drone, street" >&2
      exit 1 ;;
  esac
done
