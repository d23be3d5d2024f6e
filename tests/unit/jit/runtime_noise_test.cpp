// Noise: the language's own values against an independent double implementation of its published definition, known
// hashes, the same bits at every number of lanes, and periods.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/jit/runtime/noise_cell.h"
#include "core/jit/runtime/noise_gradient.h"
#include "core/jit/runtime/noise_perlin.h"
#include "core/jit/runtime/noise_simplex.h"
#include "tests/unit/jit/runtime_lanes.h"

namespace aerosol::jit::test {

/// runtime_avx512.cpp: perlin noise of 16 points by the way for processors with AVX-512.
void perlinByPermutation(const float* x, const float* y, const float* z, float* result);

namespace {

namespace rt = aerosol::jit::runtime;
using Triple = rt::Triple<float>;

// --- reference: plain loops over corners in double
// ---------------------------------------------------------------------

std::uint32_t rotate(std::uint32_t x, int bits) { return std::rotl(x, bits); }

std::uint32_t referenceFinal(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  c = (c ^ b) - rotate(b, 14);
  a = (a ^ c) - rotate(c, 11);
  b = (b ^ a) - rotate(a, 25);
  c = (c ^ b) - rotate(b, 16);
  a = (a ^ c) - rotate(c, 4);
  b = (b ^ a) - rotate(a, 14);
  return (c ^ b) - rotate(b, 24);
}

std::uint32_t referenceHash(const std::vector<std::uint32_t>& words) {
  const auto count = static_cast<std::uint32_t>(words.size());
  std::array<std::uint32_t, 3> s;
  s.fill(0xdeadbeefu + 4u * count + 13u);
  std::size_t done = 0;
  if (count > 3) {
    for (std::size_t i = 0; i < 3; ++i) s[i] += words[i];
    constexpr std::array rotations = {4, 6, 8, 16, 19, 4};
    for (std::size_t round = 0; round < 6; ++round) {
      std::uint32_t& a = s[round % 3];
      std::uint32_t& b = s[(round + 1) % 3];
      std::uint32_t& c = s[(round + 2) % 3];
      a = (a - c) ^ rotate(c, rotations[round]);
      c += b;
    }
    done = 3;
  }
  for (std::size_t i = done; i < words.size(); ++i) s[i - done] += words[i];
  return referenceFinal(s[0], s[1], s[2]);
}

double referenceFade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double referenceGradient(std::uint32_t h, const std::vector<double>& d) {
  const auto signedBy = [&](std::uint32_t bit, double value) { return (h & bit) != 0 ? -value : value; };
  if (d.size() == 1) return signedBy(8, 1.0 + (h & 7u)) * d[0];
  if (d.size() == 2) {
    const bool swap = (h & 7u) >= 4;
    return signedBy(1, swap ? d[1] : d[0]) + signedBy(2, 2 * (swap ? d[0] : d[1]));
  }
  if (d.size() == 3) {
    h &= 15u;
    const double u = h < 8 ? d[0] : d[1];
    const double v = h < 4 ? d[1] : (h == 12 || h == 14 ? d[0] : d[2]);
    return signedBy(1, u) + signedBy(2, v);
  }
  h &= 31u;
  return signedBy(1, h < 24 ? d[0] : d[1]) + signedBy(2, h < 16 ? d[1] : d[2]) + signedBy(4, h < 8 ? d[2] : d[3]);
}

/// Signed Perlin noise; a period of 0 is none.
double referencePerlin(const std::vector<double>& at, unsigned shift, const std::vector<double>& periods) {
  constexpr std::array scales = {0.25, 0.6616, 0.982, 0.8344};
  const std::size_t dimensions = at.size();
  double sum = 0;
  for (std::size_t corner = 0; corner < (std::size_t{1} << dimensions); ++corner) {
    std::vector<std::uint32_t> cell;
    std::vector<double> offset;
    double weight = 1;
    for (std::size_t axis = 0; axis < dimensions; ++axis) {
      const double low = std::floor(at[axis]);
      const double t = at[axis] - low;
      const bool far = (corner >> axis & 1u) != 0;
      auto index = static_cast<std::int64_t>(low) + (far ? 1 : 0);
      if (!periods.empty()) {
        const auto period = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::floor(periods[axis])));
        index = ((index % period) + period) % period;
      }
      cell.push_back(static_cast<std::uint32_t>(index));
      offset.push_back(far ? t - 1 : t);
      weight *= far ? referenceFade(t) : 1 - referenceFade(t);
    }
    sum += weight * referenceGradient(referenceHash(cell) >> shift, offset);
  }
  return sum * scales[dimensions - 1];
}

