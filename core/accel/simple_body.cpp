#include "core/accel/simple_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/accel/double3.h"
#include "core/accel/mesh_volume.h"
#include "core/accel/welded_corners.h"

namespace aerosol::accel {

namespace {

/// What rounding leaves of a product of vectors whose factors' lengths multiply to 1; generously.
constexpr double rounding = 1e-14;

struct Face {
  std::array<std::uint32_t, 3> corners{};  ///< Welded.
  std::array<Double3, 3> at{};
};

/// A direction, and the product of the lengths of what it was computed from.
struct Axis {
  Double3 direction;
  double size = 0;
};

Axis crossed(Double3 a, Double3 b) { return {cross(a, b), length(a) * length(b)}; }
Axis crossed(const Axis& a, Double3 b) { return {cross(a.direction, b), a.size * length(b)}; }

/// Does a plane across the axis keep the two sets of points strictly apart?
bool separates(const Axis& axis, std::span<const Double3> some, std::span<const Double3> others) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double reach = 0;
  const auto extent = [&](std::span<const Double3> points) {
    std::pair<double, double> range{infinity, -infinity};
    for (const Double3& p : points) {
      const double along = dot(axis.direction, p);
      range = {std::min(range.first, along), std::max(range.second, along)};
      reach = std::max(reach, length(p));
    }
    return range;
  };
  const auto [low, high] = extent(some);
  const auto [otherLow, otherHigh] = extent(others);
  const double slack = rounding * axis.size * reach;
  return otherLow - high > slack || low - otherHigh > slack;
}

/// Triangles without a common corner: convex sets are apart if and only if one of these axes tells (Gottschalk 1996).
bool areApart(const Face& a, const Face& b) {
  std::array<Double3, 3> p, q;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = a.at[i] - a.at[0];
    q[i] = b.at[i] - a.at[0];
  }
  const std::array<Double3, 3> e{p[1] - p[0], p[2] - p[1], p[0] - p[2]}, f{q[1] - q[0], q[2] - q[1], q[0] - q[2]};
  const Axis n = crossed(e[0], e[1]), m = crossed(f[0], f[1]);
  if (separates(n, p, q) || separates(m, p, q)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (separates(crossed(e[i], f[j]), p, q)) return true;
    }
    // Within a common plane.
    if (separates(crossed(n, e[i]), p, q) || separates(crossed(m, f[i]), p, q)) return true;
  }
  return false;
}

/// Sides of a plane through the origin: below, above, or too near.
int sideOf(const Axis& plane, Double3 p) {
  const double height = dot(plane.direction, p);
  const double slack = rounding * plane.size * length(p);
  return height > slack ? 1 : height < -slack ? -1 : 0;
}

/// Triangles with one common corner, the origin, meet elsewhere if and only if the wedges do that they are the tips of.
bool meetAtTheirCornerOnly(const std::array<Double3, 2>& a, const std::array<Double3, 2>& b) {
  const Axis n = crossed(a[0], a[1]), m = crossed(b[0], b[1]);
  const auto isBeside = [](const Axis& plane, const std::array<Double3, 2>& wedge) {
    return sideOf(plane, wedge[0]) * sideOf(plane, wedge[1]) > 0;
  };
  if (isBeside(n, b) || isBeside(m, a)) return true;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const Axis plane = crossed(a[i], b[j]);
      if (sideOf(plane, a[1 - i]) * sideOf(plane, b[1 - j]) < 0) return true;
    }
    // Within a common plane, along an edge of one.
    const Axis alongA = crossed(n, a[i]), alongB = crossed(m, b[i]);
    if (isBeside(alongA, b) && sideOf(alongA, a[1 - i]) * sideOf(alongA, b[0]) < 0) return true;
    if (isBeside(alongB, a) && sideOf(alongB, b[1 - i]) * sideOf(alongB, a[0]) < 0) return true;
  }
  return false;
}

