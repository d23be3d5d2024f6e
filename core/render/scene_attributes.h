// What shaders may ask for by getattribute: the camera, the objects by their names, and what the scene gives them.
#pragma once

#include "core/render/prepared_scene.h"
#include "core/scene/description.h"

namespace aerosol::render {

/// The scene's own attributes: those of the language ("osl:version") and of the camera ("camera:resolution" …), which
/// are also those of an object by the sensor's id.
void describeScene(const scene::SceneDescription& description, shading::SceneAttributes& attributes);

/// Attributes of a shape or volume: "geom:name", its id, and its values "user:…". They are also found by the id.
std::shared_ptr<const shading::AttributeTable> describeObject(const scene::Origin& origin,
                                                              const std::vector<scene::NamedValue>& values,
                                                              shading::SceneAttributes& attributes);

}  // namespace aerosol::render
