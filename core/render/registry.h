// The table of compiled-in features: closures, phase functions, light types, integrators by name.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/accel/volume_shape.h"
#include "core/base/result.h"
#include "core/render/carried_matter.h"
#include "core/render/closure.h"
#include "core/render/integrator.h"
#include "core/render/light.h"
#include "core/render/light_surface.h"
#include "core/scene/description.h"
#include "core/scene/parameter.h"
#include "core/shading/services.h"
#include "core/volume/phase.h"

namespace aerosol::render {

/// Radiance from all around by latitude and longitude, +y up, the middle at -z; rows reach from pole to pole.
struct SkyPicture {
  int width = 0, height = 0;
  std::vector<Color> texels;
};

/// What a light is made from: its parameters, checked against the type's table, and for area lights its surface.
struct LightArguments {
  std::span<const scene::NamedValue> parameters;
  std::shared_ptr<const LightSurface> surface;
  Color texture{1};                     ///< Mean of what a texture multiplies the light by.
  const SkyPicture* picture = nullptr;  ///< Of a background: instead of a file.
  std::string* problem = nullptr;       ///< Told when nothing can be made.

  /// The value of one of the type's parameters.
  template <class T>
  T get(std::string_view name) const {
    for (const scene::NamedValue& parameter : parameters) {
      if (parameter.name == name) return std::get<T>(parameter.value);
    }
    return T{};
  }
};

/// A kind of light.
struct LightType {
  std::string name;
  std::string doc;
  std::vector<scene::ParameterSpec> parameters;
  bool needsSurface = false;
  std::unique_ptr<const Light> (*make)(const LightArguments& arguments) = nullptr;
};

/// An integrator under the name that scenes call it by.
struct NamedIntegrator {
  std::string name;
  std::string doc;
  std::shared_ptr<const Integrator> integrator;
};

/// What a volume primitive is made from.
struct VolumeArguments {
  const scene::Volume& volume;
  Transform<World, Object> toWorld;                   ///< As `place` gave it.
  std::span<const std::filesystem::path> searchPath;  ///< For files with relative names.
  Diagnostics& warnings;
  shading::Services* services = nullptr;  ///< Where shaders get files from.

  /// A voxel file, read once for all that ask, shaders included. Null with a message.
  const VoxelFile* voxels(const std::string& name, std::string& message) const;
  CarriedMatter carried = {};           ///< By a velocity grid.
  bool* makesRoomForCarried = nullptr;  ///< Set by a primitive that is wherever that may be.

  /// The file that a parameter names, looked up in the search path; the name itself where no such file is found.
  std::filesystem::path file(const std::string& parameter) const;
};

/// Voxel files that a volume is made of: one, or two frames between which values are mixed.
struct VolumeFiles {
  std::vector<std::string> names;
  float blend = 0;  ///< The part of the second, from 0 to 1.
};

/// A volume primitive type: its parameters in scenes, where one is placed, and its shape.
struct VolumeType {
  scene::VolumeType described;
  /// From the primitive's canonical space (a unit ball, the box [-1, 1]³ …), which is the "object" space of its shader.
  std::function<Transform<World, Object>(const scene::Volume&)> place;
  std::function<Result<std::unique_ptr<const accel::VolumeShape>>(const VolumeArguments&)> make;
  /// Files in the shader's object space, whose grids are attributes of the volume. May be empty.
  std::function<VolumeFiles(const scene::Volume&)> files = {};
};

/// Filled once by `registerPlugins`, then const. Names are unique within a kind.
class Registry {
 public:
  void add(std::unique_ptr<const Closure> closure) { closures_.push_back(std::move(closure)); }
  void add(std::unique_ptr<const volume::PhaseFunction> phase) { phases_.push_back(std::move(phase)); }
  void add(LightType light) { lights_.push_back(std::move(light)); }
  void add(VolumeType volume) { volumes_.push_back(std::move(volume)); }
  void add(NamedIntegrator integrator) { integrators_.push_back(std::move(integrator)); }

  /// Null when unknown.
  const Closure* closure(std::string_view name) const;
  const volume::PhaseFunction* phase(std::string_view name) const;
  const LightType* light(std::string_view name) const;
  const VolumeType* volume(std::string_view name) const;
  const Integrator* integrator(std::string_view name) const;

  /// All, in the order of registration.
  std::span<const std::unique_ptr<const Closure>> closures() const { return closures_; }
  std::span<const std::unique_ptr<const volume::PhaseFunction>> phases() const { return phases_; }
  std::span<const LightType> lights() const { return lights_; }
  std::span<const VolumeType> volumes() const { return volumes_; }
  std::span<const NamedIntegrator> integrators() const { return integrators_; }

 private:
  std::vector<std::unique_ptr<const Closure>> closures_;
  std::vector<std::unique_ptr<const volume::PhaseFunction>> phases_;
  std::vector<LightType> lights_;
  std::vector<VolumeType> volumes_;
  std::vector<NamedIntegrator> integrators_;
};

/// A light as the scene describes it. An area light needs `surface`. An unknown type or a wrong parameter is an error
/// at its place, listing what is known.
Result<std::unique_ptr<const Light>> makeLight(const Registry& registry, const scene::Emitter& emitter,
                                               std::shared_ptr<const LightSurface> surface = nullptr,
                                               Color texture = Color(1), const SkyPicture* picture = nullptr);

/// A light by the name of its type. Defaults are filled in, each value is checked against the type's table.
Result<std::unique_ptr<const Light>> makeLight(const Registry& registry, std::string_view type,
                                               std::vector<scene::NamedValue> parameters,
                                               std::shared_ptr<const LightSurface> surface,
                                               const SourceLocation& location = {}, Color texture = Color(1),
                                               const SkyPicture* picture = nullptr);

}  // namespace aerosol::render
