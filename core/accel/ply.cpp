#include "core/accel/ply.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/accel/ply_attributes.h"
#include "core/accel/ply_values.h"
#include "core/accel/triangulate.h"

namespace aerosol::accel {

namespace {

/// What a vertex property is for.
enum Slot : int { slotX, slotY, slotZ, slotNx, slotNy, slotNz, slotU, slotV, slotCount, slotNone = -1 };

int slotNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, int> names[] = {
      {"x", slotX}, {"y", slotY}, {"z", slotZ}, {"nx", slotNx}, {"ny", slotNy},       {"nz", slotNz},
      {"u", slotU}, {"v", slotV}, {"s", slotU}, {"t", slotV},   {"texture_u", slotU}, {"texture_v", slotV}};
  const auto* found = std::ranges::find(names, name, &std::pair<std::string_view, int>::first);
  return found == std::end(names) ? slotNone : found->second;
}

class PlyParser {
 public:
  PlyParser(const TextSource& source, const PlyHeader& header)
      : source_(source), header_(header), reader_(source, header.format, header.dataOffset) {}

  Result<TriangleMesh> parse(Diagnostics& warnings) {
    bool hasVertices = false;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex" && !hasVertices) {
        hasVertices = true;
        parseVertices(element);
      } else if (element.name == "face") {
        if (!hasVertices) return source_.at(element.offset, "the faces come before the vertices");
        parseFaces(element);
      } else if (element.name == "tristrips") {
        return source_.at(element.offset, "triangle strips are not supported; save the mesh with faces");
      } else {
        stepOver(element);
      }
      if (errors_.hasErrors()) return errors_;
    }
    if (!hasVertices) return source_.at(0, "the file has no element 'vertex'");
    if (mesh_.triangles.empty()) warnings.warning({source_.file(), 0, 0}, "the file has no faces");
    return std::move(mesh_);
  }

 private:
  std::optional<double> readValue(PlyType type) {
    const auto value = reader_.read(type);
    if (!value) errors_.add(reader_.readError());
    return value;
  }

  /// The length of a list whose items can be in the file; nothing after an error.
  std::optional<std::size_t> readLength(const PlyProperty& property) {
    const auto length = readValue(*property.countType);
    if (!length) return {};
    const std::size_t itemBytes = reader_.format() == PlyFormat::ascii ? 2 : sizeOf(property.type);
    if (*length < 0 || *length > static_cast<double>((reader_.bytesLeft() + 1) / itemBytes)) {
      errors_.add(reader_.error("the file is too short for a list of " +
                                std::to_string(static_cast<long long>(*length)) + " items"));
      return {};
    }
    return static_cast<std::size_t>(*length);
  }

  /// Reads a property that is not used; false after an error.
  bool stepOver(const PlyProperty& property) {
    std::size_t count = 1;
    if (property.countType) {
      const auto length = readLength(property);
      if (!length) return false;
      count = *length;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!readValue(property.type)) return false;
    }
    return true;
  }

  void stepOver(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!stepOver(property)) return;
      }
    }
  }

  void parseVertices(const PlyElement& element) {
    std::vector<int> slots;
    bool has[slotCount] = {};
    for (const PlyProperty& property : element.properties) {
      const int slot = property.countType ? slotNone : slotNamed(property.name);
      slots.push_back(slot);
      if (slot != slotNone) has[slot] = true;
    }
    if (!has[slotX] || !has[slotY] || !has[slotZ]) {
      errors_.add(source_.at(element.offset, "the vertices need the properties x, y and z"));
      return;
    }
    const bool hasNormals = has[slotNx] && has[slotNy] && has[slotNz], hasUvs = has[slotU] && has[slotV];
    std::vector<bool> isTaken;
    for (const int slot : slots) isTaken.push_back(slot != slotNone);
    PlyAttributeReader attributes(element, "vertex_", isTaken);
    const auto count = static_cast<std::size_t>(element.count);
    mesh_.positions.reserve(count);
    if (hasNormals) mesh_.normals.reserve(count);
    if (hasUvs) mesh_.uvs.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      float v[slotCount] = {};
      if (!readVertex(element, slots, attributes, v)) return;
      attributes.append(1);
      mesh_.positions.push_back({v[slotX], v[slotY], v[slotZ]});
      if (hasNormals) mesh_.normals.push_back(normalize(Normal<World>(v[slotNx], v[slotNy], v[slotNz])));
      if (hasUvs) mesh_.uvs.push_back({v[slotU], v[slotV]});
    }
    mesh_.attributes = attributes.finish();
  }

  /// A value that a float can hold; nothing after an error.
  std::optional<double> readFinite(const PlyProperty& property) {
    const auto value = readValue(property.type);
    if (!value) return {};
    if (std::fabs(*value) <= static_cast<double>(std::numeric_limits<float>::max())) return value;
    errors_.add(reader_.error("'" + property.name + "' is not a finite number"));
    return {};
  }

  bool readAttribute(const PlyProperty& property, std::size_t index, PlyAttributeReader& attributes) {
    const auto value = readFinite(property);
    if (value) attributes.set(index, *value);
    return value.has_value();
  }

  bool readVertex(const PlyElement& element, const std::vector<int>& slots, PlyAttributeReader& attributes,
                  float* values) {
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (slots[k] == slotNone) {
        if (!(attributes.takes(k) ? readAttribute(property, k, attributes) : stepOver(property))) return false;
        continue;
      }
      const auto value = readFinite(property);
      if (!value) return false;
      values[slots[k]] = static_cast<float>(*value);
    }
    return true;
  }

  void parseFaces(const PlyElement& element) {
    const auto isIndices = [](const PlyProperty& p) { return p.name == "vertex_indices" || p.name == "vertex_index"; };
    const auto found = std::ranges::find_if(element.properties, isIndices);
    if (found == element.properties.end() || !found->countType || !isInteger(found->type)) {
      errors_.add(source_.at(found == element.properties.end() ? element.offset : found->offset,
                             "the faces need a list 'vertex_indices' of an integer type"));
      return;
    }
    PlyAttributeReader attributes(element, "face_", std::vector<bool>(element.properties.size()));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const std::size_t before = mesh_.triangles.size();
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        const bool isRead = &property == &*found  ? parseFace(property)
                            : attributes.takes(k) ? readAttribute(property, k, attributes)
                                                  : stepOver(property);
        if (!isRead) return;
      }
      attributes.append(mesh_.triangles.size() - before);
    }
    for (MeshAttribute& attribute : attributes.finish()) mesh_.attributes.push_back(std::move(attribute));
  }

  bool parseFace(const PlyProperty& property) {
    const auto length = readLength(property);
    if (!length) return false;
    if (*length < 3 || *length > mostCorners) {
      errors_.add(
          reader_.error("a face has 3 to " + std::to_string(mostCorners) + " corners, not " + std::to_string(*length)));
      return false;
    }
    face_.clear();
    facePositions_.clear();
    for (std::size_t i = 0; i < *length; ++i) {
      const auto index = readValue(property.type);
      if (!index) return false;
      if (*index < 0 || *index >= static_cast<double>(mesh_.positions.size())) {
        errors_.add(reader_.error("vertex " + std::to_string(static_cast<long long>(*index)) +
                                  " is out of range: there are " + std::to_string(mesh_.positions.size())));
        return false;
      }
      face_.push_back(static_cast<std::uint32_t>(*index));
      facePositions_.push_back(mesh_.positions[face_.back()]);
    }
    faceTriangles_.clear();
    triangulate(facePositions_, faceTriangles_);
    for (const auto& t : faceTriangles_) mesh_.triangles.push_back({face_[t[0]], face_[t[1]], face_[t[2]]});
    return true;
  }

  const TextSource& source_;
  const PlyHeader& header_;
  PlyValueReader reader_;
  Diagnostics errors_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> face_;
  std::vector<Point<World>> facePositions_;
  std::vector<std::array<std::uint32_t, 3>> faceTriangles_;
};

Result<TriangleMesh> parse(const TextSource& source, const Transform<World, Object>& toWorld, Diagnostics& warnings) {
  const auto header = parsePlyHeader(source);
  if (!header) return header.errors();
  auto mesh = PlyParser(source, *header).parse(warnings);
  if (mesh) transformMesh(*mesh, toWorld);
  return mesh;
}

}  // namespace

Result<TriangleMesh> loadPly(const std::string& path, const Transform<World, Object>& toWorld, Diagnostics& warnings) {
  const auto source = TextSource::read(path);
  if (!source) return source.errors();
  return parse(*source, toWorld, warnings);
}

Result<TriangleMesh> parsePly(const std::string& file, std::string data, const Transform<World, Object>& toWorld,
                              Diagnostics& warnings) {
  return parse(TextSource(file, std::move(data)), toWorld, warnings);
}

}  // namespace aerosol::accel
