#include "core/render/preparation/displacement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/accel/double3.h"
#include "core/render/preparation/displacement_run.h"
#include "core/render/scene_attributes.h"

namespace aerosol::render {

namespace {

constexpr std::size_t mostTriangles = std::size_t{1} << 24;
/// An edge is halved no more often; 2^32 is more than floats tell apart.
constexpr int mostPasses = 32;

/// The longest that edges may be.
class EdgeTarget {
 public:
  EdgeTarget(const Preparation& state, const scene::Tessellation& tessellation)
      : edgeLength_(tessellation.edgeLength), view_(state.scene->camera->view()) {
    const Camera& camera = *state.scene->camera;
    const Transform<World, aerosol::Camera> toWorld = camera.toWorld(state.scene->shutter.open);
    toCamera_ = toWorld.inverse();
    isOrthographic_ = camera.isOrthographic();
    nearClip_ = camera.nearClip();
    const double across = isOrthographic_ ? static_cast<double>(length(toWorld(Vector<aerosol::Camera>(1, 0, 0)))) : 1;
    pixel_ = across * (view_.x1 - view_.x0) / camera.projection().width * static_cast<double>(tessellation.edgePixels);
  }

  /// World units, near a point. It changes slowly from place to place: otherwise edges between a fine and a coarse
  /// region would be halved without end.
  double at(Point<World> point) const {
    if (edgeLength_) return static_cast<double>(*edgeLength_);
    const Point<aerosol::Camera> p = toCamera_(point);
    const double x = static_cast<double>(p.x), y = static_cast<double>(p.y), z = static_cast<double>(p.z);
    const double distance = isOrthographic_ ? 1 : std::fmax(std::sqrt(x * x + y * y + z * z), nearClip_);
    // Outside of the picture only shadows and reflections are seen.
    constexpr double outside = 8, margin = 0.25;
    const double away = std::fmax(std::fmax(beyond(view_.x0, -1, x, z), beyond(view_.x1, 1, x, z)),
                                  std::fmax(beyond(view_.y0, -1, y, z), beyond(view_.y1, 1, y, z)));
    const double scale = isOrthographic_ ? view_.x1 - view_.x0 : distance;
    const double coarse = std::fmin(std::fmax(away / (margin * scale), 0), 1);
    return pixel_ * distance * (1 + (outside - 1) * coarse);
  }

 private:
  /// How far a point is beyond a side of the view, of which `end` is the place at distance 1.
  double beyond(double end, double sign, double x, double z) const {
    return isOrthographic_ ? sign * (x - end) : sign * (x - end * z) / std::sqrt(1 + end * end);
  }

  std::optional<float> edgeLength_;
  Camera::View view_;
  Transform<aerosol::Camera, World> toCamera_;
  bool isOrthographic_ = false;
  double nearClip_ = 0, pixel_ = 0;
};

/// One shape's mesh, refined and displaced by turns: what decides about an edge is how long it is once displaced.
class DisplacedMesh {
 public:
  DisplacedMesh(Preparation& state, std::size_t index, UndisplacedMesh base)
      : state_(state),
        index_(index),
        shape_(state.description.shapes[index]),
        displacement_(state.description.displacements[*shape_.displacement]),
        shader_(*state.displacements[index]),
        target_(state, displacement_.tessellation),
        toWorld_(base.toWorld),
        isFlat_(base.mesh.faceNormals),
        refined_(prepared(std::move(base.mesh)), std::move(base.bend)) {}

