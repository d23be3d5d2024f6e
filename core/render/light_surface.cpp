#include "core/render/light_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/render/spherical_rectangle.h"
#include "core/render/warp.h"

namespace aerosol::render {

namespace {

using Vec = DoubleVector;

template <class T>
Vec toDouble(const T& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
template <class T>
T toFloat(Vec v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Vec column(const Matrix4& m, std::size_t i) { return {m[0][i], m[1][i], m[2][i]}; }

/// A density per area as one per solid angle: d² / |cos| times it. 0 at the back or at the point itself.
double toSolidAngle(double pdfArea, Vec from, Vec point, Vec normal) {
  const Vec d = point - from;
  const double squared = dot(d, d);
  const double facing = -dot(d, normal);
  if (!(facing > 0)) return 0;
  return pdfArea * squared * std::sqrt(squared) / facing;
}

/// The sample for a point that was chosen with `pdfArea`; none at the back.
std::optional<SurfaceSample> seen(Point<World> from, Vec point, Vec normal, double pdfArea) {
  const Vec origin = toDouble(from);
  const double pdf = toSolidAngle(pdfArea, origin, point, normal);
  if (!(pdf > 0)) return {};
  const Vec d = point - origin;
  const double distance = length(d);
  SurfaceSample sample;
  sample.point = toFloat<Point<World>>(point);
  sample.normal = toFloat<Normal<World>>(normal);
  sample.direction = toFloat<Vector<World>>(d * (1 / distance));
  sample.distance = static_cast<float>(distance);
  sample.pdf = static_cast<float>(pdf);
  return sample;
}

std::optional<SurfaceSample> withTexture(std::optional<SurfaceSample> sample, double u, double v) {
  if (!sample) return {};
  sample->u = static_cast<float>(u);
  sample->v = static_cast<float>(v);
  return sample;
}

/// The angle of (x, y) as a part of a turn.
double turn(double x, double y) {
  const double angle = std::atan2(y, x) / (2 * std::numbers::pi);
  return angle < 0 ? angle + 1 : angle;
}

class MeshLight final : public LightSurface {
 public:
  explicit MeshLight(const accel::TriangleMesh& mesh) : mesh_(&mesh) {
    cumulative_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const double part = 0.5 * length(doubleAreaNormal(i));
      area_ += part;
      cumulative_.push_back(area_);
      centre_ = centre_ + (corner(i, 0) + corner(i, 1) + corner(i, 2)) * (part / 3);
    }
    if (!(area_ > 0)) return;
    centre_ = centre_ * (1 / area_);
    double moment = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Vec d = (corner(i, 0) + corner(i, 1) + corner(i, 2)) * (1.0 / 3) - centre_;
      moment += dot(d, d) * 0.5 * length(doubleAreaNormal(i));
    }
    extent_ = static_cast<float>(std::sqrt(moment / area_));
  }

  std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const override {
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), static_cast<double>(u.choice) * area_);
    const auto i = static_cast<std::size_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
    return sampleTriangle(i, from, u.place, 1 / area_);
  }

  float pdf(Point<World> from, const LightHit& hit) const override {
    return static_cast<float>(toSolidAngle(1 / area_, toDouble(from), toDouble(hit.point), toDouble(hit.normal)));
  }

  std::uint32_t partCount() const override { return static_cast<std::uint32_t>(mesh_->triangles.size()); }
  SurfacePart part(std::uint32_t index) const override {
    SurfacePart part{.isFlat = true};
    for (const std::uint32_t i : mesh_->triangles[index]) part.box.extend(mesh_->positions[i]);
    const Vec n = doubleAreaNormal(index);
    const double size = length(n);
    if (size > 0) part.normal = toFloat<Vector<World>>(n * (1 / size));
    part.area = 0.5 * size;
    return part;
  }
  std::optional<SurfaceSample> samplePart(std::uint32_t part, Point<World> from,
                                          const LightUniforms& u) const override {
    return sampleTriangle(part, from, u.place, 2 / length(doubleAreaNormal(part)));
  }
  float pdfPart(std::uint32_t part, Point<World> from, const LightHit& hit) const override {
    const double twice = length(doubleAreaNormal(part));
    if (!(twice > 0)) return 0;
    return static_cast<float>(toSolidAngle(2 / twice, toDouble(from), toDouble(hit.point), toDouble(hit.normal)));
  }

  double area() const override { return area_; }
  Point<World> centre() const override { return toFloat<Point<World>>(centre_); }
  float extent() const override { return extent_; }

