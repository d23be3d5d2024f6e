#!/usr/bin/env bash
# Installs from Debian 12 what Aerosol is built from, where it is missing. Needs root or sudo only then.
set -euo pipefail

packages=(
  # toolchain
  clang-19 clang-format-19 llvm-19-dev libclang-19-dev libclang-cpp19-dev libclang-rt-19-dev
  lld-19 mold ccache ninja-build cmake pkg-config libstdc++-12-dev
  # libraries of the program
  libembree-dev libopenvdb-dev libnanovdb-dev libboost-dev libnanoflann-dev libopenimageio-dev libopencolorio-dev libpugixml-dev
  libtbb-dev libimath-dev libopenexr-dev libcli11-dev libfmt-dev libxxhash-dev zlib1g-dev
  # tests
  libgtest-dev libgmock-dev libbenchmark-dev librapidcheck-dev opencolorio-tools
  slurmctld slurmd slurm-client munge
)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install_packages.sh: this is no Debian system; Aerosol needs what these packages hold: ${packages[*]}" >&2
  exit 0
fi

installed=$(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^ii *//p' || true)
missing=()
for package in "${packages[@]}"; do
  grep -qxF -- "$package" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

asRoot=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install_packages.sh: these packages are missing; install them as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  asRoot=(sudo)
fi
echo "Installing from Debian: ${missing[*]}"
"${asRoot[@]}" apt-get update -q
"${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
