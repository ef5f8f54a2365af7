#!/bin/bash
# Makes the pictures of content/editor.md: content/pictures/editor.sh [BUILD]. Needs ImageMagick; takes some minutes.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:-$here/../../build/release}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
XDG_CONFIG_HOME=$work/config "$build/nearfield" edit "$build/content/cornell.glb" --offscreen --window 1160x820 \
  --ui-script "$here/editor.jsonl"
mkdir -p "$here/editor"
for picture in *.png; do
  small=(-colors 160)
  [[ $picture == missing.png ]] && small=(-resize 75% -colors 64)  # noise does not compress
  convert "$picture" -strip +dither "${small[@]}" "PNG8:$here/editor/$picture"
done