std::uint32_t referenceScramble(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return referenceFinal(a, b, c ^ 0xdeadbeefu);
}

double referenceSimplex(const std::vector<double>& at, std::uint32_t seed) {
  const auto n = static_cast<int>(at.size());
  if (n == 1) {
    const double low = std::floor(at[0]);
    double sum = 0;
    for (int corner = 0; corner < 2; ++corner) {
      const double x = at[0] - low - corner;
      const auto cell = static_cast<std::uint32_t>(static_cast<std::int64_t>(low) + corner);
      const std::uint32_t h = referenceScramble(cell, seed, 0);
      const double g = (1.0 + (h & 7u)) * ((h & 8u) != 0 ? -1 : 1);
      sum += std::pow(1 - x * x, 4) * g * x;
    }
    return 0.36 * sum;
  }
  const double skew = (std::sqrt(n + 1.0) - 1) / n;
  const double unskew = (1 - 1 / std::sqrt(n + 1.0)) / n;
  double total = 0;
  for (const double x : at) total += x;
  std::vector<std::int64_t> cell;
  double cells = 0;
  for (const double x : at) {
    cell.push_back(static_cast<std::int64_t>(std::floor(x + total * skew)));
    cells += static_cast<double>(cell.back());
  }
  std::vector<double> offset;
  for (std::size_t i = 0; i < at.size(); ++i) {
    offset.push_back(at[i] - (static_cast<double>(cell[i]) - cells * unskew));
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < at.size(); ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return offset[a] > offset[b]; });
  static constexpr int table2[8][2] = {{-1, -1}, {1, 0}, {-1, 0}, {1, 1}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}};
  static constexpr int table3[16][3] = {{1, 0, 1},   {0, 1, 1},   {-1, 0, 1}, {0, -1, 1}, {1, 0, -1}, {0, 1, -1},
                                        {-1, 0, -1}, {0, -1, -1}, {1, -1, 0}, {1, 1, 0},  {-1, 1, 0}, {-1, -1, 0},
                                        {1, 0, 1},   {-1, 0, 1},  {0, 1, -1}, {0, -1, -1}};
  double sum = 0;
  std::vector<int> step(at.size(), 0);
  for (int corner = 0; corner <= n; ++corner) {
    if (corner > 0) step[order[static_cast<std::size_t>(corner - 1)]] = 1;
    double t = 0.5;
    std::vector<double> d;
    std::vector<std::uint32_t> c;
    for (std::size_t i = 0; i < at.size(); ++i) {
      d.push_back(offset[i] - step[i] + corner * unskew);
      c.push_back(static_cast<std::uint32_t>(cell[i] + step[i]));
      t -= d.back() * d.back();
    }
    if (t < 0) continue;
    double dot = 0;
    if (n == 2) {
      const auto& g = table2[referenceScramble(c[0], c[1], seed) & 7u];
      dot = g[0] * d[0] + g[1] * d[1];
    } else if (n == 3) {
      const auto& g = table3[referenceScramble(c[0], c[1], referenceScramble(c[2], seed, 0)) & 15u];
      dot = g[0] * d[0] + g[1] * d[1] + g[2] * d[2];
    } else {
      // 32 edges of the tesseract: the absent axis counts up by blocks of 8, signs of the others by bits from the top.
      const std::uint32_t h = referenceScramble(c[0], c[1], referenceScramble(c[2], c[3], seed)) & 31u;
      std::uint32_t bit = 4;
      for (std::uint32_t axis = 0; axis < 4; ++axis) {
        if (axis == h / 8u) continue;
        dot += (h & bit) != 0 ? -d[axis] : d[axis];
        bit >>= 1;
      }
    }
    sum += std::pow(t, 4) * dot;
  }
  constexpr std::array scales = {64.0, 68.0, 54.0};
  return sum * scales[static_cast<std::size_t>(n - 2)];
}

// --- values
// ------------------------------------------------------------------------------------------------------------

float coordinate(std::mt19937_64& random) {
  return static_cast<float>(static_cast<double>(random() >> 11) / 9007199254740992.0 * 200.0 - 100.0);
}

