#include "core/app/doctor/mesh_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace aerosol::app {

namespace {

using Corner = std::array<float, 3>;
using Place = std::array<double, 3>;

Corner cornerOf(Point<World> p) { return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; }

/// Indices of positions with equal places made equal.
std::vector<std::uint32_t> weld(const accel::TriangleMesh& mesh) {
  std::map<Corner, std::uint32_t> known;
  std::vector<std::uint32_t> welded;
  welded.reserve(mesh.positions.size());
  for (const Point<World>& p : mesh.positions) {
    welded.push_back(known.emplace(cornerOf(p), static_cast<std::uint32_t>(known.size())).first->second);
  }
  return welded;
}

struct EdgeUse {
  int forward = 0, backward = 0;
  Point<World> at;
};

Point<World> middle(Point<World> a, Point<World> b) { return a + 0.5f * (b - a); }

Place placeOf(Point<World> p) { return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)}; }
Place minus(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double product(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Place crossed(const Place& a, const Place& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Face {
  std::size_t mesh = 0;
  std::array<Place, 3> corners;
  Place normal;       ///< Unit length, first component that is not zero positive.
  double offset = 0;  ///< normal · p on the plane.
};

std::optional<Face> faceOf(std::size_t index, const accel::TriangleMesh& mesh,
                           const std::array<std::uint32_t, 3>& triangle) {
  Face face{index, {}, {}, 0};
  for (std::size_t k = 0; k < 3; ++k) face.corners[k] = placeOf(mesh.positions[triangle[k]]);
  Place n = crossed(minus(face.corners[1], face.corners[0]), minus(face.corners[2], face.corners[0]));
  const double length = std::sqrt(product(n, n));
  if (!(length > 0)) return {};
  const double sign = std::fabs(n[0]) > 1e-6 * length ? n[0] : std::fabs(n[1]) > 1e-6 * length ? n[1] : n[2];
  for (double& c : n) c /= std::copysign(length, sign);
  face.normal = n;
  face.offset = product(n, face.corners[0]);
  return face;
}

/// Whether the insides of two coplanar triangles overlap: no edge of either separates them (separating axes).
bool overlap(const Face& a, const Face& b) {
  const auto separates = [](const Face& x, const Face& y, const Place& axis) {
    double lowX = 1e300, highX = -1e300, lowY = 1e300, highY = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const double p = product(axis, x.corners[k]), q = product(axis, y.corners[k]);
      lowX = std::min(lowX, p);
      highX = std::max(highX, p);
      lowY = std::min(lowY, q);
      highY = std::max(highY, q);
    }
    const double rounding = 1e-6 * std::max(highX - lowX, highY - lowY);
    return highX <= lowY + rounding || highY <= lowX + rounding;
  };
  for (const Face* face : {&a, &b}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place axis = crossed(face->normal, minus(face->corners[(k + 1) % 3], face->corners[k]));
      if (separates(a, b, axis)) return false;
    }
  }
  return true;
}

}  // namespace

MeshDefects checkMesh(const accel::TriangleMesh& mesh) {
  const std::vector<std::uint32_t> welded = weld(mesh);
  std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse> edges;
  std::set<std::array<std::uint32_t, 3>> triangles;
  MeshDefects defects;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::uint32_t, 3> corners{welded[triangle[0]], welded[triangle[1]], welded[triangle[2]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      ++defects.degenerate;
      continue;
    }
    std::array<std::uint32_t, 3> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    if (!triangles.insert(sorted).second) {
      if (defects.doubled++ == 0) defects.doubledAt = mesh.positions[triangle[0]];
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      EdgeUse& use = edges[std::minmax(a, b)];
      ++(a < b ? use.forward : use.backward);
      use.at = middle(mesh.positions[triangle[k]], mesh.positions[triangle[(k + 1) % 3]]);
    }
  }
  for (const auto& [edge, use] : edges) {
    const int count = use.forward + use.backward;
    const auto note = [&](std::size_t& counter, std::optional<Point<World>>& place) {
      if (counter++ == 0) place = use.at;
    };
    if (count == 1) note(defects.openEdges, defects.openAt);
    if (count > 2) note(defects.crowdedEdges, defects.crowdedAt);
    if (count == 2 && use.forward != use.backward) note(defects.turnedEdges, defects.turnedAt);
  }
  return defects;
}

std::vector<CoincidentFaces> findCoincidentFaces(const std::vector<const accel::TriangleMesh*>& meshes) {
  std::vector<Face> faces;
  double size = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (!meshes[i]) continue;
    for (const auto& triangle : meshes[i]->triangles) {
      if (auto face = faceOf(i, *meshes[i], triangle)) faces.push_back(*face);
    }
    for (const Point<World>& p : meshes[i]->positions) {
      for (const double c : placeOf(p)) size = std::max(size, std::fabs(c));
    }
  }
  const double tolerance = 1e-6 * std::max(size, 1e-30);
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.offset < b.offset; });
  std::vector<CoincidentFaces> found;
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size() && faces[j].offset - faces[i].offset <= tolerance; ++j) {
      const Face &a = faces[i], &b = faces[j];
      if (a.mesh == b.mesh || product(a.normal, b.normal) < 1 - 1e-10) continue;
      const auto pair = std::minmax(a.mesh, b.mesh);
      if (pairs.contains(pair) || !overlap(a, b)) continue;
      pairs.insert(pair);
      const Place& c = a.corners[0];
      found.push_back(
          {pair.first, pair.second, {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])}});
    }
  }
  return found;
}

}  // namespace aerosol::app