  Result<accel::TriangleMesh> run() {
    const auto& interface = state_.scene->shading.family(shader_).kernel(shading::Variant::displacement).interface();
    needsTangents_ = interface.reads(lang::Global::dPdu) || interface.reads(lang::Global::dPdv) ||
                     interface.reads(lang::Global::dPdx) || interface.reads(lang::Global::dPdy) ||
                     interface.reads(lang::Global::dudx) || interface.reads(lang::Global::dvdy) ||
                     interface.reads(lang::Global::flipHandedness);
    if (displacement_.tessellation.levels) findSpacing();
    displaceNew();
    const std::optional<int> levels = displacement_.tessellation.levels;
    for (int pass = 0; pass < levels.value_or(mostPasses); ++pass) {
      const auto isTooLong = [&](std::uint32_t a, std::uint32_t b) { return levels || isLong(a, b); };
      if (levels && refined_.mesh().triangles.size() * 4 > mostTriangles) return tooMany();
      if (refined_.halve(isTooLong) == 0) break;
      if (refined_.mesh().triangles.size() > mostTriangles) return tooMany();
      displaceNew();
    }
    if (unsound_ > 0) warnOfUnsound();
    return finish();
  }

 private:
  /// With the normals that the shader is to find, in the shape's own space.
  static accel::TriangleMesh prepared(accel::TriangleMesh mesh) {
    if (mesh.faceNormals) mesh.normals.clear();
    mesh.faceNormals = false;
    accel::resolveNormals(mesh);
    return mesh;
  }

  Point<World> baseAt(std::uint32_t vertex) const {
    const Point<World> p = refined_.mesh().positions[vertex];
    return toWorld_(Point<Object>(p.x, p.y, p.z));
  }

  static double distance(Point<World> a, Point<World> b) { return length(accel::toDouble(a) - accel::toDouble(b)); }
  static double length(accel::Double3 v) { return accel::length(v); }

  /// Where displacement jumps, edges grow no shorter: those of the surface as it was decide when it is enough.
  bool isLong(std::uint32_t a, std::uint32_t b) const {
    constexpr double jump = 1.0 / 16;
    const Point<World> p = points_[a], q = points_[b];
    const double most = std::fmin(target_.at(p), target_.at(q));
    return distance(p, q) > most && distance(baseAt(a), baseAt(b)) > most * jump;
  }

  /// Between vertices once all edges have been halved: a mean over the mesh.
  void findSpacing() {
    const accel::TriangleMesh& mesh = refined_.mesh();
    double sum = 0;
    for (const auto& t : mesh.triangles) {
      for (std::size_t i = 0; i < 3; ++i) sum += distance(baseAt(t[i]), baseAt(t[(i + 1) % 3]));
    }
    const auto edges = static_cast<double>(std::max<std::size_t>(3 * mesh.triangles.size(), 1));
    spacing_ = std::ldexp(sum / edges, -*displacement_.tessellation.levels);
  }

  double spacingAt(std::uint32_t vertex) const {
    return displacement_.tessellation.levels ? spacing_ : target_.at(baseAt(vertex));
  }

  struct Tangents {
    accel::Double3 u, v;
    double weight = 0;
  };

  /// Derivatives of position by texture coordinates at the vertices from `first` on, weighted by area; without
  /// coordinates there are none, and a frame of the normal stands for them.
  std::vector<Tangents> tangents(std::uint32_t first) const {
    const accel::TriangleMesh& mesh = refined_.mesh();
    std::vector<Tangents> sums(mesh.positions.size() - first);
    if (!needsTangents_) return sums;
    for (std::size_t t = refined_.firstNewTriangle(); t < mesh.triangles.size() && !mesh.uvs.empty(); ++t) {
      const auto& c = mesh.triangles[t];
      const accel::Double3 origin = accel::toDouble(baseAt(c[0]));
      const accel::Double3 e1 = accel::toDouble(baseAt(c[1])) - origin, e2 = accel::toDouble(baseAt(c[2])) - origin;
      const auto change = [&](std::size_t i, float accel::TexCoord::* part) {
        return static_cast<double>(mesh.uvs[c[i]].*part) - static_cast<double>(mesh.uvs[c[0]].*part);
      };
      const double du1 = change(1, &accel::TexCoord::u), dv1 = change(1, &accel::TexCoord::v);
      const double du2 = change(2, &accel::TexCoord::u), dv2 = change(2, &accel::TexCoord::v);
      const double determinant = du1 * dv2 - dv1 * du2;
      if (determinant == 0) continue;
      const double area = length(cross(e1, e2)), weight = area / determinant;
      for (const std::uint32_t corner : c) {
        if (corner < first) continue;
        Tangents& sum = sums[corner - first];
        sum.u = sum.u + (e1 * dv2 - e2 * dv1) * weight;
        sum.v = sum.v + (e2 * du1 - e1 * du2) * weight;
        sum.weight += area;
      }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
      Tangents& sum = sums[i];
      const Frame<World> frame(normalAt(first + static_cast<std::uint32_t>(i)).vector());
      sum.u = sum.weight > 0 ? sum.u * (1 / sum.weight) : accel::toDouble(frame.x);
      sum.v = sum.weight > 0 ? sum.v * (1 / sum.weight) : accel::toDouble(frame.y);
    }
    return sums;
  }

