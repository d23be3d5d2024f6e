#!/usr/bin/env bash
# check_install.sh CMAKE BUILD_FOLDER: installs, moves the tree, and uses the program from there: it must find its shader
# library, its runtime library and its modules without the build tree or the source tree.
set -euo pipefail

cmake=$1
build=$2
base=$(mktemp -d)
trap 'rm -rf "$base"' EXIT

"$cmake" --install "$build" --prefix "$base/first place" >"$base/install.log"
mkdir "$base/second"
mv "$base/first place" "$base/second/moved tree"
tree="$base/second/moved tree"
export XDG_CACHE_HOME=$base/cache
cd "$base"

for file in bin/aerosol share/aerosol/shaders/stdosl.h share/aerosol/LICENSE; do
  [ -f "$tree/$file" ] || { echo "not installed: $file"; exit 1; }
done
if grep -rqF -- "$build" "$tree"; then
  echo "the installation names its build folder:"
  grep -rlF -- "$build" "$tree"
  exit 1
fi

echo "-- version"
"$tree/bin/aerosol" --version

echo "-- a shader that includes the library"
cat >sphere.osl <<'OSL'
#include "stdosl.h"
volume sphere(float radius = 1) {
  Ci = anisotropic_vdf(color(0.5), color(max(radius - length(P), 0.0)), 0.0);
}
OSL
"$tree/bin/aerosol" compile sphere.osl

echo "-- the shipped shaders"
find "$tree/share/aerosol/shaders" -name '*.osl' -print0 | sort -z | xargs -0 -r "$tree/bin/aerosol" compile

echo "-- a picture"
scene=$tree/share/aerosol/scenes/first_light.xml
if [ -f "$scene" ]; then
  "$tree/bin/aerosol" render "$scene" --spp 1 --crop 0,0,8,8 -o "$base/picture.exr" --quiet
  [ -s "$base/picture.exr" ] || { echo "no picture was written"; exit 1; }
else
  echo "not installed: scenes/first_light.xml"
  exit 1
fi
