#!/usr/bin/env bash
# A link named testrender to the program takes the options of OSL's testrender and renders its scenes.
source "${BASH_SOURCE[0]%/*}/library.sh"
export XDG_CACHE_HOME=$work/cache
[ -x "${aerosol%/*}/../lib/aerosol/osl-tools/testrender" ] || fail "testrender is not among the tools"
ln -s "$aerosol" testrender

mkdir shaders
echo 'surface paint(color Cs = 0.5) { Ci = Cs * diffuse(N); }' >shaders/paint.osl
echo 'surface sky() { Ci = background(); }' >shaders/sky.osl
cat >scene.xml <<'XML'
<World>
  <Camera eye="0,0,5" look_at="0,0,0" fov="20"/>
  <ShaderGroup>shader sky layer1;</ShaderGroup>
  <Background resolution="16"/>
  <ShaderGroup>param color Cs 0.8 0.4 0.2; shader paint layer1;</ShaderGroup>
  <Quad corner="-9,-9,0" edge_x="18,0,0" edge_y="0,18,0"/>
</World>
XML

./testrender --path shaders -r 8 6 -aa 3 -t 1 scene.xml out.exr >out 2>err || fail "testrender ended with $?"
[ ! -s out ] && [ ! -s err ] || fail "testrender says something"
[ -s out.exr ] || fail "there is no image"
# The same picture by the program's own name.
expect 0 render scene.xml --shader-path shaders --set film.width=8 --set film.height=6 --spp 9 -o own.exr --quiet
expect 0 render scene.xml --shader-path shaders --set film.width=8 --set film.height=6 --spp 9 -o own.png --quiet
./testrender --options "searchpath:shader=shaders" -res 8 6 -aa 3 -O2 --iters 2 scene.xml out.png || fail "other options"
# What stands before the pixels tells how the file was made.
pixels() { tail -c +"$(grep -obUa IDAT "$1" | head -1 | cut -d: -f1)" "$1"; }
cmp <(pixels out.png) <(pixels own.png) || fail "not the same picture"

expect 0 check scene.xml --shader-path shaders
for bad in "" "scene.xml" "scene.xml a.exr b.exr" "-r 8 scene.xml a.exr" "--nothing scene.xml a.exr"; do
  code=0
  # shellcheck disable=SC2086
  ./testrender $bad >out 2>err || code=$?
  [ $code = 2 ] || fail "testrender $bad ended with $code"
done
./testrender --help | grep -q "N by N samples" || fail "no help"
