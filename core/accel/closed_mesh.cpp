#include "core/accel/closed_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/accel/double3.h"
#include "core/accel/mesh_volume.h"
#include "core/accel/welded_corners.h"

namespace aerosol::accel {

namespace {

constexpr double sheetness = 0.45;

using Triangle = std::array<std::uint32_t, 3>;

class Closer {
 public:
  explicit Closer(TriangleMesh& mesh) : mesh_(mesh), corner_(weldedCorners(mesh)) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (isFlat(t)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = edge(t, k);
        edges_[edgeKey(a, b)].push_back(t);
      }
    }
  }

  MeshRepair close() {
    part_.assign(mesh_.triangles.size(), noPart);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (part_[t] == noPart && !isFlat(t)) orientFrom(t);
    }
    closeHoles();
    return repair_;
  }

 private:
  static constexpr std::uint32_t noPart = 0xffffffffu;

  /// From corner k to the next.
  std::pair<std::uint32_t, std::uint32_t> edge(std::uint32_t t, std::size_t k) const {
    return {corner_[mesh_.triangles[t][k]], corner_[mesh_.triangles[t][(k + 1) % 3]]};
  }
  bool isFlat(std::uint32_t t) const {
    const auto [a, b] = edge(t, 0);
    const std::uint32_t c = corner_[mesh_.triangles[t][2]];
    return a == b || b == c || c == a;
  }
  bool goesAlong(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edge(t, k) == std::pair{a, b}) return true;
    }
    return false;
  }

  /// Finds what hangs together with a triangle by edges of two, and turns the fewer of those that disagree.
  void orientFrom(std::uint32_t first) {
    const auto number = static_cast<std::uint32_t>(parts_++);
    std::vector<std::uint32_t> members{first};
    std::vector<bool> turns{false};
    std::unordered_map<std::uint32_t, bool> known{{first, false}};
    part_[first] = number;
    bool isOriented = true;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const std::uint32_t t = members[i];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = edge(t, k);
        const std::vector<std::uint32_t>& users = edges_[edgeKey(a, b)];
        if (users.size() != 2) continue;
        const std::uint32_t other = users[0] == t ? users[1] : users[0];
        const bool turnsOther = turns[i] != goesAlong(other, a, b);
        const auto [place, isNew] = known.try_emplace(other, turnsOther);
        if (isNew) {
          part_[other] = number;
          members.push_back(other);
          turns.push_back(turnsOther);
        } else if (place->second != turnsOther) {
          isOriented = false;
        }
      }
    }
    const auto count = static_cast<std::size_t>(std::ranges::count(turns, true));
    if (!isOriented) return;
    const bool turnsMost = 2 * count > members.size();
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (turns[i] == turnsMost) continue;
      std::swap(mesh_.triangles[members[i]][1], mesh_.triangles[members[i]][2]);
      ++repair_.turned;
    }
  }

  /// By part: whether it is a sheet.
  std::vector<bool> findSheets() const {
    std::vector<Double3> vectors(parts_);
    std::vector<double> areas(parts_);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (part_[t] == noPart) continue;
      const Triangle& i = mesh_.triangles[t];
      const Double3 a = toDouble(mesh_.positions[i[0]]);
      const Double3 n = cross(toDouble(mesh_.positions[i[1]]) - a, toDouble(mesh_.positions[i[2]]) - a);
      vectors[part_[t]] = vectors[part_[t]] + n;
      areas[part_[t]] += std::sqrt(dot(n, n));
    }
    std::vector<bool> sheets(parts_);
    for (std::size_t i = 0; i < parts_; ++i) sheets[i] = std::sqrt(dot(vectors[i], vectors[i])) > sheetness * areas[i];
    return sheets;
  }

  void closeHoles() {
    const std::vector<bool> sheets = findSheets();
    // Of each open edge the triangle goes from a to b, so the rim goes on from b to a.
    std::multimap<std::uint32_t, RimEdge> rims;
    std::vector<std::uint32_t> starts;
    const std::size_t count = mesh_.triangles.size();
    for (std::uint32_t t = 0; t < count; ++t) {
      for (std::size_t k = 0; k < 3 && part_[t] != noPart; ++k) {
        const auto [a, b] = edge(t, k);
        if (edges_[edgeKey(a, b)].size() != 1) continue;
        if (sheets[part_[t]]) {
          ++repair_.leftOpen;
          continue;
        }
        rims.emplace(b, RimEdge{a, mesh_.triangles[t][(k + 1) % 3], t});
        starts.push_back(b);
      }
    }
    for (const std::uint32_t start : starts) {
      std::vector<RimEdge> loop;
      std::uint32_t at = start;
      do {
        const auto next = rims.find(at);
        if (next == rims.end()) break;
        loop.push_back(next->second);
        at = next->second.to;
        rims.erase(next);
      } while (at != start);
      if (loop.size() >= 3 && at == start) {
        closeHole(loop);
      } else {
        repair_.leftOpen += loop.size();
      }
    }
  }

  struct RimEdge {
    std::uint32_t to = 0;        ///< Welded corner.
    std::uint32_t position = 0;  ///< Where the edge begins.
    std::uint32_t triangle = 0;  ///< Beside it.
  };

  void closeHole(const std::vector<RimEdge>& loop) {
    ++repair_.closedHoles;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto size = static_cast<std::uint32_t>(loop.size());
    for (const RimEdge& rim : loop) addPosition(rim.position);
    if (size == 3) return addTriangle({first, first + 1, first + 2}, loop[0].triangle);
    addPosition(loop[0].position);
    Double3 middle;
    for (const RimEdge& rim : loop) middle = middle + toDouble(mesh_.positions[rim.position]) * (1.0 / size);
    mesh_.positions.back() = toFloat<Point<World>>(middle);
    for (std::uint32_t i = 0; i < size; ++i)
      addTriangle({first + i, first + (i + 1) % size, first + size}, loop[i].triangle);
  }

  /// A copy; its normal is not known.
  void addPosition(std::uint32_t of) {
    mesh_.positions.push_back(Point<World>(mesh_.positions[of]));
    if (!mesh_.normals.empty()) mesh_.normals.emplace_back(0.0f, 0.0f, 0.0f);
    if (!mesh_.uvs.empty()) mesh_.uvs.push_back(TexCoord(mesh_.uvs[of]));
    copyAttributes(false, of);
  }
  void addTriangle(const Triangle& triangle, std::uint32_t like) {
    mesh_.triangles.push_back(triangle);
    copyAttributes(true, like);
  }
  void copyAttributes(bool perFace, std::size_t of) {
    for (MeshAttribute& attribute : mesh_.attributes) {
      if (attribute.isPerFace != perFace) continue;
      const auto channels = static_cast<std::size_t>(attribute.channels);
      for (std::size_t c = 0; c < channels; ++c) attribute.values.push_back(float(attribute.values[of * channels + c]));
    }
  }

  TriangleMesh& mesh_;
  std::vector<std::uint32_t> corner_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> edges_;
  std::vector<std::uint32_t> part_;  ///< By triangle.
  std::size_t parts_ = 0;
  MeshRepair repair_;
};

}  // namespace

MeshRepair closeBodies(TriangleMesh& mesh) { return Closer(mesh).close(); }

}  // namespace aerosol::accel
