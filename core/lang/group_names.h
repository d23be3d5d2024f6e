// Parameters of a layer by the names that groups use for them and their parts.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/lang/program.h"

namespace aerosol::lang {

/// What a name stands for: one leaf parameter or all fields of a structure, or of each the same part.
struct NamedPart {
  std::vector<std::uint32_t> parameters;  ///< Indices into the program's parameters.
  std::vector<std::string> fields;        ///< Of each, its name within the structure; empty for one that is none.
  int element = -1;
  int component = -1;
};

/// The parameters of one program, by name.
class ParameterNames {
 public:
  explicit ParameterNames(const Program& program);

  /// `name`, `s.field`, `a[2]`, `c[0]`, `c.r`, `s.a[2].x` …; nothing when there is no such parameter or part.
  std::optional<NamedPart> find(std::string_view text) const;
  std::optional<std::uint32_t> findLeaf(std::string_view name) const;

  /// "color Cs, float scale", for messages; outputs alone or all.
  std::string list(bool outputsOnly) const;
  std::vector<std::string> names(bool outputsOnly) const;

 private:
  bool fields(const std::string& structure, NamedPart& part) const;

  const Program& program_;
  std::unordered_map<std::string, std::uint32_t> leaves_;
};

/// Type of a part of something of type `whole`.
Type partType(const Type& whole, int element, int component);

/// Same kind of value: equal types, or triples of any kind, or arrays of these with equal lengths.
bool sameKind(const Type& a, const Type& b);

/// May a parameter of type `from` be connected to one of type `to`? The same kind, or as assignments convert: int to
/// float, numbers to triples and matrices.
bool connects(const Type& from, const Type& to);

}  // namespace aerosol::lang
