#include "core/accel/serialized.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/accel/inflater.h"
#include "core/accel/text_source.h"

namespace aerosol::accel {

namespace {

static_assert(std::endian::native == std::endian::little, "the format's numbers are read as they are");

constexpr std::uint16_t magic = 0x041C;
enum Flag : std::uint32_t {
  hasNormals = 0x0001,
  hasTexCoords = 0x0002,
  hasTangents = 0x0004,
  hasColors = 0x0008,
  hasFaceNormals = 0x0010,
  isSingle = 0x1000,
  isDouble = 0x2000
};
constexpr std::uint32_t knownFlags =
    hasNormals | hasTexCoords | hasTangents | hasColors | hasFaceNormals | isSingle | isDouble;

/// Where a mesh lies in the file, from its header on, and the version there.
struct MeshPlace {
  std::size_t begin = 0, end = 0;  ///< At most; the compressed data know their end.
  std::uint16_t version = 0;
};

/// The end of the file: places of the meshes (of 64 bits in version 4, else of 32), and at last their number.
class Directory {
 public:
  explicit Directory(const TextSource& source) : source_(source), data_(source.text()) {}

  Result<MeshPlace> find(int index) const {
    const auto version = headerAt(0);
    if (!version) return version.errors();
    const std::size_t entry = *version == 4 ? 8 : 4;
    if (data_.size() < 8 + entry) return source_.atByte(data_.size(), "the file ends too early");
    const std::size_t countAt = data_.size() - 4;
    const auto count = at<std::uint32_t>(countAt);
    if (count == 0 || count > (countAt - 4) / entry) {
      return source_.atByte(countAt, "the file cannot hold " + std::to_string(count) + " meshes: it is damaged");
    }
    if (index < 0 || static_cast<std::uint32_t>(index) >= count) {
      return source_.atByte(countAt, "there is no mesh number " + std::to_string(index) + ": the file has " +
                                         std::to_string(count) + ", counted from 0");
    }
    const std::size_t table = countAt - count * entry;
    const auto place = [&](std::size_t i) {
      return entry == 8 ? at<std::uint64_t>(table + 8 * i) : at<std::uint32_t>(table + 4 * i);
    };
    const auto number = static_cast<std::size_t>(index);
    const std::uint64_t begin = place(number);
    if (begin >= table || table - begin < 4) {
      return source_.atByte(table + entry * number,
                            "mesh " + std::to_string(index) + " cannot be at byte " + std::to_string(begin));
    }
    const auto own = headerAt(static_cast<std::size_t>(begin));
    if (!own) return own.errors();
    return MeshPlace{static_cast<std::size_t>(begin), table, *own};
  }

 private:
  template <class T>
  T at(std::size_t offset) const {
    T value;
    std::memcpy(&value, data_.data() + offset, sizeof value);
    return value;
  }

  /// The version in the four bytes before a mesh.
  Result<std::uint16_t> headerAt(std::size_t offset) const {
    if (data_.size() < offset + 4) return source_.atByte(data_.size(), "the file ends too early");
    if (at<std::uint16_t>(offset) != magic) {
      return source_.atByte(offset, "this is no mesh of Mitsuba's binary format");
    }
    const auto version = at<std::uint16_t>(offset + 2);
    if (version != 3 && version != 4) {
      return source_.atByte(offset + 2,
                            "version " + std::to_string(version) + " of the format is not known: 3 and 4 are");
    }
    return version;
  }

  const TextSource& source_;
  std::string_view data_;
};

class MeshReader {
 public:
  MeshReader(const TextSource& source, const MeshPlace& place)
      : source_(source), place_(place), stream_(source.text().substr(place.begin + 4, place.end - place.begin - 4)) {}

  Result<TriangleMesh> read() {
    std::uint32_t flags = 0;
    if (!stream_.read(flags)) return broken("flags");
    if ((flags & ~knownFlags) != 0 || ((flags & isSingle) != 0) == ((flags & isDouble) != 0)) {
      return error("its flags " + std::to_string(flags) + " mean nothing");
    }
    if (place_.version == 4 && !skipName()) return broken("name");
    std::uint64_t vertices = 0, triangles = 0;
    if (!stream_.read(vertices) || !stream_.read(triangles)) return broken("counts");
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (vertices > most || triangles > most) {
      return error("it has " + std::to_string(std::max(vertices, triangles)) +
                   " vertices or triangles: a mesh holds at most 2^32 - 1");
    }
    isDouble_ = (flags & isDouble) != 0;
    if (auto problem = readVertices(flags, static_cast<std::size_t>(vertices))) return *problem;
    if (auto problem = readTriangles(static_cast<std::size_t>(triangles))) return *problem;
    if (!stream_.isIntact()) return broken("check sum");
    mesh_.faceNormals = (flags & hasFaceNormals) != 0;
    return std::move(mesh_);
  }

