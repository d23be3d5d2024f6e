#!/usr/bin/env bash
# Native plugins: functions and shaders from shared objects and bitcode, and what is wrong with bad ones.
source "${BASH_SOURCE[0]%/*}/library.sh"
sdk=$(cd "$input/../../../plugins/sdk" && pwd)
export XDG_CACHE_HOME=$work/cache

# object NAME: NAME.so from NAME.c on the standard input, with the SDK's header.
object() {
  cat >"$1.c"
  clang-19 -I "$sdk" -shared -fPIC -fvisibility=hidden -o "$1.so" "$1.c"
}
# bitcode NAME: NAME.bc likewise.
bitcode() {
  cat >"$1.c"
  clang-19 -I "$sdk" -O2 -fno-math-errno -fno-vectorize -fno-unroll-loops -emit-llvm -c -o "$1.bc" "$1.c"
}
# errs NAME: a shader that calls `float NAME_f(float x)` of the plugin is refused, at its declaration.
errs() {
  printf 'float %s_f(float x) [[ string native = "%s" ]];\nshader use() { printf("%%g\\n", %s_f(u)); }\n' "$1" "$1" "$1" >"use_$1.osl"
  expect 1 compile "use_$1.osl"
  said err "use_$1.osl:1:7: error: plugin '"
}

echo "-- the examples: a shader of bitcode, and one of a shared object"
cat >gears.osl <<'OSL'
float gear_distance(point p, int teeth) [[ string native = "gear" ]];
float sprinkle(point p, float radius) [[ string native = "sprinkle" ]];
shader gears() {
  printf("%.4f %.4f %.4f\n", gear_distance(point(0), 12), gear_distance(P, 3), Dx(gear_distance(P, 3)));
  if (u > 0.4) printf("%.4f\n", sprinkle(2 * P, 0.9));
}
OSL
expect 0 shade -g 3 1 gears
cp out first
for width in 16 8 4 1; do
  expect 0 shade --width $width --no-cache -g 3 1 gears
  cmp -s out first || fail "lanes differ at width $width"
  expect 0 shade --width $width -g 3 1 gears
  cmp -s out first || fail "the cache differs at width $width"
done
said out "0.3000 0.8000 0.0000"
expect 0 info gear
said out 'float gear_distance(point p, int teeth) [[ string native = "gear" ]];'
for shader in gear sprinkle; do
  cat >scene.xml <<XML
<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0,0,-5" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/></film>
    <sampler type="independent"><integer name="sample_count" value="8"/></sampler>
  </sensor>
  <emitter type="constant"/>
  <volume type="box"><medium type="$shader"/></volume>
</scene>
XML
  expect 0 render --quiet --stats scene.xml -o "$shader.exr"
  said err "bounded leaves  0 proven"
  ! grep -q " 0 declared" err || fail "the ranges of $shader are not used"
done

echo "-- strings, outputs, lanes that make no call"
object words <<'C'
#include <string.h>
#include "aerosol_shader.h"
/* void words(string s, output int length, output string twice) */
static void words(const AerosolLanes* lanes, void* const* values) {
  for (uint32_t i = 0; i < lanes->count; ++i) {
    if (!lanes->mask[i]) continue;
    char text[64];
    strncpy(text, lanes->host->text(lanes->host, ((const uint64_t*)values[0])[i]), 30);
    text[30] = 0;
    const size_t length = strlen(text);
    memcpy(text + length, text, length);
    ((int32_t*)values[1])[i] = (int32_t)length;
    ((uint64_t*)values[2])[i] = lanes->host->string(lanes->host, i, text, 2 * length);
    if (length == 0) lanes->host->report(lanes->host, i, "there is no word");
  }
}
static const AerosolShaderFunction functions[] = {{"void words(string s, output int length, output string twice)", words, 0}};
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "words", 1, functions, 0, 0};
C
cat >say.osl <<'OSL'
void words(string s, output int length, output string twice) [[ string native = "words" ]];
shader say() {
  int n = -1;
  string t = "none";
  if (u < 0.6) words(u < 0.3 ? "abc" : "", n, t);
  printf("%d %s\n", n, t);
}
OSL
expect 0 shade -g 3 1 say
said out "3 abcabc"
said out "0 "
said out "-1 none"
said err "there is no word"

