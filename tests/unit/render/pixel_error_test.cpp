#include "core/render/pixel_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "core/render/sample_stream.h"

namespace aerosol::render {
namespace {

/// What a pixel may show, with random numbers of its own.
using Integrand = std::function<float(SampleStream&)>;

/// Edges, smooth ones of two dimensions and of more, and one that no pattern helps.
std::vector<Integrand> integrands() {
  return {[](SampleStream& s) {
            const auto [x, y] = s.next2D();
            return x + y < 0.7f ? 1.0f : 0.0f;
          },
          [](SampleStream& s) {
            const auto [x, y] = s.next2D();
            return x * y + s.next1D();
          },
          [](SampleStream& s) {
            const auto p = s.next2D(), q = s.next2D();
            return p[0] < 0.3f ? q[0] * q[1] : 0.0f;
          },
          [](SampleStream& s) {
            const float u = s.next1D();
            return std::exp(-4 * (u + s.next2D()[1] + s.next2D()[0]));
          },
          [](SampleStream& s) { return s.nextHash(); }};
}

struct Ratios {
  double told = 0, asIfIndependent = 0;
};

/// Mean squared errors of many pixels over the true one.
Ratios ratiosOf(const Integrand& integrand, SamplerKind kind, std::uint32_t samples) {
  constexpr int pixels = 6000;
  double told = 0, independent = 0, sum = 0, squares = 0;
  for (int x = 0; x < pixels; ++x) {
    PixelSum pixel;
    for (std::uint32_t i = 0; i < samples; ++i) {
      SampleStream stream(kind, 7, x, 1, i);
      pixel.add(i, {Color(integrand(stream)), 1});
    }
    const SampleSums total = pixel.total();
    told += squaredErrors(pixel, total, kind == SamplerKind::sobol, 2)[1] / pixels;
    independent += squaredErrors(pixel, total, false, 2)[1] / pixels;
    const double mean = total.color[1] / samples;
    sum += mean / pixels;
    squares += mean * mean / pixels;
  }
  const double measured = squares - sum * sum;
  return {told / measured, independent / measured};
}

TEST(PixelErrors, OfScramblesAreTheTrueOnes) {
  double largest = 0;
  for (const std::uint32_t samples : {16u, 64u, 72u, 256u}) {
    for (std::size_t i = 0; i < integrands().size(); ++i) {
      const Ratios ratios = ratiosOf(integrands()[i], SamplerKind::sobol, samples);
      // The measured error has a standard error of 2%.
      EXPECT_NEAR(ratios.told, 1, 0.08) << "integrand " << i << ", " << samples << " samples";
      EXPECT_GT(ratios.asIfIndependent, 0.92);
      largest = std::max(largest, ratios.asIfIndependent);
    }
  }
  EXPECT_GT(largest, 5) << "nothing is stratified";
}

TEST(PixelErrors, OfIndependentSamplesAreTheTrueOnes) {
  for (const Integrand& integrand : integrands()) {
    EXPECT_NEAR(ratiosOf(integrand, SamplerKind::independent, 40).told, 1, 0.08);
  }
}

TEST(PixelErrors, NeedTwoSamplesAndTheScramblesThatAreAskedFor) {
  PixelSum pixel;
  const auto errorWith = [&](std::uint32_t least) { return squaredErrors(pixel, pixel.total(), true, least)[0]; };
  EXPECT_EQ(errorWith(2), 0);
  for (std::uint32_t i = 0; i < 56; ++i) {
    SampleStream stream(SamplerKind::sobol, 1, 2, 3, i);
    pixel.add(i, {Color(stream.next1D()), 1});
    if (i == 0) EXPECT_EQ(errorWith(2), 0);
    if (i == 7) EXPECT_EQ(errorWith(2), errorWith(8)) << "one scramble alone";
  }
  EXPECT_LT(errorWith(7), 0.2 * errorWith(8)) << "seven tell, eight are not there";
}

}  // namespace
}  // namespace aerosol::render
