#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/scene/syntax.h"
#include "core/scene/tables.h"
#include "core/scene/tables_emitters.h"

namespace aerosol::scene {

namespace {

/// A name that layers of files can bear.
std::string problemOfGroup(const std::string& name) {
  const bool isName = !name.empty() && name.find_first_not_of(
                                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                           "0123456789_-") == std::string::npos;
  return isName ? "" : "the name of a light group has letters, digits, _ and -";
}

template <class T>
Field<T> lightGroupField(const char* doc) {
  return {{.name = "light_group", .type = ValueType::string, .doc = doc}, [](T& object, const Value& value) {
            object.lightGroup = std::get<std::string>(value);
            return problemOfGroup(object.lightGroup);
          }};
}

std::string setVisibility(Shape& shape, const Value& value) {
  constexpr std::pair<std::string_view, std::uint32_t> words[] = {{"camera", RayKind::camera},
                                                                  {"shadow", RayKind::shadow},
                                                                  {"diffuse", RayKind::diffuse},
                                                                  {"reflection", RayKind::reflection},
                                                                  {"refraction", RayKind::refraction}};
  const auto& text = std::get<std::string>(value);
  shape.visibleTo = text == "all" ? RayKind::all : 0;
  if (text == "all" || text == "none") return {};
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = trim(std::string_view(text).substr(begin, end - begin));
    const auto known = std::find_if(std::begin(words), std::end(words), [&](const auto& w) { return w.first == word; });
    if (known == std::end(words)) {
      return fmt::format("'{}' is no kind of ray: there are camera, shadow, diffuse, reflection and refraction", word);
    }
    shape.visibleTo |= known->second;
    begin = end + 1;
  }
  return {};
}

std::vector<Field<Shape>> shapeFields(bool fromFile) {
  std::vector<Field<Shape>> fields = {
      field<&Shape::toWorld>({.name = "to_world", .doc = "the shape's own space to world", .defaultText = "identity"}),
      field<&Shape::flipNormals>({.name = "flip_normals", .doc = "turn inside and outside around"}),
      field<&Shape::facesViewer>({.name = "faces_viewer",
                                  .doc = "shaders find N and Ng turned towards the viewer, as those of testrender do: "
                                         "matte sheets are seen from both sides"}),
      field<&Shape::priority>({.name = "priority",
                               .doc = "of the interior medium (or of empty space inside, without one): where surfaces "
                                      "overlap the higher is there; 0 takes no part; a material with a medium of its "
                                      "own has its own"}),
      field<&Shape::clipVolumes>(
          {.name = "clip_volumes", .doc = "where this shape's inside rules there are no volume primitives"})};
  fields.push_back(lightGroupField<Shape>("of all that shines from it, as of an emitter"));
  fields.push_back(fieldWithoutEffect<Shape>("silhouette_sampling_weight", ValueType::number));
  fields.push_back(field<&Shape::lights>({.name = "lights",
                                          .doc = "ids of what lights it (emitters, shapes that emit, volumes that "
                                                 "glow), with commas between; \"none\"",
                                          .defaultText = "all"}));
  fields.push_back({{.name = "visible_to",
                     .type = ValueType::string,
                     .doc = "kinds of rays for which it is there, with commas between: camera, shadow, diffuse "
                            "(scattered by surfaces and media), reflection, refraction; \"none\"",
                     .defaultText = "all"},
                    setVisibility});
  if (!fromFile) return fields;
  fields.push_back(
      field<&Shape::faceNormals>({.name = "face_normals", .doc = "flat triangles: normals of the file are not used"}));
  fields.push_back(field<&Shape::repair>(
      {.name = "repair",
       .doc = "where the material says what is inside: faces that disagree with their neighbours which side is outside "
              "are turned around, and holes are closed, with a warning; false: the mesh is taken as it is"}));
  fields.push_back(field<&Shape::flipTexCoords>({.name = "flip_tex_coords",
                                                 .doc = "the file's v runs upwards, that of images downwards",
                                                 .defaultText = "true for obj, false for others"}));
  // The reader finds the file and puts in its path: the text alone does not say where it lies.
  fields.push_back({{.name = "filename",
                     .type = ValueType::string,
                     .doc = "the mesh, relative to the scene file or to a <path>",
                     .required = true},
                    [](Shape& shape, const Value& value) -> std::string {
                      shape.file = std::get<std::string>(value);
                      return shape.file.empty() ? "'filename' is empty" : "";
                    }});
  return fields;
}

std::vector<Field<Shape>> objFields() {
  std::vector<Field<Shape>> fields = shapeFields(true);
  fields.push_back({{.name = "faces",
                     .type = ValueType::string,
                     .doc = "usemtl NAME …: those of these materials of the file alone; o NAME …: those of objects or "
                            "groups; with not before, all others",
                     .defaultText = "all"},
                    [](Shape& shape, const Value& value) -> std::string {
                      std::istringstream words(std::get<std::string>(value));
                      std::string kind, name;
                      words >> kind;
                      if (kind == "not") words >> kind;
                      shape.faces = words.str();
                      if ((kind == "usemtl" || kind == "o") && words >> name) return "";
                      return "'faces' is usemtl or o with names behind it, and may begin with not";
                    }});
  return fields;
}

std::vector<Field<Shape>> serializedFields() {
  std::vector<Field<Shape>> fields = shapeFields(true);
  fields.push_back(field<&Shape::shapeIndex>(
      {.name = "shape_index", .doc = "which of the meshes in the file, from 0", .range = Range::atLeast(0)}));
  fields.push_back({{.name = "max_smooth_angle",
                     .type = ValueType::number,
                     .unit = "degrees",
                     .doc = "refused: creases are not found here",
                     .defaultText = "none"},
                    [](Shape&, const Value&) {
                      return std::string(
                          "'max_smooth_angle' is not supported: give the mesh normals where it is made, "
                          "or set 'face_normals'");
                    }});
  return fields;
}

TypeTable<Shape> curveTable(const char* type, const char* doc) {
  std::vector<Field<Shape>> fields = shapeFields(false);
  std::erase_if(fields, [](const Field<Shape>& f) { return f.spec.name == "flip_normals"; });
  for (Field<Shape>& f : fields) {
    if (f.spec.name != "to_world") continue;
    f.spec.doc = "the space of the file to world; radii stay as they are";
    f.animate = {};
  }
  fields.push_back({{.name = "filename",
                     .type = ValueType::string,
                     .doc = "text of x y z radius by line, and an empty line between fibres; u runs around a fibre, v "
                            "along it, and rays meet it from outside alone",
                     .required = true},
                    [](Shape& shape, const Value& value) -> std::string {
                      shape.file = std::get<std::string>(value);
                      return shape.file.empty() ? "'filename' is empty" : "";
                    }});
  return {.type = type, .doc = doc, .fields = std::move(fields), .nested = "bsdf"};
}

TypeTable<Shape> shapeTable(const char* type, const char* doc, std::vector<Field<Shape>> fields) {
  return {.type = type,
          .doc = doc,
          .fields = std::move(fields),
          .nested = "bsdf, displacement, emitter of type area, medium named interior, medium named exterior"};
}

std::vector<Field<Shape>> sphereFields() {
  std::vector<Field<Shape>> fields = shapeFields(false);
  fields.push_back(
      field<&Shape::center>({.name = "center", .unit = "scene units", .doc = "centre, in the shape's own space"}));
  fields.push_back(field<&Shape::radius>({.name = "radius",
                                          .unit = "scene units",
                                          .doc = "radius, in the shape's own space",
                                          .range = Range::positive()}));
  return fields;
}

std::vector<Field<Shape>> cylinderFields() {
  std::vector<Field<Shape>> fields = shapeFields(false);
  const auto end = [](const char* name, const char* doc, Point<Unplaced> standard, Point<Object> Shape::* member) {
    return Field<Shape>{
        {.name = name, .type = ValueType::point, .unit = "scene units", .doc = doc, .defaultValue = standard},
        [member](Shape& shape, const Value& value) -> std::string {
          const auto& p = std::get<Point<Unplaced>>(value);
          shape.*member = {p.x, p.y, p.z};
          return shape.center == shape.end ? "both ends of the cylinder are the same" : "";
        }};
  };
  fields.push_back(end("p0", "one end, in the shape's own space", {0, 0, 0}, &Shape::center));
  fields.push_back(end("p1", "the other end", {0, 0, 1}, &Shape::end));
  fields.push_back(field<&Shape::radius>({.name = "radius",
                                          .unit = "scene units",
                                          .doc = "radius, in the shape's own space",
                                          .range = Range::positive()}));
  return fields;
}

Field<Emitter> emittedField(const char* name, const char* unit, const char* doc) {
  return field<&Emitter::emitted>({.name = name, .unit = unit, .doc = doc, .range = Range::atLeast(0)});
}

/// `to_world` of a point light moves the origin, that of a directional one turns +z.
Field<Emitter> placementField(const char* doc) {
  return {{.name = "to_world", .type = ValueType::transform, .doc = doc, .defaultText = "identity"},
          [](Emitter& emitter, const Value& value) -> std::string {
            const auto transform = toTransform<World, Object>(std::get<Matrix4>(value));
            if (!transform) return "this transform is not affine and invertible";
            emitter.toWorld.keys.clear();
            emitter.position = (*transform)(Point<Object>(0, 0, 0));
            emitter.direction = normalize((*transform)(Vector<Object>(0, 0, 1)));
            return {};
          }};
}

Field<Emitter> pointPlacementField() {
  Field<Emitter> placement = placementField("instead of position: moves the origin to the light");
  placement.animate = [](Emitter& emitter, const std::vector<MotionKey>& keys) { emitter.toWorld.keys = keys; };
  return placement;
}

Field<Emitter> directionField() {
  return {{.name = "direction",
           .type = ValueType::vector,
           .doc = "where the light travels, of any length",
           .defaultValue = Vector<Unplaced>(0, 0, 1)},
          [](Emitter& emitter, const Value& value) -> std::string {
            const auto& d = std::get<Vector<Unplaced>>(value);
            const double x = static_cast<double>(d.x), y = static_cast<double>(d.y), z = static_cast<double>(d.z);
            const double length = std::hypot(x, y, z);
            if (!(length > 0)) return "a direction of no length points nowhere";
            emitter.direction = {static_cast<float>(x / length), static_cast<float>(y / length),
                                 static_cast<float>(z / length)};
            return {};
          }};
}

std::vector<Field<Emitter>> environmentFields() {
  // The reader finds the file, as it does for shapes.
  Field<Emitter> file{{.name = "filename",
                       .type = ValueType::string,
                       .doc = "image by latitude and longitude, relative to the scene file or to a <path>",
                       .required = true},
                      [](Emitter& emitter, const Value& value) -> std::string {
                        emitter.file = std::get<std::string>(value);
                        return emitter.file.empty() ? "'filename' is empty" : "";
                      }};
  Field<Emitter> compensation{{.name = "mis_compensation",
                               .type = ValueType::boolean,
                               .doc = "known from other renderers: here it is always on",
                               .defaultText = "true"},
                              [](Emitter&, const Value&) { return std::string(); }};
  return {std::move(file),
          field<&Emitter::scale>({.name = "scale", .doc = "factor on the image", .range = Range::atLeast(0)}),
          standing(field<&Emitter::toWorld>(
              {.name = "to_world", .doc = "turns the image, whose middle lies at -z", .defaultText = "identity"})),
          std::move(compensation)};
}

std::vector<Field<Emitter>> spotFields() {
  const Range angle{.minimum = 0, .maximum = 90, .openMinimum = true, .openMaximum = true};
  return {
      emittedField("intensity", "W/sr", "radiant intensity along the axis"),
      field<&Emitter::toWorld>(
          {.name = "to_world", .doc = "places the light, which shines along +z", .defaultText = "identity"}),
      field<&Emitter::cutoffAngle>(
          {.name = "cutoff_angle", .unit = "degrees", .doc = "from the axis to where the light ends", .range = angle}),
      field<&Emitter::beamWidth>({.name = "beam_width",
                                  .unit = "degrees",
                                  .doc = "from the axis to where it begins to fall off",
                                  .defaultText = "3/4 cutoff_angle",
                                  .range = Range{.minimum = 0, .maximum = 90, .openMaximum = true}})};
}

}  // namespace

