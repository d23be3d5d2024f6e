#include "core/grid/module/vdb_check.h"

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace aerosol::grid {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t magicNumber = 0x56444220;
constexpr std::uint32_t oldestVersion = 222;  ///< Of files that are checked.

enum Compression : std::uint32_t { zip = 1, activeMask = 2, blosc = 4 };

/// How values are stored of which a mask says which are active.
enum class Inactive : std::uint8_t { background, negated, one, maskOfBoth, maskAndOne, maskAndTwo, all };

struct ValueKind {
  std::uint64_t size = 0, halfSize = 0;  ///< Bytes; half: as files keep them that save space.
  bool isBool = false;
};

const std::map<std::string, ValueKind, std::less<>>& valueKinds() {
  static const std::map<std::string, ValueKind, std::less<>> kinds{
      {"Tree_float_5_4_3", {4, 2}},   {"Tree_double_5_4_3", {8, 2}},    {"Tree_int32_5_4_3", {4, 4}},
      {"Tree_int64_5_4_3", {8, 8}},   {"Tree_vec3s_5_4_3", {12, 6}},    {"Tree_vec3d_5_4_3", {24, 6}},
      {"Tree_vec3i_5_4_3", {12, 12}}, {"Tree_bool_5_4_3", {1, 1, true}}};
  return kinds;
}

/// Bytes of metadata of one type; those of unknown types and of strings have any size.
const std::map<std::string, std::uint32_t, std::less<>>& metadataSizes() {
  static const std::map<std::string, std::uint32_t, std::less<>> sizes{
      {"bool", 1},   {"float", 4},  {"double", 8}, {"int32", 4},  {"int64", 8},  {"vec2i", 8},
      {"vec2s", 8},  {"vec2d", 16}, {"vec3i", 12}, {"vec3s", 12}, {"vec3d", 24}, {"vec4i", 16},
      {"vec4s", 16}, {"vec4d", 32}, {"mat4s", 64}, {"mat4d", 128}};
  return sizes;
}

const std::map<std::string, std::uint64_t, std::less<>>& mapSizes() {
  static const std::map<std::string, std::uint64_t, std::less<>> sizes{{"AffineMap", 128},
                                                                       {"UnitaryMap", 128},
                                                                       {"ScaleMap", 120},
                                                                       {"UniformScaleMap", 120},
                                                                       {"TranslationMap", 24},
                                                                       {"ScaleTranslateMap", 144},
                                                                       {"UniformScaleTranslateMap", 144}};
  return sizes;
}

class Walk {
 public:
  explicit Walk(std::istream& stream) : stream_(stream) {
    stream_.seekg(0, std::ios::end);
    rest_ = static_cast<std::uint64_t>(stream_.tellg());
    stream_.seekg(0);
  }

  void run() {
    if (read<std::uint64_t>() != magicNumber) throw std::runtime_error("it does not begin as such a file");
    if (read<std::uint32_t>() < oldestVersion) return;
    skip(2 * sizeof(std::uint32_t));  // Of the library.
    readBool();
    skip(36);  // The file's own name.
    metadata();
    const auto count = read<std::int32_t>();
    if (count < 0) fail("a number of grids");
    for (std::int32_t i = 0; i < count; ++i) {
      if (!grid()) return;
    }
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw std::runtime_error(std::string("it is damaged: ") + what + " makes no sense");
  }

  void take(std::uint64_t bytes) {
    if (bytes > rest_) throw std::runtime_error("it ends too early");
    rest_ -= bytes;
  }
  void skip(std::uint64_t bytes) {
    take(bytes);
    stream_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur);
  }
  template <class T>
  T read() {
    take(sizeof(T));
    T value{};
    stream_.read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
  }
  void readBool() {
    if (read<std::uint8_t>() > 1) fail("a truth value");
  }
  std::string readString() {
    const auto size = read<std::uint32_t>();
    take(size);
    std::string text(size, '\0');
    stream_.read(text.data(), size);
    return text;
  }

  void metadata() {
    const auto count = read<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      readString();
      const std::string type = readString();
      const auto size = read<std::uint32_t>();
      const auto known = metadataSizes().find(type);
      if (known != metadataSizes().end() && size != known->second) fail("the size of a piece of metadata");
      if (known != metadataSizes().end() && type == "bool") {
        readBool();
      } else if (type == "__delayedload") {
        delayedLoad(size);
      } else {
        skip(size);
      }
    }
  }

  /// Of each leaf one byte, and a size: as many as there can be leaves in the file, which take 64 bytes at least.
  void delayedLoad(std::uint32_t size) {
    if (size == 0) return;  // Of a grid without leaves.
    if (size < sizeof(std::uint32_t)) fail("a table of leaves");
    const auto count = read<std::uint32_t>();
    if (count > (rest_ + size) / 64) fail("a number of leaves");
    skip(size - sizeof count);
  }

  void transform(bool mayBeFrustum) {
    const std::string type = readString();
    if (mayBeFrustum && type == "NonlinearFrustumMap") {
      skip(8 * sizeof(double));
      return transform(false);
    }
    const auto known = mapSizes().find(type);
    if (known == mapSizes().end()) fail("the type of a map");
    skip(known->second);
  }

  /// False when it cannot be known where the grid ends.
  bool grid() {
    readString();
    std::string type = readString();
    constexpr std::string_view half = "_HalfFloat";
    const bool isHalf = type.ends_with(half);
    if (isHalf) type.resize(type.size() - half.size());
    const bool isInstance = !readString().empty();
    skip(3 * sizeof(std::int64_t));  // Where its parts are; streams are read without.
    compression_ = read<std::uint32_t>();
    if (compression_ > (zip | activeMask | blosc)) fail("a kind of compression");
    metadata();
    transform(true);
    if (isInstance) return true;
    const auto known = valueKinds().find(type);
    if (known == valueKinds().end()) return false;
    kind_ = known->second;
    stored_ = isHalf ? kind_.halfSize : kind_.size;
    isHalf_ = isHalf && stored_ != kind_.size;
    tree();
    return true;
  }

  void tree() {
    if (read<std::int32_t>() != 1) fail("a number of buffers");
    value();  // The background.
    const auto tiles = read<std::uint32_t>(), children = read<std::uint32_t>();
    for (std::uint32_t i = 0; i < tiles; ++i) {
      origin();
      value();
      readBool();
    }
    leaves_ = 0;
    for (std::uint32_t i = 0; i < children; ++i) {
      origin();
      upperNode();
    }
    for (std::uint64_t i = 0; i < leaves_; ++i) leafValues();
  }

  void value() {
    if (kind_.isBool) {
      readBool();
    } else {
      skip(kind_.size);
    }
  }

  /// Of a node below the root.
  void origin() {
    for (int i = 0; i < 3; ++i) {
      if (read<std::int32_t>() % 4096 != 0) fail("the place of a node");
    }
  }

  template <std::size_t Bytes>
  using Mask = std::array<std::uint64_t, Bytes / 8>;
  template <std::size_t Bytes>
  Mask<Bytes> readMask() {
    return read<Mask<Bytes>>();
  }
  template <class M>
  static std::uint64_t countOf(const M& mask) {
    std::uint64_t count = 0;
    for (const std::uint64_t word : mask) count += static_cast<std::uint64_t>(std::popcount(word));
    return count;
  }

  void upperNode() {
    constexpr std::size_t bytes = 32 * 32 * 32 / 8;
    const auto children = readMask<bytes>(), active = readMask<bytes>();
    values<bytes>(countOf(active));
    for (std::uint64_t left = countOf(children); left > 0; --left) lowerNode();
  }

  void lowerNode() {
    constexpr std::size_t bytes = 16 * 16 * 16 / 8;
    const auto children = readMask<bytes>(), active = readMask<bytes>();
    values<bytes>(countOf(active));
    const std::uint64_t leaves = countOf(children);
    skip(leaves * leafMaskBytes);
    leaves_ += leaves;
  }

  void leafValues() {
    const auto active = readMask<leafMaskBytes>();
    if (kind_.isBool) {
      skip(3 * sizeof(std::int32_t) + leafMaskBytes);
    } else {
      values<leafMaskBytes>(countOf(active));
    }
  }

  /// The values of a node with a mask of so many bytes.
  template <std::size_t MaskBytes>
  void values(std::uint64_t active) {
    const auto form = read<std::uint8_t>();
    if (form > static_cast<std::uint8_t>(Inactive::all)) fail("how a node keeps its values");
    const auto inactive = static_cast<Inactive>(form);
    if (inactive == Inactive::one || inactive == Inactive::maskAndOne) value();
    if (inactive == Inactive::maskAndTwo) {
      value();
      value();
    }
    if (inactive == Inactive::maskOfBoth || inactive == Inactive::maskAndOne || inactive == Inactive::maskAndTwo) {
      skip(MaskBytes);
    }
    const bool isSparse = (compression_ & activeMask) != 0 && inactive != Inactive::all;
    const std::uint64_t count = isSparse ? active : 8 * MaskBytes;
    if (isHalf_ && count == 0) return;
    block(count * stored_);
  }

  /// So many bytes, compressed or not.
  void block(std::uint64_t bytes) {
    if ((compression_ & (zip | blosc)) == 0) return skip(bytes);
    const auto size = read<std::int64_t>();
    if (size <= 0) {
      if (size == INT64_MIN || static_cast<std::uint64_t>(-size) != bytes) fail("the size of a block of values");
      return skip(bytes);
    }
    if ((compression_ & blosc) == 0) return skip(static_cast<std::uint64_t>(size));
    // Blosc's header: four bytes, then the sizes of the content, of its parts, and of all as it is stored.
    constexpr std::int64_t headerBytes = 16;
    if (size < headerBytes) fail("the size of a block of values");
    skip(4);
    const auto content = read<std::uint32_t>();
    skip(4);
    const auto stored = read<std::uint32_t>();
    if (content != bytes || stored != static_cast<std::uint64_t>(size)) fail("the size of a block of values");
    skip(static_cast<std::uint64_t>(size - headerBytes));
  }

  static constexpr std::size_t leafMaskBytes = 512 / 8;

  std::istream& stream_;
  std::uint64_t rest_ = 0;  ///< Bytes of the file that are left.
  std::uint32_t compression_ = 0;
  ValueKind kind_;
  std::uint64_t stored_ = 0;  ///< Bytes of a value in a block.
  bool isHalf_ = false;
  std::uint64_t leaves_ = 0;  ///< Of the grid.
};

}  // namespace

void checkVdb(std::istream& stream) {
  Walk(stream).run();
  stream.seekg(0);
}

}  // namespace aerosol::grid
