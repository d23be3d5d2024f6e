#!/usr/bin/env bash
# What shaders say and do wrong is told after the render, in order and with its place.
source "${BASH_SOURCE[0]%/*}/library.sh"

cat >talk.osl <<'OSL'
volume talk() {
  printf("at %d\n", 7);
  warning("odd");
  Ci = anisotropic_vdf(color(0.5), color(2 - length(P)), 0.0);
}
OSL
sed 's/type="fog" id="fog"/type="talk"/' "$input/fog.xml" >talk.xml
expect 0 render talk.xml --quiet --crop 16,12,1,1 --threads 2
said out "at 7"
said err "talk.osl:3:3: warning: odd"
said err "at pixel (16, 12), sample 0"
cp out first
expect 0 render talk.xml --quiet --crop 16,12,1,1 --threads 1 --width 1
cmp -s out first || fail "the messages depend on threads and width"

cat >wrong.osl <<'OSL'
volume wrong() { Ci = anisotropic_vdf(color(0.5), color(P[0] < 0 ? -1 : 1), 0.0); }
OSL
sed 's/type="fog" id="fog"/type="wrong"/' "$input/fog.xml" >wrong.xml
expect 0 render wrong.xml --quiet
said err "wrong.xml:14:5: warning: volume shader 'wrong' gave"
said err "extinction (-1, -1, -1)"

sed 's/value="4"/value="2"/' "$input/fog.xml" >tight.xml
cp "$input/fog.osl" .
expect 0 render tight.xml --quiet --distance null --spp 16
said err "tight.xml:14:5: warning: the extinction of 'fog' was above its bound of 2"
grep -qE 'density_bound" value="(3\.[0-9]+|4)"' err || fail "no corrected bound"
expect 0 render "$input/fog.xml" --quiet --distance null --spp 16
silent err

cat >missing.xml <<'XML'
<scene version="3.0.0">
  <sensor type="perspective"/>
  <volume type="mesh"><string name="filename" value="dragon.ply"/><medium type="homogeneous"/></volume>
</scene>
XML
expect 1 render missing.xml --quiet
said err "missing.xml:3:54: error: there is no file 'dragon.ply'"

# Voxels that a shader is sure to read have to be there: the same is said before a render, by check and by the doctor.
scenes=$input/../../../scenes
head -c 3000 "$scenes/cloud.vdb" >damaged.vdb
cp "$scenes/cloud.vdb" cloud.vdb
voxels() {
  cat >voxels.xml <<XML
<scene version="3.0.0">
  <sensor type="perspective"/>
  <volume type="box"><medium type="grid">
    <string name="filename" value="$1"/><string name="gridname" value="$2"/></medium></volume>
</scene>
XML
  local command
  for command in "render --quiet" check "doctor --size 8"; do
    expect "$3" $command voxels.xml
    [ -z "$4" ] || said err "$4"
  done
}
voxels damaged.vdb density 1 'voxels.xml:4:36: error: "damaged.vdb": cannot read the voxel file: it is damaged'
voxels nowhere.vdb density 1 'voxels.xml:4:36: error: "nowhere.vdb": there is no such file'
voxels cloud.vdb smoke 1 'voxels.xml:4:79: error: "cloud.vdb" has no grid "smoke"; it has "density"'
said err "shader 'grid' reads it at"
# A shader that says what it wants instead has it.
cat >careful.osl <<'OSL'
volume careful(string filename = "nowhere.vdb") {
  float density = texture3d(filename, P, "missingcolor", color(0.5));
  Ci = anisotropic_vdf(color(0.5), color(density), 0.0);
}
OSL
sed 's/type="fog" id="fog"/type="careful" id="fog"/' "$input/fog.xml" >careful.xml
expect 0 render careful.xml --quiet

# A texture that is missing is told of at its place before the render, which goes on.
cat >texture.xml <<'XML'
<scene version="3.0.0">
  <sensor type="perspective"/>
  <shape type="sphere"><bsdf type="diffuse">
    <texture name="reflectance" type="bitmap"><string name="filename" value="none.png"/></texture></bsdf></shape>
</scene>
XML
expect 0 render texture.xml --quiet --spp 1 --crop 300,300,9,9
said err 'texture.xml:4:78: warning: "none.png" of shader'