/// Triangles with a common edge, from the origin, meet elsewhere only where one is folded onto the other.
bool meetAtTheirEdgeOnly(Double3 edge, Double3 a, Double3 b) {
  if (sideOf(crossed(edge, a), b) != 0) return true;
  const auto across = [&](Double3 p) { return p - edge * (dot(p, edge) / dot(edge, edge)); };
  return dot(across(a), across(b)) < 0;
}

/// Is it certain that two faces share no more than their common corners and edges?
bool meetAsNeighboursOnly(const Face& a, const Face& b) {
  std::array<std::size_t, 3> sharedA{}, sharedB{};
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a.corners[i] != b.corners[j]) continue;
      sharedA[shared] = i;
      sharedB[shared++] = j;
      break;
    }
  }
  if (shared == 0) return areApart(a, b);
  if (shared == 3) return false;
  const Double3 origin = a.at[sharedA[0]];
  const auto from = [&](const Face& face, std::size_t i) { return face.at[i % 3] - origin; };
  if (shared == 1) {
    const std::size_t i = sharedA[0], j = sharedB[0];
    return meetAtTheirCornerOnly({from(a, i + 1), from(a, i + 2)}, {from(b, j + 1), from(b, j + 2)});
  }
  return meetAtTheirEdgeOnly(from(a, sharedA[1]), from(a, 3 - sharedA[0] - sharedA[1]),
                             from(b, 3 - sharedB[0] - sharedB[1]));
}

/// Boxes around boxes around faces, to find those that may meet.
class FaceTree {
 public:
  explicit FaceTree(const std::vector<Face>& faces) : faces_(faces), order_(faces.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(faces.size());
    build(0, static_cast<std::uint32_t>(faces.size()));
  }

  bool haveOnlyNeighbours() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{{0, 0}};
    while (!pairs.empty()) {
      const auto [i, j] = pairs.back();
      pairs.pop_back();
      const Node &a = nodes_[i], &b = nodes_[j];
      if (i == j && a.isLeaf()) {
        if (!areNeighboursOnly(a, a)) return false;
      } else if (i == j) {
        pairs.insert(pairs.end(), {{i + 1, i + 1}, {a.second, a.second}, {i + 1, a.second}});
      } else if (!meet(a, b)) {
        continue;
      } else if (a.isLeaf() && b.isLeaf()) {
        if (!areNeighboursOnly(a, b)) return false;
      } else if (b.isLeaf() || (!a.isLeaf() && a.count() >= b.count())) {
        pairs.insert(pairs.end(), {{i + 1, j}, {a.second, j}});
      } else {
        pairs.insert(pairs.end(), {{i, j + 1}, {i, b.second}});
      }
    }
    return true;
  }

 private:
  static constexpr std::uint32_t leafSize = 4;
  struct Node {
    Double3 lower, upper;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t second = 0;  ///< Of an inner node the second child; the first follows it.

    std::uint32_t count() const { return end - begin; }
    bool isLeaf() const { return second == 0; }
  };

  static bool meet(const Node& a, const Node& b) {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
           a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
  }

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}, begin, end, 0};
    for (std::uint32_t i = begin; i < end; ++i) {
      for (const Double3& p : faces_[order_[i]].at) {
        node.lower = {std::min(node.lower.x, p.x), std::min(node.lower.y, p.y), std::min(node.lower.z, p.z)};
        node.upper = {std::max(node.upper.x, p.x), std::max(node.upper.y, p.y), std::max(node.upper.z, p.z)};
      }
    }
    nodes_.push_back(node);
    if (end - begin <= leafSize) return index;
    const Double3 size = node.upper - node.lower;
    const auto along = [&](std::uint32_t face) {
      const std::array<Double3, 3>& p = faces_[face].at;
      const Double3 sum = p[0] + p[1] + p[2];
      return size.x >= size.y && size.x >= size.z ? sum.x : size.y >= size.z ? sum.y : sum.z;
    };
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return along(a) < along(b); });
    build(begin, middle);
    const std::uint32_t second = build(middle, end);
    nodes_[index].second = second;
    return index;
  }

  bool areNeighboursOnly(const Node& a, const Node& b) const {
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      for (std::uint32_t j = &a == &b ? i + 1 : b.begin; j < b.end; ++j) {
        if (!meetAsNeighboursOnly(faces_[order_[i]], faces_[order_[j]])) return false;
      }
    }
    return true;
  }

  const std::vector<Face>& faces_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// How often a ray from a face crosses the others outwards, less how often inwards; none where it comes too near to an
