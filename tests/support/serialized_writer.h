// Files in Mitsuba's binary mesh format, as its exporters write them.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace aerosol::test {

template <class T>
void appendBytes(std::string& data, const T& value) {
  data.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// One mesh before it is compressed. Arrays that are empty are left out.
struct SerializedMesh {
  std::vector<double> positions, normals, texCoords, colors;
  std::vector<std::uint32_t> corners;
  bool isDouble = false;
  bool hasFaceNormals = false;
  std::uint32_t extraFlags = 0;

  std::string content(int version) const {
    std::string data;
    const std::uint32_t flags = (normals.empty() ? 0u : 1u) | (texCoords.empty() ? 0u : 2u) |
                                (colors.empty() ? 0u : 8u) | (hasFaceNormals ? 0x10u : 0u) |
                                (isDouble ? 0x2000u : 0x1000u) | extraFlags;
    appendBytes(data, flags);
    if (version == 4) data += std::string("a mesh") + '\0';
    appendBytes(data, static_cast<std::uint64_t>(positions.size() / 3));
    appendBytes(data, static_cast<std::uint64_t>(corners.size() / 3));
    for (const auto* values : {&positions, &normals, &texCoords, &colors}) {
      for (const double value : *values) {
        if (isDouble) {
          appendBytes(data, value);
        } else {
          appendBytes(data, static_cast<float>(value));
        }
      }
    }
    for (const std::uint32_t corner : corners) appendBytes(data, corner);
    return data;
  }
};

/// A whole file of contents that are not compressed yet.
inline std::string serializedFile(const std::vector<std::string>& contents, int version) {
  std::string data;
  std::vector<std::size_t> places;
  for (const std::string& content : contents) {
    places.push_back(data.size());
    appendBytes(data, std::uint16_t{0x041C});
    appendBytes(data, static_cast<std::uint16_t>(version));
    uLongf size = compressBound(static_cast<uLong>(content.size()));
    std::string compressed(size, '\0');
    compress(reinterpret_cast<Bytef*>(compressed.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
             static_cast<uLong>(content.size()));
    data.append(compressed, 0, size);
  }
  for (const std::size_t place : places) {
    if (version == 4) {
      appendBytes(data, static_cast<std::uint64_t>(place));
    } else {
      appendBytes(data, static_cast<std::uint32_t>(place));
    }
  }
  appendBytes(data, static_cast<std::uint32_t>(places.size()));
  return data;
}

inline std::string serializedFile(const std::vector<SerializedMesh>& meshes, int version) {
  std::vector<std::string> contents;
  for (const SerializedMesh& mesh : meshes) contents.push_back(mesh.content(version));
  return serializedFile(contents, version);
}

}  // namespace aerosol::test
