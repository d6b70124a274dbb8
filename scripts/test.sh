#!/usr/bin/env bash
# Installs what is missing, builds everything and runs all tests; further arguments go to ctest.
#   scripts/test.sh                  preset release; preset ci where CI=true
#   scripts/test.sh -L unit          only the tests with this label
#   KOKSMA_PRESET=clang scripts/test.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

default=release
if [[ ${CI:-} == true ]]; then
  default=ci
fi
preset=${KOKSMA_PRESET:-$default}

case $preset in
  clang | sanitize | sanitize-device) scripts/install.sh --lint ;;
  *) scripts/install.sh ;;
esac
build=build/$preset
if [[ ! -f $build/build.ninja || CMakePresets.json -nt $build/build.ninja ]]; then
  echo "test: configuring ($build)"
  cmake --preset "$preset" --log-level=WARNING >/dev/null
fi
echo "test: building ($build)"
cmake --build --preset "$preset" -- --quiet
echo "test: running (preset $preset)"
exec ctest --preset "$preset" "$@"
