#include "core/render/thin_film.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace aerosol::render {

namespace {

using Complex = std::complex<double>;

/// Amplitudes reflected at a boundary, of light with the field across (s) and along (p) the plane of incidence.
struct Amplitudes {
  Complex s, p;
};

/// From index n1 to n2, with cosines in both.
Amplitudes reflectedAt(Complex n1, Complex c1, Complex n2, Complex c2) {
  return {(n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2)};
}

/// The eye's sensitivities as Gaussians over the wave number, in Fourier space: of a wave with this way difference (m)
/// and phase, as XYZ of light that is even over the spectrum (Belcour and Barla's fit).
Color seen(double way, double phase) {
  constexpr double values[] = {5.4856e-13, 4.4201e-13, 5.2481e-13};
  constexpr double places[] = {1.6810e6, 1.7953e6, 2.2084e6};
  constexpr double variances[] = {4.3278e9, 9.3046e9, 6.6121e9};
  constexpr double norm = 1.0685e-7;
  const double at = 2 * std::numbers::pi * way;
  const auto bell = [&](double value, double place, double variance) {
    return value * std::sqrt(2 * std::numbers::pi * variance) * std::cos(place * at + phase) *
           std::exp(-variance * at * at) / norm;
  };
  Color xyz;
  for (int i = 0; i < 3; ++i) xyz[i] = static_cast<float>(bell(values[i], places[i], variances[i]));
  xyz.r += static_cast<float>(bell(9.7470e-14, 2.2399e6, 4.5282e9));
  return xyz;
}

/// To the primaries of Rec. 709, scaled so that light that is even over the spectrum is white.
Color rgbOf(Color xyz) {
  return {2.6896554f * xyz.r - 1.2758622f * xyz.g - 0.4137932f * xyz.b,
          -1.0221080f * xyz.r + 1.9782864f * xyz.g + 0.0438216f * xyz.b,
          0.0612245f * xyz.r - 0.2244899f * xyz.g + 1.1632654f * xyz.b};
}

/// One polarisation of one base: the mean, and the strength and phase of the first wave.
struct Series {
  double mean = 0, first = 0, ratio = 0, phase = 0;
};

Series seriesOf(Complex top, Complex base) {
  const double r12 = std::norm(top), r23 = std::norm(base), t121 = 1 - r12;
  Series series;
  const double rest = std::max(1 - r12 * r23, 1e-9);
  const double all = t121 * t121 * r23 / rest;
  series.mean = r12 + all;
  series.ratio = std::sqrt(r12 * r23);
  series.first = all - t121;
  // Light that comes from inside meets the top with the opposite sign.
  series.phase = std::arg(-top) + std::arg(base);
  return series;
}

}  // namespace

Color filmReflectance(const ThinFilm& film, float cosine, Color eta, Color k) {
  const double c1 = std::clamp(static_cast<double>(cosine), 1e-4, 1.0), sine2 = 1 - c1 * c1;
  const double n2 = static_cast<double>(film.ior);
  const double inside = 1 - sine2 / (n2 * n2);
  if (inside <= 0) return Color(1);
  const double c2 = std::sqrt(inside);
  const Amplitudes top = reflectedAt(1, c1, n2, c2);
  const double way = 2 * n2 * static_cast<double>(film.thickness_nm) * 1e-9 * c2;
  Color sum;
  for (int channel = 0; channel < 3; ++channel) {
    const Complex n3(static_cast<double>(eta[channel]), static_cast<double>(k[channel]));
    const Complex c3 = std::sqrt(Complex(1) - sine2 / (n3 * n3));
    const Amplitudes base = reflectedAt(n2, c2, n3, c3);
    for (const Series& series : {seriesOf(top.s, base.s), seriesOf(top.p, base.p)}) {
      Color color(static_cast<float>(series.mean));
      double strength = series.first;
      for (int wave = 1; wave <= 3; ++wave) {
        strength *= series.ratio;
        color += rgbOf(seen(wave * way, wave * series.phase)) * static_cast<float>(2 * strength);
      }
      sum[channel] += 0.5f * color[channel];
    }
  }
  return {std::clamp(sum.r, 0.0f, 1.0f), std::clamp(sum.g, 0.0f, 1.0f), std::clamp(sum.b, 0.0f, 1.0f)};
}

}  // namespace aerosol::render
