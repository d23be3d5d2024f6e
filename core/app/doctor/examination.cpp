#include "core/app/doctor/examination.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/app/doctor/mesh_check.h"
#include "core/app/quantity.h"
#include "core/app/shader_report.h"
#include "core/render/medium_facts.h"

namespace aerosol::app {

namespace {

using volume::DistanceMethod;

std::string describe(Point<World> p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

bool bounds(const render::PreparedObject& object) {
  if (object.isBoundary || object.interior || object.exterior) return true;
  return std::any_of(object.closures.begin(), object.closures.end(),
                     [](const render::Closure* c) { return c && c->kind() == render::ClosureKind::interior; });
}

/// Four points that tell an affine image of a sphere.
bool areEqualSpheres(const scene::Shape& a, const scene::Shape& b) {
  for (const Vector<Object> offset : {Vector<Object>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    if (!(a.toWorld(a.center + a.radius * offset) == b.toWorld(b.center + b.radius * offset))) return false;
  }
  return true;
}

/// Of what is inside of a shape, where the scene says it: its own, or that of its material.
std::optional<int> priorityOf(const scene::SceneDescription& description, const scene::Shape& shape) {
  if (shape.priority != 0) return shape.priority;
  const scene::ShaderParameter* const parameter = description.materials[shape.material].find("priority");
  const auto value = parameter ? parameter->convertTo(scene::ValueType::integer) : std::nullopt;
  if (!value || std::get<int>(*value) == 0) return {};
  return std::get<int>(*value);
}

/// Whether it is said which of two media holds where faces of theirs coincide: such faces are crossed together then.
bool isDecided(const scene::SceneDescription& description, const render::PreparedScene& scene, const scene::Shape& a,
               const scene::Shape& b) {
  if (!scene.nestsMedia.isCalledFor()) return false;
  const auto p = priorityOf(description, a), q = priorityOf(description, b);
  return p && q && *p != *q;
}

void reportMesh(const MeshDefects& defects, const SourceLocation& place, Diagnostics& found) {
  if (defects.openEdges > 0) {
    found.warning(
        place,
        fmt::format("this mesh bounds a medium and has holes: {} with one triangle alone",
                    formatCount(defects.openEdges, "edge")),
        {"first near the world point " + describe(*defects.openAt),
         "rays that go in through the surface and out through a hole keep the medium: close the mesh where it is "
         "modelled; a surface that is meant to be open, such as water, is fine where all rays end elsewhere"});
  }
  if (defects.doubled > 0) {
    found.warning(
        place, fmt::format("{} of this mesh stand there twice", formatCount(defects.doubled, "triangle")),
        {"first at the world point " + describe(*defects.doubledAt), "remove the doubles: a ray enters twice"});
  }
  if (defects.crowdedEdges > 0) {
    found.warning(
        place, fmt::format("{} of this mesh have three or more triangles", formatCount(defects.crowdedEdges, "edge")),
        {"first near the world point " + describe(*defects.crowdedAt),
         "inner walls make inside and outside unclear: remove them"});
  }
  if (defects.turnedEdges > 0) {
    found.warning(place,
                  fmt::format("neighbours of this mesh disagree about which side is outside, at {}",
                              formatCount(defects.turnedEdges, "edge")),
                  {"first near the world point " + describe(*defects.turnedAt), "make the windings consistent"});
  }
}

constexpr const char* undefinedRemedy =
    "a division by 0, a root or logarithm of a negative number, or a density below 0: bound it with max(0, …) in the "
    "shader";

/// Gives findings without a place that place, and all of them the remedy.
void advise(Diagnostics& found, const SourceLocation& place, const char* remedy = nullptr) {
  for (Diagnostic& each : found.entries()) {
    if (each.location.file.empty()) each.location = place;
    if (remedy) each.notes.emplace_back(remedy);
  }
}

/// Of point lights that rays may come as near to as they like.
SourceLocation firstWithoutRadius(const scene::SceneDescription& description) {
  for (const scene::Emitter& emitter : description.emitters) {
    const bool isPoint = emitter.type == scene::EmitterType::point || emitter.type == scene::EmitterType::spot;
    if (isPoint && !(emitter.radius > 0)) return emitter.origin.location;
  }
  return description.integrator.origin.location;
}

SourceLocation firstMeshVolume(const scene::SceneDescription& description) {
  for (const scene::Volume& volume : description.volumes) {
    if (volume.type == "mesh") return volume.origin.location;
  }
  return description.sensor.origin.location;
}

}  // namespace

Diagnostics examineGeometry(const scene::SceneDescription& description, const render::PreparedScene& scene) {
  Diagnostics found;
  std::vector<const accel::TriangleMesh*> meshes(scene.objects.size());
  std::vector<std::unique_ptr<accel::TriangleMesh>> placed;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (!bounds(scene.objects[i])) continue;
    const auto object = static_cast<accel::ObjectId>(i);
    meshes[i] = scene.geometry->mesh(object);
    if (const Transform<World, Object>* const place = scene.geometry->sharedPlacement(object)) {
      placed.push_back(std::make_unique<accel::TriangleMesh>(*meshes[i]));
      accel::transformMesh(*placed.back(), *place);
      meshes[i] = placed.back().get();
    }
    const scene::ShapeType type = description.shapes[i].type;
    const bool isClosedKind =
        type != scene::ShapeType::rectangle && type != scene::ShapeType::disk && type != scene::ShapeType::cylinder;
    if (meshes[i] && isClosedKind) reportMesh(checkMesh(*meshes[i]), description.shapes[i].origin.location, found);
  }
  for (const CoincidentFaces& pair : findCoincidentFaces(meshes)) {
    if (isDecided(description, scene, description.shapes[pair.first], description.shapes[pair.second])) continue;
    const SourceLocation &a = description.shapes[pair.first].origin.location,
                         &b = description.shapes[pair.second].origin.location;
    found.warning(
        b, "this surface coincides with another one that bounds a medium",
        {fmt::format("the other one is at {}:{}:{}, they meet near {}", a.file, a.line, a.column, describe(pair.at)),
         "which medium holds there is up to rounding: give both a 'priority' (of the shape, or of a material that says "
         "what is inside), and they are crossed together; or move them apart"});
  }
  for (std::size_t i = 0; i < description.shapes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const scene::Shape &a = description.shapes[j], &b = description.shapes[i];
      const bool areSpheres = a.type == scene::ShapeType::sphere && b.type == scene::ShapeType::sphere;
      if (!areSpheres || a.displacement || b.displacement || !bounds(scene.objects[i]) || !bounds(scene.objects[j]))
        continue;
      if (!areEqualSpheres(a, b) || isDecided(description, scene, a, b)) continue;
      found.warning(b.origin.location, "this surface coincides with another one that bounds a medium",
                    {fmt::format("the other one is at {}:{}:{}", a.origin.location.file, a.origin.location.line,
                                 a.origin.location.column),
                     "give both a different 'priority', or make one of the two spheres larger"});
    }
  }
  return found;
}

Diagnostics examineSampling(const scene::SceneDescription&, const render::PreparedScene& scene) {
  Diagnostics found;
  for (const volume::Medium& medium : scene.media) {
    if (medium.constant) continue;
    const SourceLocation& place = scene.mediumLocations[medium.index];
    const std::string& name = scene.mediumNames[medium.index];
    const auto extent = static_cast<double>(render::extentOf(scene, medium));
    if (medium.method == DistanceMethod::marching) {
      const double steps = render::stepsAcross(scene, medium);
      if (steps > render::endlessSteps) {
        found.warning(
            place,
            fmt::format("marching through '{}' takes {} steps a ray{}", name, formatShort(steps),
                        steps > volume::maximumSteps ? ", and would take longer ones to end" : ""),
            {fmt::format("its step_size is {:.4g} across {:.4g}: give it one of {:.4g} or so, or a density_bound",
                         static_cast<double>(medium.stepSize), extent, extent / 200)});
      } else if (steps < 2) {
        found.warning(place, fmt::format("one step of marching through '{}' is longer than half of it", name),
                      {fmt::format("its step_size is {:.4g} across {:.4g}, so what is inside is missed: give it one of "
                                   "{:.4g} or so, or let the renderer choose",
                                   static_cast<double>(medium.stepSize), extent, extent / 50)});
      }
    }
    if (medium.bound && medium.method == DistanceMethod::nullScattering) {
      const double collisions = static_cast<double>(medium.bound->value) * extent;
      if (collisions > render::endlessSteps) {
        found.warning(
            place,
            fmt::format("null scattering in '{}' makes {} tentative collisions a ray", name, formatShort(collisions)),
            {fmt::format("its bound is {:.4g} across {:.4g}: a density_bound no larger than the shader's values makes "
                         "rays shorter (aerosol render --stats tells how far it is above them); of matter that is so "
                         "dense, distance 'marching' with a step_size of {:.4g} shows the surface",
                         static_cast<double>(medium.bound->value), extent, extent / 200)});
      }
    }
  }
  return found;
}

Diagnostics examineInputs(const scene::SceneDescription& description, const render::PreparedScene& scene) {
  Diagnostics found;
  std::set<scene::Index> materials, media, displacements;
  for (const scene::Shape& shape : description.shapes) {
    materials.insert(shape.material);
    if (shape.displacement) displacements.insert(*shape.displacement);
    for (const auto& medium : {shape.interior, shape.exterior}) {
      if (medium) media.insert(*medium);
    }
  }
  for (const scene::Volume& volume : description.volumes) media.insert(volume.medium);
  if (description.sensor.medium) media.insert(*description.sensor.medium);
  const auto report = [&](const scene::ShaderUse& shader, const char* kind) {
    found.warning(shader.origin.location, fmt::format("nothing uses this {}, '{}'", kind, shader.name),
                  {"refer to it with <ref>, or remove it"});
  };
  for (scene::Index i = 0; i < description.materials.size(); ++i) {
    if (!materials.contains(i)) report(description.materials[i], "material");
  }
  for (scene::Index i = 0; i < description.media.size(); ++i) {
    if (!media.contains(i)) report(description.media[i].shader, "medium");
  }
  for (scene::Index i = 0; i < description.displacements.size(); ++i) {
    if (!displacements.contains(i)) report(description.displacements[i].shader, "displacement");
  }
  if (scene.lights.size() == 0) {
    found.warning(description.integrator.origin.location, "the scene has no light",
                  {"only what shaders emit will be seen; an <emitter type=\"constant\"/> lights everything"});
  }
  return found;
}

Diagnostics examinePilot(const scene::SceneDescription& description, const render::PreparedScene& scene,
                         const PilotReport& pilot) {
  const render::WorkerStatistics& s = pilot.report.statistics;
  const SourceLocation& camera = description.sensor.origin.location;
  Diagnostics found = reportMessages(scene.messages->sorted(), 0).messages;
  advise(found, {}, "the shader says so, or a function that it calls: its line tells when");
  Diagnostics invalid = reportInvalidClosures(scene);
  advise(invalid, {}, undefinedRemedy);
  found.append(invalid);
  found.append(reportInvalidCoefficients(scene));
  found.append(reportAmplifyingMedia(scene));
  Diagnostics trackers = reportTrackers(scene, s.trackers);
  advise(trackers, camera);
  found.append(trackers);
  Diagnostics lights = reportLights(s);
  advise(lights, firstWithoutRadius(description));
  found.append(lights);
  Diagnostics dropped = reportDroppedSamples(*pilot.film);
  advise(
      dropped, camera,
      "what shaders give at these paths is looked at by: aerosol render --crop X,Y,1,1 --aov cost, and printf in the "
      "shader");
  found.append(dropped);
  for (std::size_t i = 0; i < scene.media.size(); ++i) {
    if (scene.messages->invalid().contains(static_cast<std::uint32_t>(i))) {
      for (Diagnostic& each : found.entries()) {
        if (each.location == scene.mediumLocations[i]) {
          each.notes.push_back(undefinedRemedy);
          break;
        }
      }
    }
  }
  const std::uint64_t open = s.media.exitsWithoutEntry + s.media.repeatedEntries;
  if (open > 0) {
    found.warning(
        camera, fmt::format("{} leave a medium that they never entered, or enter it twice", formatCount(open, "ray")),
        {"a mesh is open or turned inside out, or the camera stands inside of something: see the meshes above"});
  }
  if (s.accel.openVolumes > 0) {
    found.warning(firstMeshVolume(description),
                  fmt::format("{} go through the mesh of a volume primitive an odd number of times",
                              formatCount(s.accel.openVolumes, "ray")),
                  {"the mesh has a hole: close it where it is modelled"});
  }
  if (s.accel.invalidRays > 0) {
    found.warning(camera, fmt::format("{} were not finite", formatCount(s.accel.invalidRays, "ray")),
                  {"transforms of the camera or of objects give coordinates beyond what a float holds: make the scene "
                   "smaller"});
  }
  return found;
}

}  // namespace aerosol::app
