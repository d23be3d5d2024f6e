// Scenes in the XML of OSL's testrender, whose root is <World>.
#pragma once

#include "core/scene/element.h"
#include "core/scene/reporter.h"
#include "core/scene/source_text.h"
#include "core/scene/xml_reader.h"

namespace aerosol::scene {

/// The same scene in our own elements.
///
/// <Camera eye dir|look_at up fov> (fov: degrees from bottom to top); <Option name="int N"> (max_bounces, rr_depth,
/// aa); <ShaderGroup> with the text of a group, or with <Parameter>, <Shader> and <ConnectShaders>; <Sphere center
/// radius>, <Quad corner edge_x edge_y> and <Model filename> of the last group before them (faces of a model whose
/// material, or else object, has the name of a group, have that one); <Background resolution>, of which the last group
/// before it tells the radiance. Surfaces are seen from both sides, with N and Ng towards the
/// viewer. Triples are written with commas or blanks. What is unknown is an error at its place.
SceneTree readWorld(const XmlElement& world, const SourceText& source, Reporter& reporter);

}  // namespace aerosol::scene
