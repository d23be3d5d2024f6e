#!/usr/bin/env bash
# Links named oslc, oslinfo and testshade to the program take the options of those tools and print in their form.
source "${BASH_SOURCE[0]%/*}/library.sh"
export XDG_CACHE_HOME=$work/cache
for tool in oslc oslinfo testshade; do
  [ -x "${aerosol%/*}/../lib/aerosol/osl-tools/$tool" ] || fail "$tool is not among the tools"
  ln -s "$aerosol" $tool
done

# shows CODE TOOL ARGS…: both streams together are what stands on the standard input.
shows() {
  local wanted=$1 code=0
  shift
  cat >"$work/wanted"
  "$work/$1" "${@:2}" >"$work/out" 2>&1 || code=$?
  [ "$code" = "$wanted" ] || fail "$* ended with $code, not $wanted"
  diff "$work/wanted" "$work/out" >"$work/difference" || fail "$*: $(cat "$work/difference")"
}

cat >twice.h <<'OSL'
#define TWICE(x) (2 * (x))
float twice(float x) { return TWICE(x); }
OSL
cat >many.osl <<'OSL'
#include "twice.h"
#ifndef START
#define START 1
#endif
struct Pair { float a; color b; };
surface many [[ string help = "says \"much\"", int version = 3 ]]
 (float Kd = 0.5 [[ float min = 0, float max = 1 ]],
  color c = color(1, 2, 3), point p = P, string name = "hello", string two[2] = {"x", "y"},
  int three[3] = {1, 2, 3}, float small = 1e-7, matrix m = 2, Pair s = {START, 0.5},
  output float z = twice(u))
{
  z = twice(Kd);
  printf("%g %g\n", z, s.a);
}
OSL

echo "-- oslc"
shows 0 oslc many.osl <<'OUT'
Compiled many.osl -> many.oso
OUT
shows 0 oslc -q -o other.oso many.osl </dev/null
cmp -s many.oso other.oso || fail "-o changes what is written"
shows 0 oslc -MM -MT rule many.osl <<'OUT'
rule: many.osl \
  twice.h
OUT
shows 0 oslc -MMD -MF rule.d -q many.osl </dev/null
grep -q "^many.oso: many.osl" rule.d || fail "no rule in rule.d"
expect 0 compile -E -DSTART=7 many.osl
said out "Pair s = {7 "
said out 'return ( 2 * ( x ) )'
! grep -q "TWICE" out || fail "macros are left"
cat >words.osl <<'OSL'
#define real float
#define SUM 1 +
shader words(real x = SUM+ 2) { printf("%g\n", x); }
OSL
expect 0 compile -o words.oso words.osl
shows 0 testshade words <<'OUT'
3

OUT
cat >bad.osl <<'OSL'
shader bad(float x = 1) {
  float y = densty;
}
OSL
shows 1 oslc bad.osl <<'OUT'
bad.osl:2: error: unknown name 'densty'
FAILED bad.osl
OUT
shows 1 oslc missing.osl <<'OUT'
error: Input file "missing.osl" not found
FAILED missing.osl
OUT
mkdir folder
expect 1 compile -o folder many.osl
said err "folder: error: cannot write this file"

