#include "core/accel/refined_mesh.h"

#include <algorithm>
#include <cstring>

#include "core/accel/double3.h"

namespace aerosol::accel {

namespace {

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

struct PlaceHash {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::size_t hash = 0;
    for (const float x : p) {
      std::uint32_t bits = 0;
      const float positive = x + 0.0f;  // -0 and 0 are one.
      std::memcpy(&bits, &positive, sizeof bits);
      hash = (hash ^ bits) * 0x9E3779B97F4A7C15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

double squaredDistance(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const Double3 between = toDouble(mesh.positions[a]) - toDouble(mesh.positions[b]);
  return dot(between, between);
}

}  // namespace

RefinedMesh::RefinedMesh(TriangleMesh mesh, Bend bend) : mesh_(std::move(mesh)), bend_(std::move(bend)) {
  const std::size_t count = mesh_.positions.size();
  places_.resize(count);
  shared_.assign(count, false);
  std::unordered_map<std::array<float, 3>, std::uint32_t, PlaceHash> known;
  known.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point<World> p = mesh_.positions[i];
    const auto [entry, isNew] = known.try_emplace({p.x, p.y, p.z}, i);
    places_[i] = entry->second;
    if (!isNew) shared_[i] = shared_[entry->second] = true;
  }
}

std::size_t RefinedMesh::halve(const IsTooLong& isTooLong) {
  middles_.clear();
  placeOfMiddle_.clear();
  const std::size_t end = mesh_.triangles.size();
  std::vector<std::array<std::uint32_t, 3>> found;
  std::vector<std::size_t> halved;
  for (std::size_t t = firstActive_; t < end; ++t) {
    const std::array<std::uint32_t, 3> corners = mesh_.triangles[t];
    std::array<std::uint32_t, 3> middles{};
    bool isHalved = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = corners[i], b = corners[(i + 1) % 3];
      middles[i] = middleOf(a, b);
      if (middles[i] == none && isTooLong(a, b)) middles[i] = addMiddle(a, b);
      isHalved = isHalved || middles[i] != none;
    }
    if (!isHalved) continue;
    halved.push_back(t);
    found.push_back(middles);
  }
  // A triangle that is halved becomes its first part; the others follow at the end. What has to be asked for again is
  // kept together by moving the first parts there as well.
  firstActive_ = end;
  for (std::size_t i = 0; i < halved.size(); ++i) split(halved[i], found[i]);
  std::vector<bool> isGone(end, false);
  for (const std::size_t t : halved) isGone[t] = true;
  std::size_t kept = 0;
  const auto keep = [&](std::size_t t) {
    mesh_.triangles[kept] = mesh_.triangles[t];
    for (MeshAttribute& attribute : mesh_.attributes) {
      if (!attribute.isPerFace) continue;
      const auto channels = static_cast<std::ptrdiff_t>(attribute.channels);
      std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(t) * channels, channels,
                  attribute.values.begin() + static_cast<std::ptrdiff_t>(kept) * channels);
    }
    ++kept;
  };
  for (std::size_t t = 0; t < end; ++t) {
    if (!isGone[t]) keep(t);
  }
  const std::size_t standing = kept;
  for (std::size_t t = end; t < mesh_.triangles.size(); ++t) keep(t);
  mesh_.triangles.resize(kept);
  for (MeshAttribute& attribute : mesh_.attributes) {
    if (attribute.isPerFace) attribute.values.resize(kept * static_cast<std::size_t>(attribute.channels));
  }
  firstActive_ = standing;
  return middles_.size();
}

std::uint32_t RefinedMesh::middleOf(std::uint32_t a, std::uint32_t b) const {
  const auto known = middles_.find(edgeKey(a, b));
  return known == middles_.end() ? none : known->second;
}

