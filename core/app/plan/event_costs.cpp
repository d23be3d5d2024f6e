#include "core/app/plan/event_costs.h"

#include <utility>

namespace aerosol::app {

namespace {

constexpr std::pair<std::string_view, double> costs[] = {{"depth-of-field", 30},
                                                         {"motion", 15},
                                                         {"moving-camera", 300},
                                                         {"moving-shapes", 150},
                                                         {"moving-lights", 300},
                                                         {"moving-volumes", 200},
                                                         {"holdouts", 20},
                                                         {"media-probes", 600},
                                                         {"constant-light", 10},
                                                         {"light-textures", 80},
                                                         {"light-hierarchy", 400},
                                                         {"light-splitting", 400},
                                                         {"equiangular-sampling", 150},
                                                         {"joint-lights", 2000},
                                                         {"lamp-directions", 150},
                                                         {"light-links", 30},
                                                         {"straight-shadows", 300},
                                                         {"medium-boundaries", 150},
                                                         {"subsurface", 4000},
                                                         {"nested-media", 80},
                                                         {"overlap", 150},
                                                         {"constant-media", 80},
                                                         {"analytic-voxels", 800},
                                                         {"bound-trees", 150},
                                                         {"velocity-blur", 30},
                                                         {"volume-emission", 30},
                                                         {"chromatic-extinction", 5},
                                                         {"level-of-detail", 30},
                                                         {"volume-looks", 10},
                                                         {"russian-roulette", 10},
                                                         {"contribution-roulette", 60},
                                                         {"clamped-indirect", 5},
                                                         {"displacement", 0}};

}  // namespace

std::optional<double> nanosecondsOfEvent(std::string_view effect) {
  for (const auto& [name, nanoseconds] : costs) {
    if (name == effect) return nanoseconds;
  }
  return {};
}

}  // namespace aerosol::app
