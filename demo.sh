#!/usr/bin/env bash
# Installs what is missing, builds Nearfield and renders the bundled atrium, without a display.
set -euo pipefail

for argument in "$@"; do
  case $argument in
    -h | --help)
      cat <<'HELP'
Usage: ./demo.sh
Installs missing Debian packages (as root or with sudo), builds preset `release` and renders the bundled scene
build/release/content/atrium.glb to build/release/demo/atrium.png. Needs no display. Prints the time of every pass.
HELP
      exit 0
      ;;
    *) printf '%s\n' "error: unknown argument '$argument'; see ./demo.sh --help" >&2 && exit 2 ;;
  esac
done

cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
. .ci/packages.sh

install_packages "${build_packages[@]}"
configure release
say "Building. The first time takes some minutes."
cmake --build build/release --target nearfield nearfield_scenes

say "Rendering the atrium: 24 frames, averaged."
mkdir -p build/release/demo
picture=build/release/demo/atrium.png
build/release/nearfield render build/release/content/atrium.glb --view build/release/content/atrium.json -o "$picture" \
  --size 640x360 --frames 24 --accumulate --set gi.slices=2 --set tonemap.exposure_ev=0.5
say "The picture is $PWD/$picture"
say "build/release/nearfield opens the editor in a window; README.md has more to try; ./test.sh runs the tests."
