#include "core/scene/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace aerosol::scene {

Attributes::Attributes(const XmlElement& xml, const std::vector<std::string>& required,
                       const std::vector<std::string>& optional, ReadContext context, bool substitute)
    : context_(context), element_(context.source.at(xml.offset)) {
  std::vector<std::string> known = required;
  known.insert(known.end(), optional.begin(), optional.end());
  std::vector<std::string> seen;
  bool misspelt = false;  // Then what is missing is likely there under another name.
  for (const XmlAttribute& attribute : xml.attributes) {
    if (std::find(known.begin(), known.end(), attribute.name) == known.end()) {
      reportUnknown(xml, attribute, known);
      misspelt = true;
    } else if (std::find(seen.begin(), seen.end(), attribute.name) != seen.end()) {
      context_.reporter.error(context_.source.at(attribute.nameOffset),
                              fmt::format("attribute '{}' is given twice", attribute.name));
      valid_ = false;
    } else {
      seen.push_back(attribute.name);
      add(attribute, substitute);
    }
  }
  for (const std::string& name : required) {
    const Attribute* attribute = find(name);
    if (!attribute && !misspelt && std::find(seen.begin(), seen.end(), name) == seen.end()) {
      context_.reporter.error(element_, fmt::format("<{}> lacks its attribute '{}'", xml.tag, name));
      valid_ = false;
    } else if (attribute && name != "value" && trim(attribute->value).empty()) {
      context_.reporter.error(attribute->valueLocation, fmt::format("attribute '{}' is empty", name));
      valid_ = false;
    }
  }
}

void Attributes::reportUnknown(const XmlElement& element, const XmlAttribute& xml,
                               const std::vector<std::string>& known) {
  context_.reporter.error(context_.source.at(xml.nameOffset),
                          fmt::format("<{}> has no attribute '{}'", element.tag, xml.name),
                          alternatives(xml.name, known, "its attributes:"));
  valid_ = false;
}

void Attributes::add(const XmlAttribute& xml, bool substitute) {
  Attribute attribute{.name = xml.name,
                      .value = xml.value,
                      .nameLocation = context_.source.at(xml.nameOffset),
                      .valueLocation = context_.source.at(xml.valueOffset),
                      .valueOffset = xml.valueOffset,
                      .exact = xml.exact,
                      .written = xml.value};
  if (substitute && xml.value.find('$') != std::string::npos) {
    TextError error;
    std::optional<std::string> value = context_.definitions.substitute(xml.value, error);
    if (!value) {
      context_.reporter.error(context_.source.at(xml.valueOffset + (xml.exact ? error.offset : 0)), error.message,
                              {context_.definitions.names().empty()
                                   ? "nothing is defined: give -D NAME=VALUE, or <default name=\"NAME\" value=\"…\"/>"
                                   : fmt::format("defined here: {}", join(context_.definitions.names()))});
      valid_ = false;
      return;
    }
    attribute.value = std::move(*value);
    attribute.exact = false;
  }
  attributes_.push_back(std::move(attribute));
}

const Attribute* Attributes::find(std::string_view name) const {
  for (const Attribute& attribute : attributes_) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

std::string Attributes::text(std::string_view name) const {
  const Attribute* attribute = find(name);
  return attribute ? attribute->value : std::string();
}

SourceLocation Attributes::at(std::string_view name) const {
  const Attribute* attribute = find(name);
  return attribute ? attribute->valueLocation : element_;
}

void Attributes::report(const Attribute& attribute, const TextError& error) const {
  const std::size_t offset = attribute.valueOffset + (attribute.exact ? error.offset : 0);
  std::vector<std::string> notes;
  if (attribute.value != attribute.written)
    notes.push_back(fmt::format("the value comes from '{}'", attribute.written));
  context_.reporter.error(context_.source.at(offset), error.message, std::move(notes));
}

}  // namespace aerosol::scene