 private:
  std::optional<SurfaceSample> sampleTriangle(std::size_t i, Point<World> from, std::array<float, 2> u,
                                              double pdfArea) const {
    const Vec n = doubleAreaNormal(i);
    const double size = length(n);
    if (!(size > 0)) return {};
    const std::array<double, 2> w = toTriangle(u);
    const Vec a = corner(i, 0), b = corner(i, 1), c = corner(i, 2);
    const double rest = 1 - w[0] - w[1];
    auto sample = seen(from, a * w[0] + b * w[1] + c * rest, n * (1 / size), pdfArea);
    if (sample) sample->place = {static_cast<std::uint32_t>(i), static_cast<float>(w[1]), static_cast<float>(rest)};
    if (mesh_->uvs.empty()) return withTexture(sample, w[1], rest);
    const auto uv = [&](std::size_t k) { return mesh_->uvs[mesh_->triangles[i][k]]; };
    const auto mix = [&](float p, float q, float r) {
      return static_cast<double>(p) * w[0] + static_cast<double>(q) * w[1] + static_cast<double>(r) * rest;
    };
    return withTexture(sample, mix(uv(0).u, uv(1).u, uv(2).u), mix(uv(0).v, uv(1).v, uv(2).v));
  }
  Vec corner(std::size_t triangle, std::size_t i) const {
    return toDouble(mesh_->positions[mesh_->triangles[triangle][i]]);
  }
  Vec doubleAreaNormal(std::size_t i) const { return cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0)); }

  const accel::TriangleMesh* mesh_;
  std::vector<double> cumulative_;
  Vec centre_;
  double area_ = 0;
  float extent_ = 0;
};

/// A flat shape in the xy plane under an affine map: uniform there is uniform on its image.
class FlatLight : public LightSurface {
 public:
  FlatLight(const Transform<World, Object>& toWorld, bool flipNormals, double objectArea)
      : x_(column(toWorld.matrix(), 0)), y_(column(toWorld.matrix(), 1)), centre_(column(toWorld.matrix(), 3)) {
    // The outward normal is the image of +z as a normal: under a mirroring map it is not x × y.
    const Vec n = cross(x_, y_);
    const double size = length(n);
    const bool isMirrored = dot(n, column(toWorld.matrix(), 2)) < 0;
    area_ = objectArea * size;
    if (size > 0) normal_ = n * ((isMirrored != flipNormals ? -1 : 1) / size);
  }

  float pdf(Point<World> from, const LightHit& hit) const override {
    return static_cast<float>(toSolidAngle(1 / area_, toDouble(from), toDouble(hit.point), toDouble(hit.normal)));
  }

  double area() const override { return area_; }
  Point<World> centre() const override { return toFloat<Point<World>>(centre_); }
  float extent() const override { return static_cast<float>(std::sqrt((dot(x_, x_) + dot(y_, y_)) / 2)); }
  SurfacePart part(std::uint32_t) const override {
    const Vec half{std::fabs(x_.x) + std::fabs(y_.x), std::fabs(x_.y) + std::fabs(y_.y),
                   std::fabs(x_.z) + std::fabs(y_.z)};
    SurfacePart part{.normal = toFloat<Vector<World>>(normal_), .isFlat = true, .area = area_};
    part.box = {toFloat<Point<World>>(centre_ - half), toFloat<Point<World>>(centre_ + half)};
    return part;
  }

 protected:
  Vec x() const { return x_; }
  Vec y() const { return y_; }
  Vec middle() const { return centre_; }
  Vec outward() const { return normal_; }
  std::optional<SurfaceSample> sampleAt(Point<World> from, double x, double y) const {
    return seen(from, centre_ + x_ * x + y_ * y, normal_, 1 / area_);
  }

 private:
  Vec x_, y_, centre_, normal_;
  double area_ = 0;
};

class RectangleLight final : public FlatLight {
 public:
  RectangleLight(const Transform<World, Object>& toWorld, bool flipNormals) : FlatLight(toWorld, flipNormals, 4) {
    const double a = dot(x(), x()), b = dot(y(), y());
    isRight_ = a > 0 && b > 0 && std::fabs(dot(x(), y())) <= 1e-6 * std::sqrt(a * b);
  }

