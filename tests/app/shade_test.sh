#!/usr/bin/env bash
# aerosol shade: shaders on a grid, in the manner of testshade.
source "${BASH_SOURCE[0]%/*}/library.sh"
export XDG_CACHE_HOME=$work/cache

# shows ARGS…: what `testshade ARGS…` writes to both streams is what stands on the standard input. It has to succeed.
ln -s "$aerosol" testshade
shows() {
  cat >"$work/wanted"
  "$work/testshade" "$@" >"$work/out" 2>&1 || fail "testshade $* ended with $?"
  diff "$work/wanted" "$work/out" >"$work/difference" || fail "testshade $*: $(cat "$work/difference")"
}

cat >hello.osl <<'OSL'
shader hello(float a = 0, float b = 1) { printf("hello, a+b = %g\n", a + b); }
OSL

echo "-- a shader that prints, its parameters"
shows hello <<'OUT'
hello, a+b = 1

OUT
shows --param a 3.14 --param b 5.0 hello <<'OUT'
hello, a+b = 8.14

OUT
shows -param a 3.14 -param b 5 hello.osl <<'OUT'
WARNING: attempting to set parameter with wrong type: b (expected 'float', received 'int')
hello, a+b = 4.14

OUT
shows --param c 1 hello <<'OUT'
WARNING: attempting to set nonexistent parameter: c
hello, a+b = 1

OUT

echo "-- points, line by line"
cat >where.osl <<'OSL'
shader where(output color Cout = 0, output int even = 0) {
  printf("%g %g: %g\n", u, v, P);
  Cout = color(u, v, 0);
  even = (int)(4 * u) % 2 == 0;
}
OSL
shows -g 2 2 where <<'OUT'
0 0: 0 0 1
1 0: 1 0 1
0 1: 0 1 1
1 1: 1 1 1

OUT
shows -g 2 1 --center --scaleuv 2 2 --offsetuv 10 0 where -o Cout null <<'OUT'

10.5 1: 10.5 1 1
11.5 1: 11.5 1 1

OUT
shows --print -g 2 1 where -o Cout a.exr -o even b.tif <<'OUT'

Output Cout to a.exr
Output even to b.tif
Pixel (0, 0):
  Cout : 0 0.5 0
  even : 1
Pixel (1, 0):
  Cout : 1 0.5 0
  even : 1
0 0.5: 0 0.5 1
1 0.5: 1 0.5 1
OUT
hasOnly "./difference ./hello.osl ./wanted ./where.osl"

echo "-- named spaces"
cat >spaces.osl <<'OSL'
shader spaces() {
  point p = point(1, 0, 0);
  printf("%.4f\n", transform("shader", "common", p));
  printf("%.4f\n", transform("object", "common", p));
  printf("%.4f\n", transform("common", "myspace", point(1, 1, 1)));
}
OSL
shows spaces <<'OUT'
1.7071 0.7071 0.0000
-0.0000 2.0000 0.0000
1.0000 0.5000 1.0000

OUT

cat >nowhere.osl <<'OSL'
shader nowhere() { printf("%g\n", transform("nowhere", P)); }
OSL
shows nowhere <<'OUT'
ERROR: Unknown transformation "nowhere"
0.5 0.5 1

OUT
cat >camera.osl <<'OSL'
shader camera() {
  printf("%.3f %.3f %.3f\n", transform("camera", P), transform("NDC", P), transform("raster", P));
  int size[2];
  printf("%d %d\n", getattribute("camera:resolution", size), size);
}
OSL
shows -g 4 1 camera <<'OUT'
0.000 0.500 1.000 0.500 0.750 0.900 2.000 0.750 0.900
1 4 1
0.333 0.500 1.000 0.667 0.750 0.900 2.667 0.750 0.900
1 4 1
0.667 0.500 1.000 0.833 0.750 0.900 3.333 0.750 0.900
1 4 1
1.000 0.500 1.000 1.000 0.750 0.900 4.000 0.750 0.900
1 4 1

OUT

echo "-- derivatives, and what geometry carries"
cat >steps.osl <<'OSL'
shader steps(float s = 0 [[ int lockgeom = 0 ]], float age = 7) {
  printf("%g %g %g %g %g %g\n", Dx(u), Dy(v), Dx(P), Dx(s), Dx(s * s), age);
}
OSL
shows --center -g 2 1 steps <<'OUT'
0.5 1 1 0 0 0.5 0.25 7
0.5 1 1 0 0 0.5 0.75 7

OUT
shows --vary_udxdy --scaleuv 0.5 1 --param:interpolated=1 age 1.0 --userdata age 2.5 steps <<'OUT'
0.75 1 0.5 0 0 0.75 0.375 2.5

