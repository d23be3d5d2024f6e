#include "core/render/registry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/camera.h"
#include "core/render/sun_position.h"

namespace aerosol::render {

namespace {

/// The name and the parameters under which a light of the scene format is registered.
struct NamedLight {
  std::string type;
  std::vector<scene::NamedValue> parameters;
};

/// Degrees across the picture of a projector.
float horizontalFov(const scene::Emitter& emitter) {
  scene::Sensor sensor;
  sensor.fov = emitter.fov;
  sensor.fovAxis = emitter.fovAxis;
  sensor.focalLength = emitter.focalLength;
  const double tangent = horizontalTangent(sensor.fieldOfView(), static_cast<double>(emitter.aspect.value_or(1.0f)));
  return static_cast<float>(std::atan(tangent) * 360 / std::numbers::pi);
}

Vector<scene::Unplaced> towardsSun(const scene::Emitter& emitter) {
  const Vector<World> d = emitter.sun.direction ? *emitter.sun.direction : emitter.toWorld(sunDirection(emitter.sun));
  return {d.x, d.y, d.z};
}

NamedLight nameLight(const scene::Emitter& emitter) {
  using scene::Unplaced;
  const Point<World> p = emitter.position;
  const Vector<World> d = emitter.direction;
  switch (emitter.type) {
    case scene::EmitterType::point:
      return {
          "point",
          {{"intensity", emitter.emitted}, {"position", Point<Unplaced>(p.x, p.y, p.z)}, {"radius", emitter.radius}}};
    case scene::EmitterType::directional:
      return {"directional", {{"irradiance", emitter.emitted}, {"direction", Vector<Unplaced>(d.x, d.y, d.z)}}};
    case scene::EmitterType::constant:
      return {"constant", {{"radiance", emitter.emitted}}};
    case scene::EmitterType::area:
      return {"area", {{"radiance", emitter.emitted}}};
    case scene::EmitterType::envmap:
      return {"envmap",
              {{"filename", emitter.file.string()}, {"scale", emitter.scale}, {"to_world", emitter.toWorld.matrix()}}};
    case scene::EmitterType::background:
      return {"envmap", {{"filename", std::string()}}};
    case scene::EmitterType::spot:
      return {"spot",
              {{"intensity", emitter.emitted},
               {"to_world", emitter.toWorld.matrix()},
               {"cutoff_angle", emitter.cutoffAngle},
               {"beam_width", emitter.beamWidth.value_or(-1.0f)}}};
    case scene::EmitterType::projector:
      return {"projector",
              {{"irradiance", emitter.emitted},
               {"scale", emitter.scale},
               {"to_world", emitter.toWorld.matrix()},
               {"fov", horizontalFov(emitter)},
               {"aspect", emitter.aspect.value_or(1.0f)}}};
    case scene::EmitterType::sunsky:
      return {"sunsky",
              {{"turbidity", emitter.turbidity},
               {"sun_direction", towardsSun(emitter)},
               {"sun_scale", emitter.sunScale},
               {"sky_scale", emitter.skyScale},
               {"sun_aperture", emitter.sunAperture},
               {"complex_sun", emitter.complexSun},
               {"albedo", emitter.groundAlbedo},
               {"to_world", emitter.toWorld.matrix()}}};
  }
  return {};
}

std::vector<std::string> namesOf(std::span<const LightType> types) {
  std::vector<std::string> names;
  for (const LightType& type : types) names.push_back(type.name);
  return names;
}

std::vector<std::string> namesOf(const std::vector<scene::ParameterSpec>& specs) {
  std::vector<std::string> names;
  for (const scene::ParameterSpec& spec : specs) names.push_back(spec.name);
  return names;
}

Diagnostic unknown(const SourceLocation& location, const std::string& what, const std::string& name,
                   const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& entry : known) list += (list.empty() ? "known are " : ", ") + entry;
  Diagnostic error;
  error.location = location;
  error.message = "there is no " + what + " '" + name + "'";
  if (const std::string near = didYouMean(name, known); !near.empty()) error.notes.push_back(near);
  if (!list.empty()) error.notes.push_back(list);
  return error;
}

/// Checks each parameter and adds the defaults.
Diagnostics complete(const LightType& type, std::vector<scene::NamedValue>& parameters,
                     const SourceLocation& location) {
  Diagnostics errors;
  for (scene::NamedValue& parameter : parameters) {
    const auto spec = std::find_if(type.parameters.begin(), type.parameters.end(),
                                   [&](const scene::ParameterSpec& s) { return s.name == parameter.name; });
    if (spec == type.parameters.end()) {
      errors.add(unknown(location, "parameter of " + type.name + " lights", parameter.name, namesOf(type.parameters)));
      continue;
    }
    const std::optional<scene::Value> value = scene::convert(parameter.value, spec->type);
    if (!value) {
      errors.error(location, "'" + parameter.name + "' is a " + std::string(scene::name(spec->type)) + ", not a " +
                                 std::string(scene::name(scene::typeOf(parameter.value))));
      continue;
    }
    parameter.value = *value;
    if (const std::string wrong = scene::checkValue(*spec, *value); !wrong.empty()) errors.error(location, wrong);
  }
  for (const scene::ParameterSpec& spec : type.parameters) {
    const bool given = std::any_of(parameters.begin(), parameters.end(),
                                   [&](const scene::NamedValue& parameter) { return parameter.name == spec.name; });
    if (given) continue;
    if (spec.defaultValue) {
      parameters.push_back({spec.name, *spec.defaultValue});
    } else {
      errors.error(location, "a light of type '" + type.name + "' needs '" + spec.name + "'");
    }
  }
  return errors;
}

}  // namespace