  std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const override {
    const std::optional<SphericalRectangle> seenAs = seenFrom(from);
    if (!seenAs) {
      const double x = static_cast<double>(u.place[0]), y = static_cast<double>(u.place[1]);
      return withTexture(sampleAt(from, 2 * x - 1, 2 * y - 1), x, y);
    }
    const Vec origin = toDouble(from);
    const Vec d = seenAs->sample(static_cast<double>(u.place[0]), static_cast<double>(u.place[1]));
    const double distance = length(d);
    const Vec place = origin + d - middle();
    SurfaceSample sample;
    sample.point = toFloat<Point<World>>(origin + d);
    sample.normal = toFloat<Normal<World>>(outward());
    sample.direction = toFloat<Vector<World>>(d * (1 / distance));
    sample.distance = static_cast<float>(distance);
    sample.pdf = static_cast<float>(1 / seenAs->solidAngle());
    return withTexture(sample, 0.5 + 0.5 * dot(place, x()) / dot(x(), x()),
                       0.5 + 0.5 * dot(place, y()) / dot(y(), y()));
  }

  float pdf(Point<World> from, const LightHit& hit) const override {
    const std::optional<SphericalRectangle> seenAs = seenFrom(from);
    if (!seenAs) return FlatLight::pdf(from, hit);
    return dot(toDouble(hit.direction), toDouble(hit.normal)) < 0 ? static_cast<float>(1 / seenAs->solidAngle()) : 0.0f;
  }

 private:
  /// None from behind, and where it is so small or so much edge on that its solid angle has too few digits: there
  /// points are uniform by area.
  std::optional<SphericalRectangle> seenFrom(Point<World> from) const {
    const Vec way = middle() - toDouble(from);
    if (!isRight_ || !(dot(way, outward()) < 0)) return {};
    const SphericalRectangle rectangle(way - x() - y(), x() * 2, y() * 2);
    if (!(rectangle.solidAngle() > 1e-5)) return {};
    return rectangle;
  }

  bool isRight_ = false;
};

class DiskLight final : public FlatLight {
 public:
  DiskLight(const Transform<World, Object>& toWorld, bool flipNormals)
      : FlatLight(toWorld, flipNormals, std::numbers::pi) {}

  std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const override {
    const std::array<double, 2> d = toConcentricDisk(u.place);
    return withTexture(sampleAt(from, d[0], d[1]), std::hypot(d[0], d[1]), turn(d[0], d[1]));
  }
};

class SphereLight final : public LightSurface {
 public:
  SphereLight(const Transform<World, Object>& toWorld, bool flipNormals)
      : matrix_(toWorld.matrix()), inverse_(toWorld.inverseMatrix()), flipped_(flipNormals) {
    const Vec x = column(matrix_, 0), y = column(matrix_, 1), z = column(matrix_, 2);
    centre_ = column(matrix_, 3);
    determinant_ = std::fabs(dot(x, cross(y, z)));
    radius_ = length(x);
    const double tolerance = 1e-5 * radius_ * radius_;
    const auto differs = [&](double v) { return std::fabs(v) > tolerance; };
    isRound_ = !differs(dot(x, y)) && !differs(dot(y, z)) && !differs(dot(z, x)) &&
               !differs(dot(y, y) - radius_ * radius_) && !differs(dot(z, z) - radius_ * radius_);
    area_ = isRound_ ? 4 * std::numbers::pi * radius_ * radius_ : ellipsoidArea();
  }

  std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const override {
    if (const std::optional<Cone> cone = coneFrom(from)) return withSphereTexture(sampleCone(*cone, u.place));
    const std::array<double, 3> s = toSphere(u.place);
    const Vec p{s[0], s[1], s[2]};
    const Vec n = normalFactor(p);
    const double stretch = length(n);
    return withSphereTexture(
        seen(from, column(matrix_, 0) * p.x + column(matrix_, 1) * p.y + column(matrix_, 2) * p.z + centre_,
             n * ((flipped_ ? -1 : 1) / stretch), pdfArea(stretch)));
  }

  float pdf(Point<World> from, const LightHit& hit) const override {
    const Vec origin = toDouble(from), point = toDouble(hit.point), normal = toDouble(hit.normal);
    if (const std::optional<Cone> cone = coneFrom(from)) {
      return dot(point - origin, normal) < 0 ? static_cast<float>(cone->pdf) : 0.0f;
    }
    const Vec d = point - centre_;
    const auto row = [&](std::size_t i) { return inverse_[i][0] * d.x + inverse_[i][1] * d.y + inverse_[i][2] * d.z; };
    const Vec onUnit{row(0), row(1), row(2)};
    const double stretch = length(normalFactor(onUnit)) / length(onUnit);
    return static_cast<float>(toSolidAngle(pdfArea(stretch), origin, point, normal));
  }

