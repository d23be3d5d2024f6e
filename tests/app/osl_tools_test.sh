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

echo "-- a compiled file stands for its source"
echo 'shader idle() { float nothing = 1; printf("idle\n"); }' >idle.osl
shows 0 oslc idle.osl <<'OUT'
idle.osl:1: warning: variable 'nothing' is never used
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
shows 1 oslinfo nothing <<'OUT'
ERROR opening shader "nothing" (File "nothing" could not be found.)
OUT
mv many.oso folder
shows 0 oslinfo -p /nowhere:folder --param s.a many <<'OUT'
float s.a  7
OUT
expect 2 info --parm x many
said err "'--param'"
