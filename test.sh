#!/usr/bin/env bash
# Installs what is missing, builds Nearfield and runs its tests.
set -euo pipefail

all=0
for argument in "$@"; do
  case $argument in
    --all) all=1 ;;
    -h | --help)
      cat <<'HELP'
Usage: ./test.sh [--all]
Installs missing Debian packages (as root or with sudo), builds preset `release` and runs all tests with ctest.

  --all    also checks the format of the sources, that Clang compiles the program without a warning, and that the tests
           without a GPU run clean under AddressSanitizer and UndefinedBehaviorSanitizer. Opens reports in headless
           Chromium and runs a sweep through a Slurm of one node; without these two tests skip. Takes several times as long.

Without a GPU the tests run on Mesa's software device. The exit code is 0 when everything passed.
HELP
      exit 0
      ;;
    *) printf '%s\n' "error: unknown argument '$argument'; see ./test.sh --help" >&2 && exit 2 ;;
  esac
done

cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
. .ci/packages.sh

failed=()
# part NAME COMMAND...: a failing part is remembered, the others still run.
part() {
  local name=$1
  shift
  if ! "$@"; then
    say "FAILED: $name"
    failed+=("$name")
  fi
}

check_format() {
  say "Checking the format of the sources."
  local file status=0
  while IFS= read -r -d '' file; do
    if ! clang-format --dry-run -Werror "$file" 2>/dev/null; then
      printf '%s\n' "not formatted: $file" >&2
      status=1
    fi
  done < <(find engine passes editor tests content \( -name '*.h' -o -name '*.cpp' \) -print0 | sort -z)
  if [ "$status" -ne 0 ]; then say "clang-format -i FILE mends them."; fi
  return "$status"
}

check_clang() {
  configure clang || return
  say "Building with Clang."
  cmake --build build/clang --target nearfield
}

# Only the executables whose tests are labelled `cpu`: what a driver allocates is not ours to check, and the program (label
# `cpu.editor`) would take longer to build than all the rest.
check_sanitizers() {
  configure asan || return
  local file targets=(nearfield_scenes)
  for file in build/asan/tests/*_include.cmake; do
    grep -q 'TEST_PROPERTIES.*[[;]cpu[];]' "$file" || continue
    file=${file##*/}
    targets+=("${file%%[*}")
  done
  say "Building the tests that need no GPU with sanitizers."
  cmake --build build/asan --target "${targets[@]}" || return
  say "Running them."
  UBSAN_OPTIONS=print_stacktrace=1 ctest --test-dir build/asan --output-on-failure -j "$(nproc)" -L '^cpu$'
}

# A browser for the reports: Chromium, and npm's playwright-core to drive it. npm comes with some packages of nodejs.
prepare_browser() {
  if ! command -v npm >/dev/null; then install_packages nodejs npm || return; fi
  mkdir -p build/release/browser
  cp tests/browser/package.json build/release/browser/
  quietly npm install --prefix build/release/browser --no-audit --no-fund
}

# Tests labelled `all` start a browser and a cluster.
run_tests() {
  if [ "$all" -eq 1 ]; then set --; else set -- -LE '^all$'; fi
  ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
}

if [ "$all" -eq 1 ]; then
  install_packages "${build_packages[@]}" "${check_packages[@]}"
else
  install_packages "${build_packages[@]}"
fi

# Where there is no GPU, the tests use Mesa's software device and nothing else that may be installed.
if [ -z "${VK_ICD_FILENAMES:-}${VK_DRIVER_FILES:-}" ] && [ ! -e /dev/dri ] && [ ! -e /dev/nvidiactl ]; then
  for icd in /usr/share/vulkan/icd.d/lvp_icd.*.json; do
    if [ -e "$icd" ]; then export VK_ICD_FILENAMES=$icd; fi
  done
fi

if [ "$all" -eq 1 ]; then
  part "format" check_format
  part "browser" prepare_browser
fi
configure release
say "Building. The first time takes some minutes."
cmake --build build/release
if [ "$all" -eq 1 ]; then
  part "Clang build" check_clang
  part "sanitizers" check_sanitizers
fi
# Last, so that ctest's closing line is that of the whole test set.
say "Running the tests."
part "tests" run_tests

if [ ${#failed[@]} -gt 0 ]; then
  printf '%s\n' "error: failed: $(IFS=,; printf '%s' "${failed[*]}")" >&2
  exit 1
fi
say "All passed."