namespace {

/// The numbers of samples of other renderers: here one path makes both kinds at each sample.
std::vector<Field<Integrator>> directFields() {
  std::vector<Field<Integrator>> fields = {field<&Integrator::hideEmitters>(
      {.name = "hide_emitters", .doc = "the camera sees through shapes that shine, and no environment"})};
  for (const char* name : {"shading_samples", "emitter_samples", "bsdf_samples", "samples_per_pass", "block_size"}) {
    fields.push_back(fieldWithoutEffect<Integrator>(name, ValueType::integer));
  }
  return fields;
}

std::vector<Field<Integrator>> withoutEffect(std::initializer_list<const char*> names) {
  std::vector<Field<Integrator>> fields;
  for (const char* name : names) fields.push_back(fieldWithoutEffect<Integrator>(name, ValueType::integer));
  return fields;
}

std::vector<Field<Integrator>> aovFields() {
  std::vector<Field<Integrator>> fields = withoutEffect({"samples_per_pass", "block_size"});
  fields.insert(fields.begin(), field<&Integrator::aovList>(
                                    {.name = "aovs",
                                     .doc = "what to show: NAME:QUANTITY,… with the quantities of aerosol help aovs, "
                                            "or light path expressions",
                                     .defaultText = "none"}));
  return fields;
}

}  // namespace

