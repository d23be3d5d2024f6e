#include "core/render/clear_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/scene/spectrum.h"

namespace aerosol::render {

namespace {

using scene::Spectrum;

constexpr double pi = std::numbers::pi;

/// cd/m² of a spectral radiance of 1 W / (m² sr nm) at all wavelengths: 683 lm/W times the integral of y.
constexpr double candelasOfUnit = 683.002 * 106.857;

double perezOf(const std::array<double, 5>& p, double cosZenith, double angle) {
  const double cosine = std::cos(angle);
  return (1 + p[0] * std::exp(p[1] / std::max(cosZenith, 1e-6))) *
         (1 + p[2] * std::exp(p[3] * angle) + p[4] * cosine * cosine);
}

/// A cubic in θs for each power of the turbidity, highest first.
double zenithChromaticity(const double (&rows)[3][4], double theta, double turbidity) {
  double sum = 0;
  for (const auto& row : rows) {
    const double cubic = ((row[0] * theta + row[1]) * theta + row[2]) * theta + row[3];
    sum = sum * turbidity + cubic;
  }
  return sum;
}

Spectrum evenly(double first, double step, std::initializer_list<double> values) {
  Spectrum spectrum;
  for (const double value : values) {
    spectrum.wavelengths_nm.push_back(first + step * static_cast<double>(spectrum.values.size()));
    spectrum.values.push_back(value);
  }
  return spectrum;
}

/// The sun outside of the air, W / (m² sr nm).
Spectrum sunOutside() {
  return evenly(380, 10, {16559.0, 16233.7, 21127.5, 25888.2, 25829.1, 24232.3, 26760.5, 29658.3, 30545.4, 30057.5,
                          30663.7, 28830.4, 28712.1, 27825.0, 27100.6, 27233.6, 26361.3, 25503.8, 25060.2, 25311.6,
                          25355.9, 25134.2, 24631.5, 24173.2, 23685.3, 23212.1, 22827.7, 22339.8, 21970.2, 21526.7,
                          21097.9, 20728.3, 20240.4, 19870.8, 19427.2, 19072.4, 18628.9, 18259.2});
}

/// Absorption of ozone, 1/cm.
Spectrum ozone() {
  Spectrum spectrum = evenly(445, 5, {0.003, 0.003, 0.004, 0.006, 0.008, 0.009, 0.012, 0.014, 0.017, 0.021, 0.025,
                                      0.03,  0.035, 0.04,  0.045, 0.048, 0.057, 0.063, 0.07,  0.075, 0.08,  0.085,
                                      0.095, 0.103, 0.110, 0.12,  0.122, 0.12,  0.118, 0.115, 0.12,  0.125, 0.130});
  for (const double value : {0.12, 0.105, 0.09, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018}) {
    spectrum.wavelengths_nm.push_back(spectrum.values.size() == 33 ? 610 : spectrum.wavelengths_nm.back() + 10);
    spectrum.values.push_back(value);
  }
  return spectrum;
}

}  // namespace

double ClearSky::Channel::operator()(double cosZenith, double sunAngle) const {
  return scale * perezOf(perez, cosZenith, sunAngle);
}

// Appendix A.2 of the paper: luminance in kcd/m² and chromaticities.
ClearSky::ClearSky(double sunZenith, double turbidity) : zenith_(sunZenith), turbidity_(turbidity) {
  const double T = turbidity;
  Y_.perez = {0.1787 * T - 1.4630, -0.3554 * T + 0.4275, -0.0227 * T + 5.3251, 0.1206 * T - 2.5771,
              -0.0670 * T + 0.3703};
  x_.perez = {-0.0193 * T - 0.2592, -0.0665 * T + 0.0008, -0.0004 * T + 0.2125, -0.0641 * T - 0.8989,
              -0.0033 * T + 0.0452};
  y_.perez = {-0.0167 * T - 0.2608, -0.0950 * T + 0.0092, -0.0079 * T + 0.2102, -0.0441 * T - 1.6537,
              -0.0109 * T + 0.0529};
  const double chi = (4.0 / 9 - T / 120) * (pi - 2 * sunZenith);
  const double luminance = (4.0453 * T - 4.9710) * std::tan(chi) - 0.2155 * T + 2.4192;
  const double x = zenithChromaticity(
      {{0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}},
      sunZenith, T);
  const double y = zenithChromaticity(
      {{0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}},
      sunZenith, T);
  const auto scaled = [&](Channel& channel, double zenith) {
    channel.scale = zenith / perezOf(channel.perez, 1, sunZenith);
  };
  scaled(Y_, std::max(luminance, 0.0) * 1000 / candelasOfUnit);
  scaled(x_, x);
  scaled(y_, y);
}

double ClearSky::luminance(double cosZenith, double sunAngle) const { return std::max(Y_(cosZenith, sunAngle), 0.0); }

Color ClearSky::sky(double cosZenith, double sunAngle) const {
  const double Y = luminance(cosZenith, sunAngle), x = x_(cosZenith, sunAngle), y = y_(cosZenith, sunAngle);
  const double X = x / y * Y, Z = (1 - x - y) / y * Y;
  const double r = 3.2404542 * X - 1.5371385 * Y - 0.4985314 * Z;
  const double g = -0.9692660 * X + 1.8760108 * Y + 0.0415560 * Z;
  const double b = 0.0556434 * X - 0.2040259 * Y + 1.0572252 * Z;
  return {static_cast<float>(std::max(r, 0.0)), static_cast<float>(std::max(g, 0.0)),
          static_cast<float>(std::max(b, 0.0))};
}

// Appendix A.1: the sun's spectrum through molecules (Rayleigh), aerosols (Ångström, with a turbidity coefficient by
// the turbidity) and 0.35 cm of ozone. The paper's bands of mixed gases and water vapour lie beyond 689 nm, where the
// eye sees next to nothing: they are left out.
Color ClearSky::sun() const {
  const Spectrum outside = sunOutside(), absorption = ozone();
  const double degrees = zenith_ * 180 / pi;
  const double mass = 1 / (std::cos(zenith_) + 0.15 * std::pow(93.885 - degrees, -1.253));
  const double beta = 0.04608365822050 * turbidity_ - 0.04586025928522;
  const auto seen = [&](double wavelength_nm) {
    const double lambda = wavelength_nm / 1000;
    const double depth =
        0.008735 * std::pow(lambda, -4.08) + beta * std::pow(lambda, -1.3) + 0.35 * absorption(wavelength_nm);
    return outside(wavelength_nm) * std::exp(-mass * depth);
  };
  Color color = scene::colorOf(seen, scene::SpectrumUse::emitted);
  for (int i = 0; i < 3; ++i) color[i] = std::max(color[i], 0.0f);
  return color;
}

}  // namespace aerosol::render
