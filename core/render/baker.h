// A volume shader's coefficients on a lattice of points, block by block: what is baked into voxels.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/motion.h"
#include "core/base/result.h"
#include "core/base/voxel_map.h"
#include "core/render/shader_binding.h"
#include "core/shading/kernel_host.h"
#include "core/shading/services.h"
#include "core/shading/shading_system.h"

namespace aerosol::render {

/// Points at whole multiples of the voxel size that lie in the box, edges included.
struct BakeLattice {
  /// Instead: points 0 to size - 1 of a frustum that lie in the box.
  struct Frustum {
    VoxelMap map;
    std::array<std::int64_t, 3> size{};
  };

  Box<Object> bounds;
  double voxelSize = 0.1;
  std::optional<Frustum> frustum;

  /// Least and greatest index along an axis.
  std::array<std::int64_t, 2> range(int axis) const;
  /// Of points.
  double size() const;
  Point<Object> at(const std::array<std::int64_t, 3>& index) const;
  /// Around the points from `first` to `last`, both included.
  Box<Object> boxAround(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& last) const;
};

/// 8 x 8 x 8 points at several times. Numbers stand as ((time * 8 + x) * 8 + y) * 8 + z, three a point, of points
/// outside of the box 0.
struct BakedBlock {
  std::array<std::int32_t, 3> origin{};  ///< Multiples of 8.
  std::vector<float> extinction, scattering, emission;
};

struct BakeOptions {
  jit::Compiler* compiler = nullptr;
  jit::Target target;
  std::uint32_t loopBudget = 1u << 20;
};

/// Counts of one bake.
struct BakeCounts {
  std::uint64_t blocks = 0;    ///< In the box.
  std::uint64_t proven = 0;    ///< Of which ranges of the shader told that they are empty.
  std::uint64_t points = 0;    ///< At which the shader was run.
  std::uint64_t unsound = 0;   ///< Results that were NaN, infinite or negative where that means nothing: taken as 0.
  float anisotropy = 0;        ///< Mean cosine of all scattering, by its weight.
  bool sameAnisotropy = true;  ///< It is the same everywhere.
};

/// Runs one volume shader whose object space is the world's. Immutable once made.
class Baker {
 public:
  /// Binds and compiles the shader. `services` outlives the baker.
  static Result<std::unique_ptr<const Baker>> make(const scene::ShaderUse& use, const ShaderSources& sources,
                                                   shading::Services& services, const BakeOptions& options,
                                                   Diagnostics& warnings);

  /// Takes the blocks in which something is at one of the times (ascending seconds). Blocks of one part come in order
  /// of their places; different parts may come from different threads at once.
  using TakeBlock = std::function<void(std::size_t part, BakedBlock&& block)>;
  /// The parts that a lattice is worked on in; they do not depend on the number of threads.
  static std::size_t partCount(const BakeLattice& lattice);
  /// `progress` gets the share that is done and the points so far, from one thread at a time; a set `stop` ends the
  /// work early.
  void bake(const BakeLattice& lattice, const std::vector<float>& times, int threads, const TakeBlock& take,
            const std::function<void(double, std::uint64_t)>& progress, const std::atomic<bool>* stop,
            BakeCounts& counts) const;
  /// All blocks, ordered by part and place.
  std::vector<BakedBlock> bake(const BakeLattice& lattice, const std::vector<float>& times, int threads,
                               const std::function<void(double, std::uint64_t)>& progress,
                               const std::atomic<bool>* stop, BakeCounts& counts) const;

  bool readsTime() const;

 private:
  class Worker;
  Baker(shading::Services& services, std::uint32_t loopBudget) : services_(services), loopBudget_(loopBudget) {}

  shading::Services& services_;
  std::uint32_t loopBudget_;
  shading::ShadingSystem shading_;
  shading::NamedSpaces spaces_;
  shading::InstanceRef shader_;
};

}  // namespace aerosol::render
