// What a path meets where media nest: one face, or several that coincide, judged by what is inside of them.
#pragma once

#include <optional>

#include "core/accel/hit.h"
#include "core/render/light.h"
#include "core/render/path_context.h"
#include "core/volume/medium_stack.h"
#include "core/volume/task.h"

namespace aerosol::render {

/// Faces that a ray meets in one place.
struct Nesting {
  std::optional<accel::SurfaceHit> face;  ///< Whose closures hold; its answer is the path's. Set where media nest.
  bool isInterface =
      false;  ///< Something is inside of the faces: `crossing` is set, `path.mediaBehind` is what is behind.
  volume::Crossing crossing;
  accel::HitKey last;                      ///< Of the last face.
  volume::StackStatistics crossed;         ///< What crossing them counts.
  std::optional<accel::SurfaceHit> below;  ///< A surface without inside that the faces lie on: met next behind them.
};

/// Asks the material of a hit, and those of all faces with an inside that coincide with it.
///
/// Faces that are nearer to each other than rays can tell are crossed together, in the order of (object, primitive):
/// the interface is that between the media before the first and behind the last, as if there was one surface between
/// them, and the closures are those of the face whose interior rules on either side, of two the stronger.
volume::Task<Nesting> findNesting(PathContext& path, Ray<World> ray, accel::SurfaceHit hit);

/// Where no stack is kept: a surface of another object that the face of a body lies on, met next behind it.
std::optional<accel::SurfaceHit> findBelow(PathContext& path, Ray<World> ray, const accel::SurfaceHit& face);

/// Crosses what `findNesting` found.
void crossNesting(PathContext& path, const Nesting& nesting);

/// Whether the surface of a light lies on a face that a ray meets first, by the order of objects: what comes through is
/// bent, and found by the paths that go there. `ray` ends just before the light.
bool liesBehindFace(PathContext& path, Ray<World> ray, const LightSample& light);

/// What is inside of a surface that only bounds media; none where it says nothing of them.
std::optional<volume::Interior> boundaryInterior(const PreparedScene& scene, std::uint32_t object);

}  // namespace aerosol::render
