# Sourced by demo.sh and test.sh: installs from Debian's packages what is missing, then builds into build/release.
# Everything is skipped that is there already, so a second call works without a network.

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_dir=$source_dir/build/release

build_packages=(
  build-essential ca-certificates cmake ninja-build
  libavcodec-dev libavformat-dev libcli11-dev libceres-dev libeigen3-dev libfmt-dev libfreetype-dev libhdf5-dev
  libkainjow-mustache-dev libosmesa6-dev libssl-dev libswscale-dev nlohmann-json3-dev zlib1g-dev
  fonts-dejavu-core
)
test_packages=(
  binutils chromium libbenchmark-dev libgmock-dev libgtest-dev libsimbody-dev poppler-utils python3 python3-h5py python3-jsonschema
)
# What continuous integration runs beyond the suite.
ci_packages=(clang-14 clang-format-14 libclang-rt-14-dev llvm-14)

say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    say "installing packages needs root or sudo; to go on without, install as root: $*"
    return 1
  fi
}

# install_packages NAME...: those that are not installed, from Debian.
install_packages() {
  local missing=() package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  # Node.js may come from elsewhere than Debian, with npm inside: what counts is that the command is there.
  command -v npm >/dev/null || missing+=(nodejs npm)
  if [ ${#missing[@]} -eq 0 ]; then
    say "all Debian packages are installed already"
    return
  fi
  say "installing from Debian: ${missing[*]}"
  as_root apt-get update -q
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# install_node_modules: what package-lock.json names, for the tests. Without a registry the tests that need them say so, and
# npm_unreached is set.
npm_unreached=
install_node_modules() {
  if [ "$source_dir/node_modules/.package-lock.json" -nt "$source_dir/package-lock.json" ]; then
    say "npm packages are installed already"
    return
  fi
  say "installing by package-lock.json: uplot, playwright-core"
  local told
  if ! told=$(cd "$source_dir" && npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000 2>&1); then
    grep -qE 'ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH' <<<"$told" && npm_unreached=1
    say "npm ci did not work, going on; the tests of reports in a browser will be skipped: $told"
  fi
}

# build ON|OFF TARGET...: with the tests or without.
build() {
  local tests=$1 launcher=
  shift
  command -v ccache >/dev/null && launcher=ccache
  say "building into build/release"
  (
    cd "$source_dir"
    cmake --preset release -DGROUSER_TESTS="$tests" -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" >&2
    cmake --build --preset release --target "$@" >&2
  )
}