const VoxelFile* VolumeArguments::voxels(const std::string& name, std::string& message) const {
  if (services) return services->voxels(name, message);
  message = "there are no files here";
  return nullptr;
}

std::filesystem::path VolumeArguments::file(const std::string& parameter) const {
  std::filesystem::path name = volume.get<std::string>(parameter);
  for (const std::filesystem::path& folder : searchPath) {
    std::error_code error;
    if (name.is_relative() && std::filesystem::exists(folder / name, error)) return folder / name;
  }
  return name;
}

const Closure* Registry::closure(std::string_view name) const {
  const auto found = std::find_if(closures_.begin(), closures_.end(), [&](const auto& c) { return c->name() == name; });
  return found == closures_.end() ? nullptr : found->get();
}

const volume::PhaseFunction* Registry::phase(std::string_view name) const {
  const auto found = std::find_if(phases_.begin(), phases_.end(), [&](const auto& p) { return p->name() == name; });
  return found == phases_.end() ? nullptr : found->get();
}

const Integrator* Registry::integrator(std::string_view name) const {
  const auto found =
      std::find_if(integrators_.begin(), integrators_.end(), [&](const auto& i) { return i.name == name; });
  return found == integrators_.end() ? nullptr : found->integrator.get();
}

const LightType* Registry::light(std::string_view name) const {
  const auto found = std::find_if(lights_.begin(), lights_.end(), [&](const LightType& l) { return l.name == name; });
  return found == lights_.end() ? nullptr : &*found;
}

const VolumeType* Registry::volume(std::string_view name) const {
  const auto found =
      std::find_if(volumes_.begin(), volumes_.end(), [&](const VolumeType& v) { return v.described.type == name; });
  return found == volumes_.end() ? nullptr : &*found;
}

Result<std::unique_ptr<const Light>> makeLight(const Registry& registry, const scene::Emitter& emitter,
                                               std::shared_ptr<const LightSurface> surface, Color texture,
                                               const SkyPicture* picture) {
  NamedLight named = nameLight(emitter);
  return makeLight(registry, named.type, std::move(named.parameters), std::move(surface), emitter.origin.location,
                   texture, picture);
}

Result<std::unique_ptr<const Light>> makeLight(const Registry& registry, std::string_view type,
                                               std::vector<scene::NamedValue> parameters,
                                               std::shared_ptr<const LightSurface> surface,
                                               const SourceLocation& location, Color texture,
                                               const SkyPicture* picture) {
  const LightType* const known = registry.light(type);
  if (!known) return unknown(location, "light of type", std::string(type), namesOf(registry.lights()));
  if (Diagnostics errors = complete(*known, parameters, location); errors.hasErrors()) return errors;
  if (known->needsSurface && !surface) {
    Diagnostics errors;
    errors.error(location, "a light of type '" + known->name + "' needs a shape with area");
    return errors;
  }
  std::string problem;
  auto light = known->make({parameters, std::move(surface), texture, picture, &problem});
  if (!light) {
    Diagnostics errors;
    errors.error(location, problem);
    return errors;
  }
  return light;
}

}  // namespace aerosol::render