namespace {

std::vector<Field<Integrator>> pathFields() {
  return {
      field<&Integrator::maxDepth>({.name = "max_depth",
                                    .doc = "longest path: 1 shows emitters, 2 adds direct light; -1 is unbounded",
                                    .range = Range::atLeast(-1)}),
      field<&Integrator::rrDepth>(
          {.name = "rr_depth", .doc = "path length from which Russian roulette is played", .range = Range::atLeast(1)}),
      field<&Integrator::roulette>(
          {.name = "roulette",
           .doc = "by what Russian roulette decides: the light that comes through the path (throughput), or what "
                  "the path may still bring to its pixel, from its first vertex on, as a small render before "
                  "the render tells (contribution); auto takes the latter for pictures of 1024 pixels or more "
                  "in which media scatter"}),
      field<&Integrator::hideEmitters>(
          {.name = "hide_emitters", .doc = "the camera sees through shapes that shine, and no environment"}),
      field<&Integrator::transparentShadows>(
          {.name = "transparent_shadows",
           .doc = "light of points and directions shines straight through masks, thin panes and the like; without it "
                  "their shadows are black there. Larger lights are met through them in any case",
           .defaultText = "true for volpath and volpathmis, else false"}),
      field<&Integrator::clampIndirect>(
          {.name = "clamp_indirect",
           .unit = "radiance",
           .doc = "what a path brings at once after its second scattering is dimmed to this: fewer bright dots, "
                  "and a picture that is too dark, which is reported; 0: nothing is dimmed",
           .range = Range::atLeast(0)}),
      field<&Integrator::lowerPriorityWins>(
          {.name = "lower_priority_wins",
           .doc = "where media inside of surfaces overlap, the lower priority rules, not the higher"}),
      field<&Integrator::distance>(
          {.name = "distance",
           .doc = "distance sampling of media that do not choose; delta is the plainest method, to compare "
                  "with: analogue delta tracking under one bound for the whole medium"}),
      field<&Integrator::overlap>(
          {.name = "overlap",
           .doc = "how volume primitives along a ray are found: all of them, then sorted and split; or by "
                  "walking a partition of space as far as the path comes; auto decides by how many overlap"}),
      field<&Integrator::transmittance>(
          {.name = "transmittance", .doc = "transmittance to lights through media that do not choose"}),
      field<&Integrator::equiangular>(
          {.name = "equiangular", .doc = "distances in media are also chosen for the lights beside each ray"}),
      field<&Integrator::splitLights>(
          {.name = "split_lights",
           .doc = "of many lights up to eight are sampled at a point, or along a ray through media: clusters "
                  "are split while one's spread is "
                  "more than this part of all the light that arrives; 0 samples one light, 0.05 splits readily",
           .range = Range::atLeast(0)}),
      field<&Integrator::jointLights>(
          {.name = "joint_lights",
           .doc = "instead of equiangular distances, lights are tabulated along rays together with the media, "
                  "and distances chosen in proportion to both; where all media that scatter are marched or "
                  "constant"}),
      field<&Integrator::volumeLights>(
          {.name = "volume_lights",
           .doc = "media that glow are sampled as lights, where bounds on their emission are proven; otherwise "
                  "paths meet them by chance"}),
      field<&Integrator::lampDirections>(
          {.name = "lamp_directions",
           .doc = "directions out of media are also chosen towards lamps that stand in media; only with "
                  "equiangular"}),
      field<&Integrator::stepScale>(
          {.name = "step_scale", .doc = "factor on every ray marching step", .range = Range::positive()}),
      field<&Integrator::lodPixels>(
          {.name = "lod_pixels",
           .unit = "pixels",
           .doc = "volumes whose voxels the camera sees smaller than this are read from a coarser level of "
                  "their files; 0: as they are",
           .range = Range::atLeast(0)}),
      field<&Integrator::lodDepth>({.name = "lod_depth",
                                    .doc = "paths longer than this see volumes with coarser voxels; 0: none does",
                                    .range = Range::atLeast(0)}),
      field<&Integrator::lodLevels>({.name = "lod_levels",
                                     .doc = "how often their resolution is halved then",
                                     .range = {.minimum = 1, .maximum = 8}}),
      field<&Integrator::boundBoxes>({.name = "bound_boxes",
                                      .doc = "boxes over which bounds of the media's shaders are evaluated before "
                                             "the render, all media together",
                                      .range = Range::atLeast(0)}),
      field<&Integrator::boundMegabytes>({.name = "bound_megabytes",
                                          .unit = "MB",
                                          .doc = "memory for these bounds, all media together",
                                          .range = Range::atLeast(0)}),
      fieldWithoutEffect<Integrator>("samples_per_pass", ValueType::integer),
      fieldWithoutEffect<Integrator>("block_size", ValueType::integer),
      fieldWithoutEffect<Integrator>("timeout", ValueType::number),
      fieldWithoutEffect<Integrator>("strict_normals", ValueType::boolean),
      fieldWithoutEffect<Integrator>("use_spectral_mis", ValueType::boolean)};
}

/// What Mitsuba 0.6 has for light that paths from the camera find seldom, with all of its knobs.
std::vector<Field<Integrator>> fieldsOfOthers() {
  std::vector<Field<Integrator>> fields = pathFields();
  const auto known = [&](const std::string& name) {
    return std::any_of(fields.begin(), fields.end(), [&](const auto& field) { return field.spec.name == name; });
  };
  const auto ignore = [&](std::initializer_list<const char*> names, ValueType type) {
    for (const char* name : names) {
      if (!known(name)) fields.push_back(fieldWithoutEffect<Integrator>(name, type));
    }
  };
  ignore({"light_image", "sample_direct", "two_stage", "bidirectional", "bidirectional_mutation", "lens_perturbation",
          "multi_chain_perturbation", "caustic_perturbation", "manifold_perturbation", "uniform_mutation",
          "acceptance_map", "auto_cancel_gathering"},
         ValueType::boolean);
  ignore(
      {"luminance_samples", "direct_samples", "glossy_samples", "global_photons", "caustic_photons", "volume_photons",
       "lookup_size", "granularity", "photon_count", "max_passes", "chain_length", "num_chains", "max_chains"},
      ValueType::integer);
  ignore({"p_large", "lambda", "global_lookup_radius", "caustic_lookup_radius", "volume_lookup_radius",
          "initial_radius", "alpha", "clamping"},
         ValueType::number);
  return fields;
}

}  // namespace