echo "-- arrays and structures, from both kinds of plugins"
cat >curve.c <<'C'
#include "aerosol_shader.h"
/* Knots are moved by what is left of the bend, and their sum is given back. */
static void bend(const AerosolLanes* lanes, void* const* values) {
  const uint32_t n = lanes->count;
  float* const sum = values[0];
  const int32_t* const length = values[1];
  float* const knots = values[2];
  const float* const by = values[3];
  const float* const tints = values[4]; /* color tints[2] */
  for (uint32_t i = 0; i < n; ++i) {
    sum[i] = 0;
    for (int32_t k = 0; k < length[i]; ++k) {
      knots[(uint32_t)k * n + i] += by[i];
      sum[i] += knots[(uint32_t)k * n + i] * tints[((uint32_t)k % 2 * 3 + 1) * n + i];
    }
  }
}
static const AerosolShaderFunction functions[] = {
    {"float bend(int n, output float knots[], float by, color tints[2])", bend, 0}};
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "curve", 1, functions, 0, 0};
C
cat >bend.osl <<'OSL'
struct shape { float by; color tints[2]; };
float bend(int n, output float knots[], shape how) [[ string native = "curve" ]];
shader bend() {
  float knots[3] = {1, 2, u}, others[5] = {1, 1, 1, 1, 1};
  shape how = {10, {color(0, 1, 0), color(9, v + 2, 9)}};
  float sum = -1;
  if (u < 0.7) sum = bend(3, knots, how);
  printf("%g: %g, %g %g %g; ", u, sum, knots[0], knots[1], knots[2]);
  printf("%g %g\n", bend(arraylength(others), others, how), others[4]);
}
OSL
clang-19 -I "$sdk" -shared -fPIC -fvisibility=hidden -o curve.so curve.c
expect 0 shade --no-cache -g 3 1 bend
cp out object_out
said out "0: 51, 11 12 10; 88 11"
said out "0.5: 51.5, 11 12 10.5; 88 11"
said out "1: -1, 1 2 1; 88 11"
rm curve.so
clang-19 -I "$sdk" -O2 -fno-math-errno -fno-vectorize -fno-unroll-loops -emit-llvm -c -o curve.bc curve.c
for width in 16 8 1; do
  expect 0 shade --width $width --no-cache -g 3 1 bend
  cmp -s out object_out || fail "bitcode differs from the object at width $width"
done
printf 'float bend(int n, float knots[], closure color c) [[ string native = "curve" ]];\nshader use() { float k[1]; printf("%%g", bend(1, k, emission())); }\n' >use.osl
expect 1 compile use.osl
said err "use.osl:1:48: error: a plugin's function takes no parameter of type closure color"

echo "-- bitcode from source"
mkdir made
expect 0 compile -o made/gear.bc "$sdk/examples/gear.cpp"
printf 'float gear_distance(point p, int teeth) [[ string native = "gear" ]];\nshader near() { printf("%%.4f\\n", gear_distance(P, 3)); }\n' >made/near.osl
expect 0 shade made/near.osl
said out "0.8000"
echo "int missing_semicolon" >wrong.cpp
expect 1 compile wrong.cpp
said err "it does not compile"

echo "-- bad plugins are errors with their names"
object old <<'C'
#include "aerosol_shader.h"
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {7, sizeof(AerosolShaderPlugin), "old", 0, 0, 0, 0};
C
errs old
said err "built for version 7 of the plugin interface, and this is version 1"
object gap <<'C'
#include "aerosol_shader.h"
float elsewhere(float x);
static void f(const AerosolLanes* l, void* const* v) { *(float*)v[0] = elsewhere(*(float*)v[1]); }
static const AerosolShaderFunction functions[] = {{"float gap_f(float x)", f, 0}};
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "gap", 1, functions, 0, 0};
C
errs gap
said err "elsewhere"
object crash <<'C'
#include "aerosol_shader.h"
static int start(char* message, size_t size) { *(volatile int*)0 = 1; return 0; }
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "crash", 0, 0, 0, start};
C
errs crash
said err "crash.so': its initialiser crashed: signal 11"
object refuse <<'C'
#include <stdio.h>
#include "aerosol_shader.h"
static int start(char* message, size_t size) { snprintf(message, size, "no licence"); return 1; }
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "refuse", 0, 0, 0, start};
C
errs refuse
said err "it cannot work here: no licence"
object plain <<'C'
int nothing;
C
errs plain
said err "it does not export 'aerosol_shader_plugin'"
object other <<'C'
#include "aerosol_shader.h"
static void f(const AerosolLanes* l, void* const* v) { (void)l; (void)v; }
static const AerosolShaderFunction functions[] = {{"float other_f(int x)", f, 0}};
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "other", 1, functions, 0, 0};
C
errs other
said err "has no function 'float other_f(float)'"
said err "its functions are: float other_f(int x)"
object spelled <<'C'
#include "aerosol_shader.h"
static void f(const AerosolLanes* l, void* const* v) { (void)l; (void)v; }
static const AerosolShaderFunction functions[] = {{"flot spelled_f(float x", f, 0}};
const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "spelled", 1, functions, 0, 0};
C
errs spelled
said err 'its function number 1, "flot spelled_f(float x", is not declared as in a shader'
object bodiless <<'C'
#include "aerosol_shader.h"
static const AerosolShaderFunction functions[] = {{"float bodiless_f(float x)", 0, 0}};
const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "bodiless", 1, functions, 0, 0};
C
errs bodiless
said err 'its function number 1, "float bodiless_f(float x)", has no code'
printf 'float f(float x) [[ string native = "absent" ]];\nshader use() { printf("%%g", f(u)); }\n' >use.osl
expect 1 compile use.osl
said err "use.osl:1:7: error: there is no plugin 'absent'"
echo "no bitcode" >broken.bc
errs broken
said err "no bitcode of LLVM 19 or older"
bitcode outer <<'C'
#include <math.h>
#include "aerosol_shader.h"
static void f(const AerosolLanes* l, void* const* v) {
  for (uint32_t i = 0; i < l->count; ++i) ((float*)v[0])[i] = erff(((float*)v[1])[i]);
}
static const AerosolShaderFunction functions[] = {{"float outer_f(float x)", f, 0}};
AEROSOL_SHADER_EXPORT const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "outer", 1, functions, 0, 0};
C
errs outer
said err "it needs 'erff', which it does not bring"
