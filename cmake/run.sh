#!/usr/bin/env bash
# run.sh ARGS…: runs `aerosol ARGS…`, after installing what is missing and building what is out of date. When nothing is,
# the program starts at once.
set -euo pipefail

root=$(cd "${BASH_SOURCE[0]%/*}/.." && pwd)
build=$root/.build/release
stamp=$build/program_is_built

# Out of date: anything that the program is made of, folders included, is newer than the start of the last good build.
isCurrent() {
  [ -e "$stamp" ] && [ -x "$build/bin/aerosol" ] &&
    [ -z "$(find "$root"/{CMakeLists.txt,CMakePresets.json,cmake,core,plugins} -newer "$stamp" -print -quit)" ]
}

bringUpToDate() {
  "$root/cmake/install_packages.sh"
  touch "$stamp.new"
  (cd "$root" && cmake --preset release)
  cmake --build "$build" --target aerosol
  mv "$stamp.new" "$stamp"
}

if ! isCurrent; then
  mkdir -p "$build"
  {
    flock 9  # One build at a time; who waited may find it done.
    isCurrent || bringUpToDate </dev/null >&2
  } 9>"$build/build_lock"
fi
exec "$build/bin/aerosol" "$@"
