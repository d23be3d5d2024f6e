#!/usr/bin/env bash
# aerosol compile: what it says of good and bad shaders.
source "${BASH_SOURCE[0]%/*}/library.sh"
export XDG_CACHE_HOME=$work/cache

expect 0 compile "$input/fog.osl"
said out "volume fog: 2 parameters; coefficients"
said out "; extinction"
! grep -q "from the cache" out || fail "the cache was not empty"
silent err
expect 0 compile "$input/fog.osl"
[ "$(grep -o 'from the cache' out | wc -l)" = 2 ] || fail "not from the cache"
expect 0 compile --no-cache "$input/fog.osl"
! grep -q "from the cache" out || fail "--no-cache reads the cache"
expect 0 compile --width 1 --isa avx2 "$input/fog.osl"

cat >bad.osl <<'OSL'
volume bad(float density = 1) {
  float x = densty * 2;
  Ci = anisotropic_vdf(color(0.5), color(x), 0.0);
}
OSL
expect 1 compile bad.osl "$input/fog.osl"
said err "bad.osl:2:13: error:"
said err "  float x = densty * 2;"
said err "            ^"
said err "density"
said out "volume fog"
expect 1 compile missing.osl
said err "missing.osl"
silent out

echo 'surface plain(color tint = 0.5) { Ci = tint * diffuse(N); }' >plain.osl
echo 'shader ramp(float x = 1, output float y = 0) { y = x * P[0]; }' >ramp.osl
expect 0 compile plain.osl ramp.osl
said out "surface plain: 1 parameter; closures"
said out "shader ramp: 1 parameter; outputs"
