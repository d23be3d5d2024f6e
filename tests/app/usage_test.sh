#!/usr/bin/env bash
# Command lines that are wrong, and those that ask for text.
source "${BASH_SOURCE[0]%/*}/library.sh"

expect 2
said err "Usage: aerosol"
expect 2 rendr scene.xml
said err "did you mean 'render'?"
expect 2 render "$input/fog.xml" --sppp 4
said err "unknown option '--sppp'"
said err "'--spp'"
expect 2 render "$input/fog.xml" -o fog.gif
said err "fog.gif: error: cannot write .gif files"
expect 2 render "$input/fog.xml" -o fog
said err "fog: error: this name has no extension"
silent out
hasOnly ""

expect 0 --help
said out "aerosol help scene"
silent err
expect 0 help render
said out "--shader-path"
expect 0 help scene
said out "<include filename"
said out 'volume type="sphere"'
expect 0 help perspective
said out "fov"
expect 0 help fog --shader-path "$input"
said out "volume fog"
said out "density"
expect 2 help prespective
said err "did you mean 'perspective'"

code=0
"$aerosol" help >/dev/full 2>err || code=$?
[ "$code" = 1 ] || fail "output that cannot be written ends with $code"
said err "cannot write to the standard output"

expect 0 --version
for library in LLVM clang Embree OpenImageIO OpenColorIO OpenEXR pugixml fmt Imath xxHash CLI11; do
  grep -qE "^  $library [0-9]+\.[0-9]+" "$work/out" || fail "no version of $library"
done
silent err