const std::vector<TypeTable<Integrator>>& integratorTypes() {
  static const std::vector<TypeTable<Integrator>> tables = {
      {.type = "path",
       .doc = "path tracing of surfaces and media, with light sampling",
       .aliases = {"volpath", "volpathmis", "volpath_simple"},
       .fields = pathFields()},
      {.type = "ptracer",
       .doc = "paths from the lights: imitated by paths from the camera",
       .aliases = {"prb", "prb_basic", "prb_projective", "prbvolpath"},
       .fields = pathFields(),
       .substitute = "path"},
      {.type = "bdpt",
       .doc = "paths from both ends, chains of mutations and photons: imitated by paths from the camera",
       .aliases = {"pssmlt", "mlt", "erpt", "photonmapper", "ppm", "sppm", "vpl"},
       .fields = fieldsOfOthers(),
       .substitute = "path"},
      {.type = "direct",
       .doc = "what lights reach at once: path tracing with a max_depth of 2",
       .fields = directFields()},
      {.type = "depth",
       .doc = "distance from the near clip plane, along rays, to the first surface, whatever it is made of; 0: none",
       .fields = withoutEffect({"samples_per_pass", "block_size"})},
      {.type = "aov",
       .doc = "the picture of the integrator inside (black without one), and other quantities beside it in EXR files",
       .fields = aovFields(),
       .nested = "an integrator, by whose name its picture is there once more"},
      {.type = "moment",
       .doc = "the picture of the integrator inside, and the means of its samples and of their squares, in CIE XYZ, "
              "beside it in EXR files",
       .fields = withoutEffect({"samples_per_pass", "block_size"}),
       .nested = "an integrator"},
      {.type = "stokes",
       .doc = "the picture of the integrator inside; polarisation is not followed",
       .fields = withoutEffect({"samples_per_pass", "block_size"}),
       .nested = "an integrator"}};
  return tables;
}

