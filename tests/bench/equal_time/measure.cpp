#include "tests/bench/equal_time/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "tests/support/rendering.h"

namespace aerosol::bench {

namespace {

constexpr double channels = 3;

/// Of the whole process: other programs on the machine do not count.
double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Values of all pixels and channels with the variance of each.
struct Image {
  std::vector<double> values, variances;
  double mean = 0;
  double seconds = 0;
  std::uint32_t samples = 0;

  /// Of the mean over all pixels.
  double meanVariance() const {
    double sum = 0;
    for (const double v : variances) sum += v;
    return sum / std::pow(static_cast<double>(values.size()), 2);
  }
};

class Renderer {
 public:
  Renderer(const BenchScene& scene, const Method& method, const Effort& effort, const char* sampler)
      : scene_(test::sceneXml(scene.integrator + method.parameters, sensor(scene, effort, sampler), scene.content),
               {.shaderFolder = AEROSOL_SOURCE_DIR "/tests/bench/equal_time/shaders"}) {
    // What is wrong with it has been said.
    if (!scene_.scene()) std::exit(1);
  }

  std::string choices() const {
    const scene::Integrator& integrator = scene_.description().integrator;
    std::string text = integrator.equiangular ? "" : "no equiangular; ";
    if (integrator.jointLights) text += "joint lights; ";
    if (!scene_.scene()->contributions.isEmpty()) text += "roulette by contribution; ";
    if (!scene_.scene()->lampsInMedia.empty()) text += "directions towards lamps; ";
    for (const std::string& reason : scene_.scene()->samplingReasons) text += reason + "; ";
    return text;
  }

  Image render(std::uint32_t samples, std::uint64_t seed) const {
    auto film = scene_.film();
    Image image{.samples = samples};
    const double start = processorSeconds();
    scene_.renderInto(*film, {.threads = 1, .endSample = samples, .seed = seed});
    image.seconds = processorSeconds() - start;
    const render::PixelRect area = film->area();
    for (int y = area.y0; y < area.y1; ++y) {
      for (int x = area.x0; x < area.x1; ++x) {
        const render::PixelEstimate p = film->estimate(x, y);
        for (int c = 0; c < 3; ++c) {
          const auto error = static_cast<double>(p.standardError[c]);
          image.values.push_back(static_cast<double>(p.color[c]));
          image.variances.push_back(error * error);
          image.mean += image.values.back() / (channels * static_cast<double>(area.pixelCount()));
        }
      }
    }
    return image;
  }

  /// Samples that take about so long: a power of two, of which the first render tells.
  std::uint32_t samplesFor(double seconds) const {
    std::uint32_t samples = 2;
    double taken = render(samples, 1).seconds;
    while (taken < 0.1 * seconds && samples < (1u << 20)) {
      samples *= 4;
      taken = render(samples, 1).seconds;
    }
    const double wanted = std::clamp(seconds / std::max(taken, 1e-6) * samples, 2.0, 1048576.0);
    return std::bit_floor(static_cast<std::uint32_t>(wanted * 1.41));
  }

 private:
  static test::TestSensor sensor(const BenchScene& scene, const Effort& effort, const char* sampler) {
    test::TestSensor sensor;
    sensor.fov = scene.fov;
    sensor.width = effort.width;
    sensor.height = effort.height;
    sensor.sampler = sampler;
    return sensor;
  }