  double area() const override { return area_; }
  Point<World> centre() const override { return toFloat<Point<World>>(centre_); }
  float extent() const override { return static_cast<float>(std::sqrt(area_ / (4 * std::numbers::pi))); }
  SurfacePart part(std::uint32_t) const override {
    const auto half = [&](std::size_t i) {
      return std::sqrt(matrix_[i][0] * matrix_[i][0] + matrix_[i][1] * matrix_[i][1] + matrix_[i][2] * matrix_[i][2]);
    };
    const Vec halves{half(0), half(1), half(2)};
    SurfacePart part{.area = area_};
    part.box = {toFloat<Point<World>>(centre_ - halves), toFloat<Point<World>>(centre_ + halves)};
    return part;
  }

 private:
  /// The directions from a point to the sphere.
  struct Cone {
    Vec axis;  ///< Unit.
    double distance = 0;
    double oneMinusCosine = 0;  ///< Of half its angle.
    double pdf = 0;
  };

  /// The cone from a point outside a round sphere that emits outwards. 1 - cos is taken from the sine, without which
  /// a small or distant light would be lost in rounding.
  std::optional<Cone> coneFrom(Point<World> from) const {
    if (!isRound_ || flipped_) return {};
    const Vec d = centre_ - toDouble(from);
    const double squared = dot(d, d);
    if (!(squared > radius_ * radius_)) return {};
    const double distance = std::sqrt(squared);
    const double sine2 = radius_ * radius_ / squared;
    const double oneMinusCosine = sine2 / (1 + std::sqrt(1 - sine2));
    return Cone{d * (1 / distance), distance, oneMinusCosine, 1 / (2 * std::numbers::pi * oneMinusCosine)};
  }

  std::optional<SurfaceSample> sampleCone(const Cone& cone, std::array<float, 2> u) const {
    const double c = static_cast<double>(u[0]) * cone.oneMinusCosine;
    const double sine2 = c * (2 - c), phi = 2 * std::numbers::pi * static_cast<double>(u[1]);
    const double sine = std::sqrt(sine2);
    const double reach =
        cone.distance * (1 - c) - std::sqrt(std::max(0.0, radius_ * radius_ - cone.distance * cone.distance * sine2));
    const Vec helper = std::fabs(cone.axis.x) > 0.5 ? Vec{0, 1, 0} : Vec{1, 0, 0};
    const Vec side = cross(helper, cone.axis);
    const Vec x = side * (1 / length(side)), y = cross(cone.axis, x);
    const Vec direction = cone.axis * (1 - c) + x * (sine * std::cos(phi)) + y * (sine * std::sin(phi));
    const Vec outward = direction * reach - cone.axis * cone.distance;
    const Vec normal = outward * (1 / length(outward));
    SurfaceSample sample;
    sample.point = toFloat<Point<World>>(centre_ + normal * radius_);
    sample.normal = toFloat<Normal<World>>(normal);
    sample.direction = toFloat<Vector<World>>(direction * (1 / length(direction)));
    sample.distance = static_cast<float>(reach);
    sample.pdf = static_cast<float>(cone.pdf);
    return sample;
  }

  std::optional<SurfaceSample> withSphereTexture(const std::optional<SurfaceSample>& sample) const {
    if (!sample) return {};
    const Vec d = toDouble(sample->point) - centre_;
    const auto row = [&](std::size_t i) { return inverse_[i][0] * d.x + inverse_[i][1] * d.y + inverse_[i][2] * d.z; };
    const Vec p{row(0), row(1), row(2)};
    return withTexture(sample, turn(p.x, p.y), std::acos(std::clamp(p.z / length(p), -1.0, 1.0)) / std::numbers::pi);
  }

  /// The unit sphere's normal at p, mapped: its direction is the outward normal, its length the ratio in which area
  /// grows divided by |det|.
  Vec normalFactor(Vec p) const {
    const auto component = [&](std::size_t i) {
      return inverse_[0][i] * p.x + inverse_[1][i] * p.y + inverse_[2][i] * p.z;
    };
    return {component(0), component(1), component(2)};
  }
  double pdfArea(double stretch) const { return 1 / (4 * std::numbers::pi * determinant_ * stretch); }

  /// By the midpoint rule over equal areas of the unit sphere; smooth, so 64 × 64 points give 1e-5 for axes of 1 : 10.
  double ellipsoidArea() const {
    constexpr int n = 64;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double z = 2 * (i + 0.5) / n - 1, r = std::sqrt(1 - z * z), phi = 2 * std::numbers::pi * (j + 0.5) / n;
        sum += length(normalFactor({r * std::cos(phi), r * std::sin(phi), z}));
      }
    }
    return 4 * std::numbers::pi * determinant_ * sum / (n * n);
  }

  Matrix4 matrix_, inverse_;
  Vec centre_;
  double radius_ = 0, determinant_ = 0, area_ = 0;
  bool flipped_ = false, isRound_ = false;
};

