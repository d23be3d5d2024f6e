// What ranges of a medium's shader tell before the render: that it is constant, a bound that holds everywhere, and the
// tree of bounds.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/render/prepared_scene.h"
#include "core/shading/batch.h"
#include "core/shading/bounds.h"
#include "core/volume/bounds/bound_builder.h"

namespace aerosol::render {

/// One medium's shader, run over boxes and at points on several threads.
class MediumRanges final : public volume::BoundSource {
 public:
  /// `threads` at most.
  MediumRanges(const PreparedScene& scene, const volume::Medium& medium, int threads);
  ~MediumRanges() override;

  /// Whether anything can be proven: there is a bounds kernel.
  bool canProve() const;
  /// Does what is proven rest on what plugins say of themselves?
  bool areDeclared() const;
  /// Whether points may go without their shader being run: it leaves nothing but its results.
  bool mayLeaveOut() const;
  /// The coefficients of all points of the box, where they are surely the same.
  std::optional<volume::Coefficients> uniformOver(const Box<Object>& box);
  std::optional<volume::Coefficients> uniformEverywhere();
  /// An upper bound on extinction that holds in all of space; nothing where none is proven.
  std::optional<float> boundEverywhere();

  void prove(std::span<const Box<Object>> boxes, std::span<volume::BoxKnowledge> knowledge) override;
  void sample(std::span<const Box<Object>> boxes, int pointsPerBox, std::span<volume::BoxSamples> samples) override;
  volume::Coefficients at(Point<Object> point) override;

 private:
  struct Context;
  Box<Object> everywhereOnItsWay(const Box<Object>& box) const;
  void moveBoxes(Context& context) const;
  std::vector<Point<World>> movedPoints(Context& context, std::span<const shading::VolumePoint> points) const;
  std::unique_ptr<Context> takeContext();
  void giveBack(std::unique_ptr<Context> context);
  /// Calls `run(context, first, end)` for parts of [0, count), of `step` each.
  template <class Run>
  void inParts(std::size_t count, std::size_t step, const Run& run);

  const PreparedScene& scene_;
  shading::InstanceRef shader_;
  const shading::Family& family_;
  const MediumVelocity* velocity_;  ///< Null where it does not move so.
  const VolumeLook* look_;          ///< Null where the shader is left as it is.
  int threads_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Context>> free_;
};

}  // namespace aerosol::render
