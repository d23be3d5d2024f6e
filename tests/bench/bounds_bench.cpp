// Bounds of the shipped volume shaders and of fractal noise: how close they are to the greatest value that dense
// sampling finds, and nanoseconds a box. `closeness` is the mean bound over the mean true maximum, over boxes of 1/64
// of the primitive (1/64 and 1/128 of a unit cube for the noise); `in8` the same where each box is cut in eight;
// `outside` the boxes in which a sample lies beyond the bound, which are none. Of shaders and of `noise` it is the
// extinction, where negative values count as 0; of `raw_noise` the sum of octaves as it is, and of
// `raw_noise_magnitude` how far that is from 0.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/lang/compile.h"
#include "core/shading/batch.h"
#include "core/shading/bounds.h"

namespace aerosol::bench {

namespace {

constexpr int boxCount = 256;
constexpr int samplesPerAxis = 16;

template <class T>
T valueOf(Result<T> result) {
  if (!result) throw std::runtime_error(format(result.errors()));
  return std::move(*result);
}

/// What of the shader is bounded.
enum class Quantity { extinction, value, magnitude };

constexpr const char* noise = R"(
volume octaves(float level = 0, int clamped = 1) {
  float sum = level, weight = 0.5;
  point q = P;
  for (int octave = 0; octave < 6; octave++) {
    sum += weight * snoise(q);
    q *= 2;
    weight *= 0.5;
  }
  Ci = (clamped ? max(sum, 0) : sum) * anisotropic_vdf(color(1), color(1), 0);
}
)";

float boundOf(const shading::CoefficientBounds& bounds, Quantity quantity) {
  const shading::Bound raw = bounds.sigmaT[0];
  if (quantity == Quantity::extinction) return bounds.extinction().high;
  return quantity == Quantity::value ? raw.high : std::max(raw.high, -raw.low);
}

/// A shader placed in its own space, with the kernels for points and for boxes.
class Shader {
 public:
  explicit Shader(const std::shared_ptr<const lang::Program>& program, shading::Instance instance = {})
      : host_(spaces_, 1000000), points_(4096) {
    system_.add(program, std::move(instance));
    const auto compiler = valueOf(jit::Compiler::create({}));
    const shading::ShadingOptions options{{16, *jit::hostIsa()}, false};
    if (system_.compile(*compiler, options).hasErrors() || system_.compileBounds(*compiler, options).hasErrors())
      throw std::runtime_error("the shader does not compile");
  }

  const shading::Family& family() const { return system_.families().front(); }

  void bound(std::span<const shading::VolumeBox> boxes, std::span<shading::CoefficientBounds> bounds) {
    batch_.evaluate(host_, family(), 0, boxes, bounds);
  }

  float greatest(const Box<Object>& box, Quantity quantity) {
    waiting_.bind(family(), shading::Variant::extinction);
    waiting_.shrink(0);
    const auto at = [&](int axis, int i) {
      const float t = static_cast<float>(i) / (samplesPerAxis - 1);
      return box.lower[axis] + t * (box.upper[axis] - box.lower[axis]);
    };
    for (int i = 0; i < samplesPerAxis; ++i) {
      for (int j = 0; j < samplesPerAxis; ++j) {
        for (int k = 0; k < samplesPerAxis; ++k) {
          waiting_.push(shading::VolumePoint{{at(0, i), at(1, j), at(2, k)}, {}, 0}, 0);
        }
      }
    }
    points_.run(host_, waiting_, 0);
    const float* const values = points_.output(0);
    float most = quantity == Quantity::value ? values[0] : 0.0f;
    for (std::size_t i = 0; i < waiting_.size(); ++i)
      most = std::max(most, quantity == Quantity::magnitude ? std::abs(values[i]) : values[i]);
    return most;
  }

