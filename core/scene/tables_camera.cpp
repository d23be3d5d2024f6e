#include <utility>

#include "core/scene/focal_length.h"
#include "core/scene/tables.h"

namespace aerosol::scene {

namespace {

constexpr int longestSide = 1 << 16;

/// Clip planes and shutter, which all cameras have.
void addPlanesAndShutter(std::vector<Field<Sensor>>& fields) {
  fields.push_back(field<&Sensor::nearClip>({.name = "near_clip",
                                             .unit = "scene units",
                                             .doc = "nothing nearer along the view is seen",
                                             .range = Range::positive()}));
  fields.push_back(field<&Sensor::farClip>({.name = "far_clip",
                                            .unit = "scene units",
                                            .doc = "nothing farther along the view is seen",
                                            .range = Range::positive()}));
  fields.push_back(
      field<&Sensor::shutterOpen>({.name = "shutter_open", .unit = "seconds", .doc = "when light is let in"}));
  fields.push_back(field<&Sensor::shutterClose>({.name = "shutter_close",
                                                 .unit = "seconds",
                                                 .doc = "until when; without it the picture is of one instant",
                                                 .defaultText = "shutter_open"}));
}

std::vector<Field<Sensor>> orthographicFields() {
  std::vector<Field<Sensor>> fields = {
      field<&Sensor::toWorld>({.name = "to_world",
                               .doc = "camera to world; the camera looks along +z and sees -1 to 1 in x, so its scale "
                                      "says how much of the scene",
                               .defaultText = "identity"})};
  addPlanesAndShutter(fields);
  return fields;
}

std::vector<Field<Sensor>> perspectiveFields() {
  Field<Sensor> focalLength = field<&Sensor::focalLength>(
      {.name = "focal_length", .doc = "instead of fov: focal length of a 36 x 24 mm film", .defaultText = "50mm"});
  focalLength.set = [](Sensor& sensor, const Value& value) -> std::string {
    const auto& text = std::get<std::string>(value);
    if (!parseFocalLength(text)) return "'" + text + "' is not a focal length: write one like 50mm";
    sensor.focalLength = text;
    sensor.fov.reset();
    return {};
  };
  std::vector<Field<Sensor>> fields = {
      field<&Sensor::toWorld>({.name = "to_world",
                               .doc = "camera to world, without scale; the camera looks along +z",
                               .defaultText = "identity"}),
      field<&Sensor::fov>({.name = "fov",
                           .unit = "degrees",
                           .doc = "angle of view",
                           .defaultText = "from focal_length",
                           .range = {.minimum = 0, .maximum = 180, .openMinimum = true, .openMaximum = true}}),
      field<&Sensor::fovAxis>({.name = "fov_axis", .doc = "the side of the film that fov spans"}),
      std::move(focalLength),
      field<&Sensor::principalPointX>({.name = "principal_point_offset_x",
                                       .unit = "film widths",
                                       .doc = "shifts the film to the side against the view's axis"}),
      field<&Sensor::principalPointY>({.name = "principal_point_offset_y",
                                       .unit = "film heights",
                                       .doc = "shifts the film downwards against the view's axis"}),
  };
  addPlanesAndShutter(fields);
  return fields;
}

/// Exporters write where a lens would be sharp for pinholes too.
std::vector<Field<Sensor>> pinholeFields() {
  std::vector<Field<Sensor>> fields = perspectiveFields();
  fields.push_back(fieldWithoutEffect<Sensor>("focus_distance", ValueType::number));
  return fields;
}

std::vector<Field<Sensor>> thinlensFields() {
  std::vector<Field<Sensor>> fields = perspectiveFields();
  fields.push_back(field<&Sensor::apertureRadius>({.name = "aperture_radius",
                                                   .unit = "scene units",
                                                   .doc = "radius of the lens; 0 is a pinhole",
                                                   .required = true,
                                                   .range = Range::atLeast(0)}));
  fields.push_back(field<&Sensor::focusDistance>({.name = "focus_distance",
                                                  .unit = "scene units",
                                                  .doc = "distance along the view that is sharp",
                                                  .defaultText = "far_clip",
                                                  .range = Range::positive()}));
  return fields;
}

Range side(int minimum) { return {.minimum = static_cast<double>(minimum), .maximum = longestSide}; }

std::vector<Field<Sampler>> samplerFields() {
  return {
      field<&Sampler::sampleCount>(
          {.name = "sample_count", .unit = "samples per pixel", .doc = "paths per pixel", .range = Range::atLeast(1)}),
      field<&Sampler::seed>(
          {.name = "seed", .doc = "another seed gives another, independent noise", .range = Range::atLeast(0)})};
}

/// Mitsuba's stratified samplers: the low-discrepancy one takes their place, and their own knobs mean nothing.
TypeTable<Sampler> imitated(const std::string& type) {
  TypeTable<Sampler> table{.type = type,
                           .doc = "read for compatibility: sobol is used instead, with a warning",
                           .fields = samplerFields(),
                           .substitute = "sobol"};
  const auto ignored = [&](const char* name, ValueType valueType) {
    table.fields.push_back({{.name = name, .type = valueType, .doc = "has no effect", .withoutEffect = true},
                            [](Sampler&, const Value&) { return std::string(); }});
  };
  if (type == "halton" || type == "hammersley")
    ignored("scramble", ValueType::integer);
  else if (type != "ldsampler")
    ignored("jitter", ValueType::boolean);
  if (type == "orthogonal") ignored("strength", ValueType::integer);
  return table;
}

}  // namespace

const std::vector<TypeTable<Sensor>>& sensorTypes() {
  static const std::vector<TypeTable<Sensor>> tables = {
      {.type = "perspective",
       .doc = "a pinhole camera",
       .fields = pinholeFields(),
       .nested = "film, sampler, medium (what the camera stands in)"},
      {.type = "thinlens",
       .doc = "a camera with a lens, hence depth of field",
       .fields = thinlensFields(),
       .nested = "film, sampler, medium (what the camera stands in)"},
      {.type = "orthographic",
       .doc = "a camera without perspective: all rays are parallel",
       .fields = orthographicFields(),
       .nested = "film, sampler, medium (what the camera stands in)"}};
  return tables;
}

namespace {

std::vector<Field<Film>> filmFields(std::string standardFormat, std::vector<std::string> fileFormats,
                                    const char* fileFormatDoc) {
  return {field<&Film::width>({.name = "width", .unit = "pixels", .doc = "width of the picture", .range = side(1)}),
          field<&Film::height>({.name = "height", .unit = "pixels", .doc = "height of the picture", .range = side(1)}),
          field<&Film::cropOffsetX>(
              {.name = "crop_offset_x", .unit = "pixels", .doc = "left edge of what is rendered", .range = side(0)}),
          field<&Film::cropOffsetY>(
              {.name = "crop_offset_y", .unit = "pixels", .doc = "upper edge of what is rendered", .range = side(0)}),
          field<&Film::cropWidth>({.name = "crop_width",
                                   .unit = "pixels",
                                   .doc = "width of what is rendered",
                                   .defaultText = "to the right edge",
                                   .range = side(1)}),
          field<&Film::cropHeight>({.name = "crop_height",
                                    .unit = "pixels",
                                    .doc = "height of what is rendered",
                                    .defaultText = "to the lower edge",
                                    .range = side(1)}),
          field<&Film::pixelFormat>({.name = "pixel_format",
                                     .doc = "channels of an OpenEXR file; those that end with a add coverage. Other "
                                            "files are of red, green and blue, or grey"}),
          field<&Film::componentFormat>({.name = "component_format", .doc = "precision of an OpenEXR file"}),
          {{.name = "file_format",
            .type = ValueType::string,
            .doc = fileFormatDoc,
            .defaultValue = std::move(standardFormat),
            .choices = std::move(fileFormats)},
           [](Film&, const Value&) { return std::string(); }},
          fieldWithoutEffect<Film>("sample_border", ValueType::boolean),
          fieldWithoutEffect<Film>("compensate", ValueType::boolean),
          fieldWithoutEffect<Film>("banner", ValueType::boolean),
          fieldWithoutEffect<Film>("high_quality_edges", ValueType::boolean),
          fieldWithoutEffect<Film>("attach_log", ValueType::boolean)};
}

/// How Mitsuba 0.6 makes a picture for a display out of one: here the display and its view do.
std::vector<Field<Film>> displayedFilmFields() {
  std::vector<Field<Film>> fields =
      filmFields("png", {"png", "jpeg"}, "the file's name on the command line decides: .png and .jpg are for displays");
  for (const char* name : {"gamma", "exposure", "key", "burn"})
    fields.push_back(fieldWithoutEffect<Film>(name, ValueType::number));
  fields.push_back(fieldWithoutEffect<Film>("tonemap_method", ValueType::string));
  return fields;
}

}  // namespace

const std::vector<TypeTable<Film>>& filmTypes() {
  static const std::vector<TypeTable<Film>> tables = {
      {.type = "hdrfilm",
       .doc = "the picture",
       .fields = filmFields("openexr", {"openexr", "exr", "rgbe", "pfm"},
                            "the file's name on the command line decides; OpenEXR is what this film is made for"),
       .nested = "rfilter"},
      {.type = "ldrfilm",
       .doc = "the picture, in scenes of Mitsuba 0.6; --display, --view and --exposure say how it is shown",
       .fields = displayedFilmFields(),
       .nested = "rfilter"}};
  return tables;
}

const std::vector<TypeTable<ReconstructionFilter>>& filterTypes() {
  const auto radius = [](float pixels, const char* doc) {
    Field<ReconstructionFilter> f = field<&ReconstructionFilter::radius>(
        {.name = "radius", .unit = "pixels", .doc = doc, .range = {.minimum = 0, .maximum = 64, .openMinimum = true}});
    f.spec.defaultValue = pixels;
    return f;
  };
  static const std::vector<TypeTable<ReconstructionFilter>> tables = {
      {.type = "box", .doc = "the mean over a square", .fields = {radius(0.5f, "half the side of the square")}},
      {.type = "tent", .doc = "falls linearly to zero", .fields = {radius(1, "where it reaches zero")}},
      {.type = "gaussian",
       .doc = "a bell",
       .fields = {[&] {
                    Field<ReconstructionFilter> f = radius(2, "where it is cut off");
                    f.spec.defaultValue.reset();
                    f.spec.defaultText = "4 stddev";
                    return f;
                  }(),
                  field<&ReconstructionFilter::stddev>({.name = "stddev",
                                                        .unit = "pixels",
                                                        .doc = "standard deviation",
                                                        .range = {.minimum = 0, .maximum = 16, .openMinimum = true}})}},
      {.type = "mitchell",
       .doc = "the cubic of Mitchell and Netravali, between sharp and free of ringing",
       .fields = {field<&ReconstructionFilter::b>(
                      {.name = "B", .doc = "their B: how much it blurs", .range = {.minimum = 0, .maximum = 1}}),
                  field<&ReconstructionFilter::c>(
                      {.name = "C", .doc = "their C: how much it rings", .range = {.minimum = 0, .maximum = 1}})}},
      {.type = "catmullrom", .doc = "the cubic of Catmull and Rom: sharper, rings more"},
      {.type = "lanczos",
       .doc = "a windowed sinc: sharpest, rings most",
       .fields = {field<&ReconstructionFilter::lobes>(
           {.name = "lobes", .doc = "lobes on each side", .range = {.minimum = 1, .maximum = 16}})}}};
  return tables;
}

const std::vector<TypeTable<Sampler>>& samplerTypes() {
  static const std::vector<TypeTable<Sampler>> tables = {
      {.type = "independent", .doc = "independent random numbers", .fields = samplerFields()},
      {.type = "sobol", .doc = "Owen-scrambled Sobol' points, of low discrepancy", .fields = samplerFields()},
      imitated("ldsampler"),
      imitated("stratified"),
      imitated("multijitter"),
      imitated("orthogonal"),
      imitated("halton"),
      imitated("hammersley")};
  return tables;
}

}  // namespace aerosol::scene
