// Thin films against Airy's formula, wavelength by wavelength.

#include "core/render/thin_film.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/render/fresnel.h"

namespace aerosol::render {
namespace {

using Complex = std::complex<double>;

/// Unpolarised light of one wavelength on a film.
double airy(double wavelength_nm, double thickness_nm, double film, Complex base, double cosine) {
  const double sine2 = 1 - cosine * cosine;
  const Complex c2 = std::sqrt(Complex(1 - sine2 / (film * film))), c3 = std::sqrt(1.0 - sine2 / (base * base));
  const Complex wave = std::exp(Complex(0, 4 * std::numbers::pi * film * thickness_nm / wavelength_nm) * c2);
  const auto both = [&](Complex top, Complex below) {
    return std::norm((top + below * wave) / (1.0 + top * below * wave));
  };
  const double s = both((cosine - film * c2) / (cosine + film * c2), (film * c2 - base * c3) / (film * c2 + base * c3));
  const double p = both((film * cosine - c2) / (film * cosine + c2), (base * c2 - film * c3) / (base * c2 + film * c3));
  return 0.5 * (s + p);
}

/// The observer by the fits of Wyman, Sloan and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color
/// Matching Functions".
std::array<double, 3> observer(double w) {
  const auto bell = [w](double height, double middle, double left, double right) {
    const double t = (w - middle) * (w < middle ? left : right);
    return height * std::exp(-0.5 * t * t);
  };
  return {bell(0.362, 442.0, 0.0624, 0.0374) + bell(1.056, 599.8, 0.0264, 0.0323) - bell(0.065, 501.1, 0.0490, 0.0382),
          bell(0.821, 568.8, 0.0213, 0.0247) + bell(0.286, 530.9, 0.0613, 0.0322),
          bell(1.217, 437.0, 0.0845, 0.0278) + bell(0.681, 459.0, 0.0385, 0.0725)};
}

Color reference(double thickness_nm, double film, Complex base, double cosine) {
  std::array<double, 3> xyz{}, white{};
  for (double w = 380.5; w < 780; w += 1) {
    const auto seen = observer(w);
    for (std::size_t i = 0; i < 3; ++i) {
      xyz[i] += seen[i] * airy(w, thickness_nm, film, base, cosine);
      white[i] += seen[i];
    }
  }
  const double m[3][3] = {
      {3.2409699, -1.5373832, -0.4986108}, {-0.9692436, 1.8759675, 0.0415551}, {0.0556301, -0.2039770, 1.0569715}};
  Color rgb;
  for (int c = 0; c < 3; ++c) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += m[c][i] * xyz[i] / white[i];
      all += m[c][i];
    }
    rgb[c] = static_cast<float>(std::clamp(sum / all, 0.0, 1.0));
  }
  return rgb;
}

TEST(ThinFilm, ReflectsAsAirysFormulaSays) {
  for (const Complex base : {Complex(1.5, 0), Complex(2.2, 0), Complex(0.2, 3.4), Complex(2.5, 3.0)}) {
    for (const double film : {1.33, 1.8}) {
      for (const double thickness : {80.0, 250.0, 420.0, 700.0}) {
        for (const double cosine : {1.0, 0.6, 0.25}) {
          const Color found =
              filmReflectance({static_cast<float>(thickness), static_cast<float>(film)}, static_cast<float>(cosine),
                              Color(static_cast<float>(base.real())), Color(static_cast<float>(base.imag())));
          const Color expected = reference(thickness, film, base, cosine);
          for (int c = 0; c < 3; ++c) {
            // The fits of both observers differ by some percent of the wave's strength.
            EXPECT_NEAR(found[c], expected[c], 0.04f)
                << base << " film " << film << ' ' << thickness << " nm, cosine " << cosine << ", channel " << c;
          }
        }
      }
    }
  }
}

TEST(ThinFilm, HasNoEffectWhereNothingDiffers) {
  // A film of the matter below it, or of what is above it.
  for (const float cosine : {1.0f, 0.5f, 0.1f}) {
    const float bare = fresnelDielectric(cosine, 1.6f);
    EXPECT_NEAR(filmReflectance({300, 1.6f}, cosine, Color(1.6f), Color()).g, bare, 2e-5f);
    EXPECT_NEAR(filmReflectance({300, 1.0f}, cosine, Color(1.6f), Color()).g, bare, 2e-5f);
  }
  // From inside, beyond the critical angle, everything comes back.
  EXPECT_NEAR(filmReflectance({300, 0.9f}, 0.3f, Color(1 / 1.5f), Color()).r, 1, 1e-5f);
}

TEST(ThinFilm, ThickOnesLoseTheirColours) {
  const Color thick = filmReflectance({100000, 1.4f}, 0.8f, Color(1.7f), Color());
  EXPECT_NEAR(thick.r, thick.g, 1e-5f);
  EXPECT_NEAR(thick.b, thick.g, 1e-5f);
}

}  // namespace
}  // namespace aerosol::render