  Normal<World> normalAt(std::uint32_t vertex) const {
    const accel::Double3 n = accel::toDouble(refined_.mesh().normals[vertex]);
    return accel::toFloat<Normal<World>>(accel::normalize(accel::mapNormal(toWorld_.inverseMatrix(), n)));
  }

  /// Lets the shader move the vertices that are new. Those at one place go to the mean of where it sends them.
  void displaceNew() {
    const auto first = static_cast<std::uint32_t>(points_.size());
    const accel::TriangleMesh& mesh = refined_.mesh();
    const auto end = static_cast<std::uint32_t>(mesh.positions.size());
    std::vector<DisplacementVertex> vertices(end - first);
    const std::vector<Tangents> frames = tangents(first);
    for (std::uint32_t i = first; i < end; ++i) {
      DisplacementVertex& vertex = vertices[i - first];
      vertex.point = baseAt(i);
      vertex.normal = normalAt(i);
      vertex.dPdu = accel::toFloat<Vector<World>>(frames[i - first].u);
      vertex.dPdv = accel::toFloat<Vector<World>>(frames[i - first].v);
      if (!mesh.uvs.empty()) {
        vertex.u = mesh.uvs[i].u;
        vertex.v = mesh.uvs[i].v;
      }
      vertex.spacing = static_cast<float>(needsTangents_ ? spacingAt(i) : 0);
    }
    if (!mesh.attributes.empty()) {
      for (std::size_t t = refined_.firstNewTriangle(); t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t corner = mesh.triangles[t][k];
          if (corner >= first)
            vertices[corner - first].place = {static_cast<std::uint32_t>(t), k == 1 ? 1.0f : 0.0f,
                                              k == 2 ? 1.0f : 0.0f};
        }
      }
    }
    const PathId path{-1, -1, static_cast<std::uint32_t>(index_)};
    const std::vector<DisplacedVertex> displaced = runDisplacement(*state_.scene, shader_, mesh, vertices, path, first);
    for (std::size_t i = 0; i < displaced.size(); ++i) keep(vertices[i], displaced[i]);
    join(first);
  }

  void keep(const DisplacementVertex& before, const DisplacedVertex& after) {
    const Point<World> p = after.point;
    const bool isSound = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    if (!isSound && unsound_++ == 0) firstUnsound_ = before.point;
    points_.push_back(isSound ? p : before.point);
    const Normal<World> n = after.normal;
    writesNormals_ = writesNormals_ || n.x != before.normal.x || n.y != before.normal.y || n.z != before.normal.z;
    normals_.push_back(n);
  }

  void join(std::uint32_t first) {
    std::unordered_map<std::uint32_t, std::pair<accel::Double3, int>> sums;
    const auto end = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = first; i < end; ++i) {
      if (!refined_.isShared(i)) continue;
      auto& [sum, count] = sums[refined_.placeOf(i)];
      sum = sum + accel::toDouble(points_[i]);
      ++count;
    }
    for (std::uint32_t i = first; i < end; ++i) {
      if (!refined_.isShared(i)) continue;
      const auto& [sum, count] = sums.at(refined_.placeOf(i));
      points_[i] = accel::toFloat<Point<World>>(sum * (1.0 / count));
    }
  }

