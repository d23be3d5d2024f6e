// XML text → elements with byte offsets: the only place that sees the XML library.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/reporter.h"
#include "core/scene/source_text.h"

namespace aerosol::scene {

/// An attribute with the offsets of its name and of the first byte of its value (after the quote).
struct XmlAttribute {
  std::string name;
  std::string value;
  std::size_t nameOffset = 0;
  std::size_t valueOffset = 0;
  bool exact = true;  ///< Byte i of the value is byte `valueOffset` + i of the file (no entity was replaced).
};

/// An element; `offset` is that of its `<`. Text stands in `source`, `group` and `ShaderGroup` alone.
struct XmlElement {
  std::string tag;
  std::size_t offset = 0;
  std::string text = {};
  std::size_t textOffset = 0;  ///< Of the first byte of the text.
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;
};

/// Elements may be nested this deep.
inline constexpr int nestingLimit = 64;

/// The root element; none when the text is not well-formed XML in UTF-8, which is reported. Text between elements,
/// further roots and elements nested beyond the limit are reported and left out.
std::optional<XmlElement> readXml(const SourceText& source, Reporter& reporter);

}  // namespace aerosol::scene
