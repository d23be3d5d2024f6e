#include "core/render/preparation/shapes.h"

#include <fmt/format.h>

#include <cmath>

#include "core/accel/closed_mesh.h"
#include "core/accel/curved_mesh.h"
#include "core/render/preparation/displacement.h"
#include "core/render/preparation/materials.h"
#include "core/render/preparation/velocities.h"

namespace aerosol::render {

namespace {

/// From the cylinder of radius 1 from z = 0 to 1 to the shape's own space.
Transform<World, Object> cylinderPlacement(const scene::Shape& shape) {
  const Vector<Object> along = shape.end - shape.center;
  const Frame<Object> frame(normalize(along));
  Matrix4 place = identityMatrix(), inverse;
  for (std::size_t i = 0; i < 3; ++i) {
    const int k = static_cast<int>(i);
    place[i][0] = static_cast<double>(frame.x[k] * shape.radius);
    place[i][1] = static_cast<double>(frame.y[k] * shape.radius);
    place[i][2] = static_cast<double>(along[k]);
    place[i][3] = static_cast<double>(shape.center[k]);
  }
  invert(place, inverse);
  return {place, inverse};
}

Transform<World, Object> cylinderToWorld(const scene::Shape& shape, const Transform<World, Object>& toWorld) {
  const Transform<World, Object> place = cylinderPlacement(shape);
  return {multiply(toWorld.matrix(), place.matrix()), multiply(place.inverseMatrix(), toWorld.inverseMatrix())};
}

/// Light that goes in must come out: a mesh of a material that says what is inside is made one that has an inside.
void repairBody(Preparation& state, const scene::Shape& shape, accel::TriangleMesh& mesh) {
  if (!shape.repair || findDefect(mesh)) return;
  const auto index = static_cast<std::size_t>(&shape - state.description.shapes.data());
  if (!state.scene->objects[index].saysInside) return;
  const accel::MeshRepair repair = accel::closeBodies(mesh);
  const auto warn = [&](std::string message, std::string note) {
    state.warnings.warning(shape.origin.location, std::move(message), {std::move(note)});
  };
  const std::string note = "mend the mesh where it is modelled, or set 'repair' to false to take it as it is";
  if (repair.turned > 0) {
    warn(fmt::format("{} of the {} triangles of this mesh disagree with the others which side is outside, and its "
                     "material says what is inside: they are turned around",
                     repair.turned, mesh.triangles.size()),
         note);
  }
  if (repair.closedHoles > 0) {
    warn(fmt::format("this mesh has {} and its material says what is inside: {} closed with flat faces",
                     repair.closedHoles == 1 ? "a hole" : fmt::format("{} holes", repair.closedHoles),
                     repair.closedHoles == 1 ? "it is" : "they are"),
         note);
  }
}

Result<accel::TriangleMesh> meshOf(Preparation& state, const scene::Shape& shape,
                                   const Transform<World, Object>& toWorld) {
  using scene::ShapeType;
  accel::TriangleMesh mesh;
  if (shape.isFromFile()) {
    auto loaded = state.meshFiles.load(shape, toWorld, state.warnings);
    if (!loaded) return loaded.errors();
    mesh = std::move(*loaded);
    repairBody(state, shape, mesh);
  } else {
    mesh = shape.type == ShapeType::cube ? accel::makeCube(toWorld) : accel::makeRectangle(toWorld);
  }
  applyFlags(shape, mesh);
  return mesh;
}

/// The mesh of any shape in its own space, or that of its canonical form.
Result<UndisplacedMesh> undisplacedMesh(Preparation& state, const scene::Shape& shape) {
  using scene::ShapeType;
  const auto curved = [&](accel::CurvedMesh mesh, const Transform<World, Object>& place) {
    mesh.mesh.flipNormals = shape.flipNormals;
    return UndisplacedMesh{std::move(mesh.mesh), std::move(mesh.bend), place};
  };
  const Transform<World, Object> toWorld = state.atOpening(shape.toWorld);
  if (shape.type == ShapeType::sphere)
    return curved(accel::makeSphereMesh(), ballPlacement(toWorld, shape.center, shape.radius));
  if (shape.type == ShapeType::disk) return curved(accel::makeDiskMesh(), toWorld);
  if (shape.type == ShapeType::cylinder) return curved(accel::makeCylinderMesh(), cylinderToWorld(shape, toWorld));
  auto mesh = meshOf(state, shape, {});
  if (!mesh) return mesh.errors();
  return UndisplacedMesh{std::move(*mesh), {}, toWorld};
}

Result<accel::ObjectId> addDisplacedShape(Preparation& state, std::size_t index,
                                          const std::shared_ptr<const Motion>& motion, bool passThrough) {
  const scene::Shape& shape = state.description.shapes[index];
  auto base = undisplacedMesh(state, shape);
  if (!base) return base.errors();
  auto mesh = displaceMesh(state, index, std::move(*base));
  if (!mesh) return mesh.errors();
  if (!motion) return state.builder.addMesh(std::move(*mesh), passThrough);
  const Transform<World, Object> place = state.atOpening(shape.toWorld);
  accel::transformMesh(*mesh, {place.inverseMatrix(), place.matrix()});
  return state.builder.addMesh(std::move(*mesh), MovingPlace(motion), passThrough);
}

Result<accel::ObjectId> addMovingShape(Preparation& state, std::size_t index,
                                       const std::shared_ptr<const Motion>& motion, bool passThrough) {
  using scene::ShapeType;
  const scene::Shape& shape = state.description.shapes[index];
  if (shape.displacement) return addDisplacedShape(state, index, motion, passThrough);
  if (shape.type == ShapeType::sphere) {
    const MovingPlace place(motion, asObject(ballPlacement(Transform<World, Object>(), shape.center, shape.radius)));
    return state.builder.addSphere(place, passThrough, shape.flipNormals);
  }
  if (shape.type == ShapeType::disk) return state.builder.addDisk(MovingPlace(motion), passThrough, shape.flipNormals);
  if (shape.type == ShapeType::cylinder) {
    const MovingPlace place(motion, asObject(cylinderPlacement(shape)));
    return state.builder.addCylinder(place, passThrough, shape.flipNormals);
  }
  auto mesh = meshOf(state, shape, {});
  if (!mesh) return mesh.errors();
  return state.builder.addMesh(std::move(*mesh), MovingPlace(motion), passThrough);
}

Result<accel::ObjectId> addShape(Preparation& state, std::size_t index, bool passThrough) {
  using scene::ShapeType;
  const scene::Shape& shape = state.description.shapes[index];
  if (shape.isCurves() && state.motionOf(shape.toWorld)) {
    Diagnostics errors;
    errors.error(shape.origin.location, "fibres cannot move: leave them out of a group that does");
    return errors;
  }
  if (const auto motion = state.motionOf(shape.toWorld)) return addMovingShape(state, index, motion, passThrough);
  if (shape.displacement) return addDisplacedShape(state, index, nullptr, passThrough);
  const Transform<World, Object> toWorld = state.atOpening(shape.toWorld);
  if (shape.type == ShapeType::sphere)
    return state.builder.addSphere(ballPlacement(toWorld, shape.center, shape.radius), passThrough, shape.flipNormals);
  if (shape.type == ShapeType::disk) return state.builder.addDisk(toWorld, passThrough, shape.flipNormals);
  if (shape.type == ShapeType::cylinder)
    return state.builder.addCylinder(cylinderToWorld(shape, toWorld), passThrough, shape.flipNormals);
  if (shape.isCurves()) {
    auto curves = accel::loadCurves(shape.file.string(), curveBasis(shape), toWorld);
    if (!curves) return curves.errors();
    return state.builder.addCurves(std::move(*curves), passThrough);
  }
  // Bodies may be repaired: what they are made of is theirs alone.
  if (!(shape.repair && state.scene->objects[index].saysInside)) {
    const auto shared = state.meshFiles.shared(shape, state.builder, state.warnings);
    if (!shared) return shared.errors();
    if (*shared) return state.builder.addInstance(**shared, toWorld, passThrough);
  }
  auto mesh = meshOf(state, shape, toWorld);
  if (!mesh) return mesh.errors();
  return state.builder.addMesh(std::move(*mesh), passThrough);
}

}  // namespace

accel::CurveBasis curveBasis(const scene::Shape& shape) {
  return shape.type == scene::ShapeType::linearcurve ? accel::CurveBasis::linear : accel::CurveBasis::bSpline;
}

namespace {

/// Whether another medium begins behind it.
bool isInterface(const PreparedObject& object) {
  return object.separatesMedia() || object.isBoundary ||
         std::any_of(object.closures.begin(), object.closures.end(),
                     [](const Closure* closure) { return closure && closure->kind() == ClosureKind::interior; });
}

/// Hidden emitters are not there for the camera, which sees what lies behind them. Those around a medium stay, dark.
std::uint32_t visibilityOf(const Preparation& state, const scene::Shape& shape, const PreparedObject& object) {
  const bool isHidden = state.description.integrator.hideEmitters && shape.emitter && !isInterface(object);
  return isHidden ? shape.visibleTo & ~scene::RayKind::camera : shape.visibleTo;
}

/// What keeps light and paths consistent: media lie behind surfaces that are there for every ray, and lights are met
/// wherever they are sampled.
void decideVisibility(Preparation& state, const scene::Shape& shape, PreparedObject& object) {
  using scene::RayKind;
  static_assert(RayKind::camera == shading::ray::camera && RayKind::shadow == shading::ray::shadow &&
                RayKind::diffuse == shading::ray::diffuse && RayKind::reflection == shading::ray::reflection &&
                RayKind::refraction == shading::ray::refraction);
  if (shape.visibleTo == RayKind::all) return;
  constexpr std::uint32_t scattered = RayKind::diffuse | RayKind::reflection | RayKind::refraction;
  if (isInterface(object)) {
    state.errors.error(shape.origin.of("visible_to"), "a shape that bounds a medium is there for all rays");
  }
  if (shape.emitter && (shape.visibleTo & (scattered | RayKind::shadow)) != (scattered | RayKind::shadow)) {
    state.errors.error(shape.origin.of("visible_to"), "a shape that shines can be hidden from the camera alone");
  }
  object.castsShadows = (shape.visibleTo & RayKind::shadow) != 0;
  object.stopsScattered = (shape.visibleTo & RayKind::diffuse) != 0;
  const bool hides = object.castsShadows && (shape.visibleTo & scattered) != scattered;
  state.scene->hidesSurfaces = state.scene->hidesSurfaces || hides;
}

}  // namespace

void addShapes(Preparation& state) {
  for (std::size_t i = 0; i < state.description.shapes.size(); ++i) {
    const scene::Shape& shape = state.description.shapes[i];
    PreparedObject& object = state.scene->objects[i];
    describeMaterial(state, object);
    object.facesViewer = shape.facesViewer;
    decideVisibility(state, shape, object);
    auto id = addShape(state, i, object.isBoundary);
    if (!id) state.appendAt(shape.origin.location, id.errors());
    const bool lets = object.passesShadows || object.passesPoints || !object.castsShadows;
    if (id && lets) state.builder.letShadowsPass(*id);
    const std::uint32_t visibleTo = visibilityOf(state, shape, object);
    if (id && visibleTo != scene::RayKind::all) state.builder.setVisibility(*id, visibleTo);
    state.scene->shadowsPass = state.scene->shadowsPass || lets;
  }
}

namespace {

/// As of shapes: squares of lengths have to fit into floats.
bool isTooFar(const Preparation& state, Box<World> bounds, const std::shared_ptr<const Motion>& motion) {
  const auto reachesFar = [](const Box<World>& box) {
    for (int i = 0; i < 3; ++i) {
      if (!(std::fabs(box.lower[i]) <= 1e18f && std::fabs(box.upper[i]) <= 1e18f)) return true;
    }
    return false;
  };
  if (bounds.isEmpty()) return false;
  if (!motion) return reachesFar(bounds);
  const MovingPlace place(motion);
  return reachesFar(placed(bounds, place.at(state.scene->shutter.open))) ||
         reachesFar(placed(bounds, place.at(state.scene->shutter.close)));
}

}  // namespace

void addVolumes(Preparation& state) {
  for (std::size_t i = 0; i < state.description.volumes.size(); ++i) {
    const scene::Volume& volume = state.description.volumes[i];
    const VolumeType& type = *state.registry.volume(volume.type);
    const auto motion = state.motionOf(volume.toWorld);
    const scene::Volume still = state.standing(volume, motion != nullptr);
    const Transform<World, Object> standing = type.place(still);
    bool hasRoom = false;
    auto shape = type.make({still, standing, state.description.searchPath, state.warnings, state.scene->services.get(),
                            carriedBy(state, volume), &hasRoom});
    if (!shape) {
      state.appendAt(volume.origin.location, shape.errors());
      continue;
    }
    Box<World> bounds = (*shape)->worldBounds();
    if (isTooFar(state, bounds, motion)) {
      state.errors.error(volume.origin.location, "the volume reaches beyond 1e18",
                         {"squares of lengths have to fit into floats: write lengths in a larger unit"});
      continue;
    }
    *shape = carry(state, volume, state.scene->volumes[i]->index, standing, hasRoom, std::move(*shape));
    if (motion) bounds = placed(bounds, MovingPlace(motion).at(state.scene->shutter.open));
    for (const volume::Medium* medium : state.scene->mediaOf(i)) {
      MediumPlace& place = state.placements[medium->index].place;
      place.extent = length(bounds.upper - bounds.lower);
      place.domain = (*shape)->objectBounds();
      place.staysInside = true;
    }
    auto added = motion ? state.builder.addVolume(std::move(*shape), MovingPlace(motion))
                        : state.builder.addVolume(std::move(*shape));
    if (!added) {
      state.appendAt(volume.origin.location, added.errors());
    }
  }
}

void buildGeometry(Preparation& state) {
  using scene::OverlapChoice;
  accel::SceneOptions options{.embreeIsa = state.options.embreeIsa, .shutter = state.scene->shutter};
  const OverlapChoice choice = state.description.integrator.overlap;
  if (choice == OverlapChoice::partition) options.overlap = accel::OverlapDesign::partition;
  if (choice == OverlapChoice::automatic) options.overlap = state.builder.preferredOverlapDesign();
  auto built = state.builder.build(options);
  if (built) {
    state.scene->geometry.emplace(std::move(*built));
  } else {
    state.errors.append(built.errors());
  }
}

namespace {

std::unique_ptr<const LightSurface> surfaceOf(const scene::Shape& shape, const Transform<World, Object>& toWorld,
                                              const accel::TriangleMesh* mesh) {
  switch (shape.displacement ? scene::ShapeType::ply : shape.type) {
    case scene::ShapeType::sphere:
      return makeSphereLight(ballPlacement(toWorld, shape.center, shape.radius), shape.flipNormals);
    case scene::ShapeType::disk:
      return makeDiskLight(toWorld, shape.flipNormals);
    case scene::ShapeType::cylinder:
      return makeCylinderLight(cylinderToWorld(shape, toWorld), shape.flipNormals);
    case scene::ShapeType::rectangle:
      return makeRectangleLight(toWorld, shape.flipNormals);
    default:
      return makeMeshLight(*mesh);
  }
}

}  // namespace

std::unique_ptr<const LightSurface> lightSurface(const Preparation& state, const scene::Shape& shape,
                                                 accel::ObjectId object) {
  const bool moves = shape.toWorld.motionDuring(state.scene->shutter) != nullptr;
  return surfaceOf(shape, moves ? Transform<World, Object>() : state.atOpening(shape.toWorld),
                   state.scene->geometry->mesh(object));
}

double areaAtOpening(const Preparation& state, const scene::Shape& shape, accel::ObjectId object) {
  const accel::TriangleMesh* mesh = state.scene->geometry->mesh(object);
  accel::TriangleMesh moved;
  if (mesh && shape.toWorld.motionDuring(state.scene->shutter)) {
    moved = *mesh;
    accel::transformMesh(moved, state.atOpening(shape.toWorld));
    mesh = &moved;
  }
  const auto surface = surfaceOf(shape, state.atOpening(shape.toWorld), mesh);
  return surface ? surface->area() : 0;
}

}  // namespace aerosol::render
