#include "core/grid/module/dense_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/grid/module/nano_grid.h"

namespace aerosol::grid {

namespace {

static_assert(std::endian::native == std::endian::little);

/// What one file may hold: 4 GB of floats.
constexpr std::int64_t largestCount = std::int64_t{1} << 30;

template <class T>
T readOne(std::istream& stream) {
  T value;
  stream.read(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

struct Header {
  std::array<std::int32_t, 3> size{};
  std::int32_t channels = 0;
  std::array<double, 3> lower{}, upper{};
};

Header readHeader(std::istream& stream) {
  std::array<char, 4> magic{};
  stream.read(magic.data(), magic.size());
  if (magic[3] != 3) throw std::runtime_error("version " + std::to_string(magic[3]) + " is not known, 3 is");
  if (const auto encoding = readOne<std::int32_t>(stream); encoding != 1) {
    throw std::runtime_error("encoding " + std::to_string(encoding) + " is not known, 1 (float32) is");
  }
  Header header;
  std::int64_t count = 1;
  for (std::int32_t& size : header.size) {
    size = readOne<std::int32_t>(stream);
    if (size < 1 || size > largestCount / count) {
      throw std::runtime_error("a size of " + std::to_string(size) + " makes no sense");
    }
    count *= size;
  }
  header.channels = readOne<std::int32_t>(stream);
  if (header.channels != 1 && header.channels != 3) {
    throw std::runtime_error("grids of " + std::to_string(header.channels) + " channels are not read, of 1 or 3 are");
  }
  if (count * header.channels > largestCount) throw std::runtime_error("there are more than 2^30 values");
  for (double& x : header.lower) x = static_cast<double>(readOne<float>(stream));
  for (double& x : header.upper) x = static_cast<double>(readOne<float>(stream));
  for (std::size_t r = 0; r < 3; ++r) {
    if (!std::isfinite(header.lower[r]) || !std::isfinite(header.upper[r]) || !(header.lower[r] < header.upper[r])) {
      throw std::runtime_error("its box has no extent");
    }
  }
  return header;
}

/// `components` floats a value.
template <class GridT>
typename GridT::Ptr fill(const Header& header, const std::vector<float>& values) {
  using Value = typename GridT::ValueType;
  auto grid = GridT::create(openvdb::zeroVal<Value>());
  auto accessor = grid->getAccessor();
  const auto channels = static_cast<std::size_t>(header.channels);
  const auto inside = [&](std::int32_t i, std::size_t r) { return i >= 0 && i < header.size[r]; };
  const auto nearest = [&](std::int32_t i, std::size_t r) {
    return static_cast<std::size_t>(std::clamp(i, 0, header.size[r] - 1));
  };
  for (std::int32_t z = -1; z <= header.size[2]; ++z) {
    for (std::int32_t y = -1; y <= header.size[1]; ++y) {
      for (std::int32_t x = -1; x <= header.size[0]; ++x) {
        const std::size_t at = (nearest(z, 2) * static_cast<std::size_t>(header.size[1]) + nearest(y, 1)) *
                                   static_cast<std::size_t>(header.size[0]) +
                               nearest(x, 0);
        Value value;
        std::memcpy(&value, values.data() + at * channels, sizeof value);
        const openvdb::Coord place(x, y, z);
        if (inside(x, 0) && inside(y, 1) && inside(z, 2)) {
          accessor.setValueOn(place, value);
        } else {
          accessor.setValueOff(place, value);
        }
      }
    }
  }
  return grid;
}

}  // namespace

bool isDenseFile(std::istream& stream) {
  std::array<char, 3> magic{};
  stream.read(magic.data(), magic.size());
  stream.seekg(0);
  return std::memcmp(magic.data(), "VOL", 3) == 0;
}

openvdb::GridBase::Ptr readDenseFile(std::istream& stream) {
  const Header header = readHeader(stream);
  std::vector<float> values;
  // In parts: a header that promises more than the file holds does not take memory for it.
  const std::size_t count = static_cast<std::size_t>(header.size[0]) * static_cast<std::size_t>(header.size[1]) *
                            static_cast<std::size_t>(header.size[2]) * static_cast<std::size_t>(header.channels);
  constexpr std::size_t part = std::size_t{1} << 20;
  while (values.size() < count) {
    const std::size_t begin = values.size(), more = std::min(part, count - begin);
    values.resize(begin + more);
    stream.read(reinterpret_cast<char*>(values.data() + begin), static_cast<std::streamsize>(more * sizeof(float)));
  }
  openvdb::GridBase::Ptr grid;
  if (header.channels == 1) {
    grid = fill<openvdb::FloatGrid>(header, values);
  } else {
    grid = fill<openvdb::Vec3SGrid>(header, values);
  }
  openvdb::math::Mat4d map = openvdb::math::Mat4d::identity();
  for (int r = 0; r < 3; ++r) {
    const auto i = static_cast<std::size_t>(r);
    const double size = (header.upper[i] - header.lower[i]) / header.size[i];
    map(r, r) = size;
    map(3, r) = header.lower[i] + 0.5 * size;
  }
  grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->insertMeta(paddedName, openvdb::BoolMetadata(true));
  return grid;
}

}  // namespace aerosol::grid
