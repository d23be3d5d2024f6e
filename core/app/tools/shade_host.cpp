#include "core/app/tools/shade_host.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/app/tools/shade_grid.h"
#include "core/base/hash.h"
#include "core/lang/preprocessor.h"
#include "core/render/scene_services.h"
#include "core/shading/ray_type.h"

namespace aerosol::app {

namespace {

using lang::Constant;
using lang::Global;

constexpr int textureMemory_MB = 1024;

Constant floats(std::vector<float> values) {
  const auto length = static_cast<int>(values.size());
  return {lang::types::floating.arrayOf(length), std::move(values)};
}

std::uint32_t rayTypeNamed(const std::string& name) {
  const auto known = std::ranges::find(shading::rayTypeNames, name);
  return known == shading::rayTypeNames.end() ? 0u : 1u << (known - shading::rayTypeNames.begin());
}

void describeGrid(const ShadeGrid& grid, const ShadeGroup& group, shading::AttributeTable& table) {
  const float aspect = static_cast<float>(grid.width) / static_cast<float>(std::max(grid.height, 1));
  table.set("osl:version", Constant::ofInt(lang::oslVersion));
  table.set("shader:layername", Constant::ofString(group.layers.back().name));
  table.set("shader:groupname", Constant::ofString(group.name));
  table.set("camera:resolution", {lang::types::integer.arrayOf(2), std::vector<std::int32_t>{grid.width, grid.height}});
  table.set("camera:projection", Constant::ofString("perspective"));
  table.set("camera:pixelaspect", Constant::ofFloat(1));
  table.set("camera:fov", Constant::ofFloat(90));
  table.set("camera:clip_near", Constant::ofFloat(nearClip));
  table.set("camera:clip_far", Constant::ofFloat(farClip));
  table.set("camera:clip", floats({nearClip, farClip}));
  table.set("camera:shutter_open", Constant::ofFloat(0));
  table.set("camera:shutter_close", Constant::ofFloat(1));
  table.set("camera:shutter", floats({0, 1}));
  table.set("camera:screen_window", floats({-aspect, -1, aspect, 1}));
}

/// User data that testshade makes up of where a point is: one row a name.
struct MadeUp {
  const char* name;
  Global source;  ///< u or v
  float sign;     ///< The value is sign * source, and 1 more where it is negative.
  bool (*isThere)(float x, float y);
};
constexpr std::array madeUp = {
    MadeUp{"s", Global::u, 1, [](float, float) { return true; }},
    MadeUp{"t", Global::v, 1, [](float, float) { return true; }},
    MadeUp{"red", Global::u, 1, [](float x, float) { return x > 0.5f; }},
    MadeUp{"green", Global::v, 1, [](float x, float) { return x < 0.5f; }},
    MadeUp{"blue", Global::u, -1, [](float, float y) { return (static_cast<int>(y * 12) % 2) == 0; }},
};

float component(const shading::ShadingPoint& point, Global global, std::size_t i = 0) {
  return point[static_cast<std::size_t>(jit::globalPointer(global)) + i];
}

const MadeUp* findMadeUp(std::uint64_t nameHash, const shading::ShadingPoint& point) {
  for (const MadeUp& row : madeUp)
    if (hashString(row.name) == nameHash)
      return row.isThere(component(point, Global::P), component(point, Global::P, 1)) ? &row : nullptr;
  return nullptr;
}

}  // namespace

std::shared_ptr<const ShadeHost> makeShadeHost(const ShadeArguments& arguments,
                                               std::vector<std::filesystem::path> searchPath, const ShadeGroup& group) {
  auto host = std::make_shared<ShadeHost>();
  host->rayTypes = rayTypeNamed(arguments.rayType);
  host->services = render::makeServices({.searchPath = std::move(searchPath), .textureMemory_MB = textureMemory_MB});
  shading::AttributeTable& table = host->attributes.global;
  describeGrid(arguments.grid, group, table);
  host->traced.set("geom:name", Constant::ofString("teapot"));
  host->attributes.object("options").set("blahblah", Constant::ofFloat(3.14159f));
  for (const NamedValue& given : arguments.userData) {
    const auto* values = std::get_if<std::vector<float>>(&given.value.value);
    if (values && values->size() <= shading::PointFacts::maximumUserData) {
      host->userData[hashString(given.name)] = {given.value.type, *values};
    } else {
      table.set(given.name, {given.value.type, given.value.value});
    }
  }
  return host;
}

shading::ShadingPoint GridFacts::at(std::uint32_t point) const {
  return gridPoint(grid_, number(point) % grid_.width, number(point) / grid_.width);
}

std::optional<lang::Type> GridFacts::userData(std::uint32_t point, std::uint64_t nameHash,
                                              std::span<float, maximumUserData> values) const {
  static const std::uint64_t index = hashString("shading:index");
  if (const auto given = host_.userData.find(nameHash); given != host_.userData.end()) {
    std::ranges::copy(given->second.values, values.begin());
    return given->second.type;
  }
  if (nameHash == index) {
    values[0] = static_cast<float>(number(point));
    return lang::types::floating;
  }
  const shading::ShadingPoint place = at(point);
  const MadeUp* row = findMadeUp(nameHash, place);
  if (!row) return std::nullopt;
  values[0] = row->sign * component(place, row->source) + (row->sign < 0 ? 1.0f : 0.0f);
  return lang::types::floating;
}

bool GridFacts::trace(std::uint32_t point, const shading::TraceRequest& request, shading::TraceAnswer& answer) const {
  const shading::ShadingPoint place = at(point);
  const float u = component(place, Global::u), v = component(place, Global::v);
  answer.isHit = u > 0.5f;
  answer.distance = 0.5f;
  answer.normal = {1 - v, 0.25f, 1 - u};
  answer.object = &host_.traced;
  const auto& [p, r] = std::pair(request.origin, request.direction);
  return u / (p[0] * r[0] + p[1] * r[1] + p[2] * r[2]) > 0.5f;
}

void GridFacts::userDataChange(std::uint32_t point, std::uint64_t nameHash, int axis,
                               std::span<float, maximumUserData> values) const {
  std::ranges::fill(values, 0.0f);
  if (host_.userData.contains(nameHash)) return;
  const shading::ShadingPoint place = at(point);
  const MadeUp* row = findMadeUp(nameHash, place);
  if (!row) return;
  const bool isU = row->source == Global::u;
  const Global along[2] = {isU ? Global::dudx : Global::dvdx, isU ? Global::dudy : Global::dvdy};
  values[0] = row->sign * component(place, along[axis == 0 ? 0 : 1]);
}

}  // namespace aerosol::app
