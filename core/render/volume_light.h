// A medium that glows, as a light: directions towards places where it may emit.
#pragma once

#include <memory>
#include <vector>

#include "core/render/light.h"
#include "core/volume/bounds/bound_walk.h"

namespace aerosol::render {

/// Places are chosen in the leaves of a tree of bounds, in proportion to the most that each may emit; directions to
/// them have the density p(ω) = ∫ p(x + t ω) t² dt. The radiance from such a direction is not this light's own: all
/// media on the way emit, so it is the integral of T ε along the whole ray (Simon et al. 2017, "Line Integration for
/// Rendering Heterogeneous Emissive Volumes"), and one density serves for all of it.
class VolumeLight final : public Light {
 public:
  /// Null where nothing is known to emit, or no bound on the emission is.
  static std::unique_ptr<const VolumeLight> make(const volume::BoundTree& tree);
  /// Of a medium that emits alike all over `domain`; null where it does not.
  static std::unique_ptr<const VolumeLight> make(const Box<Object>& domain, const Transform<World, Object>& toWorld,
                                                 Color emission);

  /// `value` is black: what arrives is to be integrated along the direction.
  std::optional<LightSample> sample(Point<World> from, const LightUniforms& u) const override;
  float pdfEscaped(Point<World> from, Vector<World> direction) const override;

  Color power(float sceneRadius) const override;
  float importance(Point<World> at) const override;
  bool isDelta() const override { return false; }
  bool isInfinite() const override { return false; }
  bool isVolume() const override { return true; }

 private:
  struct Part {
    Point<Object> lower;
    Vector<Object> size;
    double cumulative = 0;  ///< Of emission times volume.
  };

  explicit VolumeLight(const volume::BoundTree& tree) : tree_(&tree) { medium_.tree = tree_; }
  bool gather();
  void gather(std::uint32_t first, std::array<std::int32_t, 3> cell, int shift);

  std::unique_ptr<const volume::BoundTree> own_;
  const volume::BoundTree* tree_;
  volume::Medium medium_;  ///< For walks through the tree.
  std::vector<Part> parts_;
  double volume_ = 0;  ///< World units³ of one object unit³.
  double total_ = 0;   ///< ∫ of the bound on the emission over world space.
  bool isBounded_ = true;
  Point<World> centre_;
  float extent_ = 0;
};

}  // namespace aerosol::render