const std::vector<TypeTable<Shape>>& shapeTypes() {
  static const std::vector<TypeTable<Shape>> tables = {
      shapeTable("obj", "a mesh in a Wavefront OBJ file", objFields()),
      shapeTable("ply", "a mesh in a PLY file", shapeFields(true)),
      shapeTable("serialized", "one of the meshes in a file of Mitsuba's binary format, version 3 or 4",
                 serializedFields()),
      shapeTable("sphere", "a sphere", sphereFields()),
      shapeTable("cube", "a cube from -1 to 1 on each axis", shapeFields(false)),
      shapeTable("rectangle", "a square from -1 to 1 in x and y, facing +z", shapeFields(false)),
      shapeTable("disk", "a disk of radius 1 in x and y, facing +z", shapeFields(false)),
      shapeTable("cylinder", "a cylinder between two points, without caps", cylinderFields()),
      curveTable("linearcurve", "fibres of straight pieces, with round ends"),
      curveTable("bsplinecurve", "fibres along cubic B-splines, without caps"),
      {.type = "shapegroup",
       .doc = "shapes and volumes that are seen where an instance refers to them",
       .nested = "shape, volume; no groups"},
      {.type = "instance",
       .doc = "a group in another place: each has the materials, media and emitters of the group",
       .fields = {field<&Shape::toWorld>(
           {.name = "to_world", .doc = "the group's space to world", .defaultText = "identity"})},
       .nested = "a shapegroup, or a ref to one"},
      {.type = "merge", .doc = "shapes that Mitsuba makes one of; here each stays what it is", .nested = "shape"}};
  return tables;
}

