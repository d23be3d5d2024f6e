// A scene in preparation: what its steps share.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/accel/scene.h"
#include "core/render/grid_answers.h"
#include "core/render/light_linking.h"
#include "core/render/medium_preparation.h"
#include "core/render/preparation/mesh_files.h"
#include "core/render/prepare.h"
#include "core/render/shader_binding.h"

namespace aerosol::render {

using MovingPlace = MovingTransform<World, Object>;

/// A box of a space that moves, in the world.
Box<World> placed(const Box<World>& box, const Transform<World, Object>& place);

/// The same map within the object's own spaces.
Transform<Object, Object> asObject(const Transform<World, Object>& local);

/// A medium whose voxels are coarser than their files'.
struct CoarseMedium {
  std::uint32_t medium = 0;
  int level = 0;                      ///< Halvings.
  std::optional<std::uint32_t> fine;  ///< The same medium as it is seen by shorter paths.
};

/// Each step adds to the errors what is wrong with its part, so that one run reports all.
struct Preparation {
  /// Where a medium of the description is placed.
  struct Placement {
    scene::Index medium = 0;
    scene::MediumSampling sampling;
    MediumPlace place;
  };

  Preparation(const scene::SceneDescription& description, const Registry& registry, const PrepareOptions& options,
              Diagnostics& warnings);

  ShaderSources shaderSources() { return {library, groups, description.layers}; }

  /// A material used by many shapes is reported once.
  void appendNew(const Diagnostics& added);
  void appendNew(const Diagnostic& error);
  /// Errors without a place of their own are those of the element. What is known is not repeated.
  void appendAt(const SourceLocation& element, const Diagnostics& added);

  Transform<World, Object> atOpening(const scene::Placement<World, Object>& placement) const {
    return placement.at(scene->shutter.open);
  }
  /// Null where nothing changes while the shutter is open.
  std::shared_ptr<const Motion> motionOf(const scene::Placement<World, Object>& placement);
  /// A volume as it stands when the shutter opens; one that moves, in the space that moves.
  scene::Volume standing(const scene::Volume& volume, bool moves) const;
  /// World units; of the geometry, once that is built.
  float sceneExtent() const;

  const scene::SceneDescription& description;
  const Registry& registry;
  const PrepareOptions& options;
  Diagnostics& warnings;
  shading::ShaderLibrary library;
  shading::GroupLibrary groups;
  std::unique_ptr<PreparedScene> scene;
  accel::SceneBuilder builder;
  std::vector<std::optional<shading::InstanceRef>> lightTextures;  ///< By emitter, then by shape that has one.
  std::vector<std::optional<shading::InstanceRef>> displacements;  ///< By shape.
  MeshFiles meshFiles;
  LightLinking links;
  GridAnswers gridAnswers;
  std::vector<Placement> placements;  ///< By medium index.
  std::vector<CoarseMedium> coarseMedia;
  Diagnostics errors;
};

}  // namespace aerosol::render
