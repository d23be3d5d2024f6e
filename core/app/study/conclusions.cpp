#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/app/quantity.h"
#include "core/app/study/measure.h"
#include "core/app/study/report.h"

namespace aerosol::app {

namespace {

double positiveRoot(double square) { return std::sqrt(std::max(square, 0.0)); }

/// The standard error of an error: that of its square, carried through the root.
double errorOf(const StudyRound& round) {
  return round.squaredError.error / (2 * std::max(positiveRoot(round.squaredError.value), 1e-9));
}

std::string halving(const StudyRow& best) {
  const StudyRound& last = best.study->rounds.back();
  const double error = positiveRoot(last.squaredError.value);
  const double factor = costOfHalving(*best.study);
  if (factor == 0) return "What halving its error costs takes a larger --budget to tell.";
  if (!std::isfinite(factor)) {
    return fmt::format("Time does not halve its error: its bias is {}.",
                       formatError(positiveRoot(last.squaredBias.value)));
  }
  return fmt::format("To halve the error costs {:.1f} times the time: from {} in {} to {} in about {}, at this size.",
                     factor, formatError(error), formatDuration(last.seconds), formatError(error / 2),
                     formatDuration(last.seconds * factor));
}

std::string judgeBias(const StudyCase& study) {
  const StudyRound& last = study.rounds.back();
  const double bias = positiveRoot(last.squaredBias.value);
  if (!last.hasBias()) {
    return fmt::format("{}: no bias is found; it is below {}.", study.name,
                       formatError(positiveRoot(std::max(last.squaredBias.value, 0.0) + 2 * last.squaredBias.error)));
  }
  std::string text = fmt::format("{}: bias of {}, however long it renders", study.name, formatError(bias));
  if (last.hasMeanBias()) {
    text += fmt::format("; the image is {} too {} in the mean (+- {})", formatError(std::fabs(last.meanBias.value)),
                        last.meanBias.value > 0 ? "bright" : "dark", formatError(last.meanBias.error));
  }
  return text + ".";
}

Chart makeChart(const char* title) { return {title, "seconds of one render", "error, part of the mean", true, {}}; }

/// " Of those …", where the best of all has a bias.
std::string bestWithoutBias(const std::vector<StudyRow>& rows) {
  const auto found =
      std::ranges::find_if(rows, [](const StudyRow& row) { return !row.study->rounds.back().hasBias(); });
  if (found == rows.begin() || found == rows.end()) return {};
  return fmt::format(" Of those in which no bias is found it is {}: {}.", found->study->name,
                     formatError(found->error));
}

}  // namespace

std::vector<StudyRow> sortRows(const StudyResults& results) {
  const double time = equalTime(results);
  std::vector<StudyRow> rows;
  for (const StudyCase& study : results.cases) {
    if (!study.rounds.empty()) rows.push_back({&study, errorAtTime(study, time), convergenceRate(study), false});
  }
  std::sort(rows.begin(), rows.end(), [](const StudyRow& a, const StudyRow& b) { return a.error < b.error; });
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double both = std::hypot(errorOf(rows[i].study->rounds.back()), errorOf(rows[i - 1].study->rounds.back()));
    rows[i].isWithinNoise = rows[i].error - rows[i - 1].error < 2 * both;
  }
  return rows;
}

std::vector<std::string> conclusions(const StudyResults& results) {
  const auto rows = sortRows(results);
  if (rows.empty()) return {"Nothing has been measured yet."};
  const StudyRow& best = rows.front();
  std::vector<std::string> sentences;
  const bool isTie = rows.size() > 1 && rows[1].isWithinNoise;
  if (rows.size() == 1) {
    sentences.push_back(fmt::format("In {} its error is {} ({}).", formatDuration(equalTime(results)),
                                    formatError(best.error), best.study->name));
  }
  if (rows.size() > 1)
    sentences.push_back(fmt::format("In equal time, {} each, {} has the smallest error: {}{}.",
                                    formatDuration(equalTime(results)), best.study->name, formatError(best.error),
                                    isTie ? fmt::format("; {} with {} is not told from it", rows[1].study->name,
                                                        formatError(rows[1].error))
                                          : "") +
                        bestWithoutBias(rows));
  sentences.push_back(halving(best));
  for (const StudyRow& row : rows) sentences.push_back(judgeBias(*row.study));
  if (!results.reference.isUnbiased) {
    sentences.push_back(fmt::format("The reference itself is biased ({}): bias that all methods share is not seen.",
                                    results.reference.method));
  }
  return sentences;
}

Chart errorChart(const StudyResults& results) {
  Chart chart = makeChart("error against time");
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    const StudyCase& study = results.cases[i];
    ChartSeries series{study.name, chartColor(i), false, {}};
    for (const StudyRound& round : study.rounds) {
      if (!(round.squaredError.value > 0)) continue;
      const auto [value, error] = round.squaredError;
      series.points.push_back(
          {round.seconds, std::sqrt(value), positiveRoot(value - 2 * error), std::sqrt(value + 2 * error)});
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Chart partsChart(const StudyResults& results) {
  Chart chart = makeChart("noise (lines) and bias (dashed) apart");
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    const StudyCase& study = results.cases[i];
    ChartSeries noise{study.name, chartColor(i), false, {}}, bias{study.name + " bias", chartColor(i), true, {}};
    for (const StudyRound& round : study.rounds) {
      const auto [value, error] = round.variance;
      if (value > 0) {
        noise.points.push_back(
            {round.seconds, std::sqrt(value), positiveRoot(value - 2 * error), std::sqrt(value + 2 * error)});
      }
      if (!round.hasBias()) continue;
      const auto [square, squareError] = round.squaredBias;
      bias.points.push_back({round.seconds, std::sqrt(square), positiveRoot(square - 2 * squareError),
                             std::sqrt(square + 2 * squareError)});
    }
    chart.series.push_back(std::move(noise));
    if (!bias.points.empty()) chart.series.push_back(std::move(bias));
  }
  return chart;
}

}  // namespace aerosol::app