TEST(RuntimeNoise, hashesAreLookup3) {
  // Values of the public bjhash functions (OpenImageIO's hash.h) for the language's seeds.
  EXPECT_EQ(rt::hashWords(0u), 0x9519dc65u);
  EXPECT_EQ(rt::hashWords(1u, 2u), 0x1037cb9du);
  EXPECT_EQ(rt::hashWords(1u, 2u, 3u), 0xb8d17a0au);
  EXPECT_EQ(rt::hashWords(1u, 2u, 3u, 4u), 0x0584dec1u);
  EXPECT_EQ(rt::hashWords(1u, 2u, 3u, 4u, 5u), 0x277f6d5eu);
  std::mt19937 random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    std::array<std::uint32_t, 5> w;
    for (std::uint32_t& word : w) word = static_cast<std::uint32_t>(random());
    EXPECT_EQ(rt::hashWords(w[0]), referenceHash({w[0]}));
    EXPECT_EQ(rt::hashWords(w[0], w[1]), referenceHash({w[0], w[1]}));
    EXPECT_EQ(rt::hashWords(w[0], w[1], w[2]), referenceHash({w[0], w[1], w[2]}));
    EXPECT_EQ(rt::hashWords(w[0], w[1], w[2], w[3]), referenceHash({w[0], w[1], w[2], w[3]}));
    EXPECT_EQ(rt::hashWords(w[0], w[1], w[2], w[3], w[4]), referenceHash({w[0], w[1], w[2], w[3], w[4]}));
  }
}

TEST(RuntimeNoise, perlinHasTheLanguagesValues) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 20000; ++trial) {
    const float x = coordinate(random);
    const float y = coordinate(random);
    const float z = coordinate(random);
    const float w = coordinate(random);
    const Triple p = {x, y, z};
    ASSERT_NEAR(rt::perlin(x), referencePerlin({x}, 0, {}), 2e-6);
    ASSERT_NEAR(rt::perlin(x, y), referencePerlin({x, y}, 0, {}), 2e-6);
    ASSERT_NEAR(rt::perlin(p), referencePerlin({x, y, z}, 0, {}), 2e-6);
    ASSERT_NEAR(rt::perlin(p, w), referencePerlin({x, y, z, w}, 0, {}), 2e-6);
    ASSERT_NEAR(rt::perlinTriple(x).z, referencePerlin({x}, 16, {}), 2e-6);
    ASSERT_NEAR(rt::perlinTriple(x, y).y, referencePerlin({x, y}, 8, {}), 2e-6);
    ASSERT_NEAR(rt::perlinTriple(p).x, referencePerlin({x, y, z}, 0, {}), 2e-6);
    ASSERT_NEAR(rt::perlinTriple(p).y, referencePerlin({x, y, z}, 8, {}), 2e-6);
    ASSERT_NEAR(rt::perlinTriple(p, w).z, referencePerlin({x, y, z, w}, 16, {}), 2e-6);
    ASSERT_EQ(rt::unsignedPerlin(p), 0.5f * (rt::perlin(p) + 1.0f));
  }
}

TEST(RuntimeNoise, periodicPerlinRepeats) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const float x = coordinate(random);
    const float y = coordinate(random);
    const float z = coordinate(random);
    const float w = coordinate(random);
    const auto period = [&] { return static_cast<float>(random() % 100u) * 0.3f; };
    const float px = period();
    const float py = period();
    const float pz = period();
    const float pw = period();
    ASSERT_NEAR(rt::periodicPerlin(x, px), referencePerlin({x}, 0, {px}), 2e-6);
    ASSERT_NEAR(rt::periodicPerlin(x, y, px, py), referencePerlin({x, y}, 0, {px, py}), 2e-6);
    ASSERT_NEAR(rt::periodicPerlin(Triple{x, y, z}, Triple{px, py, pz}), referencePerlin({x, y, z}, 0, {px, py, pz}),
                2e-6);
    ASSERT_NEAR(rt::periodicPerlinTriple(Triple{x, y, z}, w, Triple{px, py, pz}, pw).y,
                referencePerlin({x, y, z, w}, 8, {px, py, pz, pw}), 2e-6);
  }
  // Far from the origin, where quotients are rounded.
  for (const float x : {1e7f, -1e7f, 2e9f, -2e9f, 123456789.0f}) {
    for (const float period : {1.0f, 3.0f, 7.9f, 1000.0f, 2e7f, 2e9f}) {
      ASSERT_NEAR(rt::periodicPerlin(x, period), referencePerlin({x}, 0, {period}), 2e-6) << x << ' ' << period;
    }
  }
}