  test::TestScene scene_;
};

Image mean(const Image& a, const Image& b) {
  // Weighted by the precision of the whole: the better half counts for more.
  const double va = a.meanVariance(), vb = b.meanVariance();
  const double wa = va + vb > 0 ? vb / (va + vb) : 0.5, wb = 1 - wa;
  Image result{.mean = wa * a.mean + wb * b.mean, .samples = std::min(a.samples, b.samples)};
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    result.values.push_back(wa * a.values[i] + wb * b.values[i]);
    result.variances.push_back(wa * wa * a.variances[i] + wb * wb * b.variances[i]);
  }
  return result;
}

/// What squares of single values are divided by: the mean's square, as studies measure errors; or each value's own,
/// which a hundredth of the mean's square keeps from 0 (Rousselle, Knaus and Zwicker 2011).
enum class Scale : std::uint8_t { image, pixel };

/// The mean over the values of `square(i)`, relative.
template <class Square>
double relativeMean(const Image& reference, Scale scale, const Square& square) {
  const double mean2 = reference.mean * reference.mean;
  double sum = 0;
  for (std::size_t i = 0; i < reference.values.size(); ++i) {
    sum += square(i) / (scale == Scale::image ? mean2 : reference.values[i] * reference.values[i] + 0.01 * mean2);
  }
  return sum / static_cast<double>(reference.values.size());
}

double relativeSquaredError(const Image& image, const Image& reference, Scale scale) {
  const double error = relativeMean(reference, scale, [&](std::size_t i) {
    return std::pow(image.values[i] - reference.values[i], 2) - reference.variances[i];
  });
  // Where the reference's own noise is all that is left, the difference may be negative by chance.
  return std::max(error, 1e-12);
}

MethodResult measureMethod(const Renderer& renderer, const Method& method, const Effort& effort,
                           const Image& reference) {
  MethodResult result{.name = method.name, .choices = renderer.choices()};
  result.samples = renderer.samplesFor(effort.secondsOfSeed);
  double mean = 0, variance = 0;
  for (int seed = 0; seed < effort.seeds; ++seed) {
    const Image image = renderer.render(result.samples, 1000 + static_cast<std::uint64_t>(seed));
    result.error.push_back(relativeSquaredError(image, reference, Scale::image));
    result.seconds.push_back(image.seconds);
    result.cost.push_back(result.error.back() * image.seconds);
    result.pixelCost.push_back(relativeSquaredError(image, reference, Scale::pixel) * image.seconds);
    mean += image.mean / effort.seeds;
    variance += image.meanVariance() / (effort.seeds * effort.seeds);
  }
  result.meanDifference = mean / reference.mean - 1;
  result.meanDifferenceError = std::sqrt(variance + reference.meanVariance()) / reference.mean;
  return result;
}

}  // namespace

Spread Spread::of(std::vector<double> values) {
  std::ranges::sort(values);
  const auto at = [&](double part) {
    const double place = part * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (place - static_cast<double>(low)) * (values[high] - values[low]);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

const MethodResult* SceneResult::find(const std::string& method) const {
  const auto found = std::ranges::find(methods, method, &MethodResult::name);
  return found == methods.end() ? nullptr : &*found;
}

const MethodResult* SceneResult::best() const {
  const MethodResult* best = nullptr;
  for (const MethodResult& m : methods) {
    if (m.name == automaticName) continue;
    if (!best || Spread::of(m.cost).median < Spread::of(best->cost).median) best = &m;
  }
  return best;
}

Spread ratio(const std::vector<double>& one, const std::vector<double>& other) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i) ratios.push_back(one[i] / other[i]);
  return Spread::of(ratios);
}

SceneResult measure(const BenchScene& scene, const Effort& effort, const std::string& only) {
  SceneResult result{.name = scene.name};
  const auto half = [&](const Method& method, std::uint64_t seed) {
    const Renderer renderer(scene, method, effort, "independent");
    return renderer.render(renderer.samplesFor(effort.secondsOfReference), seed);
  };
  const Image first = half(firstReference(scene), 1), second = half(secondReference(scene), 2);
  const Image reference = mean(first, second);
  result.referenceSamples = reference.samples;
  result.referenceError =
      std::sqrt(relativeMean(reference, Scale::image, [&](std::size_t i) { return reference.variances[i]; }));
  result.halvesDiffer = second.mean / first.mean - 1;
  result.halvesError = std::sqrt(first.meanVariance() + second.meanVariance()) / first.mean;
  for (const Method& method : allMethods()) {
    const bool isKept = method.name == automaticName || method.name == simplestName;
    if (!isKept && !only.empty() && method.name != only) continue;
    const Renderer renderer(scene, method, effort, "sobol");
    // Where it comes to the same as another one it has been measured; the two that are compared always are.
    const bool isKnown = std::ranges::any_of(result.methods, [&](const MethodResult& m) {
      return m.name != automaticName && m.choices == renderer.choices();
    });
    if (isKnown && !isKept) continue;
    result.methods.push_back(measureMethod(renderer, method, effort, reference));
  }
  return result;
}

}  // namespace aerosol::bench
