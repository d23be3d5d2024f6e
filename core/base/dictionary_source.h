// Dictionaries that shaders search: trees of nodes with attributes, from text or files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aerosol {

/// Safe to use from any thread. A node's number follows from how it was found, not from when.
class DictionarySource {
 public:
  virtual ~DictionarySource() = default;

  /// The first node of a dictionary (its text, or the name of a file) that a query matches: 0 when there is none, -1
  /// when the dictionary is none or cannot be read. `problem` is what is wrong with the dictionary or the query.
  virtual std::int32_t find(std::string_view dictionary, std::string_view query, std::string& problem) = 0;
  /// The same from a node on.
  virtual std::int32_t find(std::int32_t node, std::string_view query, std::string& problem) = 0;
  /// The next node that matched the query by which this one was found; 0 when it was the last.
  virtual std::int32_t next(std::int32_t node) = 0;
  /// An attribute of a node; of an empty name, its text. Nothing when there is no such attribute or node.
  virtual std::optional<std::string> value(std::int32_t node, std::string_view attribute) = 0;
};

}  // namespace aerosol