 private:
  Diagnostic error(const std::string& message) const { return source_.atByte(place_.begin, "in the mesh: " + message); }
  Diagnostic broken(const char* what) const {
    return error(std::string("the compressed data end too early or are damaged in its ") + what);
  }

  bool skipName() {
    for (char letter = 1; letter != 0;) {
      if (!stream_.read(letter)) return false;
    }
    return true;
  }

  std::optional<Diagnostic> readVertices(std::uint32_t flags, std::size_t count) {
    std::optional<Diagnostic> problem;
    std::vector<float> values;
    const auto take = [&](const char* what, std::size_t width) {
      values.clear();
      problem = readFloats(what, count * width, values);
      return !problem;
    };
    if (!take("positions", 3)) return problem;
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.positions.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    }
    if ((flags & hasNormals) != 0) {
      if (!take("normals", 3)) return problem;
      for (std::size_t i = 0; i < count; ++i) {
        mesh_.normals.push_back(normalize(Normal<World>(values[3 * i], values[3 * i + 1], values[3 * i + 2])));
      }
    }
    if ((flags & hasTexCoords) != 0) {
      if (!take("texture coordinates", 2)) return problem;
      for (std::size_t i = 0; i < count; ++i) mesh_.uvs.push_back({values[2 * i], values[2 * i + 1]});
    }
    if ((flags & hasColors) != 0) {
      if (!take("vertex colours", 3)) return problem;
      mesh_.attributes.push_back({"vertex_color", 3, false, std::move(values)});
    }
    return {};
  }

  /// In pieces: what the counts claim is not believed before it is there.
  std::optional<Diagnostic> readFloats(const char* what, std::size_t count, std::vector<float>& values) {
    float singles[1024];
    double doubles[1024];
    while (count > 0) {
      const std::size_t piece = std::min<std::size_t>(count, 1024);
      const bool isThere =
          isDouble_ ? stream_.read(doubles, piece * sizeof(double)) : stream_.read(singles, piece * sizeof(float));
      if (!isThere) return broken(what);
      for (std::size_t i = 0; i < piece; ++i) {
        const double value = isDouble_ ? doubles[i] : static_cast<double>(singles[i]);
        if (!(std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
          return error("number " + std::to_string(values.size()) + " of its " + what + " is not finite");
        }
        values.push_back(static_cast<float>(value));
      }
      count -= piece;
    }
    return {};
  }

  std::optional<Diagnostic> readTriangles(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      std::array<std::uint32_t, 3> corners;
      if (!stream_.read(corners.data(), sizeof corners)) return broken("triangles");
      for (const std::uint32_t corner : corners) {
        if (corner < mesh_.positions.size()) continue;
        return error("triangle " + std::to_string(i) + " names vertex " + std::to_string(corner) + ", but there are " +
                     std::to_string(mesh_.positions.size()));
      }
      mesh_.triangles.push_back(corners);
    }
    return {};
  }

  const TextSource& source_;
  MeshPlace place_;
  Inflater stream_;
  bool isDouble_ = false;
  TriangleMesh mesh_;
};

Result<TriangleMesh> parse(const TextSource& source, int index, const Transform<World, Object>& toWorld) {
  const auto place = Directory(source).find(index);
  if (!place) return place.errors();
  auto mesh = MeshReader(source, *place).read();
  if (mesh) transformMesh(*mesh, toWorld);
  return mesh;
}

}  // namespace

Result<TriangleMesh> loadSerialized(const std::string& path, int index, const Transform<World, Object>& toWorld) {
  const auto source = TextSource::read(path);
  if (!source) return source.errors();
  return parse(*source, index, toWorld);
}

Result<TriangleMesh> parseSerialized(const std::string& file, std::string data, int index,
                                     const Transform<World, Object>& toWorld) {
  return parse(TextSource(file, std::move(data)), index, toWorld);
}

}  // namespace aerosol::accel
