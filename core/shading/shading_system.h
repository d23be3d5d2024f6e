// All shader instances of a scene and the kernels that run them.
//
// Instances of one program form a family and share kernels: a parameter that is equal in all of them is folded into the
// code, the others are read per lane from the instance's block. That is the whole rule: no instance has a kernel of its
// own. A family has a kernel a variant, a variant being a set of results.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/motion.h"
#include "core/base/result.h"
#include "core/jit/compiler.h"

namespace aerosol::shading {

enum class Variant : std::uint8_t {
  coefficients,  ///< Volumes: everything.
  extinction,    ///< Volumes: sigmaT alone, for shadow rays; no messages.
  surface,       ///< Surfaces: weights and parameters of all closure sites.
  outputs,       ///< Any shader: its output parameters, or some of them. Made only when asked for.
  velocity,      ///< The output parameter that Family::velocityOutput names. Made only where it names one.
  displacement,  ///< Displacement shaders: where the surface is, and its normal.
};
inline constexpr std::size_t variantCount = 6;

/// A value that an instance gives to a parameter; its type is that of the program's parameter.
struct ParameterValue {
  std::uint32_t parameter = 0;  ///< Index into the program's parameters.
  lang::ConstantValue value;
};

/// Finds a parameter by name; nothing when the program has none. Output parameters are not settable.
std::optional<std::uint32_t> findParameter(const lang::Program& program, const std::string& name);

class AttributeTable;

struct Instance {
  std::vector<ParameterValue> values;
  Transform<World, Object> objectToWorld;  ///< Of an instance that moves: when the shutter opens.
  std::optional<MovingTransform<World, Object>> motion;
  /// The space that shaders call "shader"; none: where the object is.
  std::optional<Transform<World, Object>> shaderToWorld;
  std::shared_ptr<const AttributeTable> attributes;  ///< Of the object that it belongs to; may be null.
  float surfaceArea = 0;                             ///< Of that object, in square scene units.
};

/// An instance's place: its family, and its index there.
struct InstanceRef {
  std::uint32_t family = 0;
  std::uint32_t index = 0;
};

struct Family {
  std::shared_ptr<const lang::Program> program;
  std::vector<Instance> instances;
  std::array<std::optional<jit::Kernel>, variantCount> kernels;
  std::optional<jit::Kernel> bounds;          ///< Volumes: all results over ranges (core/shading/bounds.h).
  std::string velocityOutput;                 ///< A triple; empty: nobody asks for one.
  std::vector<std::uint32_t> shownOutputs;    ///< Parameters of Variant::outputs; empty: nobody asks for any.
  std::optional<jit::Kernel> velocityBounds;  ///< The same of the velocity.
  std::vector<unsigned char>
      instanceData;  ///< Blocks of all instances, shared by the variants. 64-byte aligned use is not assumed.
  std::vector<std::pair<std::uint64_t, std::string>> strings;  ///< Of string parameters read from blocks.

  /// Whether one of the instances moves.
  bool moves() const;
  const jit::Kernel& kernel(Variant variant) const { return *kernels[static_cast<std::size_t>(variant)]; }
};

struct ShadingOptions {
  jit::Target target;
  bool counters = false;
  bool outputsAlone = false;  ///< Compile Variant::outputs of every family, and nothing else.
};

class ShadingSystem {
 public:
  /// `program` is the family's key: the same object means the same family.
  InstanceRef add(std::shared_ptr<const lang::Program> program, Instance instance);

  /// Compiles all variants of all families, in parallel. Errors carry positions in the sources.
  Diagnostics compile(jit::Compiler& compiler, const ShadingOptions& options);

  /// Compiles the bounds kernels of all families of volumes whose results vary, in parallel, after `compile`.
  Diagnostics compileBounds(jit::Compiler& compiler, const ShadingOptions& options);

  const std::vector<Family>& families() const { return families_; }
  const Family& family(InstanceRef instance) const { return families_[instance.family]; }
  const Instance& instance(InstanceRef instance) const { return family(instance).instances[instance.index]; }
  /// What shaders may ask about the object of an instance.
  void describeObject(InstanceRef instance, std::shared_ptr<const AttributeTable> attributes, float surfaceArea);
  /// Asks for a kernel of an instance's velocity, before `compile`. False when another output of its family is asked
  /// for already.
  bool setVelocity(InstanceRef instance, const std::string& output);
  /// Asks for an output parameter of an instance by Variant::outputs, before `compile`.
  void showOutput(InstanceRef instance, std::uint32_t parameter);
  /// Makes an instance move, before `compile`.
  void setMotion(InstanceRef instance, const MovingTransform<World, Object>& motion) {
    families_[instance.family].instances[instance.index].motion.emplace(motion);
  }

 private:
  std::vector<Family> families_;
};

/// Puts the matrices of a place into an instance's block.
void writePlacement(const Instance& instance, const Transform<World, Object>& objectToWorld, unsigned char* block);

/// The value that an instance gives, or the constant default; null when the program computes the default.
const lang::ConstantValue* valueOf(const lang::Program& program, const Instance& instance, std::uint32_t parameter);

}  // namespace aerosol::shading
