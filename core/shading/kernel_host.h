// What running kernels reach of the host: named spaces and the log of their messages. One per thread.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/motion.h"
#include "core/jit/kernel_interface.h"
#include "core/lang/abi.h"
#include "core/shading/host_functions.h"

namespace aerosol::shading {

/// What the projections of a camera follow from.
struct CameraProjection {
  Matrix4 toScreen = identityMatrix();  ///< From camera space, to be divided by the fourth coordinate.
  Matrix4 screenToNdc = identityMatrix();
  int width = 1, height = 1;  ///< Pixels: "raster" is "NDC" times these.
};

/// Coordinate systems that shaders may name, besides object, shader, world and common. Const after preparation.
class NamedSpaces {
 public:
  void add(const std::string& name, const Matrix4& toWorld, const Matrix4& fromWorld);
  /// "screen", "NDC" and "raster" of a camera.
  void addCamera(const Matrix4& worldToCamera, const CameraProjection& camera);
  /// The same of a camera that moves, and "camera".
  void addCamera(const MovingTransform<World, Camera>& toWorld, const CameraProjection& camera);

  struct Space {
    std::array<float, 16> toWorld{};  ///< Row-major, for column vectors.
    std::array<float, 16> fromWorld{};
    std::optional<MovingTransform<World, Camera>> motion;  ///< Then these maps alone count:
    Matrix4 fromCamera{}, toCamera{};
  };
  /// Null when there is none of that name.
  const Space* find(std::uint64_t nameHash) const;

 private:
  std::map<std::uint64_t, Space> spaces_;
};

struct Family;

/// One record that a kernel left.
struct Record {
  std::uint32_t kind = 0;
  std::uint32_t site = 0;
  std::uint32_t lane = 0;
  std::vector<AerosolRecordValue> values;
};

/// The context that kernels of one thread run with.
class KernelHost {
 public:
  /// `services` may be null: then there are no files.
  KernelHost(const NamedSpaces& spaces, std::uint32_t loopBudget, Services* services = nullptr);
  KernelHost(const KernelHost&) = delete;
  KernelHost& operator=(const KernelHost&) = delete;

  AerosolKernelContext* context() { return &context_.base; }
  const AerosolKernelCounters& counters() const { return context_.base.counters; }

  /// The records since the last call, in call order. The caller empties them.
  std::vector<Record>& records() { return records_; }

  /// A kernel is about to run on points 0 to count - 1 of instances of the family.
  void begin(const jit::KernelInterface& interface, const Family& family, std::size_t count);
  /// The blocks that the kernel's instance numbers mean, where they are not the family's.
  void setInstanceData(const unsigned char* blocks) { instanceData_ = blocks; }
  /// Answers the kernel's calls of host functions.
  HostCalls& calls() { return calls_; }

 private:
  struct Context {
    AerosolKernelContext base;  // First: kernels and services see its address.
    KernelHost* host;
  };
  static KernelHost& of(AerosolKernelContext* context) { return *reinterpret_cast<Context*>(context)->host; }
  static void record(AerosolKernelContext* context, std::uint32_t kind, std::uint32_t site, std::uint32_t lane,
                     const AerosolRecordValue* arguments, std::uint32_t count);
  static std::int32_t spaceToWorld(AerosolKernelContext* context, std::uint64_t name, std::uint32_t instance,
                                   float time, float* matrix);
  static std::int32_t worldToSpace(AerosolKernelContext* context, std::uint64_t name, std::uint32_t instance,
                                   float time, float* matrix);

  static void call(AerosolKernelContext* context, const AerosolHostCall* call);

  static const AerosolHostServices services_;
  /// Writes 16 floats of a named space for an instance at a time; false when the name is unknown.
  bool spaceMatrix(std::uint64_t name, std::uint32_t instance, float time, bool toWorld, float* matrix) const;

  Context context_;
  const NamedSpaces& spaces_;
  const unsigned char* instanceData_ = nullptr;
  std::size_t instanceStride_ = 0;
  std::vector<Record> records_;
  HostCalls calls_;
};

}  // namespace aerosol::shading
