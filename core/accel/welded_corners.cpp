#include "core/accel/welded_corners.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace aerosol::accel {

std::vector<std::uint32_t> weldedCorners(const TriangleMesh& mesh) {
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Point<World>&p = mesh.positions[a], &q = mesh.positions[b];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> corner(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool isSame = i > 0 && mesh.positions[order[i]] == mesh.positions[order[i - 1]];
    corner[order[i]] = isSame ? corner[order[i - 1]] : order[i];
  }
  return corner;
}

}  // namespace aerosol::accel
