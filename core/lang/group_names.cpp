#include "core/lang/group_names.h"

#include <algorithm>
#include <charconv>

namespace aerosol::lang {

namespace {

constexpr std::size_t maximumListed = 40;

/// A name as written, taken apart: `s.a[2].x` is the names s, a, x and the index 2.
struct Path {
  std::vector<std::string> names;
  std::vector<int> indices;
};

std::optional<Path> split(std::string_view text) {
  Path path;
  while (!text.empty()) {
    if (text[0] == '[') {
      int index = 0;
      const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), index);
      const auto length = static_cast<std::size_t>(end - text.data());
      if (path.names.empty() || error != std::errc() || index < 0 || length >= text.size() || text[length] != ']')
        return std::nullopt;
      path.indices.push_back(index);
      text.remove_prefix(length + 1);
      continue;
    }
    if (!path.names.empty()) {
      if (text[0] != '.') return std::nullopt;
      text.remove_prefix(1);
    }
    const std::size_t length = std::min(text.find_first_of(".["), text.size());
    if (length == 0) return std::nullopt;
    path.names.emplace_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  if (path.names.empty()) return std::nullopt;
  return path;
}

std::string joined(const std::vector<std::string>& names, std::size_t count) {
  std::string text = names[0];
  for (std::size_t i = 1; i < count; ++i) text += "." + names[i];
  return text;
}

int componentNamed(const std::string& name) {
  if (name == "r" || name == "x") return 0;
  if (name == "g" || name == "y") return 1;
  if (name == "b" || name == "z") return 2;
  return -1;
}

/// Takes indices as elements of arrays, then as components of triples.
bool takeIndices(const Type& type, const std::vector<int>& indices, NamedPart& part) {
  std::size_t next = 0;
  if (type.isArray() && next < indices.size()) {
    part.element = indices[next++];
    if (part.element >= type.arrayLength) return false;
  }
  if (next == indices.size()) return true;
  const bool isOne = !type.isArray() || part.element >= 0;
  if (part.component >= 0 || !isOne || !type.element().isTriple()) return false;
  part.component = indices[next++];
  return part.component < 3 && next == indices.size();
}

}  // namespace

ParameterNames::ParameterNames(const Program& program) : program_(program) {
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) leaves_.emplace(program.parameters[i].name, i);
}

std::optional<std::uint32_t> ParameterNames::findLeaf(std::string_view name) const {
  const auto known = leaves_.find(std::string(name));
  return known == leaves_.end() ? std::nullopt : std::optional(known->second);
}

bool ParameterNames::fields(const std::string& structure, NamedPart& part) const {
  const std::string prefix = structure + ".";
  for (std::uint32_t i = 0; i < program_.parameters.size(); ++i) {
    const std::string& name = program_.parameters[i].name;
    if (!name.starts_with(prefix)) continue;
    part.parameters.push_back(i);
    part.fields.push_back(name.substr(prefix.size()));
  }
  return !part.parameters.empty();
}

std::optional<NamedPart> ParameterNames::find(std::string_view text) const {
  const std::optional<Path> path = split(text);
  if (!path) return std::nullopt;
  NamedPart part;
  const std::string whole = joined(path->names, path->names.size());
  if (const auto leaf = findLeaf(whole)) {
    part.parameters = {*leaf};
    part.fields = {""};
  } else if (!fields(whole, part)) {
    // The last name may be that of a component.
    if (path->names.size() < 2) return std::nullopt;
    const auto triple = findLeaf(joined(path->names, path->names.size() - 1));
    part.component = componentNamed(path->names.back());
    if (!triple || part.component < 0) return std::nullopt;
    const Type& type = program_.parameters[*triple].type;
    if (!type.element().isTriple() || (type.isArray() && path->indices.empty())) return std::nullopt;
    part.parameters = {*triple};
    part.fields = {""};
  }
  for (const std::uint32_t parameter : part.parameters) {
    NamedPart one;
    one.component = part.component;
    if (!takeIndices(program_.parameters[parameter].type, path->indices, one)) return std::nullopt;
    part.element = one.element;
    if (part.parameters.size() == 1) part.component = one.component;
    if (part.parameters.size() > 1 && one.component >= 0) return std::nullopt;
  }
  return part;
}

std::vector<std::string> ParameterNames::names(bool outputsOnly) const {
  std::vector<std::string> names;
  for (const Parameter& parameter : program_.parameters)
    if (parameter.isOutput || !outputsOnly) names.push_back(parameter.name);
  return names;
}

std::string ParameterNames::list(bool outputsOnly) const {
  std::string text;
  std::size_t count = 0;
  for (const Parameter& parameter : program_.parameters) {
    if (outputsOnly && !parameter.isOutput) continue;
    if (++count > maximumListed) return text + ", ...";
    text += (text.empty() ? "" : ", ") + toString(parameter.type) + " " + parameter.name;
  }
  return text;
}

Type partType(const Type& whole, int element, int component) {
  const Type type = element >= 0 ? whole.element() : whole;
  return component >= 0 ? types::floating : type;
}

bool sameKind(const Type& a, const Type& b) {
  if (a.closure != b.closure || a.arrayLength != b.arrayLength) return false;
  return a.base == b.base || (a.element().isTriple() && b.element().isTriple());
}

bool connects(const Type& from, const Type& to) {
  if (sameKind(from, to)) return true;
  if (from.isArray() || to.isArray() || from.closure || to.closure || !from.isNumber()) return false;
  return to == types::floating || to.isTriple() || to == types::matrix;
}

}  // namespace aerosol::lang
