// A signed distance field: a gear wheel around the z axis, for volumes with soft or hard borders. As bitcode it is
// inlined into shaders, and its loop over lanes becomes vector code.
#include "aerosol_shader.h"

namespace {

float minimum(float a, float b) { return a < b ? a : b; }
float maximum(float a, float b) { return a > b ? a : b; }
float magnitude(float x) { return x < 0 ? -x : x; }
float root(float x) { return __builtin_sqrtf(x); }

/// A triangle wave of period 1 between 0 and 1 of the angle as a part of the circle: no trigonometry is needed for
/// teeth. `turn` is the angle's diamond form, 0 to 4.
float diamondAngle(float x, float y) {
  const float sum = magnitude(x) + magnitude(y);
  const float share = sum > 0 ? y / sum : 0;
  return x >= 0 ? (y >= 0 ? share : 4 + share) : 2 - share;
}

float tooth(float x, float y, float teeth) {
  const float wave = diamondAngle(x, y) * 0.25f * teeth;
  const float phase = wave - __builtin_floorf(wave);
  return 1 - magnitude(2 * phase - 1);
}

/// Distance to a wheel of radius 1, 0.4 thick, with teeth 0.15 high and a hole of radius 0.3 (a lower bound near
/// teeth).
float gearDistance(float x, float y, float z, float teeth) {
  const float r = root(x * x + y * y);
  const float rim = r - (0.85f + 0.15f * tooth(x, y, teeth));
  const float side = magnitude(z) - 0.2f;
  return maximum(maximum(0.6f * rim, side), 0.3f - r);
}

/// float gear_distance(point p, int teeth)
void evaluateGear(const AerosolLanes* lanes, void* const* values) {
  auto* const distance = static_cast<float*>(values[0]);
  const auto* const p = static_cast<const float*>(values[1]);
  const auto* const teeth = static_cast<const int32_t*>(values[2]);
  const uint32_t count = lanes->count;
  for (uint32_t i = 0; i < count; ++i)
    distance[i] = gearDistance(p[i], p[count + i], p[2 * count + i], static_cast<float>(teeth[i]));
}

struct Range {
  float low, high;
};

Range magnitudes(float low, float high) {
  const float a = magnitude(low), b = magnitude(high);
  return {low <= 0 && high >= 0 ? 0 : minimum(a, b), maximum(a, b)};
}

/// The same over boxes: teeth may be anywhere in their height.
void boundGear(const AerosolLanes* lanes, void* const* low, void* const* high) {
  const auto* const pLow = static_cast<const float*>(low[1]);
  const auto* const pHigh = static_cast<const float*>(high[1]);
  const uint32_t count = lanes->count;
  for (uint32_t i = 0; i < count; ++i) {
    const Range x = magnitudes(pLow[i], pHigh[i]);
    const Range y = magnitudes(pLow[count + i], pHigh[count + i]);
    const Range z = magnitudes(pLow[2 * count + i], pHigh[2 * count + i]);
    const float rLow = root(x.low * x.low + y.low * y.low), rHigh = root(x.high * x.high + y.high * y.high);
    // Rounding of some units in the last place of coordinates of this size.
    const float slack = 1e-6f * (1 + rHigh + z.high);
    static_cast<float*>(low[0])[i] = maximum(maximum(0.6f * (rLow - 1), z.low - 0.2f), 0.3f - rHigh) - slack;
    static_cast<float*>(high[0])[i] = maximum(maximum(0.6f * (rHigh - 0.85f), z.high - 0.2f), 0.3f - rLow) + slack;
  }
}

const AerosolShaderFunction functions[] = {{"float gear_distance(point p, int teeth)", evaluateGear, boundGear}};

// A volume of that shape, in the shading language: its parameters, its bound, its closures.
const char shader[] = R"(volume gear
    [[ string help = "A gear wheel around the z axis, from -1 to 1 in the primitive.",
       string extinction_bound = "density" ]]
(
    float density = 8 [[ string label = "Density", float min = 0 ]],
    int teeth = 12 [[ string label = "Teeth", int min = 1, int max = 100 ]],
    float softness = 0.05 [[ string label = "Width of the border", float min = 0 ]],
    color albedo = 0.9
)
{
    float inside = -gear_distance(transform("object", P), teeth);
    Ci = density * smoothstep(0, max(softness, 1e-4), inside) * anisotropic_vdf(albedo, color(1), 0);
}
)";

}  // namespace

const AerosolShaderPlugin aerosol_shader_plugin = {
    AEROSOL_SHADER_ABI, sizeof(AerosolShaderPlugin), "gear", 1, functions, shader, nullptr};
