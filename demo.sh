#!/usr/bin/env bash
# Installs what is missing, builds Nearfield and renders the bundled Cornell box, without a display.
set -euo pipefail

for argument in "$@"; do
  case $argument in
    -h | --help)
      cat <<'HELP'
Usage: ./demo.sh
Installs missing Debian packages (as root or with sudo), builds preset `release` and renders the bundled scene
build/release/content/cornell.glb to build/release/demo/cornell.png. Needs no display. Prints the time of every pass.
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

say "Rendering the Cornell box: 64 frames, averaged."
mkdir -p build/release/demo
picture=build/release/demo/cornell.png
build/release/nearfield render build/release/content/cornell.glb -o "$picture" --size 640x360 --frames 64 --accumulate \
  --set gi.slices=4 --set tonemap.exposure_ev=1
say "The picture is $PWD/$picture"
say "See README.md for more to try; ./test.sh runs the tests."
