#!/usr/bin/env bash
# How the editor's window feels while the scene is slow: prints the interface's frame times and periods, and the scene's frame
# time, on the atrium at the whole window's resolution. Usage: tests/bench/ui_frame.sh BUILD_FOLDER [FRAMES]
set -euo pipefail
build=$1 frames=${2:-12}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/script.jsonl" <<SCRIPT
{"wait": "scene_frames >= 2", "timeout": 120}
{"wait": "scene_frames >= $frames", "timeout": 600}
SCRIPT
XDG_CONFIG_HOME=$work "$build/nearfield" edit --offscreen --window 1280x720 --ui-script "$work/script.jsonl" --ui-state "$work/ui.json"
python3 - "$work/ui.json" <<'PRINT'
import json, sys
state = json.load(open(sys.argv[1]))
for name in ("ui_frames_ms", "ui_periods_ms"):
    row = state[name]
    print(f"{name:14} median {row['median']:7.1f}  p95 {row['p95']:7.1f}  max {row['max']:7.1f}  of {row['count']}")
print(f"scene_ms       last   {state['scene_ms']:7.1f}  after {state['scene_frames']} frames at {state['picture_size'][0]}x{state['picture_size'][1]}")
PRINT
