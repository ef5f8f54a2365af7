# shellcheck shell=bash disable=SC2034
# Sourced by demo.sh and test.sh: which Debian packages are needed, and how they are installed.

# glslang-dev's CMake files ask for the program in glslang-tools; SPIRV-Tools-opt is in spirv-tools.
build_packages=(
  git g++ cmake ninja-build
  libvulkan-dev vulkan-validationlayers mesa-vulkan-drivers
  glslang-dev glslang-tools spirv-tools libspirv-cross-c-shared-dev
  libcli11-dev libfmt-dev libglm-dev libspdlog-dev nlohmann-json3-dev
  libembree-dev libopenexr-dev libpng-dev libstb-dev libtinygltf-dev libmeshoptimizer-dev libdraco-dev
  libimgui-dev libglfw3-dev fonts-dejavu-core
  libgtest-dev python3-jsonschema make librenderdoc-dev xvfb xdotool x11-utils
)
# Only `test.sh --all` needs these: a second compiler, and what optional tests and benchmarks use.
check_packages=(clang clang-format libbenchmark-dev assimp-testmodels chromium slurm-wlm munge)

say() { printf '%s\n' "== $*"; }
die() {
  printf '%s\n' "error: $*" >&2
  exit 1
}

# Runs a command and shows what it printed only when it fails; returns its exit code.
quietly() {
  local log status=0
  log=$(mktemp)
  "$@" >"$log" 2>&1 </dev/null || status=$?
  if [ "$status" -ne 0 ]; then
    cat "$log" >&2
    printf '%s\n' "error: failed with exit code $status: $*" >&2
  fi
  rm -f "$log"
  return "$status"
}

# install_packages NAME...: installs those that are missing. Leaves a machine alone that has them all, so that no network
# is needed there.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "This is not a Debian system: install what these packages hold by hand: $*"
    return 0
  fi
  local name missing=() as_root=()
  for name in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
  done
  if [ ${#missing[@]} -eq 0 ]; then return 0; fi
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      printf '%s\n' "error: these packages are missing, and installing them needs root: ${missing[*]}" \
        "Ask an administrator to run:" \
        "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    say "sudo may ask for your password, to install packages."
    sudo -n true 2>/dev/null || sudo -v || die "sudo did not let us in: run  sudo apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  say "Installing ${#missing[@]} packages: ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 -o DPkg::Lock::Timeout=120)
  quietly "${apt[@]}" update || die "apt-get update failed: is there a network, and a mirror in /etc/apt?"
  quietly "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    die "apt-get install failed: this program is made for Debian 12 and its packages"
}

# configure PRESET [CMAKE ARGUMENT...]: quiet, with the log on failure.
configure() {
  say "Configuring build/$1."
  quietly cmake --preset "$@"
}
