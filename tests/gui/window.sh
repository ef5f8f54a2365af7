#!/usr/bin/env bash
# The editor in a real window: found, clicked and typed at by xdotool under Xvfb. The first argument is the build folder.
set -euo pipefail
build=$1
edit=(env "LD_PRELOAD=${NF_PRELOAD:-}" "$build/nearfield" edit)  # the process is the editor's own, for xdotool
here=$(cd "$(dirname "$0")" && pwd)
for tool in Xvfb xdotool python3; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
work=$(mktemp -d)
export XDG_CONFIG_HOME=$work/config LC_ALL=C NEARFIELD_DATA_DIR=$work/data
mkdir -p "$work/data" && cp -r "$here/../../shaders" "$work/data/shaders"
Xvfb -displayfd 3 -screen 0 1600x1000x24 -nolisten tcp -noreset 3>"$work/display" >"$work/xvfb.log" 2>&1 &
server=$!
editor=
finish() {
  local status=$?
  if [ "$status" -ne 0 ]; then
    echo "--- the editor said:" && cut -c1-400 "$work/err.log" | head -40
    [ -e "$work/ui.json" ] && head -60 "$work/ui.json"
  fi
  [ -z "$editor" ] || kill "$editor" 2>/dev/null || true
  kill "$server" 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
export DISPLAY=:$(cat "$work/display")
cd "$work"

ui() { python3 "$here/ui.py" "$work/ui.json" "$@"; }
click() { # WIDGET [BUTTON]
  local x y
  read -r x y < <(ui place "$1")
  xdotool mousemove --window "$window" "$x" "$y" click "${2:-1}" mousemove --window "$window" 2 2
}

"${edit[@]}" "$build/content/cornell.glb" --window 1280x720 --ui-state ui.json --validation >out.log 2>err.log &
editor=$!
window=$(timeout 30 xdotool search --sync --onlyvisible --pid "$editor" | head -1)
xdotool windowfocus --sync "$window"
ui wait 'scene_frames >= 1'
first=$(ui get picture_hash)

echo "swap by combo and by key"
click technique.combo
ui wait 'popup == open'
click technique.combo/gtao
ui wait 'technique == gtao and scene_frames_since_change >= 1'
[ "$(ui get picture_hash)" != "$first" ]
xdotool key n
ui wait 'technique != gtao'
xdotool key shift+n
ui wait 'technique == gtao'

echo "a number typed into a slider, undone"
read -r x y < <(ui place gi.radius)
xdotool mousemove --window "$window" "$x" "$y" keydown ctrl click 1 keyup ctrl
sleep 0.5
xdotool key ctrl+a type --delay 60 "2.5"
xdotool key Return
ui wait 'params.gi.radius == 2.5'
xdotool key ctrl+z
ui wait 'params.gi.radius == 4'

echo "a wipe dragged"
xdotool key k
ui wait 'toasts != []'
xdotool key x
ui wait 'widgets.viewport.wipe.value == 0.500'
read -r x y < <(ui place viewport.wipe)
xdotool mousemove --window "$window" "$x" "$y" mousedown 1 mousemove_relative 30 0 mousemove_relative 30 0 mouseup 1
ui wait 'widgets.viewport.wipe.value > 0.52'
xdotool key x

echo "a shader broken and mended"
sed -i 's/void main() {/void main() { nonsense/' data/shaders/tonemap.frag
ui wait 'faults != []'
frames=$(ui get ui_frame)
ui wait "ui_frame > $frames"
sed -i 's/void main() { nonsense/void main() {/' data/shaders/tonemap.frag
ui wait 'faults == []'

echo "captured to disk"
xdotool key ctrl+t  # records; once more: writes what there is
xdotool key ctrl+t
for _ in $(seq 100); do
  ls captures/timing-*/trace.json captures/timing-*/frames.csv >/dev/null 2>&1 && break
  sleep 0.1
done
ls captures/timing-*/trace.json captures/timing-*/frames.csv >/dev/null

echo "tiny and back"
xdotool windowsize "$window" 60 40
ui wait 'window.0 == 60'
xdotool windowsize "$window" 1280 720
ui wait 'window.0 == 1280 and scene_frames_since_change >= 1'

xdotool key ctrl+q
status=0
wait "$editor" || status=$?
editor=
[ "$status" -eq 0 ] || { echo "exit code $status"; exit 1; }

echo "twice the pixels"
xprop -root -f RESOURCE_MANAGER 8s -set RESOURCE_MANAGER "Xft.dpi: 192"
"${edit[@]}" "$build/content/cornell.glb" --window 640x360 --ui-state ui2.json --validation >out.log 2>err.log &
editor=$!
python3 "$here/ui.py" ui2.json wait 'scale == 2 and scene_frames >= 1'
window=$(timeout 30 xdotool search --sync --onlyvisible --pid "$editor" | head -1)
xdotool windowfocus --sync "$window" key ctrl+q
wait "$editor" || status=$?
editor=
[ "$status" -eq 0 ] || { echo "exit code $status"; exit 1; }

echo "one device for window and renderer, resized, lost by either and opened anew"
lost='{"wait": "device_lost == true"}
{"click": "banner.restart"}
{"wait": "device_lost == false && picture_kind == image && scene_frames_since_change >= 1"}'
cat >lost.jsonl <<EOF
{"wait": "scene_frames >= 1 && picture_kind == image"}
{"resize": [900, 600]}
{"wait": "window.0 == 900 && scene_frames_since_change >= 1"}
{"lose_device": "renderer"}
$lost
{"lose_device": "window"}
$lost
EOF
"${edit[@]}" "$build/content/cornell.glb" --window 1280x720 --device-sharing shared --ui-script lost.jsonl --validation >out.log 2>err.log
if grep -q "validation:" err.log; then exit 1; fi

echo "a device each: the window's is lost, and the renderer goes on"
cat >lost.jsonl <<'EOF'
{"wait": "scene_frames >= 1"}
{"lose_device": "window"}
{"wait": "window_devices == 2"}
{"resize": [900, 600]}
{"wait": "window.0 == 900 && scene_frames_since_change >= 1"}
{"expect": "device_lost == false && picture_kind == bytes"}
EOF
"${edit[@]}" "$build/content/cornell.glb" --window 1280x720 --device-sharing separate --ui-script lost.jsonl --validation >out.log 2>err.log
grep -q "the GPU was lost" err.log
if grep -q "validation:" err.log; then exit 1; fi
echo "all well"
