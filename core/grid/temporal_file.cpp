#include "core/grid/temporal_file.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "core/grid/temporal_curve.h"
#include "core/grid/temporal_grid.h"

namespace aerosol::grid {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr char magic[4] = {'A', 'V', 'T', '1'};
constexpr std::size_t voxels = 512;
constexpr std::size_t mostTimes = 255;

template <class T>
void put(std::ostream& out, const T* values, std::size_t count) {
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}
void putCount(std::ostream& out, std::size_t count) {
  const auto number = static_cast<std::uint32_t>(count);
  put(out, &number, 1);
}

Diagnostic problem(const std::string& path, const std::string& message) {
  return {Severity::error, {path, 0, 0}, message, {}, {}};
}

/// Takes numbers from a file's bytes; `ok` turns false where there are too few.
class Source {
 public:
  explicit Source(std::vector<char> bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  bool take(T* values, std::size_t count) {
    if (count > (bytes_.size() - at_) / sizeof(T)) return false;
    if (count > 0) std::memcpy(values, bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
    return true;
  }
  template <class T>
  bool takeInto(std::vector<T>& values, std::size_t count) {
    if (count > (bytes_.size() - at_) / sizeof(T)) return false;
    const std::size_t before = values.size();
    values.resize(before + count);
    return take(values.data() + before, count);
  }
  bool atEnd() const { return at_ == bytes_.size(); }

 private:
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

constexpr const char* tooShort = "the file of voxels in time ends too early";

/// What is wrong; empty when the block was read.
std::string readBlock(Source& source, TemporalCurves& grid) {
  std::array<std::int32_t, 3> origin{};
  const std::size_t curves = voxels * static_cast<std::size_t>(grid.channels);
  if (!source.take(origin.data(), 3)) return tooShort;
  for (const std::int32_t i : origin) {
    if (i % 8 != 0 || i < -(1 << 30) || i > 1 << 30) return "a block of the file does not begin at a multiple of 8";
  }
  const std::size_t firstCurve = grid.counts.size(), firstKnot = grid.knots.size();
  if (!source.takeInto(grid.counts, curves)) return tooShort;
  std::size_t knots = 0;
  for (std::size_t i = firstCurve; i < grid.counts.size(); ++i) knots += grid.counts[i];
  if (!source.takeInto(grid.knots, knots) || !source.takeInto(grid.values, knots)) return tooShort;
  std::size_t at = firstKnot;
  for (std::size_t i = firstCurve; i < grid.counts.size(); ++i) {
    for (std::size_t k = 0; k < grid.counts[i]; ++k, ++at) {
      if (grid.knots[at] >= grid.times.size()) return "a curve of the file names a time that there is not";
      if (k > 0 && grid.knots[at] <= grid.knots[at - 1])
        return "a curve of the file has two values at one time, or times out of order";
    }
  }
  grid.origins.push_back(origin);
  return {};
}

std::string readGrid(Source& source, TemporalCurves& grid) {
  std::uint32_t length = 0, channels = 0, times = 0, blocks = 0;
  std::vector<char> name;
  if (!source.take(&length, 1) || !source.takeInto(name, length) || !source.take(&channels, 1) ||
      !source.take(grid.indexToFile.data(), 16) || !source.take(&times, 1))
    return tooShort;
  grid.name.assign(name.begin(), name.end());
  if (channels != 1 && channels != 3) return "a grid of the file has neither 1 nor 3 channels";
  grid.channels = static_cast<int>(channels);
  if (times < 1 || times > mostTimes) return "a grid of the file has not 1 to 255 times";
  if (!source.takeInto(grid.times, times) || !source.take(&blocks, 1)) return tooShort;
  for (std::size_t i = 0; i < grid.times.size(); ++i) {
    if (!std::isfinite(grid.times[i]) || (i > 0 && !(grid.times[i] > grid.times[i - 1])))
      return "the times of a grid do not ascend";
  }
  for (std::uint32_t i = 0; i < blocks; ++i) {
    if (std::string wrong = readBlock(source, grid); !wrong.empty()) return wrong;
  }
  const std::set<std::array<std::int32_t, 3>> places(grid.origins.begin(), grid.origins.end());
  if (places.size() != grid.origins.size()) return "two blocks of a grid stand in one place";
  return {};
}

class File final : public VoxelFile {
 public:
  explicit File(std::vector<std::unique_ptr<VoxelGrid>> grids) : grids_(std::move(grids)) {}
  std::span<const std::unique_ptr<VoxelGrid>> grids() const override { return grids_; }

 private:
  std::vector<std::unique_ptr<VoxelGrid>> grids_;
};

}  // namespace

void TemporalCurves::add(const TemporalSamples& samples, float error) {
  if (std::ranges::all_of(samples.values, [](float v) { return v == 0; })) return;
  const auto perTime = voxels * static_cast<std::size_t>(channels);
  std::vector<float> curve(times.size());
  std::array<std::uint8_t, mostTimes + 1> chosen;
  for (std::size_t c = 0; c < perTime; ++c) {
    for (std::size_t t = 0; t < times.size(); ++t) curve[t] = samples.values[t * perTime + c];
    const bool isNothing = std::ranges::all_of(curve, [](float v) { return v == 0; });
    const std::size_t count = isNothing ? 0 : fitCurve(times, curve, error, chosen.data());
    counts.push_back(static_cast<std::uint8_t>(count));
    for (std::size_t k = 0; k < count; ++k) {
      knots.push_back(chosen[k]);
      values.push_back(curve[chosen[k]]);
    }
  }
  origins.push_back(samples.origin);
}

void TemporalCurves::append(const TemporalCurves& other) {
  const auto join = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  join(origins, other.origins);
  join(counts, other.counts);
  join(knots, other.knots);
  join(values, other.values);
}

Diagnostics writeTemporal(const std::string& path, std::span<const TemporalCurves> grids) {
  std::ofstream out(path, std::ios::binary);
  put(out, magic, 4);
  putCount(out, grids.size());
  for (const TemporalCurves& grid : grids) {
    putCount(out, grid.name.size());
    put(out, grid.name.data(), grid.name.size());
    putCount(out, static_cast<std::size_t>(grid.channels));
    put(out, grid.indexToFile.data(), 16);
    putCount(out, grid.times.size());
    put(out, grid.times.data(), grid.times.size());
    putCount(out, grid.origins.size());
    const std::size_t curves = voxels * static_cast<std::size_t>(grid.channels);
    std::size_t knot = 0;
    for (std::size_t b = 0; b < grid.origins.size(); ++b) {
      const std::uint8_t* const counts = grid.counts.data() + b * curves;
      std::size_t knots = 0;
      for (std::size_t i = 0; i < curves; ++i) knots += counts[i];
      put(out, grid.origins[b].data(), 3);
      put(out, counts, curves);
      put(out, grid.knots.data() + knot, knots);
      put(out, grid.values.data() + knot, knots);
      knot += knots;
    }
  }
  out.close();
  Diagnostics errors;
  if (!out) errors.add(problem(path, "cannot write the file: the disk is full or the folder is not there"));
  return errors;
}

bool isTemporalFile(std::string_view path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return extension == ".avt";
}

Result<std::shared_ptr<const VoxelFile>> readTemporal(const std::string& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  std::vector<char> bytes(stream ? static_cast<std::size_t>(stream.tellg()) : 0);
  stream.seekg(0);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    return problem(path, "the file cannot be read");
  Source source(std::move(bytes));
  char found[4];
  std::uint32_t count = 0;
  if (!source.take(found, 4) || std::memcmp(found, magic, 4) != 0)
    return problem(path, "this is no file of voxels in time: it does not begin with AVT1");
  if (!source.take(&count, 1)) return problem(path, tooShort);
  std::vector<std::unique_ptr<VoxelGrid>> grids;
  for (std::uint32_t i = 0; i < count; ++i) {
    TemporalCurves grid;
    if (const std::string wrong = readGrid(source, grid); !wrong.empty()) return problem(path, wrong);
    std::string wrong;
    auto made = TemporalGrid::make(std::move(grid), wrong);
    if (!made) return problem(path, wrong);
    grids.push_back(std::move(made));
  }
  if (grids.empty()) return problem(path, "the file has no grids");
  if (!source.atEnd()) return problem(path, "something stands behind the last grid of the file");
  return std::shared_ptr<const VoxelFile>(std::make_shared<const File>(std::move(grids)));
}

}  // namespace aerosol::grid
