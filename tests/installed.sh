#!/usr/bin/env bash
# What `cmake --install` puts down works by itself, and a first run of it compiles no shader. The first argument is the
# build folder.
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset NEARFIELD_DATA_DIR
cmake --install "$build" --prefix "$work/usr" >"$work/install.log" 2>&1 || { cat "$work/install.log"; exit 1; }
share=$work/usr/share/nearfield
cd "$work"
# $1: a name. The programs that a first run had to compile.
render() {
  XDG_CACHE_HOME=$work/$1 "$work/usr/bin/nearfield" render "$share/content/cornell.glb" --size 32x18 --frames 2 \
    -o "$1.png" >"$1.log" 2>&1 || { cat "$1.log" "$work/install.log"; exit 1; }
  find "$work/$1" -name '*.spv' | wc -l
}
fail() { echo "$1"; cat "$work/install.log"; exit 1; }
shipped=$(render shipped)
[ "$shipped" -eq 0 ] || fail "$shipped programs were not precompiled, of $(ls "$share/spirv" | wc -l) that are"
mv "$share/spirv" "$work/away"
compiled=$(render compiled)
[ "$compiled" -gt 5 ] || fail "the control: $compiled programs compiled without the precompiled ones"
cmp shipped.png compiled.png
echo "$(ls "$work/away" | wc -l) programs precompiled, $compiled of them used"
