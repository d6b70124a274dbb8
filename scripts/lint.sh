#!/usr/bin/env bash
# Checks format and lint of the C++ files in harness/ and tests/.
#   scripts/lint.sh                both, as CI does
#   scripts/lint.sh format         rewrites the files in place, and no more
#   scripts/lint.sh REGEX...       both, but clang-tidy only on the files whose path matches one of them
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

scripts/install.sh --lint
mapfile -d '' -t files < <(find harness tests -type f \( -name '*.cpp' -o -name '*.hpp' -o -name '*.h' \) -print0)
if ((${#files[@]} == 0)); then
  echo 'lint: no C++ files in harness/ and tests/' >&2
  exit 1
fi

if [[ ${1:-} == format ]]; then
  clang-format -i "${files[@]}"
  echo "lint: ${#files[@]} files formatted"
  exit 0
fi

failed=()
echo "lint: clang-format on ${#files[@]} files"
clang-format --dry-run --Werror "${files[@]}" || failed+=('clang-format (scripts/lint.sh format repairs it)')

# The compile database; headers that the build generates must be there before they are read.
echo 'lint: configuring (build/tidy)'
cmake --preset tidy --log-level=WARNING >/dev/null
if ninja -C build/tidy -t query koksma_generated >/dev/null 2>&1; then
  ninja -C build/tidy --quiet koksma_generated
fi

python3 scripts/lint_tidy.py . build/tidy "$@" || failed+=('clang-tidy')

if ((${#failed[@]} > 0)); then
  printf 'lint: FAILED: %s\n' "${failed[@]}" >&2
  exit 1
fi
echo 'lint: clean'
