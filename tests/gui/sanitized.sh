#!/usr/bin/env bash
# All of the editor's scripts, and the window's, with a build of preset asan: any leak or error of ours fails. Takes minutes, so it
# is a command and no test. The first argument is that build's folder; others go to the tests, e.g. --gtest_filter=*Swaps*.
set -euo pipefail
build=$(cd "${1:-build/asan}" && pwd)
[ $# -eq 0 ] || shift
here=$(cd "$(dirname "$0")" && pwd)
driver=$(ldconfig -p | awk '/libvulkan_lvp\.so/ && !found++ { print $NF }')
[ -n "$driver" ] || driver=$(find /usr/lib -name libvulkan_lvp.so | head -1)
# The driver stays loaded to the end, or the report could not name it.
preload="$(gcc -print-file-name=libasan.so) $driver"
export LSAN_OPTIONS="suppressions=$here/leaks.supp:print_suppressions=0" UBSAN_OPTIONS=print_stacktrace=1
for name in gui_test gui_camera_test gui_compare_test gui_tools_test; do LD_PRELOAD=$preload "$build/tests/$name" "$@"; done
[ $# -gt 0 ] || NF_PRELOAD=$preload bash "$here/window.sh" "$build"
