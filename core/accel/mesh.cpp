#include "core/accel/mesh.h"

#include <utility>

#include "core/accel/double3.h"

namespace aerosol::accel {

namespace {

bool isFinite(Point<World> p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void swapWinding(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

/// The angle at `corner` between the directions to `a` and `b`; 0 in a degenerate triangle.
double angleAt(Double3 corner, Double3 a, Double3 b) {
  const Double3 u = normalize(a - corner), v = normalize(b - corner);
  return std::atan2(length(cross(u, v)), dot(u, v));
}

/// Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets" (1998): a vertex normal is the sum of its
/// faces' unit normals weighted by the angle each face spans at the vertex, so it does not depend on how faces are
/// split.
void computeVertexNormals(TriangleMesh& mesh) {
  std::vector<Double3> sums(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    const Double3 corners[3] = {toDouble(mesh.positions[triangle[0]]), toDouble(mesh.positions[triangle[1]]),
                                toDouble(mesh.positions[triangle[2]])};
    const Double3 normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = angleAt(corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
      sums[triangle[i]] = sums[triangle[i]] + normal * angle;
    }
  }
  mesh.normals.reserve(sums.size());
  for (const Double3 sum : sums) mesh.normals.push_back(toFloat<Normal<World>>(normalize(sum)));
}

}  // namespace

std::optional<std::string> findDefect(const TriangleMesh& mesh) {
  const std::size_t count = mesh.positions.size();
  if (count > 0xFFFFFFFFu || mesh.triangles.size() > 0xFFFFFFFFu) return "a mesh holds at most 2^32 - 1 vertices";
  const auto checkLength = [&](std::size_t length, const char* what) -> std::optional<std::string> {
    if (length == 0 || length == count) return {};
    return "the mesh has " + std::to_string(count) + " positions but " + std::to_string(length) + " " + what;
  };
  if (auto defect = checkLength(mesh.normals.size(), "normals")) return defect;
  if (auto defect = checkLength(mesh.uvs.size(), "texture coordinates")) return defect;
  for (const MeshAttribute& attribute : mesh.attributes) {
    const std::size_t places = attribute.isPerFace ? mesh.triangles.size() : count;
    if (attribute.channels >= 1 && attribute.channels <= 4 &&
        attribute.values.size() == places * static_cast<std::size_t>(attribute.channels)) {
      continue;
    }
    return "the attribute '" + attribute.name + "' of the mesh has " + std::to_string(attribute.values.size()) +
           " numbers for " + std::to_string(places) + (attribute.isPerFace ? " triangles" : " positions");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!isFinite(mesh.positions[i])) return "position " + std::to_string(i) + " of the mesh is not finite";
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner < count) continue;
      return "triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) + ", but the mesh has " +
             std::to_string(count);
    }
  }
  return {};
}

std::array<float, 4> valueAt(const TriangleMesh& mesh, const MeshAttribute& attribute, const MeshPlace& place) {
  std::array<float, 4> values{};
  const auto channels = static_cast<std::size_t>(attribute.channels);
  const auto& corners = mesh.triangles[place.triangle];
  for (std::size_t c = 0; c < channels; ++c) {
    const auto at = [&](std::size_t index) { return attribute.values[index * channels + c]; };
    values[c] = attribute.isPerFace ? at(place.triangle)
                                    : at(corners[0]) * (1 - place.b1 - place.b2) + at(corners[1]) * place.b1 +
                                          at(corners[2]) * place.b2;
  }
  return values;
}

void resolveNormals(TriangleMesh& mesh) {
  if (mesh.faceNormals) {
    mesh.normals.clear();
  } else if (mesh.normals.empty()) {
    computeVertexNormals(mesh);
  }
  if (mesh.flipNormals) {
    swapWinding(mesh);
    for (auto& n : mesh.normals) n = -n;
  }
  mesh.faceNormals = mesh.flipNormals = false;
}

void windByNormals(TriangleMesh& mesh) {
  if (mesh.normals.empty()) return;
  for (auto& triangle : mesh.triangles) {
    const Double3 a = toDouble(mesh.positions[triangle[0]]);
    const Double3 outside = cross(toDouble(mesh.positions[triangle[1]]) - a, toDouble(mesh.positions[triangle[2]]) - a);
    const auto opposes = [&](std::uint32_t corner) { return dot(outside, toDouble(mesh.normals[corner])) < 0; };
    if (opposes(triangle[0]) && opposes(triangle[1]) && opposes(triangle[2])) std::swap(triangle[1], triangle[2]);
  }
}

void transformMesh(TriangleMesh& mesh, const Transform<World, Object>& toWorld) {
  const Matrix4 &forward = toWorld.matrix(), &inverse = toWorld.inverseMatrix();
  for (auto& p : mesh.positions) p = toFloat<Point<World>>(mapPoint(forward, toDouble(p)));
  for (auto& n : mesh.normals) n = toFloat<Normal<World>>(normalize(mapNormal(inverse, toDouble(n))));
  if (linearDeterminant(forward) < 0) swapWinding(mesh);
}

TriangleMesh makeRectangle(const Transform<World, Object>& toWorld) {
  TriangleMesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, Normal<World>(0, 0, 1));
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  transformMesh(mesh, toWorld);
  return mesh;
}

namespace {

/// The texture coordinates of a point of the cube, on the face across `axis` at `side`: as Mitsuba lays them, which
/// keeps pictures upright nowhere but is what its scenes are made for.
TexCoord onCube(int axis, float side, Point<World> p) {
  const auto part = [](float x) { return 0.5f * (x + 1); };
  if (axis == 0) return {part(p.y), part(side > 0 ? -p.z : p.z)};
  if (axis == 1) return side > 0 ? TexCoord{part(-p.x), part(-p.z)} : TexCoord{part(p.z), part(p.x)};
  return {part(side > 0 ? p.y : -p.y), part(p.x)};
}

}  // namespace

TriangleMesh makeCube(const Transform<World, Object>& toWorld) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      Vector<World> normal, u, v;
      normal[axis] = side;
      u[(axis + 1) % 3] = side;
      v[(axis + 2) % 3] = 1;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const TexCoord uv : {TexCoord{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        mesh.positions.push_back(Point<World>() + normal + u * (2 * uv.u - 1) + v * (2 * uv.v - 1));
        mesh.normals.emplace_back(normal);
        mesh.uvs.push_back(onCube(axis, side, mesh.positions.back()));
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  transformMesh(mesh, toWorld);
  return mesh;
}

}  // namespace aerosol::accel
