#include "core/render/scene_attributes.h"

#include <cmath>
#include <numbers>

#include "core/lang/preprocessor.h"
#include "core/render/shader_binding.h"

namespace aerosol::render {

namespace {

using lang::Constant;

Constant floats(std::vector<float> values) {
  const auto length = static_cast<int>(values.size());
  return {lang::types::floating.arrayOf(length), std::move(values)};
}

void describeCamera(const scene::Sensor& sensor, const scene::Film& film, shading::AttributeTable& table) {
  const float aspect = static_cast<float>(film.width) / static_cast<float>(film.height);
  const Camera camera(sensor, film);
  const double degrees = camera.isOrthographic() ? 0 : 360 / std::numbers::pi * std::atan(camera.tangentX());
  table.set("camera:resolution", {lang::types::integer.arrayOf(2), std::vector<std::int32_t>{film.width, film.height}});
  table.set("camera:pixelaspect", Constant::ofFloat(1));
  table.set("camera:projection", Constant::ofString(camera.isOrthographic() ? "orthographic" : "perspective"));
  table.set("camera:fov", Constant::ofFloat(static_cast<float>(degrees)));
  table.set("camera:clip_near", Constant::ofFloat(sensor.nearClip));
  table.set("camera:clip_far", Constant::ofFloat(sensor.farClip));
  table.set("camera:clip", floats({sensor.nearClip, sensor.farClip}));
  table.set("camera:shutter_open", Constant::ofFloat(0));
  table.set("camera:shutter_close", Constant::ofFloat(0));
  table.set("camera:shutter", floats({0, 0}));
  // Of the plane at distance 1 where the angle of view is 90 degrees across the film's width.
  table.set("camera:screen_window", floats({-1, -1 / aspect, 1, 1 / aspect}));
}

}  // namespace

void describeScene(const scene::SceneDescription& description, shading::SceneAttributes& attributes) {
  attributes.global.set("osl:version", Constant::ofInt(lang::oslVersion));
  describeCamera(description.sensor, description.film, attributes.global);
  if (const std::string& id = description.sensor.origin.id; !id.empty())
    describeCamera(description.sensor, description.film, attributes.object(id));
}

std::shared_ptr<const shading::AttributeTable> describeObject(const scene::Origin& origin,
                                                              const std::vector<scene::NamedValue>& values,
                                                              shading::SceneAttributes& attributes) {
  auto table = std::make_shared<shading::AttributeTable>();
  table->set("geom:name", Constant::ofString(origin.id));
  for (const scene::NamedValue& value : values) table->set(value.name, constantOf(value.value));
  if (!origin.id.empty()) attributes.object(origin.id) = *table;
  return table;
}

}  // namespace aerosol::render