TEST(RuntimeNoise, simplexHasTheLanguagesValues) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 20000; ++trial) {
    const float x = coordinate(random) * 0.1f;
    const float y = coordinate(random) * 0.1f;
    const float z = coordinate(random) * 0.1f;
    const float w = coordinate(random) * 0.1f;
    const Triple p = {x, y, z};
    // Offsets from the corners are differences of rounded numbers: the language's own float values differ as much.
    ASSERT_NEAR(rt::simplex(x), referenceSimplex({x}, 0), 2e-6);
    ASSERT_NEAR(rt::simplex(x, y), referenceSimplex({x, y}, 0), 2e-5);
    ASSERT_NEAR(rt::simplex(p), referenceSimplex({x, y, z}, 0), 2e-5);
    ASSERT_NEAR(rt::simplex(p, w), referenceSimplex({x, y, z, w}, 0), 2e-5);
    ASSERT_NEAR(rt::simplexTriple(p).y, referenceSimplex({x, y, z}, 1), 2e-5);
    ASSERT_NEAR(rt::simplexTriple(p, w).z, referenceSimplex({x, y, z, w}, 2), 2e-5);
    ASSERT_NEAR(rt::simplexTriple(x, y).z, referenceSimplex({x, y}, 2), 2e-5);
    ASSERT_EQ(rt::unsignedSimplex(p), 0.5f * (rt::simplex(p) + 1.0f));
  }
}

/// Partial derivatives of a reference by central differences in double.
template <class Function>
std::vector<double> differences(const std::vector<double>& at, Function&& function) {
  constexpr double step = 1e-4;
  std::vector<double> partials;
  for (std::size_t i = 0; i < at.size(); ++i) {
    std::vector<double> low = at, high = at;
    low[i] -= step;
    high[i] += step;
    partials.push_back((function(high) - function(low)) / (2 * step));
  }
  return partials;
}

template <int N, class Function>
void expectGradient(const rt::Jet<float, N>& jet, float value, const std::vector<double>& at, double tolerance,
                    Function&& function) {
  EXPECT_TRUE(isSame(jet.value, value));
  const std::vector<double> expected = differences(at, function);
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(N));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_NEAR(jet.partial[i], expected[i], tolerance) << N << " dimensions, coordinate " << i << " at " << at[0];
  }
}

TEST(RuntimeNoise, perlinHasItsGradient) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 5000; ++trial) {
    const float x = coordinate(random), y = coordinate(random), z = coordinate(random), w = coordinate(random);
    const Triple p = {x, y, z};
    const Triple pp = {3, 5, 7};
    const auto reference = [](unsigned shift, std::vector<double> periods = {}) {
      return [=](const std::vector<double>& at) { return referencePerlin(at, shift, periods); };
    };
    constexpr double tolerance = 3e-5;
    expectGradient(rt::perlinJet(x), rt::perlin(x), {x}, tolerance, reference(0));
    expectGradient(rt::perlinJet(x, y), rt::perlin(x, y), {x, y}, tolerance, reference(0));
    expectGradient(rt::perlinJet(p), rt::perlin(p), {x, y, z}, tolerance, reference(0));
    expectGradient(rt::perlinJet(p, w), rt::perlin(p, w), {x, y, z, w}, tolerance, reference(0));
    expectGradient(rt::perlinTripleJet(x).y, rt::perlinTriple(x).y, {x}, tolerance, reference(8));
    expectGradient(rt::perlinTripleJet(x, y).z, rt::perlinTriple(x, y).z, {x, y}, tolerance, reference(16));
    expectGradient(rt::perlinTripleJet(p).z, rt::perlinTriple(p).z, {x, y, z}, tolerance, reference(16));
    expectGradient(rt::perlinTripleJet(p, w).y, rt::perlinTriple(p, w).y, {x, y, z, w}, tolerance, reference(8));
    expectGradient(rt::periodicPerlinJet(x, 3.0f), rt::periodicPerlin(x, 3.0f), {x}, tolerance, reference(0, {3}));
    expectGradient(rt::periodicPerlinJet(p, w, pp, 2.0f), rt::periodicPerlin(p, w, pp, 2.0f), {x, y, z, w}, tolerance,
                   reference(0, {3, 5, 7, 2}));
    expectGradient(rt::periodicPerlinTripleJet(p, pp).y, rt::periodicPerlinTriple(p, pp).y, {x, y, z}, tolerance,
                   reference(8, {3, 5, 7}));
    expectGradient(rt::unsignedPerlinJet(p), rt::unsignedPerlin(p), {x, y, z}, tolerance,
                   [&](const auto& at) { return 0.5 + 0.5 * referencePerlin(at, 0, {}); });
    if (HasFailure()) return;
  }
}

