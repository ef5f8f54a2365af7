#!/usr/bin/env bash
# Makes reports and opens them in headless Chromium: run.sh NEARFIELD SCENE WORK, where WORK has node_modules with
# playwright-core (`npm install --prefix WORK` of package.json here). Exit code 77 where something is not installed.
set -euo pipefail
nearfield=$1 scene=$2 work=$3
here=$(dirname "$(readlink -f "$0")")

skip() {
  printf '%s\n' "SKIPPED: $*; ./test.sh --all installs it" >&2
  exit 77
}
command -v node >/dev/null || skip "node is not installed"
[ -x "${NF_CHROMIUM:-/usr/bin/chromium}" ] || skip "chromium is not installed"
[ -d "$work/node_modules/playwright-core" ] || skip "playwright-core is not in $work/node_modules"

out=$work/reports
rm -rf "$out"
mkdir -p "$out"
"$nearfield" bench "$scene" --size 64x36 --technique none --technique vbgi --frames 3 --warmup 1 --repeats 2 --quiet \
  --html "$out/bench.html" --json "$out/bench.json" --pictures "$out/pictures" >/dev/null
cat >"$out/spec.json" <<SPEC
{"schema": "nearfield.sweep/1", "scene": "$scene", "size": [48, 27], "reference": {"spp": 4}, "repeats": 1, "warmup": 1,
 "frames": 2, "cost": "technique", "runs": [{"technique": "none"}, {"technique": "vbgi", "permute": {"gi.slices": [1, 4]}}]}
SPEC
"$nearfield" sweep "$out/spec.json" -o "$out/sweep" --quiet >/dev/null
"$nearfield" report "$out/bench.json" "$out/sweep" -o "$out/both.html" >/dev/null
for report in "$out/bench.html" "$out/sweep/report.html" "$out/both.html"; do
  node "$here/report.mjs" "$report" "$work"
done

# Reports that are broken must not pass: a script that fails, a picture from elsewhere, a table that lacks rows.
broken() {
  sed "$1" "$out/both.html" >"$out/broken.html"
  if cmp -s "$out/both.html" "$out/broken.html"; then printf '%s\n' "the page has changed: '$1' does nothing" >&2 && exit 1; fi
  if node "$here/report.mjs" "$out/broken.html" "$work" >/dev/null 2>&1; then
    printf '%s\n' "a broken report passed: $1" >&2
    exit 1
  fi
}
broken 's/^environment(); stacks();/environment(); nothing();/'
broken 's|<body>|<body><img src="nowhere.png">|'
broken 's/const rows = runs.flatMap(run => run.passes.map/const rows = runs.flatMap(run => run.passes.slice(1).map/'
broken "s/\\\$('wipe-a').style.width = /const width = /"
printf '%s\n' "ok: three reports open, four broken ones do not pass"