const std::vector<TypeTable<Emitter>>& emitterTypes() {
  static const std::vector<TypeTable<Emitter>> tables = [] {
    std::vector<TypeTable<Emitter>> all = {
        {.type = "point",
         .doc = "light from one point",
         .fields = {field<&Emitter::position>({.name = "position", .unit = "scene units", .doc = "place in the world"}),
                    pointPlacementField(), emittedField("intensity", "W/sr", "radiant intensity"),
                    field<&Emitter::radius>({.name = "radius",
                                             .unit = "scene units",
                                             .doc =
                                                 "no ray through media comes nearer than this; 0: only rays that meet "
                                                 "the light are kept off, by 1e-4 of their way through media",
                                             .range = Range::atLeast(0)})}},
        {.type = "directional",
         .doc = "parallel light from far away",
         .fields = {directionField(), placementField("instead of direction: turns +z into it"),
                    emittedField("irradiance", "W/m^2", "irradiance at right angles to the light")}},
        {.type = "constant",
         .doc = "equal light from everywhere far away",
         .fields = {emittedField("radiance", "W/(m^2 sr)", "radiance")}},
        {.type = "area",
         .doc = "light from the surface of the shape it stands in",
         .fields = {emittedField("radiance", "W/(m^2 sr)", "radiance, or a texture of it")},
         .nested = "texture named radiance"},
        {.type = "envmap", .doc = "light from all around, by an image", .fields = environmentFields()},
        {.type = "spot", .doc = "light from one point into a cone", .fields = spotFields(), .nested = "texture"},
        {.type = "projector",
         .doc = "a picture that is projected from one point, as a perspective camera sees",
         .fields = projectorFields(),
         .nested = "texture named irradiance"},
        {.type = "sunsky",
         .doc = "the sun and a clear sky, by the model of Hosek and Wilkie (2012, 2013)",
         .fields = sunSkyFields()},
        {.type = "background",
         .doc = "light from all around, as a surface shader says: its background() by the direction I",
         .fields = {field<&Emitter::resolution>(
             {.name = "resolution",
              .unit = "pixels",
              .doc = "the shader is asked in so many directions around and half as many from pole to pole",
              .range = {.minimum = 4, .maximum = 8192}})},
         .nested = "bsdf"}};
    for (TypeTable<Emitter>& table : all) {
      table.fields.push_back(lightGroupField<Emitter>("its light is a layer of its own with --aov light_groups"));
      table.fields.push_back(fieldWithoutEffect<Emitter>("sampling_weight", ValueType::number));
    }
    return all;
  }();
  return tables;
}

