#include "core/app/tools/shade_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "core/image/plain_image.h"

namespace aerosol::app {

namespace {

void appendValues(std::string& text, const ShadedOutput& output, std::size_t point) {
  const auto components = static_cast<std::size_t>(output.components);
  for (std::size_t c = 0; c < components; ++c) {
    const std::size_t i = point * components + c;
    if (const auto* floats = std::get_if<std::vector<float>>(&output.values)) {
      fmt::format_to(std::back_inserter(text), " {:g}", (*floats)[i]);
    } else if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&output.values)) {
      fmt::format_to(std::back_inserter(text), " {}", (*integers)[i]);
    }
  }
}

bool isForScreens(const std::string& file) {
  std::string name = file;
  std::ranges::transform(name, name.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
  return name.ends_with(".jpg") || name.ends_with(".jpeg") || name.ends_with(".gif") || name.ends_with(".png");
}

image::PlainOptions::Type pixelType(const std::string& dataFormat) {
  using Type = image::PlainOptions::Type;
  if (dataFormat == "uint8") return Type::uint8;
  if (dataFormat == "half") return Type::float16;
  if (dataFormat == "float") return Type::float32;
  return Type::asIs;
}

}  // namespace

void printShadedValues(const ShadeGrid& grid, const Shaded& shaded, const std::vector<PrintedOutput>& printed,
                       const Console& console) {
  std::string text;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto point =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(x);
      fmt::format_to(std::back_inserter(text), "Pixel ({}, {}):\n", x, y);
      for (const PrintedOutput& each : printed) {
        const ShadedOutput& output = shaded.outputs[each.index];
        if (output.type.base == lang::BaseType::string) continue;
        fmt::format_to(std::back_inserter(text), "  {} :", each.label);
        appendValues(text, output, point);
        text += '\n';
      }
    }
    console.print(text);
    text.clear();
  }
}

Diagnostics writeShadedImage(const ShadeGrid& grid, const ShadedOutput& output, const std::string& file,
                             const std::string& dataFormat) {
  Diagnostics errors;
  if (output.type.base == lang::BaseType::string) {
    errors.error({.file = file}, fmt::format("the output '{}' is text, which no image holds", output.name));
    return errors;
  }
  image::PlainImage picture;
  picture.width = grid.width;
  picture.height = grid.height;
  picture.channels = output.components;
  if (const auto* floats = std::get_if<std::vector<float>>(&output.values)) {
    picture.values = *floats;
  } else {
    picture.values = std::get<std::vector<std::int32_t>>(output.values);
  }
  return image::writePlainImage(file, picture, {pixelType(dataFormat), isForScreens(file)});
}

}  // namespace aerosol::app
