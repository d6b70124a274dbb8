#!/usr/bin/env bash
# Installs what is missing, builds koksma and runs `koksma run` with the arguments given here.
# Without arguments it runs the default study and writes results/latest.json.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release

"$root/scripts/install.sh"

# Ninja decides what else is out of date; only a change of the presets it cannot see.
if [[ ! -f $build/build.ninja || $root/CMakePresets.json -nt $build/build.ninja ]]; then
  echo 'run: configuring (build/release)'
  (cd "$root" && cmake --preset release --log-level=WARNING >/dev/null)
fi
echo 'run: building koksma'
(cd "$root" && cmake --build --preset release --target koksma -- --quiet)

# The default results belong to this checkout; names given by the user start where the user is.
if (($# == 0)); then
  cd "$root"
fi
echo "run: koksma run${*:+ $*}"
exec "$build/koksma" run "$@"