OUT
cat >asks.osl <<'OSL'
shader asks(float age = 7 [[ int lockgeom = 0 ]]) {
  float distance = -1;
  int isHit = trace(point(0), vector(0, 0, 1)), isKnown = getmessage("trace", "hitdist", distance);
  printf("%d %d %d %d %d %g\n", raytype("camera"), raytype("shadow"), isconnected(age), isHit, isKnown, distance);
}
OSL
shows --raytype shadow asks <<'OUT'
0 1 0 1 0 -1

OUT
shows --userdata_isconnected --offsetuv 0.25 0 asks <<'OUT'
1 0 1 1 1 0.5

OUT

echo "-- closures, and files that are added to"
cat >adds.osl <<'OSL'
surface adds() {
  Ci = 0.5 * diffuse(N) + microfacet("ggx", N, 0.1, 1.5, 0);
  printf("%s\n", Ci);
  fprintf("added.txt", "%g\n", u);
}
OSL
shows adds <<'OUT'
(0.5, 0.5, 0.5) * diffuse ((0, 0, 1), "label", "")
	+ (1, 1, 1) * microfacet ("ggx", (0, 0, 1), (0, 0, 0), 0.1, 0.1, 1.5, 0)

OUT
[ "$(cat added.txt)" = 0.5 ] || fail "added.txt holds $(cat added.txt)"

echo "-- warnings and errors of shaders, each once"
cat >wrong.osl <<'OSL'
shader wrong(int given[2] = {1, 2}) {
  warning("half is %g", 0.5);
  error("bad");
  float a[3];
  a[0] = u;
  printf("%g\n", a[(int)(v * 20)]);
  int fixed[2] = {3, 4};
  if (v > 0) printf("%d %d\n", given[(int)(v * 20)], fixed[(int)(v * 20)]);
  color c = u;
  matrix m = u;
  if (v > 0) printf("%g %g\n", c[(int)(v * 20)], m[1][(int)(v * 20)]);
}
OSL
shows -g 1 2 --groupname g --layer one wrong <<'OUT'
WARNING: Shader warning [wrong]: half is 0.5
ERROR: Shader error [wrong]: bad
0.5
ERROR: Index [20] out of range a[0..2]: wrong.osl:6 (group g, layer 0 one, shader wrong)
0
ERROR: Index [20] out of range given[0..1]: wrong.osl:8 (group g, layer 0 one, shader wrong)
ERROR: Index [20] out of range fixed[0..1]: wrong.osl:8 (group g, layer 0 one, shader wrong)
2 4
ERROR: Index [20] out of range c[0..2]: wrong.osl:11 (group g, layer 0 one, shader wrong)
ERROR: Index [20] out of range m[0..3]: wrong.osl:11 (group g, layer 0 one, shader wrong)
0.5 0

OUT

echo "-- expressions and images"
shows --expr "result = color(s, t, 0.25)" -g 3 2 -o result grid.exr -o alpha alpha.tif <<'OUT'

Output result to grid.exr
Output alpha to alpha.tif
OUT
# Bytes of a 3 x 2 picture without compression: 255 times the value, rounded.
shows --expr 'result = color(u, v, 0.4)' -g 3 2 -o result grid.ppm -od uint8 <<'OUT'

Output result to grid.ppm
OUT
pixels=$(tail -c 18 grid.ppm | od -An -v -tu1 | tr -s ' \n' ' ')
[ "$pixels" = " 0 0 102 128 0 102 255 0 102 0 255 102 128 255 102 255 255 102 " ] || fail "pixels are$pixels"
shows --expr 'result = 0.5' -o result half.tif -o result srgb.png -d half <<'OUT'

Output result to half.tif
Output result to srgb.png
OUT
[ -s half.tif ] && [ -s srgb.png ] || fail "a picture is missing"

echo "-- threads and width do not matter"
"$work/testshade" -g 100 70 where -t 1 --width 1 >one 2>&1 || fail "one thread"
"$work/testshade" -g 100 70 where -t 4 >four 2>&1 || fail "four threads"
cmp -s one four || fail "threads or width change the messages"

echo "-- mistakes"
expect 2 shade
said err "no shader"
expect 2 shade --grp x hello
said err "'--group'"
expect 1 shade nothing
said err "nothing"
expect 2 shade hello --param a 1
said err "--param comes before its shader"
expect 0 shade --debugnan hello -o color x.exr
said err "--debugnan means nothing here"
said err "there is no output 'color'"
expect 1 shade where -o Cout a.nonsense
said err "a.nonsense"
expect 0 help shade
said out "--connect LAYER OUTPUT LAYER INPUT"