 private:
  shading::ShadingSystem system_;
  shading::NamedSpaces spaces_;
  shading::KernelHost host_;
  shading::Batch points_;
  shading::PointArrays waiting_;
  shading::BoundsBatch batch_;
};

std::vector<shading::VolumeBox> randomBoxes(float extent, float size) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> corner(-extent, extent - size);
  std::vector<shading::VolumeBox> boxes(boxCount);
  for (shading::VolumeBox& box : boxes) {
    box.box.lower = {corner(random), corner(random), corner(random)};
    box.box.upper = {box.box.lower.x + size, box.box.lower.y + size, box.box.lower.z + size};
  }
  return boxes;
}

std::vector<shading::VolumeBox> cutInEight(const std::vector<shading::VolumeBox>& boxes) {
  std::vector<shading::VolumeBox> parts;
  for (const shading::VolumeBox& box : boxes) {
    for (int part = 0; part < 8; ++part) {
      shading::VolumeBox cut = box;
      for (int axis = 0; axis < 3; ++axis) {
        const float middle = 0.5f * (box.box.lower[axis] + box.box.upper[axis]);
        ((part >> axis & 1) != 0 ? cut.box.lower : cut.box.upper)[axis] = middle;
      }
      parts.push_back(cut);
    }
  }
  return parts;
}

void measure(benchmark::State& state, Shader& shader, float extent, float size,
             Quantity quantity = Quantity::extinction) {
  const auto boxes = randomBoxes(extent, size);
  std::vector<shading::CoefficientBounds> bounds(boxes.size());
  for (auto _ : state) shader.bound(boxes, bounds);
  state.counters["box"] =
      benchmark::Counter(boxCount, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  const auto parts = cutInEight(boxes);
  std::vector<shading::CoefficientBounds> partBounds(parts.size());
  shader.bound(parts, partBounds);
  double whole = 0, cut = 0, greatest = 0;
  int empty = 0, outside = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    float most = boundOf(partBounds[8 * i], quantity);
    for (std::size_t part = 1; part < 8; ++part) most = std::max(most, boundOf(partBounds[8 * i + part], quantity));
    const float bound = boundOf(bounds[i], quantity), seen = shader.greatest(boxes[i].box, quantity);
    whole += static_cast<double>(bound);
    cut += static_cast<double>(most);
    greatest += static_cast<double>(seen);
    empty += bounds[i].isEmpty();
    outside += seen > bound || seen > most;
  }
  state.counters["closeness"] = whole / greatest;
  state.counters["in8"] = cut / greatest;
  state.counters["empty"] = static_cast<double>(empty) / boxCount;
  state.counters["outside"] = outside;
}

void shippedShader(benchmark::State& state, const std::filesystem::path& file) {
  Shader shader(valueOf(lang::compileFile(file, {})).program);
  if (!shader.family().bounds) return state.SkipWithError("constant");
  measure(state, shader, 1.0f, 2.0f / 64);
}

void fractalNoise(benchmark::State& state, float parts, Quantity quantity) {
  const auto program = valueOf(lang::compileString(noise, "octaves.osl", {})).program;
  shading::Instance instance;
  const std::int32_t clamped = quantity == Quantity::extinction ? 1 : 0;
  instance.values.push_back({*shading::findParameter(*program, "clamped"), std::vector<std::int32_t>{clamped}});
  Shader shader(program, std::move(instance));
  measure(state, shader, 0.5f, 1 / parts, quantity);
}

const bool registered = [] {
  const std::filesystem::path folder = std::filesystem::path(AEROSOL_SOURCE_DIR) / "shaders" / "volume";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (file.extension() != ".osl") continue;
    benchmark::RegisterBenchmark(("bounds/" + file.stem().string()).c_str(), shippedShader, file);
  }
  const std::pair<const char*, Quantity> kinds[] = {
      {"noise", Quantity::extinction}, {"raw_noise", Quantity::value}, {"raw_noise_magnitude", Quantity::magnitude}};
  for (const auto& [kind, quantity] : kinds) {
    for (const int parts : {64, 128}) {
      const std::string name = std::string("bounds/") + kind + "/" + std::to_string(parts);
      benchmark::RegisterBenchmark(name.c_str(), fractalNoise, static_cast<float>(parts), quantity);
    }
  }
  return true;
}();

}  // namespace

}  // namespace aerosol::bench