const std::vector<Field<MediumSampling>>& samplingFields() {
  static const std::vector<Field<MediumSampling>> fields = {
      field<&MediumSampling::stepSize>({.name = "step_size",
                                        .unit = "scene units",
                                        .doc = "ray marching step",
                                        .defaultText = "chosen by the renderer",
                                        .range = Range::positive()}),
      field<&MediumSampling::densityBound>({.name = "density_bound",
                                            .unit = "per scene unit",
                                            .doc = "declared upper bound of the extinction",
                                            .defaultText = "found by the renderer",
                                            .range = Range::positive()}),
      field<&MediumSampling::distance>(
          {.name = "distance", .doc = "distance sampling", .defaultText = "the integrator's"}),
      field<&MediumSampling::transmittance>(
          {.name = "transmittance", .doc = "transmittance to lights", .defaultText = "the integrator's"})};
  return fields;
}

const std::vector<Field<Tessellation>>& tessellationFields() {
  static const std::vector<Field<Tessellation>> fields = {
      field<&Tessellation::edgePixels>(
          {.name = "edge_pixels",
           .unit = "pixels",
           .doc = "edges are halved until the camera sees none longer; eight times that outside of the picture",
           .range = Range::positive()}),
      field<&Tessellation::edgeLength>({.name = "edge_length",
                                        .unit = "scene units",
                                        .doc = "instead: edges are halved until none is longer",
                                        .defaultText = "by edge_pixels",
                                        .range = Range::positive()}),
      field<&Tessellation::levels>({.name = "levels",
                                    .doc = "instead: all edges are halved so many times",
                                    .defaultText = "by edge_pixels",
                                    .range = {.minimum = 0, .maximum = 12}})};
  return fields;
}

