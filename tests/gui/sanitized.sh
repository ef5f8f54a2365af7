#!/usr/bin/env bash
# All of the editor's scripts, and the window's, with a build of preset asan: any leak or error of ours fails. Takes minutes, so it
# is a command and no test. The first argument is that build's folder; others go to gui_test, e.g. --gtest_filter=*Swaps*.
set -euo pipefail
build=${1:-build/asan}
[ $# -eq 0 ] || shift
here=$(cd "$(dirname "$0")" && pwd)
driver=$(ldconfig -p | awk '/libvulkan_lvp\.so/ { print $NF; exit }')
[ -n "$driver" ] || driver=$(find /usr/lib -name libvulkan_lvp.so | head -1)
# The driver stays loaded to the end, or the report could not name it.
LD_PRELOAD="$(gcc -print-file-name=libasan.so) $driver"
export LD_PRELOAD LSAN_OPTIONS="suppressions=$here/leaks.supp:print_suppressions=0" UBSAN_OPTIONS=print_stacktrace=1
"$build/tests/gui_test" "$@"
