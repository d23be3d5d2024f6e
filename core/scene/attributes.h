// The attributes of one element: checked against what the element knows, with constants replaced.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/scene/definitions.h"
#include "core/scene/reporter.h"
#include "core/scene/source_text.h"
#include "core/scene/xml_reader.h"

namespace aerosol::scene {

/// An attribute after substitution.
struct Attribute {
  std::string name;
  std::string value;
  SourceLocation nameLocation;
  SourceLocation valueLocation;
  std::size_t valueOffset = 0;
  bool exact = true;    ///< Byte i of the value is byte `valueOffset` + i of the file.
  std::string written;  ///< The value before substitution.
};

/// What the reading of attributes needs to know.
struct ReadContext {
  const SourceText& source;
  Definitions& definitions;
  Reporter& reporter;
};

class Attributes {
 public:
  /// Reports attributes that are neither in `required` nor in `optional`, repeated ones, missing or empty required
  /// ones, and undefined constants. `$names` stay as they are where `substitute` is false.
  Attributes(const XmlElement& xml, const std::vector<std::string>& required, const std::vector<std::string>& optional,
             ReadContext context, bool substitute = true);

  /// Null when not written (or wrong, which has been reported).
  const Attribute* find(std::string_view name) const;
  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// The text, or nothing.
  std::string text(std::string_view name) const;
  /// The place of the value, or of the element when it is not written.
  SourceLocation at(std::string_view name) const;
  /// False when anything was reported.
  bool valid() const { return valid_; }

  /// Reports what is wrong with a value at its very byte where the file shows it.
  void report(const Attribute& attribute, const TextError& error) const;

 private:
  void add(const XmlAttribute& xml, bool substitute);
  void reportUnknown(const XmlElement& element, const XmlAttribute& xml, const std::vector<std::string>& known);

  ReadContext context_;
  SourceLocation element_;
  std::vector<Attribute> attributes_;
  bool valid_ = true;
};

}  // namespace aerosol::scene
