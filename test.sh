#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: ./test.sh [ctest options]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/.ci/prepare.sh"

install_packages "${build_packages[@]}" "${test_packages[@]}"
install_node_modules
build ON all
exec ctest --test-dir "$build_dir" --output-on-failure -j "$(nproc)" "$@"
