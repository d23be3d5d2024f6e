/* A density made of points: balls with soft borders around points that fill space at random, one in each cell of a
 * grid. Plain C, as a shared object. */
#include <math.h>
#include <stdio.h>

#include "aerosol_shader.h"

static uint32_t mixed(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

/* In [0, 1): number k of a cell. */
static float number(const int32_t cell[3], uint32_t k) {
  uint32_t h = mixed((uint32_t)cell[0] + 0x9e3779b9u * k);
  h = mixed(h ^ (uint32_t)cell[1]);
  h = mixed(h ^ (uint32_t)cell[2]);
  return (float)(h >> 8) * (1.0f / 16777216.0f);
}

static int32_t cellOf(float x) { return x > -1e6f && x < 1e6f ? (int32_t)floorf(x) : 0; }

/* The sum over the points of the 27 cells around: (1 - d^2 / r^2)^2 within the radius r, which is at most 1. */
static float density(float x, float y, float z, float radius) {
  const float r = fminf(fmaxf(radius, 0.0f), 1.0f);
  const int32_t middle[3] = {cellOf(x), cellOf(y), cellOf(z)};
  float sum = 0;
  if (!(r > 0)) return 0;
  for (int32_t k = 0; k < 27; ++k) {
    const int32_t cell[3] = {middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1};
    const float dx = (float)cell[0] + number(cell, 0) - x, dy = (float)cell[1] + number(cell, 1) - y;
    const float dz = (float)cell[2] + number(cell, 2) - z;
    const float share = 1 - (dx * dx + dy * dy + dz * dz) / (r * r);
    if (share > 0) sum += share * share;
  }
  return sum;
}

/* float sprinkle(point p, float radius) */
static void evaluateSprinkle(const AerosolLanes* lanes, void* const* values) {
  float* const result = (float*)values[0];
  const float* const p = (const float*)values[1];
  const float* const radius = (const float*)values[2];
  const uint32_t count = lanes->count;
  for (uint32_t i = 0; i < count; ++i)
    if (lanes->mask[i]) result[i] = density(p[i], p[count + i], p[2 * count + i], radius[i]);
}

/* Each of the 27 points adds at most 1, and nothing where none reaches. */
static void boundSprinkle(const AerosolLanes* lanes, void* const* low, void* const* high) {
  for (uint32_t i = 0; i < lanes->count; ++i) {
    ((float*)low[0])[i] = 0;
    ((float*)high[0])[i] = ((const float*)high[2])[i] > 0 ? 27.0f : 0.0f;
  }
}

static int start(char* message, size_t size) {
  if (floorf(-0.5f) == -1.0f) return 0;
  snprintf(message, size, "this machine rounds in a strange way");
  return 1;
}

static const AerosolShaderFunction functions[] = {
    {"float sprinkle(point p, float radius)", evaluateSprinkle, boundSprinkle}};

const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI,
    sizeof(AerosolShaderPlugin),
    "sprinkle",
    1,
    functions,
    "volume sprinkle [[ string help = \"Soft balls around points at random.\" ]]\n"
    "(float density = 4, float frequency = 4, float radius = 0.6, color albedo = 0.9)\n"
    "{\n"
    "    Ci = density * sprinkle(frequency * transform(\"object\", P), radius) * anisotropic_vdf(albedo, color(1), "
    "0);\n"
    "}\n",
    start};
