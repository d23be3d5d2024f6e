#!/usr/bin/env bash
# aerosol shade: layers, connections, groups as text.
source "${BASH_SOURCE[0]%/*}/library.sh"
export XDG_CACHE_HOME=$work/cache
ln -s "$aerosol" testshade

# shows ARGS…: what `testshade ARGS…` writes to both streams is what stands on the standard input. It has to succeed.
shows() {
  cat >"$work/wanted"
  "$work/testshade" "$@" >"$work/out" 2>&1 || fail "testshade $* ended with $?"
  diff "$work/wanted" "$work/out" >"$work/difference" || fail "testshade $*: $(cat "$work/difference")"
}

cat >ramp.osl <<'OSL'
shader ramp(float scale = 1, output float out = 0) {
  out = scale * u;
  printf("ramp %g\n", out);
}
OSL
cat >tint.osl <<'OSL'
shader tint(color base = 0.5, float amount = 0, output color Cout = 0) {
  Cout = base * amount;
  printf("tint %g\n", Cout);
  if (amount > 1) warning("too much");
}
OSL

echo "-- layers on the command line"
shows --param scale 2.0 --shader ramp first --param base 1,0.5,0.25 --shader tint second \
  --connect first out second amount -g 2 1 --print -o Cout x.exr -o first.out y.exr <<'OUT'
Connect first.out to second.amount

Output Cout to x.exr
Output first.out to y.exr
Pixel (0, 0):
  Cout : 0 0 0
  out : 0
Pixel (1, 0):
  Cout : 2 1 0.5
  out : 2
ramp 0
tint 0 0 0
ramp 2
tint 2 1 0.5
WARNING: Shader warning [tint]: too much
OUT

echo "-- a layer that nothing reads is not run"
shows --shader ramp first --shader tint second <<'OUT'
tint 0 0 0

OUT

echo "-- a group as text, and in a file"
group='param float scale 3.0 ; shader ramp first ; param color base 1 0 0 ; shader tint second ;
connect first.out second.amount ;'
shows --group "$group" <<'OUT'
ramp 1.5
tint 1.5 0 0
WARNING: Shader warning [tint]: too much

OUT
echo "$group" >file.group
shows --group file.group --archivegroup again.group -o Cout null <<'OUT'

ramp 1.5
tint 1.5 0 0
WARNING: Shader warning [tint]: too much

OUT
shows --group again.group <<'OUT'
ramp 1.5
tint 1.5 0 0
WARNING: Shader warning [tint]: too much

OUT

echo "-- arrays without a length are as long as what they are given"
cat >lists.osl <<'OSL'
float sum(float x[]) { float s = 0; for (int i = 0; i < arraylength(x); ++i) s += x[i]; return s; }
shader lists(float a[] = {1, 2}, string names[] = {"x"}, output float total = 0, output float more[4] = {1, 1, 1, 1}) {
  total = sum(a);
  printf("%d %d %g\n", arraylength(a), arraylength(names), total);
}
OSL
shows lists <<'OUT'
2 1 3

OUT
shows --param:type=float[4] a 1,2,3,4 lists <<'OUT'
4 1 10

OUT
shows --group 'param float[1] a 7; param string[3] names "a" "b" "c"; shader lists one; shader lists two;
connect one.more two.a;' --entry one --entry two <<'OUT'
Entry layers: one(0) two(1)
1 3 7
4 1 4

OUT

echo "-- a parameter that changes"
shows --iters 2 --param:interactive=1 base 1,1,1 --param amount 0.5 --shader tint t --reparam t base 0,1,0 <<'OUT'
tint 0.5 0.5 0.5
tint 0 0.5 0

OUT

echo "-- mistakes"
expect 1 shade --group "shader ramp a ; shader tint b ; connect a.nothing b.amount ;"
said err "nothing"
expect 1 shade --group "shadr ramp a ;"
said err "group:1:1: error: unknown statement 'shadr'"
expect 0 shade --userdata a 1 --raytype shadow ramp
