#!/usr/bin/env bash
# Installs the Debian packages that koksma needs; does nothing, at once, where all of them are there.
#   scripts/install.sh          to build, run and test
#   scripts/install.sh --lint   also clang, its sanitizers, clang-tidy and clang-format
# KOKSMA_SKIP_INSTALL=1 leaves the machine as it is: for systems that get these packages another way.
set -euo pipefail

packages=(
  # tools
  g++ cmake ninja-build git ca-certificates
  # OpenCL: PoCL as the device, the loader, the headers
  pocl-opencl-icd ocl-icd-opencl-dev opencl-headers opencl-clhpp-headers
  # libraries of the host program and its tests
  nlohmann-json3-dev libcli11-dev libfmt-dev libvalijson-dev libboost-dev librandom123-dev libstb-dev
  catch2 libbenchmark-dev
  # vector functions, for the benchmark's limits of exp and cos
  libsleef-dev
)
lint_packages=(clang clang-tidy clang-format libclang-rt-14-dev)

say() { printf 'install: %s\n' "$*"; }
fail() {
  printf 'install: %s\n' "$@" >&2
  exit 1
}

case "${1:-}" in
  '') ;;
  --lint) packages+=("${lint_packages[@]}") ;;
  *) fail "unknown argument '$1'; allowed: --lint" ;;
esac

if [[ ${KOKSMA_SKIP_INSTALL:-} == 1 ]]; then
  say 'skipped (KOKSMA_SKIP_INSTALL=1)'
  exit 0
fi
if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  say 'not a Debian system, nothing installed; the build needs what these Debian packages hold:'
  say "${packages[*]}"
  exit 0
fi

# What dpkg does not know, or knows but has not installed, is missing.
installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  grep -qxF -- "installed $package" <<<"$installed" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if [[ $(id -u) != 0 ]]; then
  command -v sudo >/dev/null ||
    fail 'packages are missing, and there is neither root nor sudo here. As root, run:' \
      "  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" </dev/null >>"$log" 2>&1
}

# A broken list of some other repository need not matter, so only the installation decides.
say "${#missing[@]} packages, this can take some minutes: ${missing[*]}"
apt update || say 'apt-get update failed, going on with the package lists that are here'
if ! apt install --no-install-recommends "${missing[@]}"; then
  tail -n 25 "$log" >&2
  fail 'apt-get could not install the packages named above; its last lines are printed here' \
    'koksma is made for Debian 12; is the network there, and does this system have these packages?'
fi
say 'done'
