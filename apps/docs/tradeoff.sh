#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures what apps/docs/tradeoff.md tells: sh apps/docs/tradeoff.sh IBR DATASETS OUT
# IBR: the program; DATASETS: folder with drone_brighton, hall-pano and street; OUT: for scenes and reports. Started
# again it goes on where it was. Leave the machine to it. Then: python3 apps/docs/tradeoff.py OUT
set -eu
ibr=$1 data=$2 out=$3
photographs=$(dirname "$0")/../../examples/photographs
rounds=${ROUNDS:-9}
mkdir -p "$out"

build() {
  name=$1
  shift
  [ -f "$out/$name/scene/scene.gltf" ] || "$ibr" build "$@" -o "$out/$name/scene" -q
}

measure() {
  name=$1
  shift
  "$ibr" tradeoff "$out/$name/scene" "$@" --repeat "$rounds" -o "$out/$name/report" | tee "$out/$name/report.txt"
}

build cathedral "$photographs/cathedral" --exclude 02.jpg --max-size 700
build lane "$photographs/lane" --exclude 04.jpg 08.jpg --max-size 500
build hall "$data/hall-pano" --panoramas "$data/hall-pano/panoramas.json" --max-size 1024
build drone "$data/drone_brighton/images" --model "$data/drone_brighton/sparse" --max-size 500 \
  --exclude DJI_0023.jpg DJI_0029.jpg
build street "$data/street/images" --model "$data/street/sparse" --max-size 384

measure cathedral --truth "$photographs/cathedral" --only 02.jpg --shrink 4
measure lane --truth "$photographs/lane" --only 04.jpg 08.jpg --shrink 3
measure hall --truth "$data/hall-pano/gt" --only gt00.png gt03.png --shrink 3
measure drone --truth "$data/drone_brighton" --only DJI_0023.jpg DJI_0029.jpg --shrink 4
measure street --truth "$data/street/gt" --only gt00.png gt12.png --shrink 3
