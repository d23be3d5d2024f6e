#include "core/render/microfacet.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerosol::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float leastAlpha = 1e-4f;

float square(float x) { return x * x; }

}  // namespace

Microfacets::Microfacets(Finish finish, float alphaX, float alphaY)
    : shape_(finish.shape),
      isSingle_(finish.isSingle),
      alphaX_(std::clamp(alphaX, leastAlpha, 1.0f)),
      alphaY_(std::clamp(alphaY, leastAlpha, 1.0f)) {}

float Microfacets::density(Vector<Local> h) const {
  if (!(h.z > 0)) return 0;
  const float cos2 = h.z * h.z;
  const float stretched = square(h.x / alphaX_) + square(h.y / alphaY_);
  if (shape_ == Shape::ggx) return 1 / (pi * alphaX_ * alphaY_ * square(stretched + cos2));
  return std::exp(-stretched / cos2) / (pi * alphaX_ * alphaY_ * cos2 * cos2);
}

float Microfacets::lambda(Vector<Local> w) const {
  const float cos2 = w.z * w.z;
  if (!(cos2 > 0)) return std::numeric_limits<float>::infinity();
  const float slope2 = (square(alphaX_ * w.x) + square(alphaY_ * w.y)) / cos2;
  if (!(slope2 > 0)) return 0;
  if (shape_ == Shape::ggx) return 0.5f * (std::sqrt(1 + slope2) - 1);
  // Heitz 2014, equation 68.
  const float a = 1 / std::sqrt(slope2);
  return 0.5f * (std::erf(a) - 1) + std::exp(-a * a) / (2 * a * std::sqrt(pi));
}

float Microfacets::seenByBoth(Vector<Local> a, Vector<Local> b) const {
  const float la = lambda(a), lb = lambda(b);
  if (isSingle_) return 1 / ((1 + la) * (1 + lb));
  if (a.z * b.z > 0) return 1 / (1 + la + lb);
  // On different sides: Heitz 2014, equation 99 for refraction: the beta function B(1 + Λa, 1 + Λb).
  return static_cast<float>(std::exp(std::lgamma(1.0 + static_cast<double>(la)) +
                                     std::lgamma(1.0 + static_cast<double>(lb)) -
                                     std::lgamma(2.0 + static_cast<double>(la) + static_cast<double>(lb))));
}

Vector<Local> Microfacets::sampleVisible(Vector<Local> viewer, std::array<float, 2> u) const {
  // Dupuy and Benyoub 2023: in the space where the ellipsoid is a sphere, visible normals are halfway between the
  // viewer and a uniform cap.
  const Vector<Local> v = normalize(Vector<Local>(alphaX_ * viewer.x, alphaY_ * viewer.y, viewer.z));
  const float phi = 2 * pi * u[0];
  const float z = (1 - u[1]) * (1 + v.z) - v.z;
  const float sine = std::sqrt(std::clamp(1 - z * z, 0.0f, 1.0f));
  const Vector<Local> h = Vector<Local>(sine * std::cos(phi), sine * std::sin(phi), z) + v;
  return normalize(Vector<Local>(alphaX_ * h.x, alphaY_ * h.y, std::max(h.z, 0.0f)));
}

float Microfacets::visibleDensity(Vector<Local> viewer, Vector<Local> h) const {
  if (shape_ != Shape::ggx) return Microfacets({Shape::ggx}, alphaX_, alphaY_).visibleDensity(viewer, h);
  const float cosine = std::fabs(viewer.z);
  return cosine > 0 ? seen(viewer) * std::max(dot(viewer, h), 0.0f) * density(h) / cosine : 0;
}

LocalFrame::LocalFrame(Vector<World> normal, Vector<World> tangent, Vector<World> viewer) {
  z_ = dot(normal, viewer) < 0 ? -normal : normal;
  const Vector<World> along = tangent - z_ * dot(tangent, z_);
  const float size = squaredLength(along);
  if (size > 1e-12f) {
    x_ = along * (1 / std::sqrt(size));
  } else {
    x_ = Frame<World>(z_).x;
  }
  y_ = cross(z_, x_);
}

std::optional<Vector<Local>> refractAt(Vector<Local> w, Vector<Local> h, float eta) {
  const float cosine = dot(w, h);
  const float inverse = 1 / eta;
  const float k = 1 - inverse * inverse * (1 - cosine * cosine);
  if (!(k > 0) || !(cosine > 0)) return {};
  return normalize(h * (inverse * cosine - std::sqrt(k)) - w * inverse);
}

}  // namespace aerosol::render
