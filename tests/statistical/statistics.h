// What statistical tests share: random numbers, means with their resolution, chi-squared, distribution of z,
// quadrature.
//
// A test of a mean states its resolution: the standard error is at most 0.3% of the value (otherwise the test has seen
// nothing and fails), and |z| ≤ 4. Histograms and the z of many blocks are tested by chi-squared with p > 1e-6. The
// seed is a hash of the test's name.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "core/base/hash.h"
#include "core/base/random.h"

namespace aerosol::test {

inline constexpr double maximumZ = 4;
inline constexpr double meanResolution = 0.003;
inline constexpr double minimumP = 1e-6;

/// A hash of the running test's full name and of `salt`.
inline std::uint64_t seedOfTest(std::uint64_t salt = 0) {
  const ::testing::TestInfo* const info = ::testing::UnitTest::GetInstance()->current_test_info();
  return combineHashes(hashString(std::string(info->test_suite_name()) + '.' + info->name()), salt);
}

/// Independent numbers in [0, 1).
class Uniforms {
 public:
  explicit Uniforms(std::uint64_t seed) : key_(mixBits(seed)) {}
  float next() {
    const std::uint64_t i = count_++;
    return randomFloat(key_, static_cast<std::uint32_t>(i >> 32), static_cast<std::uint32_t>(i));
  }
  std::array<float, 2> next2D() {
    const float first = next();
    return {first, next()};
  }
  /// On the unit sphere.
  std::array<double, 3> direction() {
    const double z = 1 - 2 * static_cast<double>(next()), phi = 2 * std::numbers::pi * static_cast<double>(next());
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

/// Mean and variance of a stream of numbers (Welford 1962).
class RunningMean {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / static_cast<double>(count_);
    squares_ += delta * (x - mean_);
  }
  std::uint64_t count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }
  double standardError() const { return std::sqrt(variance() / static_cast<double>(count_)); }
  /// Deviation from `expected` in standard errors; 0 when a constant meets it up to rounding.
  double z(double expected) const {
    const double error = standardError(), difference = mean_ - expected;
    if (std::fabs(difference) <= 1e-6 * std::fabs(expected)) return error > 0 ? difference / error : 0;
    return error > 0 ? difference / error : std::copysign(std::numeric_limits<double>::infinity(), difference);
  }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// Means of consecutive batches, whose distribution is near a normal one even where single values have heavy tails.
class BatchMeans {
 public:
  explicit BatchMeans(std::uint64_t batchSize) : size_(batchSize) {}
  void add(double x) {
    batch_.add(x);
    if (batch_.count() < size_) return;
    means_.add(batch_.mean());
    batch_ = {};
  }
  /// Over the complete batches.
  const RunningMean& means() const { return means_; }

 private:
  std::uint64_t size_;
  RunningMean batch_, means_;
};

/// Whether the mean meets a known value, and could have told it from one 1% away.
inline ::testing::AssertionResult agrees(const RunningMean& sample, double expected,
                                         double resolution = meanResolution) {
  const double error = sample.standardError(), z = sample.z(expected);
  const auto describe = [&](::testing::AssertionResult result) {
    return result << "mean " << sample.mean() << " ± " << error << " of " << sample.count() << ", expected " << expected
                  << ", z " << z;
  };
  if (!(error <= resolution * std::fabs(expected))) {
    return describe(::testing::AssertionFailure() << "the test resolves nothing: ");
  }
  if (!(std::fabs(z) <= maximumZ)) return describe(::testing::AssertionFailure());
  return describe(::testing::AssertionSuccess());
}

/// The probability that chi-squared with `degrees` of freedom exceeds `x`: the regularised upper incomplete gamma
/// function Q(degrees / 2, x / 2), by its series for small x and by Lentz's continued fraction for large x.
inline double chiSquaredTail(double x, double degrees) {
  const double a = degrees / 2, h = x / 2;
  if (!(h > 0)) return 1;
  const double front = std::exp(a * std::log(h) - h - std::lgamma(a));
  if (h < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 100000 && term > sum * 1e-16; ++n) sum += term *= h / (a + n);
    return std::max(0.0, 1 - front * sum);
  }
  double b = h + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int n = 1; n < 100000; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= d * c;
    if (std::fabs(d * c - 1) < 1e-15) break;
  }
  return front * fraction;
}

struct ChiSquared {
  double statistic = 0;
  int degrees = 0;
  double p = 1;
};

/// Pearson's test of counts against expected counts, of which the cells with fewer than five are thrown together.
inline ChiSquared chiSquared(std::span<const double> observed, std::span<const double> expected) {
  ChiSquared result;
  double pooledObserved = 0, pooledExpected = 0;
  const auto cell = [&](double o, double e) {
    result.statistic += (o - e) * (o - e) / e;
    ++result.degrees;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5) {
      cell(observed[i], expected[i]);
    } else {
      pooledObserved += observed[i];
      pooledExpected += expected[i];
    }
  }
  // Where next to nothing is expected, next to nothing may be found.
  if (pooledExpected >= 5 || pooledObserved > pooledExpected + 15) cell(pooledObserved, std::max(pooledExpected, 1e-3));
  result.degrees = std::max(1, result.degrees - 1);
  result.p = chiSquaredTail(result.statistic, result.degrees);
  return result;
}

inline ::testing::AssertionResult countsAgree(std::span<const double> observed, std::span<const double> expected) {
  const ChiSquared test = chiSquared(observed, expected);
  ::testing::AssertionResult result = test.p > minimumP ? ::testing::AssertionSuccess() : ::testing::AssertionFailure();
  return result << "chi-squared " << test.statistic << " with " << test.degrees << " degrees, p " << test.p;
}

/// Whether the z of many independent blocks or pixels are distributed as a standard normal variable.
inline ::testing::AssertionResult zScoresAreNormal(std::span<const double> scores) {
  const auto bins = static_cast<std::size_t>(std::clamp(static_cast<double>(scores.size()) / 20, 4.0, 40.0));
  std::vector<double> observed(bins), expected(bins, static_cast<double>(scores.size()) / static_cast<double>(bins));
  for (const double z : scores) {
    const double below = 0.5 * std::erfc(-z / std::numbers::sqrt2);
    if (!std::isfinite(z)) return ::testing::AssertionFailure() << "a score is not finite";
    ++observed[std::min(bins - 1, static_cast<std::size_t>(below * static_cast<double>(bins)))];
  }
  return countsAgree(observed, expected);
}

/// ∫ f over [a, b]: five-point Gauss–Legendre on `pieces` equal pieces.
template <class Function>
double integrate(Function f, double a, double b, int pieces) {
  constexpr double nodes[] = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double half = (b - a) / pieces / 2;
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    const double centre = a + (2 * i + 1) * half;
    sum += weights[0] * f(centre);
    for (int n = 1; n < 3; ++n) sum += weights[n] * (f(centre - half * nodes[n]) + f(centre + half * nodes[n]));
  }
  return sum * half;
}

}  // namespace aerosol::test
