#!/usr/bin/env bash
# aerosol render: files, options, exit codes.
source "${BASH_SOURCE[0]%/*}/library.sh"

echo "-- without -o a PNG named after the scene"
expect 0 render "$input/fog.xml"
hasOnly "./fog.png"
said err "100%"
said err "wrote fog.png: 32 x 24 pixels, 2 samples a pixel"
silent out
rm fog.png

echo "-- several outputs, a crop, definitions and overrides"
expect 0 render "$input/fog.xml" -o a.exr -o a.png --crop 4,6,10,8 -D spp=3 --set fog.density=1 --seed 5 --quiet
hasOnly "./a.exr ./a.png"
silent err
silent out
for entry in aerosol:spp aerosol:sppMinimum aerosol:seed aerosol:embreeIsa aerosol:version aerosol:renderSeconds \
  aerosol:endSample; do
  grep -qaF "$entry" a.exr || fail "no $entry in the metadata"
done
rm a.exr a.png

echo "-- statistics"
expect 0 render "$input/fog.xml" -o a.exr --quiet --stats
said err "shader points"
said err "kernel calls"
said err "filled by batches"
expect 0 render "$input/fog.xml" -o a.exr --quiet --count-lanes --threads 1 --width 4
said err "at work inside shaders"
said err "on 1 thread,"
rm a.exr

echo "-- bad input"
expect 1 render missing.xml
said err "missing.xml: error:"
expect 1 render "$input/fog.xml" -D sp=4
said err "sp"
expect 1 render "$input/fog.xml" --set fog.densty=4
said err "densty"
expect 1 render "$input/fog.xml" --crop 30,0,3,3
said err "reaches beyond the film of 32 x 24 pixels"
expect 1 render "$input/fog.xml" -o no/such/folder/a.exr
said err "no/such/folder/a.exr: error:"
mkdir taken.exr
expect 1 render "$input/fog.xml" -o taken.exr
rmdir taken.exr
# Nobody, root included, can make files there.
expect 1 render "$input/fog.xml" -o /proc/a.exr
said err "/proc/a.exr: error: cannot write in the folder '/proc'"
! grep -q "samples/s" err || fail "found out after the render"
OCIO=$work/no_such_config.ocio expect 1 render "$input/fog.xml" -o a.png
said err "a.png: error:"
hasOnly ""

echo "-- strange input"
sed 's/type="fog" id="fog"/type="constvolume"/' "$input/fog.xml" >kind.xml
expect 1 render kind.xml
said err "'constvolume' is a shader; a volume shader is needed here"
expect 2 render "$input/fog.xml" --threads 100000
said err "must be at most 4096"
sed 's/Ci =/float n = 1;\n  for (int i = 0; P[0] < 1e9; i += 1) n *= 0.5;\n  Ci = (1 + n) */; s/volume fog/volume endless/' "$input/fog.osl" >endless.osl
sed 's/type="fog" id="fog"/type="endless"/' "$input/fog.xml" >endless.xml
expect 0 render endless.xml -o a.exr --spp 1 --crop 14,10,4,4 --loop-budget 100 --quiet
said err "endless.osl"
rm kind.xml endless.osl endless.xml a.exr

echo "-- the shader path of the environment"
mkdir shaders
sed 's/volume fog/volume mist/' "$input/fog.osl" >shaders/mist.osl
sed 's/type="fog" id="fog"/type="mist"/' "$input/fog.xml" >mist.xml
expect 1 render mist.xml --quiet
said err "unknown shader 'mist'"
AEROSOL_SHADER_PATH=/nowhere:$work/shaders expect 0 render mist.xml --quiet
expect 0 render mist.xml --quiet --shader-path shaders
expect 0 render mist.xml --quiet --shader-path shaders --shader-path nowhere
said err "'nowhere', where shaders are to be looked for, is no folder"

echo "-- values beyond a parameter's range are used, with a warning"
sed 's/float density = 4/float density = 4 [[ float min = 0, float max = 4 ]]/; s/volume fog/volume ranged/' "$input/fog.osl" >ranged.osl
sed 's/type="fog"/type="ranged"/' "$input/fog.xml" >ranged.xml
expect 0 render ranged.xml -o a.exr --spp 1 --quiet --set fog.density=7
said err "parameter 'density' of shader 'ranged' is 7; the shader is made for values from 0 to 4"
expect 0 render ranged.xml -o a.exr --spp 1 --quiet --set fog.density=4
silent err

echo "-- a bound that is far too loose does not make a render endless"
sed 's/float sigma =/float x = noise(1000 * P), sigma = 1e8 * max(x * x - x - 0.1, 0) +/; s/volume fog/volume loose/' "$input/fog.osl" >loose.osl
sed 's/type="fog"/type="loose"/; /<medium/s/<float.*\/><\/medium>/<\/medium>/' "$input/fog.xml" >loose.xml
expect 0 render loose.xml -o a.exr --spp 1 --crop 14,10,4,4 --stats
said err "ray marching by"
expect 0 check loose.xml
sed 's/<\/medium>/<string name="distance" value="null"\/><\/medium>/' loose.xml >forced.xml
expect 0 check forced.xml
said err "will take"
rm ranged.osl ranged.xml loose.osl loose.xml forced.xml a.exr

echo "-- deep images: joined parts are the whole, a larger error makes a smaller file"
expect 0 render "$input/fog.xml" -o whole.exr --deep deep.exr --spp 4 --quiet
expect 0 render "$input/fog.xml" -o a.exr --deep deep_a.exr --spp 4 --samples 0:2 --quiet
expect 0 render "$input/fog.xml" -o b.exr --deep deep_b.exr --spp 4 --samples 2:4 --quiet
expect 0 merge b.exr a.exr -o joined.exr --deep deep_joined.exr
said err "samples a pixel along depth"
grep -qaF "ZBack" deep_joined.exr || fail "no depths in the deep image"
expect 0 render "$input/fog.xml" -o whole.exr --deep coarse.exr --deep-error 0.5 --spp 4 --quiet
[ "$(stat -c %s coarse.exr)" -lt "$(stat -c %s deep.exr)" ] || fail "a larger error makes no smaller file"
expect 0 render "$input/fog.xml" -o a.exr --keep-sums --quiet
expect 1 merge a.exr -o joined.exr --deep deep_joined.exr
said err "has gathered nothing for a deep image"
expect 2 render "$input/fog.xml" -o a.exr --deep a.png
said err "deep images are written to .exr files alone"
expect 2 render "$input/fog.xml" -o a.exr --deep a.exr
said err "a file of its own"
rm ./*.exr
