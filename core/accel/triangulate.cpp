#include "core/accel/triangulate.h"

#include "core/accel/double3.h"

namespace aerosol::accel {

namespace {

struct Flat {
  double x = 0, y = 0;
};

/// Twice the signed area of a triangle; positive when it turns counter-clockwise.
double turnOf(Flat a, Flat b, Flat c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Newell's normal: the sum of cross products around the polygon; its length is twice the area.
Double3 newellNormal(std::span<const Point<World>> corners) {
  Double3 normal;
  const Double3 origin = toDouble(corners[0]);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Double3 a = toDouble(corners[i]) - origin;
    const Double3 b = toDouble(corners[(i + 1) % corners.size()]) - origin;
    normal = normal + cross(a, b);
  }
  return normal;
}

/// The polygon seen along its normal's largest component, turning counter-clockwise.
std::vector<Flat> flatten(std::span<const Point<World>> corners) {
  const Double3 n = newellNormal(corners);
  const Double3 size{std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
  std::vector<Flat> flat;
  flat.reserve(corners.size());
  for (const auto& corner : corners) {
    const Double3 p = toDouble(corner);
    if (size.x >= size.y && size.x >= size.z) {
      flat.push_back(n.x > 0 ? Flat{p.y, p.z} : Flat{p.z, p.y});
    } else if (size.y >= size.z) {
      flat.push_back(n.y > 0 ? Flat{p.z, p.x} : Flat{p.x, p.z});
    } else {
      flat.push_back(n.z > 0 ? Flat{p.x, p.y} : Flat{p.y, p.x});
    }
  }
  return flat;
}

bool isConvex(const std::vector<Flat>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turnOf(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]) < 0) return false;
  }
  return true;
}

/// Whether the corner between `previous` and `next` can be cut off: it turns left and no other corner is in its
/// triangle.
bool isEar(const std::vector<Flat>& polygon, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const std::uint32_t ia = left[(i + n - 1) % n], ib = left[i], ic = left[(i + 1) % n];
  const Flat a = polygon[ia], b = polygon[ib], c = polygon[ic];
  if (turnOf(a, b, c) <= 0) return false;
  for (const std::uint32_t other : left) {
    if (other == ia || other == ib || other == ic) continue;
    const Flat p = polygon[other];
    const bool isCorner = (p.x == a.x && p.y == a.y) || (p.x == b.x && p.y == b.y) || (p.x == c.x && p.y == c.y);
    if (!isCorner && turnOf(a, b, p) >= 0 && turnOf(b, c, p) >= 0 && turnOf(c, a, p) >= 0) return false;
  }
  return true;
}

}  // namespace

// Ear clipping (Meisters, "Polygons Have Ears", 1975): every simple polygon has a corner whose triangle holds no other
// corner; cut it off and repeat. Convex polygons, nearly all that occur, are cut as a fan.
void triangulate(std::span<const Point<World>> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  if (corners.size() > 3) {
    const std::vector<Flat> polygon = flatten(corners);
    std::size_t next = 0;
    if (!isConvex(polygon)) {
      for (std::size_t failures = 0; left.size() > 3 && failures < left.size();) {
        next %= left.size();
        if (!isEar(polygon, left, next)) {
          ++next;
          ++failures;
          continue;
        }
        triangles.push_back({left[(next + left.size() - 1) % left.size()], left[next], left[(next + 1) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(next));
        failures = 0;
      }
    }
  }
  for (std::size_t i = 2; i < left.size(); ++i) triangles.push_back({left[0], left[i - 1], left[i]});
}

}  // namespace aerosol::accel
