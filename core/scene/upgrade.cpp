#include "core/scene/upgrade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "core/scene/syntax.h"

namespace aerosol::scene {

namespace {

bool isUpper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool isLower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

/// A word begins at a capital behind a small letter; all capitals that follow it belong to it.
std::string withUnderscores(const std::string& name) {
  std::string result;
  bool isInWord = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool begins = i > 0 && isLower(name[i - 1]) && isUpper(name[i]);
    if (begins) result += '_';
    isInWord = begins || (isInWord && isUpper(name[i]));
    result += isInWord ? static_cast<char>(std::tolower(static_cast<unsigned char>(name[i]))) : name[i];
  }
  return result;
}

XmlAttribute* find(XmlElement& element, std::string_view name) {
  const auto found = std::find_if(element.attributes.begin(), element.attributes.end(),
                                  [&](const XmlAttribute& attribute) { return attribute.name == name; });
  return found == element.attributes.end() ? nullptr : &*found;
}

bool hasValue(XmlElement& element, std::string_view name, std::string_view value) {
  const XmlAttribute* attribute = find(element, name);
  return attribute && attribute->value == value;
}

/// Takes `<float name="NAME"/>` out of the element and makes its value the attribute `axis` of `operation`.
bool takeNumber(XmlElement& element, std::string_view name, const char* axis, XmlElement& operation) {
  const auto child = std::find_if(element.children.begin(), element.children.end(), [&](XmlElement& each) {
    return each.tag == "float" && hasValue(each, "name", name) && find(each, "value");
  });
  if (child == element.children.end()) return false;
  XmlAttribute number = *find(*child, "value");
  number.name = axis;
  operation.offset = child->offset;
  operation.attributes.push_back(std::move(number));
  element.children.erase(child);
  return true;
}

void gatherPlaceOnTexture(XmlElement& element) {
  XmlElement move{.tag = "translate", .attributes = {}, .children = {}};
  XmlElement scale{.tag = "scale", .attributes = {}, .children = {}};
  const bool movesU = takeNumber(element, "uoffset", "x", move), movesV = takeNumber(element, "voffset", "y", move);
  const bool scalesU = takeNumber(element, "uscale", "x", scale), scalesV = takeNumber(element, "vscale", "y", scale);
  if (!movesU && !movesV && !scalesU && !scalesV) return;
  XmlElement transform{.tag = "transform", .attributes = {}, .children = {}};
  transform.offset = movesU || movesV ? move.offset : scale.offset;
  transform.attributes.push_back({"name", "to_uv", transform.offset, transform.offset, false});
  if (movesU || movesV) transform.children.push_back(std::move(move));
  if (scalesU || scalesV) transform.children.push_back(std::move(scale));
  element.children.push_back(std::move(transform));
}

/// Filters of textures that trace footprints, and the gamma by which an image is not a picture.
void upgradeBitmap(XmlElement& element) {
  std::erase_if(element.children, [](XmlElement& child) {
    return hasValue(child, "name", "gamma") && (hasValue(child, "value", "-1") || hasValue(child, "value", "2.2"));
  });
  for (XmlElement& child : element.children) {
    XmlAttribute* const value = find(child, "value");
    if (!value) continue;
    if (hasValue(child, "name", "filter_type") && (value->value == "trilinear" || value->value == "ewa")) {
      value->value = "bilinear";
      value->exact = false;
    }
    if (hasValue(child, "name", "gamma") && (value->value == "1" || value->value == "1.0")) {
      child.tag = "boolean";
      find(child, "name")->value = "raw";
      value->value = "true";
      value->exact = find(child, "name")->exact = false;
    }
  }
}

void rename(XmlElement& element, std::string_view from, const char* to) {
  XmlAttribute* const name = find(element, "name");
  if (!name || name->value != from) return;
  name->value = to;
  name->exact = false;
}

/// Media of voxels: their extinction had another name, how they were sampled was theirs to say, and voxels stood where
/// their file says. Those that have the new name stay as they are.
void upgradeMedium(XmlElement& medium) {
  const bool isOld = std::any_of(medium.children.begin(), medium.children.end(),
                                 [](XmlElement& child) { return hasValue(child, "name", "density"); });
  if (!isOld) return;
  std::erase_if(medium.children, [](XmlElement& child) { return hasValue(child, "name", "method"); });
  for (XmlElement& child : medium.children) {
    rename(child, "density_multiplier", "scale");
    rename(child, "density", "sigma_t");
    if (child.tag != "volume" || !hasValue(child, "type", "gridvolume")) continue;
    std::erase_if(child.children, [](XmlElement& each) { return hasValue(each, "name", "send_data"); });
    XmlElement box{.tag = "boolean", .attributes = {}, .children = {}};
    box.offset = child.offset;
    box.attributes.push_back({"name", "use_grid_bbox", child.offset, child.offset, false});
    box.attributes.push_back({"value", "true", child.offset, child.offset, false});
    child.children.push_back(std::move(box));
  }
}

float linearOf(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// `<srgb value="r, g, b"/>` holds encoded numbers, where `<rgb>` has linear ones; after a # both have the same.
void upgradeSrgb(XmlElement& element) {
  element.tag = "rgb";
  XmlAttribute* const value = find(element, "value");
  TextError error;
  if (!value || value->value.find('#') != std::string::npos) return;
  const auto numbers = parseNumbers(value->value, error);
  if (!numbers) return;
  value->value.clear();
  for (const double number : *numbers)
    value->value += fmt::format("{}{}", value->value.empty() ? "" : ", ", linearOf(static_cast<float>(number)));
  value->exact = false;
}

}  // namespace

void upgradeNames(XmlElement& element) {
  if (element.tag == "lookAt") element.tag = "lookat";
  if (element.tag == "srgb") upgradeSrgb(element);
  XmlAttribute* name = find(element, "name");
  if (name && element.tag != "default") {
    std::string upgraded = withUnderscores(name->value);
    name->exact = name->exact && upgraded == name->value;
    name->value = std::move(upgraded);
  }
  for (XmlElement& child : element.children) upgradeNames(child);
  if (element.tag == "bsdf" && hasValue(element, "type", "diffuse")) {
    for (XmlElement& child : element.children) {
      if (XmlAttribute* own = find(child, "name"); own && own->value == "diffuse_reflectance") {
        own->value = "reflectance";
        own->exact = false;
      }
    }
  }
  if (element.tag == "medium" && hasValue(element, "type", "heterogeneous")) upgradeMedium(element);
  gatherPlaceOnTexture(element);
  if (element.tag == "texture" && hasValue(element, "type", "bitmap")) upgradeBitmap(element);
}

}  // namespace aerosol::scene
