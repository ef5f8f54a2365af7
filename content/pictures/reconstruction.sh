#!/usr/bin/env bash
# Makes reconstruction.png: the stages of the reconstruction on the bundled atrium, one added after the other. Needs
# ImageMagick:  content/pictures/reconstruction.sh [BUILD]
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
build=${1:-build/release} work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
no_mean="--set temporal.enabled=false" no_filter="--set denoise.method=off" no_taa="--set taa.enabled=false"
stages=("--frames 1 $no_mean $no_filter $no_taa" "--frames 1 $no_taa" "--frames 16 $no_filter $no_taa" "--frames 16 $no_taa"
        "--frames 16" "--frames 16 --set feedback.reprojection=gather")
pictures=()
for stage in "${stages[@]}"; do
  picture=$work/${#pictures[@]}.png
  # shellcheck disable=SC2086
  "$build/nearfield" render "$build/content/atrium.glb" --view "$build/content/atrium.json" --size 320x180 $stage \
    --set tonemap.exposure_ev=0.5 -o "$picture" --quiet >/dev/null
  pictures+=("$picture")
done
montage "${pictures[@]}" -tile 3x -geometry +2+2 -background black "$work/all.png"
convert "$work/all.png" -strip +dither -colors 200 PNG8:content/pictures/reconstruction.png