TEST(RuntimeNoise, simplexHasItsGradient) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto near = [&] { return coordinate(random) * 0.1f; };
    const float x = near(), y = near(), z = near(), w = near();
    const Triple p = {x, y, z};
    const auto reference = [](std::uint32_t seed) {
      return [=](const std::vector<double>& at) { return referenceSimplex(at, seed); };
    };
    // As with values: offsets from the corners are rounded, by up to 1e-6, and second derivatives are up to 100.
    constexpr double tolerance = 4e-4;
    expectGradient(rt::simplexJet(x), rt::simplex(x), {x}, tolerance, reference(0));
    expectGradient(rt::simplexJet(x, y), rt::simplex(x, y), {x, y}, tolerance, reference(0));
    expectGradient(rt::simplexJet(p), rt::simplex(p), {x, y, z}, tolerance, reference(0));
    expectGradient(rt::simplexJet(p, w), rt::simplex(p, w), {x, y, z, w}, tolerance, reference(0));
    expectGradient(rt::simplexTripleJet(x).z, rt::simplexTriple(x).z, {x}, tolerance, reference(2));
    expectGradient(rt::simplexTripleJet(p, w).y, rt::simplexTriple(p, w).y, {x, y, z, w}, tolerance, reference(1));
    if (HasFailure()) return;
  }
}

TEST(RuntimeNoise, cellAndHashNoiseHaveTheLanguagesValues) {
  std::mt19937_64 random(5);
  const auto unit = [](std::uint32_t h) { return static_cast<float>(h) * 2.3283064365386963e-10f; };
  const auto cell = [](float x) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(x))); };
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  for (int trial = 0; trial < 5000; ++trial) {
    const float x = coordinate(random);
    const float y = coordinate(random);
    const float z = coordinate(random);
    const float w = coordinate(random);
    const Triple p = {x, y, z};
    ASSERT_EQ(rt::cellNoise(x), unit(referenceHash({cell(x)})));
    ASSERT_EQ(rt::cellNoise(p), unit(referenceHash({cell(x), cell(y), cell(z)})));
    ASSERT_EQ(rt::cellNoiseTriple(p).y, unit(referenceHash({cell(x), cell(y), cell(z), 1u})));
    ASSERT_EQ(rt::cellNoiseTriple(p, w).z, unit(referenceHash({cell(x), cell(y), cell(z), cell(w), 2u})));
    ASSERT_EQ(rt::hashNoise(x, y), unit(referenceHash({bits(x), bits(y)})));
    ASSERT_EQ(rt::hashNoise(p, w), unit(referenceHash({bits(x), bits(y), bits(z), bits(w)})));
    ASSERT_EQ(rt::hashNoiseTriple(x).x, unit(referenceHash({bits(x), 0u})));
    ASSERT_EQ(rt::hashInt(p), static_cast<std::int32_t>(referenceHash({bits(x), bits(y), bits(z)})));
    ASSERT_EQ(rt::periodicCellNoise(std::floor(x), 5.0f), rt::periodicCellNoise(std::floor(x) + 5.0f, 5.0f));
    ASSERT_EQ(rt::periodicHashNoise(std::floor(x), 5.0f), rt::periodicHashNoise(std::floor(x) + 5.0f, 5.0f));
  }
}

TEST(RuntimeNoise, latticePointsAreZero) {
  EXPECT_EQ(rt::perlin(Triple{3, -4, 5}), 0.0f);
  EXPECT_EQ(rt::perlin(7.0f), 0.0f);
  EXPECT_TRUE(std::isnan(rt::perlin(static_cast<float>(INFINITY))));
  EXPECT_EQ(rt::perlin(Triple{3e9f, 1e20f, -1e30f}), 0.0f);
}

