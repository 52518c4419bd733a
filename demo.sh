#!/usr/bin/env bash
# Installs what is missing, builds, and runs the whole pipeline: ./demo.sh [-o DIR]   (default: out/demo beside this script)
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/.ci/prepare.sh"

install_packages "${build_packages[@]}"
build OFF grouser
[ $# -gt 0 ] || cd "$source_dir"
exec "$build_dir/grouser" demo "$@"
