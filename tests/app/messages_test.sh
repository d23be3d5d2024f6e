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