echo 'shader part(float whole = 2) { int x = whole; printf("%d\n", x); }' >part.osl
shows 0 oslc part.osl <<'OUT'
part.osl:1: warning: the initial value of 'x' is of type float, which is truncated to int
Compiled part.osl -> part.oso
OUT
shows 1 oslc -Werror part.osl <<'OUT'
part.osl:1: error: the initial value of 'x' is of type float, which is truncated to int
FAILED part.osl
OUT
printf 'shader open(output float x = 0) {\n  x = 1\n  x = 2;\n}\n' >unended.osl
shows 1 oslc unended.osl <<'OUT'
unended.osl:3: error: expected ';' after the expression, found 'x'
FAILED unended.osl
OUT
cat >scopes.osl <<'OSL'
float helper(float x, float P) {
  float sin = x;
  return sin + P;
}
float helper2(float x) {
  float x = 1;
  return x;
}
shader scopes(float a = 1, float b = 1, float u = 2, float cos = 3, output float r = 0) {
  float a = 2;
  float v = 3;
  float helper = 4;
  float tan = 5;
  float once = 6;
  int once() { return 1; }
  { float a = 7, v = 8, tan = 9; r = a + v + tan; }
  b = 3;
  time = 4;
  P = 5;
}
OSL
shows 1 oslc scopes.osl <<'OUT'
scopes.osl:6: error: 'x' is declared twice in the same scope
scopes.osl:9: error: parameter 'u' has the name of a shader global
scopes.osl:9: warning: parameter 'cos' has the name of a function
scopes.osl:10: error: 'a' is already declared in this scope
scopes.osl:11: error: 'v' is already declared in this scope
scopes.osl:12: error: 'helper' is already declared in this scope
scopes.osl:13: error: 'tan' is already declared in this scope
scopes.osl:15: error: 'once' is already declared in this scope as a variable
scopes.osl:17: error: parameter 'b' is written though it is not declared 'output'
scopes.osl:18: warning: the shader global 'time' is not meant to be written in generic shaders
FAILED scopes.osl
OUT
cat >values.osl <<'OSL'
shader values(color c = 1, output float r = 0) {
  vector w = 1;
  r = c.x + w.g;
  color one = color("rgb", 1);
  string s = string("a");
  float list[] = {1, 2};
  float few[2] = {};
  float single = {1};
  int ints[2] = {1, 2};
  ints = r > 0 ? ints : ints;
  printf(s);
}
OSL
shows 1 oslc values.osl <<'OUT'
values.osl:3: error: a color has no component 'x'
values.osl:3: error: a vector has no component 'g'
values.osl:4: error: color(...) takes three numbers, with a space before them if wanted
values.osl:5: error: strings have no constructor
values.osl:6: error: array 'list' needs a length: only parameters may go without
values.osl:7: error: an initialiser list needs at least one value
values.osl:8: error: a value in braces is for arrays, structures, triples and matrices, not for float
values.osl:10: error: the two values of '?:' do not go together: int[2] and int[2]
values.osl:11: warning: printf() uses a format that is not a constant
FAILED values.osl
OUT
printf '#include "vector2.h"\nshader pair(output float x = 0) { vector2 a = vector2(1, 2); x = (a + a).x; }\n' >pair.osl
shows 1 oslc pair.osl <<'OUT'
pair.osl:2: error: expected an operator or the end of the expression, found '.': only variables have elements and components
FAILED pair.osl
OUT
sed -i 's/x = (a + a).x/a = a + a; x = a.x/' pair.osl
shows 0 oslc -q pair.osl </dev/null
expect 0 compile pair.osl
rm many.oso part.oso
expect 0 compile -q many.osl part.osl
expect 0 compile -v many.osl part.osl
[ ! -e many.oso ] && [ ! -e part.oso ] || fail "compile writes files that nobody has named"
shows 0 oslc -q many.osl </dev/null

echo "-- a compiled file stands for its source"
echo 'shader idle() { float nothing = 1; printf("idle\n"); }' >idle.osl
shows 0 oslc -Wall idle.osl <<'OUT'
idle.osl:1: warning: variable 'nothing' is never used
Compiled idle.osl -> idle.oso
OUT
shows 0 oslc -Werror idle.osl <<'OUT'
Compiled idle.osl -> idle.oso
OUT
shows 0 testshade idle <<'OUT'
idle

OUT
shows 0 testshade --param Kd 3.0 many <<'OUT'
6 1

OUT
shows 0 oslc -q -DSTART=7 many.osl </dev/null
mv many.osl twice.h folder
shows 0 testshade many <<'OUT'
1 7

