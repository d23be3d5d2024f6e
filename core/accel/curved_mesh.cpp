#include "core/accel/curved_mesh.h"

#include <cmath>
#include <numbers>

#include "core/accel/double3.h"

namespace aerosol::accel {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t sectors = 16, rows = 8;

/// The angle of (x, y) as a fraction of a turn, in the turn that `near` is in.
double turnNear(double x, double y, double near) {
  const double turn = std::atan2(y, x) / (2 * pi);
  return turn + std::round(near - turn);
}

/// A point of the unit circle; the last one of a round is the first one.
std::array<double, 2> onCircle(std::uint32_t sector) {
  const double angle = 2 * pi * (sector % sectors) / sectors;
  return {std::cos(angle), std::sin(angle)};
}

std::uint32_t addVertex(TriangleMesh& mesh, Double3 point, Double3 normal, double u, double v) {
  mesh.positions.push_back(toFloat<Point<World>>(point));
  mesh.normals.push_back(toFloat<Normal<World>>(normal));
  mesh.uvs.push_back({static_cast<float>(u), static_cast<float>(v)});
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

/// The shape's normal on the side of the mean of both neighbours: it may have been flipped.
void setNormal(TriangleMesh& mesh, std::uint32_t vertex, Double3 normal) {
  const Double3 mean = toDouble(mesh.normals[vertex]);
  mesh.normals[vertex] = toFloat<Normal<World>>(dot(mean, normal) < 0 ? -normal : normal);
}

void bendSphere(TriangleMesh& mesh, std::uint32_t vertex, std::uint32_t, std::uint32_t) {
  const Double3 p = normalize(toDouble(mesh.positions[vertex]));
  mesh.positions[vertex] = toFloat<Point<World>>(p);
  setNormal(mesh, vertex, p);
  TexCoord& uv = mesh.uvs[vertex];
  uv.u = static_cast<float>(turnNear(p.x, p.y, static_cast<double>(uv.u)));
  uv.v = static_cast<float>(std::acos(std::clamp(p.z, -1.0, 1.0)) / pi);
}

void bendDisk(TriangleMesh& mesh, std::uint32_t vertex, std::uint32_t a, std::uint32_t b) {
  Double3 p = toDouble(mesh.positions[vertex]);
  TexCoord& uv = mesh.uvs[vertex];
  const bool isRim = mesh.uvs[a].u == 1 && mesh.uvs[b].u == 1;
  if (isRim) p = normalize(p);
  mesh.positions[vertex] = toFloat<Point<World>>(p);
  uv.u = isRim ? 1 : static_cast<float>(length(p));
  uv.v = static_cast<float>(turnNear(p.x, p.y, static_cast<double>(uv.v)));
}

void bendCylinder(TriangleMesh& mesh, std::uint32_t vertex, std::uint32_t, std::uint32_t) {
  const Double3 p = toDouble(mesh.positions[vertex]);
  const Double3 outward = normalize({p.x, p.y, 0});
  mesh.positions[vertex] = toFloat<Point<World>>({outward.x, outward.y, p.z});
  setNormal(mesh, vertex, outward);
  TexCoord& uv = mesh.uvs[vertex];
  uv.u = static_cast<float>(turnNear(p.x, p.y, static_cast<double>(uv.u)));
}

}  // namespace

CurvedMesh makeSphereMesh() {
  TriangleMesh mesh;
  std::array<std::array<std::uint32_t, sectors + 1>, rows + 1> vertices{};
  for (std::uint32_t row = 0; row <= rows; ++row) {
    const bool isPole = row == 0 || row == rows;
    const double theta = pi * row / rows, z = isPole ? (row == 0 ? 1 : -1) : std::cos(theta);
    const double rho = isPole ? 0 : std::sin(theta);
    for (std::uint32_t sector = 0; sector <= sectors; ++sector) {
      if (isPole && sector == sectors) continue;
      const auto [x, y] = onCircle(sector);
      const Double3 p{isPole ? 0 : rho * x, isPole ? 0 : rho * y, z};
      const double u = (sector + (isPole ? 0.5 : 0.0)) / sectors;
      vertices[row][sector] = addVertex(mesh, p, p, u, static_cast<double>(row) / rows);
    }
  }
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const auto &above = vertices[row], &below = vertices[row + 1];
      if (row + 1 < rows) mesh.triangles.push_back({above[s], below[s], below[s + 1]});
      if (row > 0) mesh.triangles.push_back({above[s], row + 1 < rows ? below[s + 1] : below[s], above[s + 1]});
    }
  }
  return {std::move(mesh), bendSphere};
}

CurvedMesh makeDiskMesh() {
  TriangleMesh mesh;
  std::array<std::uint32_t, sectors + 1> rim{};
  const Double3 up{0, 0, 1};
  for (std::uint32_t s = 0; s <= sectors; ++s) {
    const auto [x, y] = onCircle(s);
    rim[s] = addVertex(mesh, {x, y, 0}, up, 1, static_cast<double>(s) / sectors);
  }
  for (std::uint32_t s = 0; s < sectors; ++s) {
    const std::uint32_t middle = addVertex(mesh, {0, 0, 0}, up, 0, (s + 0.5) / sectors);
    mesh.triangles.push_back({middle, rim[s], rim[s + 1]});
  }
  return {std::move(mesh), bendDisk};
}

CurvedMesh makeCylinderMesh() {
  TriangleMesh mesh;
  std::array<std::array<std::uint32_t, sectors + 1>, 2> vertices{};
  for (std::uint32_t end = 0; end < 2; ++end) {
    for (std::uint32_t s = 0; s <= sectors; ++s) {
      const auto [x, y] = onCircle(s);
      vertices[end][s] = addVertex(mesh, {x, y, static_cast<double>(end)}, {x, y, 0}, static_cast<double>(s) / sectors,
                                   static_cast<double>(end));
    }
  }
  for (std::uint32_t s = 0; s < sectors; ++s) {
    mesh.triangles.push_back({vertices[0][s], vertices[0][s + 1], vertices[1][s + 1]});
    mesh.triangles.push_back({vertices[0][s], vertices[1][s + 1], vertices[1][s]});
  }
  return {std::move(mesh), bendCylinder};
}

}  // namespace aerosol::accel
