#!/usr/bin/env bash
# Runs koksma on a second OpenCL implementation, Intel's CPU runtime, and writes what was measured.
#   scripts/second_opencl.sh               tests' device part, stability suite -> results/second-opencl*.json
#   scripts/second_opencl.sh --install     only makes the runtime there and says how to use it
#   scripts/second_opencl.sh -- COMMAND    runs a command with this runtime as the only one
# The runtime comes from PyPI (intel-opencl-rt) into a Python environment in build/second-opencl, and is known to the
# OpenCL loader by an ICD file in a folder of its own (OCL_ICD_VENDORS): nothing outside that folder is touched.
# KOKSMA_PRESET chooses the build (release unless said). Exit status 1 where a test or a case fails.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
folder=$root/build/second-opencl
build=build/${KOKSMA_PRESET:-release}

fail() {
  printf 'second_opencl: %s\n' "$@" >&2
  exit 1
}

# intel-cmplr-lib-rt holds libsvml and its like, which the runtime needs and its package does not ask for.
install_runtime() {
  if [[ ! -x $folder/venv/bin/python ]]; then
    python3 -m venv "$folder/venv" || fail 'no Python environment; on Debian: apt-get install python3-venv'
  fi
  if ! compgen -G "$folder/venv/lib/libsvml.so" >/dev/null || [[ ! -e $folder/venv/lib/libintelocl.so ]]; then
    "$folder/venv/bin/python" -m pip install -q --disable-pip-version-check --retries 1 intel-opencl-rt \
      intel-cmplr-lib-rt || fail 'pip could not install intel-opencl-rt (x86-64 only); is the network there?'
  fi
  mkdir -p "$folder/vendors"
  printf '%s\n' "$folder/venv/lib/libintelocl.so" >"$folder/vendors/intel-cpu.icd"
}

case ${1:-} in
  '' | --install | --) ;;
  *) fail "unknown argument '$1'; allowed: --install, -- COMMAND" ;;
esac
install_runtime
export OCL_ICD_VENDORS=$folder/vendors
if [[ ${1:-} == --install ]]; then
  printf 'export OCL_ICD_VENDORS=%q\n' "$OCL_ICD_VENDORS"
  exit 0
fi
if [[ ${1:-} == -- ]]; then
  shift
  (($# > 0)) || fail 'a command is missing after --'
  exec "$@"
fi

for program in koksma tests/koksma_tests; do
  [[ -x $build/$program ]] || fail "$build/$program is missing: scripts/test.sh builds it"
done
export OCL_ICD_VENDORS=${folder#"$root"/}/vendors # results hold it, and no folder of this machine
"$build/koksma" list devices
status=0
echo 'second_opencl: device tests (some minutes)'
"$build/tests/koksma_tests" '[device]' -r junit -o "$folder/tests.xml" || status=1
echo 'second_opencl: stability suite'
"$build/koksma" stability --quiet --out results/second-opencl-stability.json || status=1
"$build/koksma" run --quiet --n '2^10..2^22' --replicates 8 --scene linear-prod:d=8 --scene genz-gaussian:d=8 \
  --sampler sobol-lms-shift --sampler random --out results/second-opencl-run.json || status=1
python3 scripts/second_opencl_summary.py "$folder/tests.xml" results/second-opencl-stability.json results/second-opencl.json
exit "$status"
