#include "core/accel/point_writer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

namespace aerosol::accel {

namespace {

using Base = PointAttribute::Base;

constexpr std::size_t maximumPoints = 50'000'000;

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

/// Names of an attribute's columns, as readPoints puts them together again.
std::vector<std::string> columnNames(const PointAttribute& attribute) {
  static constexpr const char* known[][4] = {{"position", "x", "y", "z"},
                                             {"normal", "nx", "ny", "nz"},
                                             {"velocity", "vx", "vy", "vz"},
                                             {"color", "red", "green", "blue"}};
  if (attribute.components == 1) return {attribute.name};
  std::vector<std::string> names;
  for (int c = 0; c < attribute.components; ++c) {
    std::string name =
        attribute.components == 3 ? attribute.name + "." + "xyz"[c] : fmt::format("{}[{}]", attribute.name, c);
    for (const auto& row : known)
      if (attribute.name == row[0] && attribute.components == 3) name = row[c + 1];
    names.push_back(std::move(name));
  }
  return names;
}

/// Order by value, attribute after attribute; bits decide between floats.
bool isBefore(const std::vector<PointAttribute>& attributes, std::size_t a, std::size_t b) {
  for (const PointAttribute& attribute : attributes) {
    const auto n = static_cast<std::size_t>(attribute.components);
    for (std::size_t c = 0; c < n; ++c) {
      if (attribute.base == Base::string) {
        if (const int order = attribute.strings[a * n + c].compare(attribute.strings[b * n + c])) return order < 0;
      } else if (attribute.base == Base::integer) {
        const auto x = attribute.integers[a * n + c], y = attribute.integers[b * n + c];
        if (x != y) return x < y;
      } else {
        const float x = attribute.floats[a * n + c], y = attribute.floats[b * n + c];
        if (x < y || y < x) return x < y;
        const auto xBits = std::bit_cast<std::uint32_t>(x), yBits = std::bit_cast<std::uint32_t>(y);
        if (xBits != yBits) return xBits < yBits;
      }
    }
  }
  return false;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c;
    if (c == '"') result += '"';
  }
  return result + "\"";
}

std::string csv(const std::vector<PointAttribute>& attributes, const std::vector<std::size_t>& order) {
  std::string text;
  for (const PointAttribute& attribute : attributes)
    for (const std::string& name : columnNames(attribute)) text += (text.empty() ? "" : ",") + name;
  text += '\n';
  for (const std::size_t point : order) {
    bool isFirst = true;
    for (const PointAttribute& attribute : attributes) {
      const auto n = static_cast<std::size_t>(attribute.components);
      for (std::size_t i = point * n; i < (point + 1) * n; ++i) {
        if (!isFirst) text += ',';
        isFirst = false;
        if (attribute.base == Base::string) {
          text += quoted(attribute.strings[i]);
        } else if (attribute.base == Base::integer) {
          text += std::to_string(attribute.integers[i]);
        } else {
          text += fmt::format("{}", attribute.floats[i]);
        }
      }
    }
    text += '\n';
  }
  return text;
}

std::string ply(const std::vector<PointAttribute>& attributes, const std::vector<std::size_t>& order) {
  std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", order.size());
  for (const PointAttribute& attribute : attributes)
    for (const std::string& name : columnNames(attribute))
      text += fmt::format("property {} {}\n", attribute.base == Base::integer ? "int" : "float", name);
  text += "end_header\n";
  static_assert(std::endian::native == std::endian::little);
  for (const std::size_t point : order) {
    for (const PointAttribute& attribute : attributes) {
      const auto n = static_cast<std::size_t>(attribute.components);
      const void* values = attribute.base == Base::integer ? static_cast<const void*>(&attribute.integers[point * n])
                                                           : static_cast<const void*>(&attribute.floats[point * n]);
      text.append(static_cast<const char*>(values), 4 * n);
    }
  }
  return text;
}

}  // namespace

bool PointWriter::add(std::vector<PointAttribute> point, std::string& problem) {
  const std::lock_guard lock(mutex_);
  if (attributes_.empty()) {
    attributes_ = std::move(point);
    count_ = 1;
    return true;
  }
  const auto isSame = [](const PointAttribute& a, const PointAttribute& b) {
    return a.name == b.name && a.base == b.base && a.components == b.components;
  };
  if (!std::ranges::equal(attributes_, point, isSame)) {
    problem = "the attributes are not those of the points before";
    return false;
  }
  if (count_ == maximumPoints) {
    problem = "the cloud has as many points as it can";
    return false;
  }
  for (std::size_t i = 0; i < point.size(); ++i) {
    append(attributes_[i].integers, std::move(point[i].integers));
    append(attributes_[i].floats, std::move(point[i].floats));
    append(attributes_[i].strings, std::move(point[i].strings));
  }
  ++count_;
  return true;
}

std::optional<std::string> PointWriter::encode(const std::string& extension, std::string& problem) {
  const std::lock_guard lock(mutex_);
  if (extension != ".csv" && extension != ".ply") {
    problem = "point clouds are .ply or .csv files";
    return {};
  }
  std::vector<std::size_t> order(count_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return isBefore(attributes_, a, b); });
  if (extension == ".csv") return csv(attributes_, order);
  for (const PointAttribute& attribute : attributes_) {
    if (attribute.base != Base::string) continue;
    problem = "attribute \"" + attribute.name + "\" holds text, which .ply files do not; write a .csv file";
    return {};
  }
  return ply(attributes_, order);
}

}  // namespace aerosol::accel