// --- the same bits
// -----------------------------------------------------------------------------------------------------

template <int W, class Function>
std::vector<float> evaluate(Function function, const std::array<std::vector<float>, 4>& in) {
  std::vector<float> results(in[0].size());
  for (std::size_t i = 0; i < results.size(); i += W) {
    using F = rt::Wide<float, W>;
    const rt::Triple<F> p = {lanesAt<W>(in[0], i), lanesAt<W>(in[1], i), lanesAt<W>(in[2], i)};
    store(results, i, function(p, lanesAt<W>(in[3], i)));
  }
  return results;
}

template <class Function>
void expectSameBits(const char* name, Function function) {
  std::array<std::vector<float>, 4> in = {anyFloats(8192, 21), anyFloats(8192, 22), anyFloats(8192, 23),
                                          anyFloats(8192, 24)};
  for (std::size_t k = 1; k < 4; ++k) std::shuffle(in[k].begin(), in[k].end(), std::mt19937(static_cast<unsigned>(k)));
  const std::vector<float> one = evaluate<1>(function, in);
  for (const auto& other : {evaluate<4>(function, in), evaluate<8>(function, in), evaluate<16>(function, in)}) {
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_TRUE(isSame(one[i], other[i])) << name << " at " << in[0][i] << ' ' << in[1][i] << ' ' << in[2][i] << ' '
                                            << in[3][i] << ": " << one[i] << " and " << other[i];
    }
  }
}

TEST(RuntimeNoiseBits, allKinds) {
  expectSameBits("perlin1", [](auto p, auto) { return rt::perlin(p.x); });
  expectSameBits("perlin2", [](auto p, auto) { return rt::perlin(p.x, p.y); });
  expectSameBits("perlin3", [](auto p, auto) { return rt::perlin(p); });
  expectSameBits("perlin4", [](auto p, auto w) { return rt::perlin(p, w); });
  expectSameBits("perlin3 triple", [](auto p, auto) { return rt::perlinTriple(p).y; });
  expectSameBits("perlin3 gradient", [](auto p, auto) { return rt::perlinJet(p).partial[1]; });
  expectSameBits("perlin4 gradient", [](auto p, auto w) { return rt::perlinTripleJet(p, w).y.partial[3]; });
  expectSameBits("simplex3 gradient", [](auto p, auto) { return rt::simplexJet(p).partial[2]; });
  expectSameBits("periodic 1", [](auto p, auto) { return rt::periodicPerlin(p.x, p.y); });
  expectSameBits("periodic 3",
                 [](auto p, auto w) { return rt::periodicPerlin(p, rt::Triple<decltype(w)>{w, p.x, w}); });
  expectSameBits("cell", [](auto p, auto w) { return rt::cellNoise(p, w); });
  expectSameBits("hash", [](auto p, auto) { return rt::hashNoiseTriple(p).z; });
  expectSameBits("periodic cell", [](auto p, auto) { return rt::periodicCellNoise(p.x, p.y); });
  expectSameBits("simplex 1", [](auto p, auto) { return rt::simplex(p.x); });
  expectSameBits("simplex 2", [](auto p, auto) { return rt::simplex(p.x, p.y); });
  expectSameBits("simplex 3", [](auto p, auto) { return rt::simplex(p); });
  expectSameBits("simplex 4", [](auto p, auto w) { return rt::simplex(p, w); });
}

TEST(RuntimeNoiseBits, permutationsGiveTheSame) {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("x86-64-v4")) GTEST_SKIP() << "no AVX-512 here";
  std::array<std::vector<float>, 3> in = {anyFloats(65536, 31), anyFloats(65536, 32), anyFloats(65536, 33)};
  for (std::size_t k = 1; k < 3; ++k) std::shuffle(in[k].begin(), in[k].end(), std::mt19937(static_cast<unsigned>(k)));
  for (std::size_t i = 0; i < 65536; i += 16) {
    alignas(64) float result[16];
    perlinByPermutation(in[0].data() + i, in[1].data() + i, in[2].data() + i, result);
    for (std::size_t lane = 0; lane < 16; ++lane) {
      const Triple p = {in[0][i + lane], in[1][i + lane], in[2][i + lane]};
      ASSERT_TRUE(isSame(result[lane], rt::perlin(p))) << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
}

}  // namespace

}  // namespace aerosol::jit::test
