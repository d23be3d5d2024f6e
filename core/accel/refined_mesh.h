// Meshes that are made finer by halving edges.
#pragma once

#include <functional>
#include <unordered_map>
#include <vector>

#include "core/accel/mesh.h"

namespace aerosol::accel {

/// A mesh whose edges are halved, each by itself. Neighbours agree about their common edge, so that no cracks open:
/// also where they have vertices of their own at one place (seams of texture coordinates, sharp edges), which stay
/// together.
class RefinedMesh {
 public:
  /// Moves a new vertex from the middle between two to where the shape has it.
  using Bend = std::function<void(TriangleMesh& mesh, std::uint32_t vertex, std::uint32_t a, std::uint32_t b)>;
  /// Has to say the same of both directions, and of all edges between the same places.
  using IsTooLong = std::function<bool(std::uint32_t a, std::uint32_t b)>;

  /// The mesh has normals and no flags; without `bend` edges are straight.
  explicit RefinedMesh(TriangleMesh mesh, Bend bend = {});

  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh take() && { return std::move(mesh_); }
  /// The first of the vertices at the place of this one.
  std::uint32_t placeOf(std::uint32_t vertex) const { return places_[vertex]; }
  /// Whether there are others at its place.
  bool isShared(std::uint32_t vertex) const { return shared_[vertex]; }

  /// Halves the edges that are too long, once. Only those of triangles that came of the last call (at first: all) are
  /// asked for: where nothing is halved nothing will be. How many were.
  std::size_t halve(const IsTooLong& isTooLong);
  /// The first triangle that came of the last call; at first 0.
  std::size_t firstNewTriangle() const { return firstActive_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::uint32_t middleOf(std::uint32_t a, std::uint32_t b) const;
  std::uint32_t addMiddle(std::uint32_t a, std::uint32_t b);
  void split(std::size_t triangle, const std::array<std::uint32_t, 3>& middles);
  void addTriangle(std::size_t parent, std::uint32_t a, std::uint32_t b, std::uint32_t c);

  TriangleMesh mesh_;
  Bend bend_;
  std::vector<std::uint32_t> places_;
  std::vector<bool> shared_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< Of the edges that are being halved, by both ends.
  std::unordered_map<std::uint64_t, std::uint32_t> placeOfMiddle_;
  std::size_t firstActive_ = 0;
};

/// Normals of a mesh of which vertices lie together: as `resolveNormals` computes them, and vertices at one place have
/// one normal where they had in `before`.
void computeJoinedNormals(TriangleMesh& mesh, const std::vector<Normal<World>>& before,
                          const std::function<std::uint32_t(std::uint32_t)>& placeOf);

}  // namespace aerosol::accel
