// The header of a PLY file. Internal to this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/accel/text_source.h"

namespace aerosol::accel {

enum class PlyFormat : std::uint8_t { ascii, littleEndian, bigEndian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t sizeOf(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool isInteger(PlyType type) { return type < PlyType::float32; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> countType;  ///< Set for a list.
  std::size_t offset = 0;            ///< Of its line in the file.
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t offset = 0;  ///< Of its line in the file.

  /// The fewest bytes that one record can take.
  std::size_t leastBytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t dataOffset = 0;
};

/// Checks that the counts can fit the file, so nothing is reserved for a lie.
Result<PlyHeader> parsePlyHeader(const TextSource& source);

}  // namespace aerosol::accel