  Result<accel::TriangleMesh> finish() {
    const auto placeOf = [places = places()](std::uint32_t i) { return places[i]; };
    accel::TriangleMesh mesh = std::move(refined_).take();
    const std::vector<Normal<World>> before = std::move(mesh.normals);
    mesh.normals.clear();
    mesh.positions = std::move(points_);
    if (accel::linearDeterminant(toWorld_.matrix()) < 0) {
      for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
    mesh.faceNormals = isFlat_;
    if (isFlat_) return mesh;
    if (writesNormals_) {
      for (Normal<World>& n : normals_) n = accel::toFloat<Normal<World>>(accel::normalize(accel::toDouble(n)));
      mesh.normals = std::move(normals_);
    } else {
      accel::computeJoinedNormals(mesh, before, placeOf);
    }
    return mesh;
  }

  std::vector<std::uint32_t> places() const {
    std::vector<std::uint32_t> places(refined_.mesh().positions.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = refined_.placeOf(i);
    return places;
  }

  Diagnostic tooMany() const {
    return {Severity::error,
            displacement_.shader.origin.location,
            fmt::format("displaced so finely this shape has more than {} triangles", mostTriangles),
            {},
            {"give the displacement an 'edge_length', fewer 'levels' or more 'edge_pixels'"}};
  }

  void warnOfUnsound() const {
    const Point<World> p = firstUnsound_;
    state_.warnings.warning(
        displacement_.shader.origin.location,
        fmt::format("displacement '{}' moves {} of {} vertices to nowhere (NaN or infinite): they stay where they were",
                    displacement_.shader.name, unsound_, points_.size()),
        {fmt::format("the first one at ({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z),
         "a division by 0, or a root or logarithm of a negative number: bound what it is taken of"});
  }

  Preparation& state_;
  std::size_t index_;
  const scene::Shape& shape_;
  const scene::Displacement& displacement_;
  shading::InstanceRef shader_;
  EdgeTarget target_;
  Transform<World, Object> toWorld_;
  bool isFlat_;
  accel::RefinedMesh refined_;
  bool needsTangents_ = false;
  double spacing_ = 0;  ///< Where edges have no target.
  std::vector<Point<World>> points_;
  std::vector<Normal<World>> normals_;
  bool writesNormals_ = false;
  std::size_t unsound_ = 0;
  Point<World> firstUnsound_;
};

/// A shape that is blurred has the form of one instant.
void warnOfTime(Preparation& state, const scene::Displacement& displacement, shading::InstanceRef shader) {
  const auto& interface = state.scene->shading.family(shader).kernel(shading::Variant::displacement).interface();
  if (state.scene->shutter.isInstant() || !interface.reads(lang::Global::time)) return;
  state.warnings.warning(
      displacement.shader.origin.location,
      fmt::format("displacement '{}' reads the time: the surface keeps the form that it has when "
                  "the shutter opens",
                  displacement.shader.name),
      {"only transforms blur it: an <animation> moves the shape, or leave the time out of the shader"});
}

}  // namespace

void bindDisplacements(Preparation& state) {
  for (const scene::Shape& shape : state.description.shapes) {
    state.displacements.emplace_back();
    if (!shape.displacement) continue;
    auto bound =
        bindShader(state.description.displacements[*shape.displacement].shader, "displacement",
                   state.atOpening(shape.toWorld), state.shaderSources(), state.scene->shading, state.warnings);
    if (bound) {
      state.displacements.back() = *bound;
    } else {
      state.appendNew(bound.errors());
    }
  }
}

Result<accel::TriangleMesh> displaceMesh(Preparation& state, std::size_t index, UndisplacedMesh base) {
  const scene::Shape& shape = state.description.shapes[index];
  if (const auto defect = accel::findDefect(base.mesh)) return Diagnostic{.message = *defect};
  const shading::InstanceRef shader = *state.displacements[index];
  state.scene->shading.describeObject(shader, describeObject(shape.origin, shape.attributes, state.scene->attributes),
                                      0);
  warnOfTime(state, state.description.displacements[*shape.displacement], shader);
  return DisplacedMesh(state, index, std::move(base)).run();
}

}  // namespace aerosol::render