std::uint32_t RefinedMesh::addMiddle(std::uint32_t a, std::uint32_t b) {
  const auto vertex = static_cast<std::uint32_t>(mesh_.positions.size());
  middles_.emplace(edgeKey(a, b), vertex);
  const Double3 p = toDouble(mesh_.positions[a]) + toDouble(mesh_.positions[b]);
  mesh_.positions.push_back(toFloat<Point<World>>(p * 0.5));
  if (!mesh_.normals.empty()) {
    const Double3 sum = toDouble(mesh_.normals[a]) + toDouble(mesh_.normals[b]);
    mesh_.normals.push_back(toFloat<Normal<World>>(dot(sum, sum) > 0 ? normalize(sum) : toDouble(mesh_.normals[a])));
  }
  if (!mesh_.uvs.empty()) {
    const TexCoord u = mesh_.uvs[a], v = mesh_.uvs[b];
    mesh_.uvs.push_back({0.5f * (u.u + v.u), 0.5f * (u.v + v.v)});
  }
  for (MeshAttribute& attribute : mesh_.attributes) {
    if (attribute.isPerFace) continue;
    const auto channels = static_cast<std::size_t>(attribute.channels);
    for (std::size_t c = 0; c < channels; ++c)
      attribute.values.push_back(0.5f * (attribute.values[a * channels + c] + attribute.values[b * channels + c]));
  }
  const bool mayMeetOthers = shared_[a] || shared_[b];
  const std::uint32_t place =
      mayMeetOthers ? placeOfMiddle_.try_emplace(edgeKey(places_[a], places_[b]), vertex).first->second : vertex;
  places_.push_back(place);
  shared_.push_back(place != vertex);
  if (place != vertex) shared_[place] = true;
  if (bend_) bend_(mesh_, vertex, a, b);
  return vertex;
}

void RefinedMesh::addTriangle(std::size_t parent, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_.triangles.push_back({a, b, c});
  for (MeshAttribute& attribute : mesh_.attributes) {
    if (!attribute.isPerFace) continue;
    const auto channels = static_cast<std::size_t>(attribute.channels);
    for (std::size_t i = 0; i < channels; ++i) {
      const float value = attribute.values[parent * channels + i];
      attribute.values.push_back(value);
    }
  }
}

/// Three halved edges make four triangles; two cut off a corner and leave a quadrangle, which the shorter diagonal
/// halves; one halves the triangle.
void RefinedMesh::split(std::size_t triangle, const std::array<std::uint32_t, 3>& middles) {
  const std::array<std::uint32_t, 3> c = mesh_.triangles[triangle];
  const auto count = std::ranges::count_if(middles, [](std::uint32_t m) { return m != none; });
  if (count == 3) {
    addTriangle(triangle, c[0], middles[0], middles[2]);
    addTriangle(triangle, c[1], middles[1], middles[0]);
    addTriangle(triangle, c[2], middles[2], middles[1]);
    addTriangle(triangle, middles[0], middles[1], middles[2]);
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t a = c[i], b = c[(i + 1) % 3], d = c[(i + 2) % 3];
    const std::uint32_t ab = middles[i], bd = middles[(i + 1) % 3];
    if (count == 1 && ab != none) {
      addTriangle(triangle, a, ab, d);
      addTriangle(triangle, ab, b, d);
    }
    if (count == 2 && ab != none && bd != none) {
      addTriangle(triangle, ab, b, bd);
      if (squaredDistance(mesh_, a, bd) < squaredDistance(mesh_, ab, d)) {
        addTriangle(triangle, a, ab, bd);
        addTriangle(triangle, a, bd, d);
      } else {
        addTriangle(triangle, a, ab, d);
        addTriangle(triangle, ab, bd, d);
      }
    }
  }
}

void computeJoinedNormals(TriangleMesh& mesh, const std::vector<Normal<World>>& before,
                          const std::function<std::uint32_t(std::uint32_t)>& placeOf) {
  // Vertices at one place that had one normal are told apart by nothing but their texture coordinates.
  constexpr float same = 0.999f;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> companies;
  std::vector<std::uint32_t> joined(mesh.positions.size());
  for (std::uint32_t i = 0; i < joined.size(); ++i) {
    joined[i] = i;
    const std::uint32_t place = placeOf(i);
    if (place == i) continue;
    std::vector<std::uint32_t>& company = companies[place];
    if (company.empty()) company.push_back(place);
    const auto alike = std::ranges::find_if(
        company, [&](std::uint32_t other) { return dot(before[other].vector(), before[i].vector()) > same; });
    joined[i] = alike == company.end() ? i : *alike;
    if (alike == company.end()) company.push_back(i);
  }
  TriangleMesh welded;
  welded.positions = std::move(mesh.positions);
  welded.triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) welded.triangles.push_back({joined[t[0]], joined[t[1]], joined[t[2]]});
  resolveNormals(welded);
  mesh.positions = std::move(welded.positions);
  mesh.normals.resize(joined.size());
  for (std::size_t i = 0; i < joined.size(); ++i) mesh.normals[i] = welded.normals[joined[i]];
}

}  // namespace aerosol::accel
