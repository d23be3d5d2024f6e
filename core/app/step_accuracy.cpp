#include "core/app/step_accuracy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/app/picture.h"
#include "core/app/pilot.h"
#include "core/render/renderer.h"

namespace aerosol::app {

namespace {

constexpr int pilotSize = 48;    ///< Pixels of the longer side.
constexpr int cellsPerSide = 4;  ///< The image is compared in so many parts, squared.
constexpr int mostHalvings = 8;
constexpr std::uint32_t firstSamples = 64, mostSamples = 4096;

struct Cell {
  double mean = 0, variance = 0;  ///< Of the mean.
};
using Cells = std::array<Cell, static_cast<std::size_t>(cellsPerSide* cellsPerSide)>;

Cells cellsOf(const render::Film& film) {
  Cells cells;
  std::array<double, cells.size()> pixels{};
  const render::PixelRect& area = film.area();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const int column = (x - area.x0) * cellsPerSide / area.width();
      const int row = (y - area.y0) * cellsPerSide / area.height();
      const auto index = static_cast<std::size_t>(row * cellsPerSide + column);
      const render::PixelEstimate estimate = film.estimate(x, y);
      for (int c = 0; c < 3; ++c) {
        const auto error = static_cast<double>(estimate.standardError[c]);
        cells[index].mean += static_cast<double>(estimate.color[c]) / 3;
        // Channels of one sample go together.
        cells[index].variance += error * error / 3;
      }
      ++pixels[index];
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (pixels[i] == 0) continue;
    cells[i].mean /= pixels[i];
    cells[i].variance /= pixels[i] * pixels[i];
  }
  return cells;
}

double meanOf(const Cells& cells) {
  double sum = 0;
  for (const Cell& cell : cells) sum += std::fabs(cell.mean);
  return sum / static_cast<double>(cells.size());
}

/// Relative, mean square.
double noiseOf(const Cells& cells) {
  double sum = 0;
  for (const Cell& cell : cells) sum += cell.variance;
  const double mean = meanOf(cells);
  return mean > 0 ? sum / static_cast<double>(cells.size()) / (mean * mean) : 0;
}

/// Root mean square of what is left of the differences without their noise, as a part of the mean.
double differenceOf(const Cells& a, const Cells& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = a[i].mean - b[i].mean;
    sum += difference * difference - a[i].variance - b[i].variance;
  }
  const double mean = meanOf(b);
  return mean > 0 ? std::sqrt(std::max(0.0, sum / static_cast<double>(a.size()))) / mean : 0;
}

}  // namespace

bool marches(const render::PreparedScene& scene) {
  return std::ranges::any_of(scene.media, [](const volume::Medium& medium) {
    return !medium.constant && (medium.method == volume::DistanceMethod::marching ||
                                medium.transmittance == volume::TransmittanceMethod::marching ||
                                medium.transmittance == volume::TransmittanceMethod::twoCombs);
  });
}

StepAccuracy findStepScale(SceneSession& session, double targetError, const std::atomic<bool>& stop) {
  const double wantedNoise = targetError * targetError / 8;
  std::uint64_t run = 0;
  const auto renderWith = [&](float stepScale) {
    scene::SceneDescription description = session.description();
    description.integrator.stepScale = stepScale;
    shrinkFilm(description.film, pilotSize);
    const auto scene = session.prepareVariant(description);
    Cells cells{};
    if (!scene) return cells;
    render::Film film(cropOf(description.film));
    render::RenderOptions options;
    options.threads = session.threadCount();
    options.seed = scene->seed + 0x9e3779b97f4a7c15u * ++run;
    options.stop = &stop;
    for (std::uint32_t end = firstSamples; end <= mostSamples && !stop; end *= 2) {
      options.endSample = end;
      render::render(*scene, session.integrator(), film, options);
      cells = cellsOf(film);
      if (noiseOf(cells) <= wantedNoise) break;
      options.firstSample = end;
    }
    return cells;
  };
  StepAccuracy found{.stepScale = session.description().integrator.stepScale};
  Cells coarse = renderWith(found.stepScale);
  for (int halving = 0; halving < mostHalvings && !stop; ++halving) {
    const Cells fine = renderWith(found.stepScale / 2);
    found.after = 2 * differenceOf(coarse, fine);
    if (halving == 0) found.before = found.after;
    if (found.after <= targetError / 2) break;
    found.stepScale /= 2;
    coarse = fine;
  }
  return found;
}

}  // namespace aerosol::app
