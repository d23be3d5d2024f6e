// Where volumes are, and what it costs to find out: printed tables, one function each. Alternatives are timed in turn,
// and medians compared, so that the load of the machine falls on all of them alike.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <span>
#include <vector>

namespace aerosol::bench {

void printSpans();
void printFrusta();
void printOverlap();
void printLookups();
void printPriorities();

/// Seconds that a call of each takes, which should be some milliseconds.
inline std::vector<double> medianSeconds(std::span<const std::function<void()>> works, int rounds = 9) {
  std::vector<std::vector<double>> times(works.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      const auto begin = std::chrono::steady_clock::now();
      works[i]();
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      if (round >= 0) times[i].push_back(taken.count());  // The first one warms caches up.
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& each : times) {
    std::ranges::nth_element(each, each.begin() + rounds / 2);
    medians.push_back(each[static_cast<std::size_t>(rounds / 2)]);
  }
  return medians;
}

}  // namespace aerosol::bench