OUT
expect 0 compile --shader-path . many.oso
said out "surface many"
echo "OpenShadingLanguage 1.00" >foreign.oso
expect 1 shade foreign
said err "compiled for another renderer"
mv folder/* .

echo "-- values and calls that do not fit"
cat >lengths.osl <<'OSL'
shader lengths(float a[] = {1, 2}, color c[] = {color(1)}, string s[] = {"x"}) {
  printf("%d %d %d: %g %g %s\n", arraylength(a), arraylength(c), arraylength(s), a[arraylength(a) - 1], c[0],
         s[arraylength(s) - 1]);
}
OSL
shows 0 oslc -q lengths.osl </dev/null
shows 0 testshade '--param:type=float[]' a '5 6 7' '--param:type=color[]' c 1,2,3,4,5,6 \
  '--param:type=string[]' s p,q lengths <<'OUT'
3 2 2: 7 1 2 3 q

OUT
shows 0 testshade --param a 5 lengths <<'OUT'
WARNING: attempting to set parameter with wrong type: a (expected 'float[]', received 'int')
2 1 1: 2 1 1 1 x

OUT
cat >misfits.osl <<'OSL'
shader misfits(output float r = 0) {
  printf("begin\n");
  r = noise("perlim", u) + noise("gabor", P, "anisotropic", 1.5) + noise("perlin", u, "other", 1);
  r = texture("nothing.exr", u, v, "blurr", 1, "blur", "much");
  setmessage("m", 1);
  setmessage("m", 2);
  int whole = 0;
  float part = 0;
  printf("%d %d %d\n", getmessage("m", whole), getmessage("m", part), whole);
  setmessage("c", diffuse(N));
  setmessage("c", 1);
  closure color c = 0;
  printf("%d %d %s\n", getmessage("c", c), getmessage("c", part), c);
  printf("%d %d\n", dict_find("<a></b>", "a"), dict_find("<a/>", "a["));
  printf("%g\n", transformc("nowhere", "rgb", color(1)));
}
OSL
shows 0 oslc -q misfits.osl </dev/null
shows 0 testshade -o r null misfits <<'OUT'

ERROR: noise type "perlim" is unknown, called from (misfits.osl:3)
ERROR: Unknown noise optional argument: "anisotropic", <float> (misfits.osl:3)
ERROR: Unknown texture optional argument: "blurr", <int> (misfits.osl:4)
ERROR: Unknown texture optional argument: "blur", <string> (misfits.osl:4)
begin
ERROR: [RendererServices::texture] Invalid image file "nothing.exr": Could not open file "nothing.exr"
ERROR: message "m" already exists (created here: misfits.osl:5) cannot set again from misfits.osl:6
ERROR: type mismatch for message "m" (created as int here: misfits.osl:5) cannot fetch as float from misfits.osl:9
1 0 1
ERROR: message "c" already exists (created here: misfits.osl:10) cannot set again from misfits.osl:11
ERROR: type mismatch for message "c" (created as closure color here: misfits.osl:10) cannot fetch as float from misfits.osl:13
1 0 (1, 1, 1) * diffuse ((0, 0, 1), "label", "")
ERROR: XML parsed with errors: Start-end tags mismatch, at offset 5
ERROR: Invalid dict_find query 'a[': Unrecognized node test
-1 0
ERROR: Unknown color space transformation "nowhere" -> "rgb"
1 1 1

OUT
# refused 'SOURCE': as oslc, with an error in its line; the compiler that is no oslc takes it.
refused() {
  printf '%s\n' "$1" >refused.osl
  "$work/oslc" refused.osl >out 2>&1 && fail "oslc takes $1"
  said out "refused.osl:1: error"
  expect 0 compile --no-cache -o refused.oso refused.osl
}
refused 'float f(float x) { return x; }; shader refused(output float r = 0) { r = f(1); }'
refused 'shader refused(output float r = 0) { struct A { float x; }; A a; a.x = 1; r = a.x; }'
refused 'light refused(output float r = 0) { r = 1; }'
refused 'shader refused(output float r = 0 [ [ string help = "a" ] ]) { r = 1; }'
refused 'shader refused(float a[2] = {1, 2,}, output float r = 0) { r = a[1]; }'
refused 'shader refused(output float r = 0) { r = max(1, 2,); }'
refused 'surface refused() { closure color a = diffuse(N); Ci = u > 0 ? a : 0; }'
refused 'void f(output int x) { x = 2; } shader refused(output float r = 0) { f(1); r = 1; }'
echo 'void f(output int x) { x = 2; } shader taken(output int r = 0) { r = 5; f(r + 1); printf("%d\n", r); }' >taken.osl
shows 0 oslc -q taken.osl </dev/null
shows 0 testshade taken <<'OUT'
5

OUT

echo "-- oslinfo"
shows 0 oslinfo many <<'OUT'
surface "many"
float Kd  0.5
color c  [ 1 2 3 ]
point p nodefault
string name "hello" 
string[2] two "x" "y" 
int[3] three  [ 1 2 3 ]
float small  1e-07
matrix m  [ 2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 2 ]
struct Pair s fields: {float a, color b}
float s.a  7
color s.b  [ 0.5 0.5 0.5 ]
output float z nodefault
OUT
shows 0 oslinfo --param Kd many.osl <<'OUT'
float Kd  0.5
OUT
shows 0 oslinfo -v --param two many.osl <<'OUT'
    "two" "string[2]"
		Default value: "x"
		Default value: "y"
OUT
"$work/oslinfo" -v many >out 2>&1
said out '		metadata: string help = "says \"much\""'
said out '		metadata: int version = 3'
said out '		metadata: float max = 1'
said out '		Unknown default value'
cat >braces.osl <<'OSL'
shader braces {{ string help = "in braces" }} (float a[2] = {1, 2} {{ float min = 0, int range[2] = {1, 2} }}) {{ printf("%g\n", a[0]); }}
OSL
"$work/oslinfo" -v braces.osl >out 2>&1
said out '		metadata: string help = "in braces"'
said out '		metadata: float min = 0'
said out '		metadata: int[2] range = 1 2'
echo 'shader open(float list[] = {1, 2.5}, string s[] = {"a"}) { printf("%g\n", list); }' >open.osl
shows 0 oslinfo open.osl <<'OUT'
shader "open"
float[] list  [ 1 2.5 ]
string[] s "a" 
OUT
cat >computed.osl <<'OSL'
struct Pair { float a; float b; };
shader computed(int whole = 1 + 2 * 3, float third = 1.0 / 3, float cast = (float)3, float minus = -1.5,
                color sum = color(1) + 1, color negative = -color(1), color parts = color(-1, 2, 3), string s = concat("a", "b"),
                Pair pair = {1, 1.0 + 2}) { printf("%g %g\n", third, parts); }
OSL
shows 0 oslinfo computed.osl <<'OUT'
shader "computed"
int whole  7
float third nodefault
float cast nodefault
float minus  -1.5
color sum nodefault
color negative nodefault
color parts  [ -1 2 3 ]
string s nodefault
struct Pair pair fields: {float a, float b}
float pair.a  1
float pair.b nodefault
OUT
shows 1 oslinfo nothing <<'OUT'
ERROR opening shader "nothing" (File "nothing" could not be found.)
OUT
mv many.oso folder
shows 0 oslinfo -p /nowhere:folder --param s.a many <<'OUT'
float s.a  7
OUT
expect 2 info --parm x many
said err "'--param'"
