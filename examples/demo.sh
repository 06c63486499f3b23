#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds ibr, and turns the bundled photographs into scenes. For each scene, renders a walk
# between the camera positions and slightly beyond.
#   sh examples/demo.sh [--output DIR]      default: out/demo
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
output=$root/out/demo
while [ $# -gt 0 ]; do
  case $1 in
    --output)
      [ $# -ge 2 ] || { echo "demo.sh: --output needs a folder" >&2; exit 1; }
      output=$2
      shift 2
      ;;
    -h | --help)
      sed -n '3,5s/^# //p' "$0"
      exit 0
      ;;
    *)
      echo "demo.sh: unknown argument $1; usage: sh examples/demo.sh [--output DIR]" >&2
      exit 1
      ;;
  esac
done
mkdir -p "$output"
output=$(cd "$output" && pwd)
cd "$root"
. examples/packages.sh
# shellcheck disable=SC2086 # lists of words
install_packages $IBR_PACKAGES_BUILD $IBR_PACKAGES_DEMO

echo "== building"
cmake --preset release --log-level=WARNING -DIBR_BUILD_TESTS=OFF -DIBR_BUILD_EXAMPLES=OFF
cmake --build --preset release --target ibr_batch
ibr=$root/build/release/apps/batch/ibr
"$ibr" doctor || true

# is_current FILE: succeeds if FILE exists and is newer than this program and this script.
is_current() { [ -n "$(find "$1" -newer "$ibr" -newer "$root/examples/demo.sh" 2>/dev/null)" ]; }

# walk NAME FRAMES SIZE: photographs → scene → images, contact sheet, video. Current files are not made again.
walk() {
  scene=$output/$1/scene pictures=$output/$1/pictures rendered=$output/$1/pictures/.rendered
  if ! is_current "$scene/scene.gltf"; then
    echo "== $1: photographs to scene"
    rm -f "$rendered"
    "$ibr" build "examples/photographs/$1" -o "$scene" --json "$output/$1/build.json" >"$output/$1/build.txt"
    head -n 1 "$output/$1/build.txt"
  fi
  if is_current "$rendered" && [ -e "$output/$1/walk.mp4" ] && [ -e "$output/$1/contact-sheet.jpg" ]; then return; fi
  echo "== $1: scene to images"
  rm -rf "$pictures"
  "$ibr" render "$scene" --path "auto:$2" --size "$3" -o "$pictures"
  ffmpeg -v error -y -i "$pictures/frame_%04d.png" -vf "select=not(mod(n\,$(($2 / 12)))),scale=480:-2,tile=4x3" \
    -frames:v 1 -q:v 3 "$output/$1/contact-sheet.jpg" </dev/null
  ffmpeg -v error -y -framerate 30 -i "$pictures/frame_%04d.png" -pix_fmt yuv420p -crf 20 -movflags +faststart \
    "$output/$1/walk.mp4" </dev/null
  touch "$rendered"
}
names="cathedral lane relief"
for name in $names; do mkdir -p "$output/$name"; done

# Draft scene for an early first image. The full build resumes from the draft.
if ! is_current "$output/cathedral/scene/scene.gltf"; then
  echo "== first image"
  "$ibr" build examples/photographs/cathedral -o "$output/cathedral/scene" --draft -q
  "$ibr" render "$output/cathedral/scene" --path auto:1 --size 1280x960 -o "$output/first" -q
  echo "$output/first"
  # Marks the draft as out of date, so that walk() builds the full scene.
  touch -d 2000-01-01 "$output/cathedral/scene/scene.gltf"
fi
walk cathedral 96 1280x960
walk lane 180 984x738
walk relief 120 960x720

# The viewer is optional: its libraries or a display may be missing.
viewer=$root/build/release/apps/viewer/ibr-viewer
echo "== building the viewer"
cmake --build --preset release --target ibr_viewer || true

echo
for name in $names; do
  echo "$name"
  echo "  images         $output/$name/pictures"
  echo "  contact sheet  $output/$name/contact-sheet.jpg"
  echo "  video          $output/$name/walk.mp4"
  echo "  scene          $output/$name/scene"
done
cat <<END

For your own photographs of one place, which must overlap well:
  $ibr build PHOTOGRAPHS -o SCENE
  $ibr render SCENE --path auto:90 -o IMAGES
END
[ ! -x "$viewer" ] || echo "  $ibr view SCENE"
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] && [ -x "$viewer" ]; then
  "$viewer" "$output/cathedral/scene" "$output/lane/scene" "$output/relief/scene"
fi
