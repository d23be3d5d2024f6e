// Shapes that emit, as light sampling sees them.
#pragma once

#include <memory>
#include <optional>

#include "core/accel/mesh.h"
#include "core/render/light.h"

namespace aerosol::render {

/// A point chosen on a surface as seen from another one.
struct SurfaceSample {
  Point<World> point;
  Normal<World> normal;     ///< Geometric, unit, outwards.
  Vector<World> direction;  ///< Unit, towards the point.
  float distance = 0;
  float pdf = 0;  ///< Per steradian.
};

/// The emitting side of a surface: the one that its outward normal points to.
class LightSurface {
 public:
  virtual ~LightSurface() = default;

  /// A point whose outside is seen from `from`, as far as the surface does not hide itself; none when the chosen one
  /// is turned away.
  virtual std::optional<SurfaceSample> sample(Point<World> from, const LightUniforms& u) const = 0;
  /// The density of `sample` at a hit; 0 at its back.
  virtual float pdf(Point<World> from, const LightHit& hit) const = 0;
  virtual double area() const = 0;          ///< Scene units².
  virtual Point<World> centre() const = 0;  ///< Mean of its points.
};

// Each of these is null when the surface has no area.

/// Uniform by area over all triangles. The mesh has its flags carried out (accel::resolveNormals) and must outlive the
/// surface.
std::unique_ptr<const LightSurface> makeMeshLight(const accel::TriangleMesh& mesh);

/// The square [-1, 1]² of the xy plane, facing +z; uniform by area.
std::unique_ptr<const LightSurface> makeRectangleLight(const Transform<World, Object>& toWorld, bool flipNormals);

/// The unit disk of the xy plane, facing +z, uniform by area.
std::unique_ptr<const LightSurface> makeDiskLight(const Transform<World, Object>& toWorld, bool flipNormals);

/// The unit sphere: seen from outside, uniform in the cone that it fills; from inside and as an ellipsoid, uniform over
/// the unit sphere before `toWorld`.
std::unique_ptr<const LightSurface> makeSphereLight(const Transform<World, Object>& toWorld, bool flipNormals);

}  // namespace aerosol::render
