// Proof that noise keeps below the values that its ranges are cut to (range_perlin.h, range_noise.h). At a point of a
// cell the Perlin noise is a mean, with the fades' weights, of products gradient · offset; with the worst gradient at
// each corner it is at most
//
//   U(x) = scale · sum over corners c of prod_i w_i(c) · max over gradients g of g · (x - c) ,
//
// a function without a hash. Boxes of the cell are halved until a bound on U over each, by the largest offsets at every
// corner and both ends of every fade, is below the value. U is symmetric under reflection and exchange of coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/jit/runtime/range_noise.h"

namespace aerosol::jit::test {

namespace {

template <int N>
struct Cube {
  std::array<double, N> low{}, high{};
};

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

/// The greatest product of a gradient with an offset whose components have these magnitudes.
template <int N>
double worst(const std::array<double, N>& offset) {
  double sum = 0, least = offset[0], most = offset[0];
  for (const double x : offset) {
    sum += x;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  return N == 1 ? 8 * sum : N == 2 ? sum + most : sum - least;
}

template <int N>
double boundOver(const Cube<N>& cube) {
  constexpr std::size_t corners = std::size_t{1} << N;
  std::array<double, corners> values{};
  for (std::size_t corner = 0; corner < corners; ++corner) {
    std::array<double, N> offset{};
    for (std::size_t i = 0; i < N; ++i) offset[i] = (corner >> i & 1u) != 0 ? 1 - cube.low[i] : cube.high[i];
    values[corner] = worst<N>(offset);
  }
  std::size_t count = corners;
  for (std::size_t i = 0; i < N; ++i) {
    count /= 2;
    for (std::size_t k = 0; k < count; ++k) {
      const double a = values[2 * k], b = values[2 * k + 1];
      values[k] = std::max(a + fade(cube.low[i]) * (b - a), a + fade(cube.high[i]) * (b - a));
    }
  }
  return values[0];
}

/// Halves boxes of [0, end]^N until `bound` over each is below `greatest`. Gives the number of boxes looked at, or 0
/// when one of size `smallest` is not below. Coordinates rise, or fall: others are alike.
template <int N, class Bound>
std::size_t prove(const Bound& bound, double greatest, double end, bool rises, double smallest) {
  std::vector<Cube<N>> open(1);
  open[0].high.fill(end);
  std::size_t seen = 0;
  while (!open.empty()) {
    const Cube<N> cube = open.back();
    open.pop_back();
    ++seen;
    bool isOrdered = true;
    for (std::size_t i = 1; i < N; ++i) {
      const std::size_t less = rises ? i - 1 : i, more = rises ? i : i - 1;
      isOrdered = isOrdered && cube.low[less] <= cube.high[more];
    }
    if (!isOrdered || bound(cube) * (1 + 1e-9) <= greatest) continue;
    std::size_t longest = 0;
    for (std::size_t i = 1; i < N; ++i) {
      if (cube.high[i] - cube.low[i] > cube.high[longest] - cube.low[longest]) longest = i;
    }
    const double middle = 0.5 * (cube.low[longest] + cube.high[longest]);
    if (cube.high[longest] - cube.low[longest] < smallest) return 0;
    open.push_back(cube);
    open.back().high[longest] = middle;
    open.push_back(cube);
    open.back().low[longest] = middle;
  }
  return seen;
}

template <int N>
std::size_t provePerlin(double greatest, double smallest) {
  const auto scale = static_cast<double>(runtime::detail::perlinScale[N]);
  return prove<N>([=](const Cube<N>& cube) { return scale * boundOver(cube); }, greatest, 0.5, true, smallest);
}
template <int N>
std::size_t provePerlin(double smallest) {
  // Kernels round: their values may exceed the exact ones by this.
  return provePerlin<N>(static_cast<double>(runtime::detail::perlinGreatest[N]) - 4e-6, smallest);
}

/// Simplex noise: the sum over the corners of a simplex, over a box of skewed coordinates within the unit cube, where
/// the first is the largest. Offsets may be off by `error`, as kernels round them.
template <int N>
double simplexBoundOver(const Cube<N>& cube, double unskew, double square, double error) {
  double low = 0, high = 0, sum = 0;
  for (std::size_t i = 0; i < N; ++i) {
    low += cube.low[i];
    high += cube.high[i];
  }
  for (std::size_t corner = 0; corner <= N; ++corner) {
    std::array<double, N> offset{};
    double nearest = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const double step = static_cast<double>(corner) * unskew - (i < corner ? 1 : 0);
      const double least = cube.low[i] * (1 - unskew) - unskew * (high - cube.high[i]) + step - error;
      const double most = cube.high[i] * (1 - unskew) - unskew * (low - cube.low[i]) + step + error;
      const double closest = std::max({least, -most, 0.0});
      nearest += closest * closest;
      offset[i] = std::max(std::abs(least), std::abs(most));
    }
    // Gradients of the plane have both components of magnitude 1, unlike those of Perlin noise.
    const double product = N == 2 ? offset[0] + offset[N - 1] : worst<N>(offset);
    sum += std::pow(std::max(0.0, square - nearest), 4) * product;
  }
  return sum;
}

template <int N>
std::size_t proveSimplex(double unskew, double scale, double square, double smallest) {
  const auto greatest = static_cast<double>(runtime::detail::greatestSimplex<float>(0));
  const auto bound = [=](const Cube<N>& cube) { return scale * simplexBoundOver<N>(cube, unskew, square, 1e-3); };
  return prove<N>(bound, greatest, 1, false, smallest);
}

TEST(NoiseBound, simplexIsNowhereAboveItsGreatestValue) {
  EXPECT_GT(proveSimplex<1>(0, 0.36, 1, 1e-5), 0u);
  EXPECT_GT(proveSimplex<2>(0.211324865, 64, 0.5, 1e-5), 0u);
  EXPECT_GT(proveSimplex<3>(1.0 / 6, 68, 0.5, 1e-4), 0u);
  EXPECT_GT(proveSimplex<4>(0.138196601, 54, 0.5, 1e-4), 0u);
}

TEST(NoiseBound, perlinIsNowhereAboveItsGreatestValue) {
  EXPECT_GT(provePerlin<1>(1e-6), 0u);
  EXPECT_GT(provePerlin<2>(1e-6), 0u);
  EXPECT_GT(provePerlin<3>(1e-5), 0u);
  EXPECT_GT(provePerlin<4>(1e-4), 0u);
}

TEST(NoiseBound, aLowerValueIsNotProven) {
  EXPECT_EQ(provePerlin<2>(0.95, 1e-4), 0u);
  EXPECT_EQ(provePerlin<3>(1.0, 1e-4), 0u);
}

}  // namespace

}  // namespace aerosol::jit::test
