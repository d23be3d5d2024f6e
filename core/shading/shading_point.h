// The shader globals of one point, in the order in which kernels take them.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/geometry.h"
#include "core/base/mesh_place.h"
#include "core/jit/kernel_interface.h"

namespace aerosol::shading {

/// All components of all globals (see AerosolKernelArguments::globals); what is not set is zero.
class ShadingPoint {
 public:
  template <class Triple>
  void set(lang::Global global, const Triple& value) {
    const auto first = static_cast<std::size_t>(jit::globalPointer(global));
    components_[first] = value.x;
    components_[first + 1] = value.y;
    components_[first + 2] = value.z;
  }
  void set(lang::Global global, float value) {
    components_[static_cast<std::size_t>(jit::globalPointer(global))] = value;
  }

  /// Where on a mesh the point lies.
  void setPlace(const MeshPlace& place) { place_ = place; }
  const MeshPlace& place() const { return place_; }

  /// N and Ng were turned towards the viewer, who sees the surface from behind.
  void setTurned(bool isTurned) { isTurned_ = isTurned; }
  bool isTurned() const { return isTurned_; }

  float operator[](std::size_t component) const { return components_[component]; }

 private:
  std::array<float, jit::globalPointerCount> components_{};
  MeshPlace place_;
  bool isTurned_ = false;
};

}  // namespace aerosol::shading