const std::vector<Field<VelocityBlur>>& velocityFields() {
  static const std::vector<Field<VelocityBlur>> fields = {
      field<&VelocityBlur::output>(
          {.name = "velocity",
           .doc = "output of the medium's shader that gives its velocity, a vector in world space: blurs it"}),
      field<&VelocityBlur::grid>(
          {.name = "velocity_grid", .doc = "instead of velocity: a vector grid, in the space of its file"}),
      field<&VelocityBlur::file>(
          {.name = "velocity_file", .doc = "the file of velocity_grid", .defaultText = "the volume's filename"}),
      field<&VelocityBlur::scale>({.name = "velocity_scale", .doc = "factor on velocities"}),
      field<&VelocityBlur::fps>({.name = "fps",
                                 .unit = "frames per second",
                                 .doc = "velocities are scene units per frame",
                                 .defaultText = "per second",
                                 .range = Range::positive()}),
      field<&VelocityBlur::referenceTime>(
          {.name = "reference_time", .unit = "seconds", .doc = "when the medium is where its shader has it"})};
  return fields;
}

namespace {

template <auto pointer>
Field<Volume> control(ParameterSpec spec) {
  Field<VolumeControls> inner = field<pointer>(std::move(spec));
  return {std::move(inner.spec),
          [set = std::move(inner.set)](Volume& volume, const Value& value) { return set(volume.controls, value); }};
}

}  // namespace

const std::vector<Field<Volume>>& volumeFields() {
  static const std::vector<Field<Volume>> fields = {
      field<&Volume::toWorld>(
          {.name = "to_world", .doc = "the primitive's own space to world", .defaultText = "identity"}),
      control<&VolumeControls::density>(
          {.name = "density", .doc = "factor on the medium's extinction and scattering", .range = Range::atLeast(0)}),
      control<&VolumeControls::color>({.name = "color",
                                       .doc = "factor on the medium's scattering, from 0 to 1",
                                       .range = {.minimum = 0, .maximum = 1}}),
      control<&VolumeControls::emission>(
          {.name = "emission", .doc = "factor on the medium's emission", .range = Range::atLeast(0)}),
      control<&VolumeControls::densityRamp>(
          {.name = "density_ramp",
           .doc = "factor on extinction and scattering, by the medium's extinction there: \"0: 0; 2: 0.5; 10: 1\"",
           .defaultText = "none"}),
      control<&VolumeControls::colorRamp>(
          {.name = "color_ramp",
           .doc = "factor on scattering, by the medium's extinction there: \"0: 1 0.9 0.8; 10: 0.4 0.3 0.2\"",
           .defaultText = "none"}),
      control<&VolumeControls::stepScale>(
          {.name = "step_scale", .doc = "factor on the ray marching step", .range = Range::positive()}),
      control<&VolumeControls::shadowDensity>(
          {.name = "shadow_density", .doc = "factor on extinction as shadow rays see it", .range = Range::atLeast(0)}),
      control<&VolumeControls::holdout>(
          {.name = "holdout", .doc = "what the camera sees of the volume is a hole: black, without coverage"}),
      control<&VolumeControls::lights>(
          {.name = "lights",
           .doc =
               "ids of what lights it (emitters, shapes that emit, volumes that glow), with commas between; \"none\"",
           .defaultText = "all"})};
  return fields;
}

}  // namespace aerosol::scene