/// edge for that to be told.
std::optional<int> windingBefore(const std::vector<Face>& faces, std::size_t index, Double3 direction) {
  const Face& from = faces[index];
  const Double3 origin = (from.at[0] + from.at[1] + from.at[2]) * (1.0 / 3);
  int winding = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (f == index) continue;
    std::array<Double3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = faces[f].at[i] - origin;
    std::array<int, 3> sides{};
    for (std::size_t i = 0; i < 3; ++i) sides[i] = sideOf(crossed(p[i], p[(i + 1) % 3]), direction);
    const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
    if (least < 0 && most > 0) continue;  // The line passes by.
    // Where the line goes through, on all sides alike, the face's normal is on that side of its direction.
    const int facing = most > 0 ? most : least;
    const int height = sideOf(crossed(p[1] - p[0], p[2] - p[0]), p[0]);
    if (least != most || facing == 0 || height == 0) return {};
    if (height != facing) continue;  // It lies behind.
    winding += facing;
  }
  return winding;
}

/// Of each part of the mesh that hangs together: its largest face.
std::vector<std::size_t> largestFaces(const std::vector<Face>& faces, std::size_t cornerCount) {
  std::vector<std::uint32_t> root(cornerCount);
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Face& face : faces) {
    root[find(face.corners[1])] = find(face.corners[0]);
    root[find(face.corners[2])] = find(face.corners[0]);
  }
  std::vector<std::pair<double, std::size_t>> largest(cornerCount, {-1.0, 0});
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::array<Double3, 3>& p = faces[f].at;
    auto& best = largest[find(faces[f].corners[0])];
    best = std::max(best, {length(cross(p[1] - p[0], p[2] - p[0])), f});
  }
  std::vector<std::size_t> found;
  for (const auto& [area, face] : largest) {
    if (area >= 0) found.push_back(face);
  }
  return found;
}

/// In front of each part nothing is inside: as no part crosses another, one place of it tells for all.
bool turnOutwards(const std::vector<Face>& faces, std::size_t cornerCount) {
  const std::vector<std::size_t> largest = largestFaces(faces, cornerCount);
  constexpr std::size_t mostTests = 1u << 28;
  if (largest.size() > mostTests / faces.size()) return false;
  return std::ranges::all_of(largest, [&](std::size_t f) {
    const std::array<Double3, 3>& p = faces[f].at;
    const Double3 normal = normalize(cross(p[1] - p[0], p[2] - p[0]));
    const Double3 edge = normalize(p[1] - p[0]), other = cross(normal, edge);
    for (int attempt = 0; attempt < 8; ++attempt) {
      const double angle = 2.4 * attempt, lean = 0.07 * attempt;
      const Double3 direction = normal + edge * (lean * std::cos(angle)) + other * (lean * std::sin(angle));
      if (const std::optional<int> winding = windingBefore(faces, f, direction)) return *winding == 0;
    }
    return false;
  });
}

}  // namespace

bool isSimpleBody(const TriangleMesh& mesh) {
  const MeshTopology topology = examine(mesh);
  if (topology.openEdges + topology.flippedEdges + topology.crowdedEdges > 0) return false;
  const std::vector<std::uint32_t> welded = weldedCorners(mesh);
  std::vector<Face> faces;
  faces.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Face face{{welded[t[0]], welded[t[1]], welded[t[2]]},
                    {toDouble(mesh.positions[t[0]]), toDouble(mesh.positions[t[1]]), toDouble(mesh.positions[t[2]])}};
    const auto [a, b, c] = face.corners;
    if (a != b && b != c && c != a) faces.push_back(face);
  }
  if (faces.empty()) return false;
  return FaceTree(faces).haveOnlyNeighbours() && turnOutwards(faces, welded.size());
}

}  // namespace aerosol::accel
