#include "core/scene/tables_emitters.h"

#include <cmath>

#include "core/scene/focal_length.h"

namespace aerosol::scene {

namespace {

constexpr const char* otherwiseDirection = "instead of sun_direction: ";

/// A parameter of the place of the sun.
template <auto pointer>
Field<Emitter> sunField(ParameterSpec spec) {
  spec.doc = otherwiseDirection + spec.doc;
  Field<SunPlace> inner = field<pointer>(std::move(spec));
  return {std::move(inner.spec),
          [set = std::move(inner.set)](Emitter& emitter, const Value& value) { return set(emitter.sun, value); }};
}

Field<Emitter> sunDirectionField() {
  return {{.name = "sun_direction",
           .type = ValueType::vector,
           .doc = "towards the sun in the world, of any length",
           .defaultText = "by place and time"},
          [](Emitter& emitter, const Value& value) -> std::string {
            const auto& d = std::get<Vector<Unplaced>>(value);
            const double x = static_cast<double>(d.x), y = static_cast<double>(d.y), z = static_cast<double>(d.z);
            const double length = std::hypot(x, y, z);
            if (!(length > 0)) return "a direction of no length points nowhere";
            emitter.sun.direction = {static_cast<float>(x / length), static_cast<float>(y / length),
                                     static_cast<float>(z / length)};
            return {};
          }};
}

Range between(double least, double greatest) { return {.minimum = least, .maximum = greatest}; }

}  // namespace

Field<Emitter> standing(Field<Emitter> placement) {
  placement.animate = nullptr;
  return placement;
}

std::vector<Field<Emitter>> projectorFields() {
  Field<Emitter> focalLength = field<&Emitter::focalLength>(
      {.name = "focal_length", .doc = "instead of fov: focal length of a 36 x 24 mm film", .defaultText = "50mm"});
  focalLength.set = [](Emitter& emitter, const Value& value) -> std::string {
    const auto& text = std::get<std::string>(value);
    if (!parseFocalLength(text)) return "'" + text + "' is not a focal length: write one like 50mm";
    emitter.focalLength = text;
    emitter.fov.reset();
    return {};
  };
  return {
      field<&Emitter::emitted>({.name = "irradiance",
                                .unit = "W/m^2 / pi",
                                .doc = "what a plane at distance 1 that faces the light gets, over pi; or a "
                                       "texture of it, upright as the light sees it",
                                .range = Range::atLeast(0)}),
      field<&Emitter::scale>({.name = "scale", .doc = "factor on the irradiance", .range = Range::atLeast(0)}),
      field<&Emitter::toWorld>(
          {.name = "to_world", .doc = "places the light, which shines along +z with +y up", .defaultText = "identity"}),
      field<&Emitter::fov>({.name = "fov",
                            .unit = "degrees",
                            .doc = "angle of view",
                            .defaultText = "from focal_length",
                            .range = {.minimum = 0, .maximum = 180, .openMinimum = true, .openMaximum = true}}),
      field<&Emitter::fovAxis>({.name = "fov_axis", .doc = "the side of the picture that fov spans"}),
      std::move(focalLength),
      field<&Emitter::aspect>({.name = "aspect",
                               .doc = "width of the picture over its height",
                               .defaultText = "that of a bitmap, else 1",
                               .range = Range::positive()})};
}

std::vector<Field<Emitter>> sunSkyFields() {
  return {
      field<&Emitter::turbidity>(
          {.name = "turbidity", .doc = "of the air: 2 is very clear, 10 hazy", .range = between(1, 10)}),
      sunDirectionField(),
      sunField<&SunPlace::latitude>(
          {.name = "latitude", .unit = "degrees", .doc = "north of the equator", .range = between(-90, 90)}),
      sunField<&SunPlace::longitude>(
          {.name = "longitude", .unit = "degrees", .doc = "east of Greenwich", .range = between(-180, 180)}),
      sunField<&SunPlace::timezone>(
          {.name = "timezone", .unit = "hours", .doc = "ahead of universal time", .range = between(-24, 24)}),
      sunField<&SunPlace::year>({.name = "year", .doc = "the year", .range = between(1901, 2099)}),
      sunField<&SunPlace::month>({.name = "month", .doc = "from 1 to 12", .range = between(1, 12)}),
      sunField<&SunPlace::day>({.name = "day", .doc = "of the month, from 1", .range = between(1, 31)}),
      sunField<&SunPlace::hour>({.name = "hour", .doc = "of the day", .range = between(0, 24)}),
      sunField<&SunPlace::minute>({.name = "minute", .doc = "of the hour", .range = between(0, 60)}),
      sunField<&SunPlace::second>({.name = "second", .doc = "of the minute", .range = between(0, 60)}),
      field<&Emitter::sunScale>({.name = "sun_scale", .doc = "factor on the sun; 0: none", .range = Range::atLeast(0)}),
      field<&Emitter::skyScale>({.name = "sky_scale", .doc = "factor on the sky; 0: none", .range = Range::atLeast(0)}),
      field<&Emitter::sunAperture>(
          {.name = "sun_aperture",
           .unit = "degrees",
           .doc = "across the disc of the sun; a wider one is dimmer, so that it lights the same",
           .range = {.minimum = 0, .maximum = 180, .openMinimum = true}}),
      standing(field<&Emitter::toWorld>({.name = "to_world",
                                         .doc = "turns the sky, whose zenith is +z and whose north is -x (east is -y)",
                                         .defaultText = "identity"})),
      field<&Emitter::complexSun>(
          {.name = "complex_sun", .doc = "the disc of the sun is darker towards its edge, as it is"}),
      field<&Emitter::groundAlbedo>(
          {.name = "albedo", .doc = "of the ground, which brightens the sky", .range = between(0, 1)})};
}

}  // namespace aerosol::scene
