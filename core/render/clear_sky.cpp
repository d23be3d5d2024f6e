#include "core/render/clear_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/sky_tables.h"

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;

/// What an even spectrum of 1 weighs in the tables: the integral of the CIE's y, in nm.
constexpr double unitOfTables = 106.75025939941406;

double mix(double a, double b, double t) { return a + (b - a) * t; }

/// A place between the entries of a table.
struct Between {
  std::size_t first, second;
  double share;  ///< Of the second.

  Between(double position, std::size_t entries)
      : first(static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(entries - 1)))),
        second(std::min(first + 1, entries - 1)),
        share(std::clamp(position - static_cast<double>(first), 0.0, 1.0)) {}
};

/// Bernstein's polynomials of degree 5: Equation 10 of the paper.
std::array<double, 6> bernstein(double x) {
  const double y = 1 - x;
  return {y * y * y * y * y,      5 * x * y * y * y * y, 10 * x * x * y * y * y,
          10 * x * x * x * y * y, 5 * x * x * x * x * y, x * x * x * x * x};
}

float notNegative(double value) { return static_cast<float>(std::max(value, 0.0)); }

}  // namespace

ClearSky::ClearSky(double sunZenith, double turbidity, Color albedo) {
  const double elevation = std::max(pi / 2 - sunZenith, 0.0);
  const std::array<double, 6> weights = bernstein(std::cbrt(elevation / (pi / 2)));
  const Between air(turbidity - 1, 10);
  const auto interpolated = [&](std::size_t channel, auto&& entry) {
    const auto overElevations = [&](std::size_t t, std::size_t ground) {
      double sum = 0;
      for (std::size_t i = 0; i < 6; ++i) sum += weights[i] * static_cast<double>(entry(t, ground, i));
      return sum;
    };
    const double ground = static_cast<double>(albedo[static_cast<int>(channel)]);
    return mix(mix(overElevations(air.first, 0), overElevations(air.first, 1), ground),
               mix(overElevations(air.second, 0), overElevations(air.second, 1), ground), air.share);
  };
  const Between height((elevation * 180 / pi - 2) / 3, 30);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 9; ++k) {
      shape_[c][k] =
          interpolated(c, [=](std::size_t t, std::size_t a, std::size_t i) { return skyShapes[t][a][i][c][k]; });
    }
    mean_[c] = interpolated(c, [=](std::size_t t, std::size_t a, std::size_t i) { return skyMeans[t][a][i][c]; }) /
               unitOfTables;
    const auto sunThrough = [&](std::size_t t) {
      return mix(static_cast<double>(sunMeans[t][height.first][c]), static_cast<double>(sunMeans[t][height.second][c]),
                 height.share);
    };
    sun_[static_cast<int>(c)] = notNegative(mix(sunThrough(air.first), sunThrough(air.second), air.share));
  }
}

// Equations 8 and 9 of the paper of 2012. Of the coefficients A to I the tables have H last.
Color ClearSky::sky(double cosZenith, double sunAngle) const {
  const double cosine = std::cos(sunAngle), square = cosine * cosine;
  Color radiance;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [A, B, C, D, E, F, G, I, H] = shape_[i];
    const double aureole = (1 + square) / std::pow(1 + H * H - 2 * H * cosine, 1.5);
    const double relative = (1 + A * std::exp(B / (cosZenith + 0.01))) *
                            (C + D * std::exp(E * sunAngle) + F * square + G * aureole + I * std::sqrt(cosZenith));
    radiance[static_cast<int>(i)] = notNegative(relative * mean_[i]);
  }
  return radiance;
}

// A polynomial of the cosine at which the sun's surface is seen. It is that of the paper of 2013 in the three colours
// of the sun at the zenith and a turbidity of 3; deeper suns have one that differs by less than 2 %.
Color ClearSky::limbDarkening(double sine) {
  constexpr double coefficients[3][6] = {{0.40145718, 1.63492319, -2.33279872, 3.11028167, -2.29401963, 0.68443873},
                                         {0.31780114, 1.66148375, -1.83009124, 2.11456600, -1.39508072, 0.38076203},
                                         {0.20934932, 1.64526607, -1.22216951, 1.27112396, -0.78151174, 0.19931000}};
  const double cosine = std::sqrt(std::max(1 - sine * sine, 0.0));
  Color factor;
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (int j = 5; j >= 0; --j) sum = sum * cosine + coefficients[c][j];
    factor[c] = static_cast<float>(sum);
  }
  return factor;
}

}  // namespace aerosol::render
