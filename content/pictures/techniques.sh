#!/usr/bin/env bash
# Makes techniques.png: every technique on five scenes, as a user sees them (16 frames, default reconstruction, default settings).
# Needs the scenes of ../shared and ImageMagick:  content/pictures/techniques.sh [BUILD]
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
build=${1:-build/release} shared=../shared/scenes work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
views=("$build/content/cornell.glb" "$build/content/fence.glb" "$build/content/atrium.glb $build/content/atrium.json"
       "$shared/breakfast_room.glb $shared/breakfast_sun.json" "$shared/sponza.glb $shared/sponza_nave.json")
pictures=()
for view in "${views[@]}"; do
  read -r scene camera <<<"$view"
  for technique in none hbao gtao vbao vbgi hbil ssao ssdo raymarch; do
    picture=$work/${#pictures[@]}.png
    "$build/nearfield" render "$scene" ${camera:+--view "$camera"} --technique "$technique" --size 160x90 --frames 16 \
      -o "$picture" --quiet >/dev/null
    pictures+=("$picture")
  done
done
montage "${pictures[@]}" -tile 9x -geometry +2+2 -background black -strip -define png:compression-level=9 content/pictures/techniques.png
