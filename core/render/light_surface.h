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
  float pdf = 0;         ///< Per steradian.
  float u = 0, v = 0;    ///< Texture coordinates, as rays find them.
  MeshPlace place = {};  ///< On a mesh.
};

/// A part of a surface that can be sampled apart: all of it, or a triangle of a mesh.
struct SurfacePart {
  Box<World> box;
  Vector<World> normal{0, 0, 1};  ///< Unit, outwards, where it is flat.
  bool isFlat = false;
  double area = 0;  ///< Scene units²; may be 0.
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

  virtual std::uint32_t partCount() const { return 1; }
  virtual SurfacePart part(std::uint32_t index) const = 0;
  /// As `sample` and `pdf`, of one part alone.
  virtual std::optional<SurfaceSample> samplePart(std::uint32_t, Point<World> from, const LightUniforms& u) const {
    return sample(from, u);
  }
  virtual float pdfPart(std::uint32_t, Point<World> from, const LightHit& hit) const { return pdf(from, hit); }

  virtual double area() const = 0;          ///< Scene units².
  virtual Point<World> centre() const = 0;  ///< Mean of its points.
  virtual float extent() const = 0;         ///< About the distance of its points from the centre.
};

// Each of these is null when the surface has no area.

/// Uniform by area over all triangles. The mesh has its flags carried out (accel::resolveNormals) and must outlive the
/// surface.
std::unique_ptr<const LightSurface> makeMeshLight(const accel::TriangleMesh& mesh);

/// The square [-1, 1]² of the xy plane, facing +z: as a rectangle uniform by solid angle, far away and as a
/// parallelogram by area.
std::unique_ptr<const LightSurface> makeRectangleLight(const Transform<World, Object>& toWorld, bool flipNormals);

/// The unit disk of the xy plane, facing +z, uniform by area.
std::unique_ptr<const LightSurface> makeDiskLight(const Transform<World, Object>& toWorld, bool flipNormals);

/// The open cylinder of radius 1 about the z axis from 0 to 1, facing outwards; uniform over it before `toWorld`.
std::unique_ptr<const LightSurface> makeCylinderLight(const Transform<World, Object>& toWorld, bool flipNormals);

/// The unit sphere: seen from outside, uniform in the cone that it fills; from inside and as an ellipsoid, uniform over
/// the unit sphere before `toWorld`.
std::unique_ptr<const LightSurface> makeSphereLight(const Transform<World, Object>& toWorld, bool flipNormals);

}  // namespace aerosol::render