class CylinderLight final : public LightSurface {
 public:
  CylinderLight(const Transform<World, Object>& toWorld, bool flipNormals)
      : matrix_(toWorld.matrix()), inverse_(toWorld.inverseMatrix()), flipped_(flipNormals) {
    const Vec x = column(matrix_, 0), y = column(matrix_, 1), z = column(matrix_, 2);
    determinant_ = std::fabs(dot(x, cross(y, z)));
    centre_ = column(matrix_, 3) + z * 0.5;
    // A circle under an affine map: smooth and periodic, so equal steps give all digits.
    constexpr int steps = 256;
    for (int i = 0; i < steps; ++i) area_ += areaFactor(normalFactor(2 * std::numbers::pi * i / steps)) / steps;
    area_ *= 2 * std::numbers::pi;
  }

  std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const override {
    const double around = static_cast<double>(u.place[0]), along = static_cast<double>(u.place[1]);
    const double angle = 2 * std::numbers::pi * around;
    const Vec p = column(matrix_, 0) * std::cos(angle) + column(matrix_, 1) * std::sin(angle) +
                  column(matrix_, 2) * along + column(matrix_, 3);
    const Vec n = normalFactor(angle);
    return withTexture(seen(from, p, n * ((flipped_ ? -1 : 1) / length(n)), density(n)), around, along);
  }

  float pdf(Point<World> from, const LightHit& hit) const override {
    const Vec d = toDouble(hit.point) - column(matrix_, 3);
    const auto row = [&](std::size_t i) { return inverse_[i][0] * d.x + inverse_[i][1] * d.y + inverse_[i][2] * d.z; };
    const Vec n = normalFactor(std::atan2(row(1), row(0)));
    return static_cast<float>(toSolidAngle(density(n), toDouble(from), toDouble(hit.point), toDouble(hit.normal)));
  }

  SurfacePart part(std::uint32_t) const override {
    SurfacePart part;
    part.area = area_;
    const Vec x = column(matrix_, 0), y = column(matrix_, 1), z = column(matrix_, 2), base = column(matrix_, 3);
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-1.0, 1.0}) {
        for (const double c : {0.0, 1.0}) part.box.extend(toFloat<Point<World>>(base + x * a + y * b + z * c));
      }
    }
    return part;
  }
  double area() const override { return area_; }
  Point<World> centre() const override { return toFloat<Point<World>>(centre_); }
  float extent() const override {
    const double radius = std::max(length(column(matrix_, 0)), length(column(matrix_, 1)));
    return static_cast<float>(std::max(radius, 0.5 * length(column(matrix_, 2))));
  }

 private:
  /// The normal there, mapped; its length times the determinant is the ratio in which area grows.
  Vec normalFactor(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {inverse_[0][0] * c + inverse_[1][0] * s, inverse_[0][1] * c + inverse_[1][1] * s,
            inverse_[0][2] * c + inverse_[1][2] * s};
  }
  double areaFactor(Vec normal) const { return determinant_ * length(normal); }
  double density(Vec normal) const { return 1 / (2 * std::numbers::pi * areaFactor(normal)); }

  Matrix4 matrix_, inverse_;
  Vec centre_;
  double determinant_ = 0, area_ = 0;
  bool flipped_ = false;
};

template <class Surface, class... Arguments>
std::unique_ptr<const LightSurface> makeWithArea(const Arguments&... arguments) {
  auto surface = std::make_unique<Surface>(arguments...);
  if (!(surface->area() > 0)) return nullptr;
  return surface;
}

}  // namespace

std::unique_ptr<const LightSurface> makeMeshLight(const accel::TriangleMesh& mesh) {
  return makeWithArea<MeshLight>(mesh);
}

std::unique_ptr<const LightSurface> makeRectangleLight(const Transform<World, Object>& toWorld, bool flipNormals) {
  return makeWithArea<RectangleLight>(toWorld, flipNormals);
}

std::unique_ptr<const LightSurface> makeDiskLight(const Transform<World, Object>& toWorld, bool flipNormals) {
  return makeWithArea<DiskLight>(toWorld, flipNormals);
}

std::unique_ptr<const LightSurface> makeCylinderLight(const Transform<World, Object>& toWorld, bool flipNormals) {
  return makeWithArea<CylinderLight>(toWorld, flipNormals);
}

std::unique_ptr<const LightSurface> makeSphereLight(const Transform<World, Object>& toWorld, bool flipNormals) {
  return makeWithArea<SphereLight>(toWorld, flipNormals);
}

}  // namespace aerosol::render
