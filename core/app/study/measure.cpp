#include "core/app/study/measure.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace aerosol::app {

namespace {

double finite(float value) { return std::isfinite(value) ? static_cast<double>(value) : 0.0; }

/// Sums over the values of the image, from which every estimate with any one repetition left out follows.
struct Moments {
  double count = 0;              ///< Values.
  std::vector<double> means;     ///< By repetition: Σ (I_r - F).
  std::vector<double> cross;     ///< R · R: Σ (I_r - F)(I_s - F).
  double referenceVariance = 0;  ///< Σ v_F.
  double referenceScatter = 0;   ///< Σ 2 v_F² + 4 M² v_F: the variance of Σ (M - F)² that the reference makes.
  double squaredVariances = 0;   ///< Σ v_F².
};

Moments momentsOf(std::span<const StudyImage> repetitions, const StudyReference& reference) {
  const std::size_t r = repetitions.size();
  Moments m;
  m.means.resize(r);
  m.cross.resize(r * r);
  std::vector<double> difference(r);
  for (std::size_t i = 0; i < reference.mean.size(); ++i) {
    if (reference.leavesOut(i)) continue;
    ++m.count;
    const double v = finite(reference.variance[i]);
    m.referenceVariance += v;
    m.squaredVariances += v * v;
    double mean = 0;
    for (std::size_t a = 0; a < r; ++a) {
      difference[a] = finite(repetitions[a][i]) - finite(reference.mean[i]);
      m.means[a] += difference[a];
      mean += difference[a] / static_cast<double>(r);
      for (std::size_t b = 0; b <= a; ++b) m.cross[a * r + b] += difference[a] * difference[b];
    }
    m.referenceScatter += 2 * v * v + 4 * mean * mean * v;
  }
  return m;
}

struct Estimates {
  double squaredError = 0, variance = 0, squaredBias = 0, meanBias = 0;
};

/// Of all repetitions but `left`.
Estimates estimate(const Moments& m, std::size_t count, std::size_t left) {
  double n = 0, diagonal = 0, all = 0, mean = 0;
  for (std::size_t a = 0; a < count; ++a) {
    if (a == left) continue;
    ++n;
    mean += m.means[a];
    diagonal += m.cross[a * count + a];
    for (std::size_t b = 0; b < a; ++b) {
      if (b != left) all += 2 * m.cross[a * count + b];
    }
  }
  all += diagonal;
  const double squareOfMean = all / (n * n);  // Σ (M - F)²
  Estimates e;
  e.squaredError = (diagonal / n - m.referenceVariance) / m.count;
  const double variance = (diagonal - n * squareOfMean) / (n - 1);
  e.variance = variance / m.count;
  e.squaredBias = (squareOfMean - variance / n - m.referenceVariance) / m.count;
  e.meanBias = mean / n / m.count;
  return e;
}

double jackknife(const std::vector<Estimates>& parts, double Estimates::* member) {
  const auto n = static_cast<double>(parts.size());
  double mean = 0, squares = 0;
  for (const Estimates& part : parts) mean += part.*member / n;
  for (const Estimates& part : parts) squares += (part.*member - mean) * (part.*member - mean);
  return std::sqrt(squares * (n - 1) / n);
}

}  // namespace

namespace {

/// Marks what is above `brightest` times the mean of the rest, the hundredth of all values that is largest at most: a
/// lamp that is seen would decide all errors alone.
void leaveOutTheBrightest(StudyReference& reference) {
  constexpr double brightest = 20;
  const std::size_t values = reference.mean.size(), most = values / 100;
  reference.leftOut.assign(values, 0);
  if (most == 0) return;
  std::vector<double> sizes;
  for (const float mean : reference.mean) sizes.push_back(std::fabs(finite(mean)));
  std::vector<double> sorted = sizes;
  std::ranges::nth_element(sorted, sorted.end() - static_cast<std::ptrdiff_t>(most));
  double rest = 0;
  for (std::size_t i = 0; i + most < values; ++i) rest += sorted[i] / static_cast<double>(values - most);
  const double limit = std::max(brightest * rest, sorted[values - most]);
  for (std::size_t i = 0; i < values; ++i) reference.leftOut[i] = rest > 0 && sizes[i] > limit;
}

}  // namespace

void summarise(std::span<const StudyImage> repetitions, StudyReference& reference) {
  const std::size_t values = repetitions.front().size();
  const auto r = static_cast<double>(repetitions.size());
  reference.mean.assign(values, 0);
  reference.variance.assign(values, 0);
  for (std::size_t i = 0; i < values; ++i) {
    double mean = 0, squares = 0;
    for (const StudyImage& image : repetitions) mean += finite(image[i]) / r;
    for (const StudyImage& image : repetitions) squares += (finite(image[i]) - mean) * (finite(image[i]) - mean);
    reference.mean[i] = static_cast<float>(mean);
    reference.variance[i] = static_cast<float>(squares / (r - 1) / r);
  }
  leaveOutTheBrightest(reference);
  std::vector<double> imageMeans(repetitions.size());
  double scale = 0, variances = 0, count = 0;
  for (std::size_t i = 0; i < values; ++i) {
    if (reference.leavesOut(i)) continue;
    ++count;
    scale += std::fabs(finite(reference.mean[i]));
    variances += finite(reference.variance[i]);
    for (std::size_t k = 0; k < repetitions.size(); ++k) imageMeans[k] += finite(repetitions[k][i]);
  }
  double mean = 0, squares = 0;
  for (double& m : imageMeans) {
    m /= count;
    mean += m / r;
  }
  for (const double m : imageMeans) squares += (m - mean) * (m - mean);
  reference.scale = scale > 0 ? scale / count : 1;
  reference.error = std::sqrt(variances / count) / reference.scale;
  reference.meanError = std::sqrt(squares / (r - 1) / r) / reference.scale;
}

StudyRound measureRound(std::span<const StudyImage> repetitions, const StudyReference& reference,
                        std::uint32_t samples) {
  const std::size_t count = repetitions.size();
  const Moments moments = momentsOf(repetitions, reference);
  const Estimates all = estimate(moments, count, count);
  std::vector<Estimates> parts;
  for (std::size_t i = 0; i < count; ++i) parts.push_back(estimate(moments, count, i));
  const double scale = reference.scale, squared = scale * scale;
  // What the reference's noise adds to the mean over all values: its product with the bias, and its own scatter.
  const double byReference = std::sqrt(moments.referenceScatter) / moments.count;
  // What is seldom and bright may be in none of the repetitions, which then agree about being wrong: as many samples of
  // the reference say how far their mean may be off, s² = v_F n_F / (R n), and Σ (M - F)² scatters by sqrt(2 Σ s⁴).
  const double fewer = samples > 0 && reference.samples > 0
                           ? static_cast<double>(reference.samples) / (static_cast<double>(count) * samples)
                           : 0;
  const double bySeldom = std::sqrt(2 * moments.squaredVariances) * fewer / moments.count;
  const double besides = std::hypot(byReference, bySeldom);
  StudyRound round;
  round.samples = samples;
  round.squaredError = {all.squaredError / squared,
                        std::hypot(jackknife(parts, &Estimates::squaredError), besides) / squared};
  round.variance = {all.variance / squared, jackknife(parts, &Estimates::variance) / squared};
  round.squaredBias = {all.squaredBias / squared,
                       std::hypot(jackknife(parts, &Estimates::squaredBias), besides) / squared};
  // The same of the mean: variances of all values, as if they did not depend on each other.
  const double meanBySeldom = std::sqrt(moments.referenceVariance * fewer) / moments.count;
  round.meanBias = {all.meanBias / scale, std::hypot(jackknife(parts, &Estimates::meanBias) / scale,
                                                     reference.meanError, meanBySeldom / scale)};
  return round;
}

double errorAtTime(const StudyCase& study, double seconds) {
  const auto& rounds = study.rounds;
  if (rounds.empty()) return std::numeric_limits<double>::infinity();
  const auto error = [](const StudyRound& r) { return std::sqrt(std::max(r.squaredError.value, 1e-12)); };
  std::size_t after = 0;
  while (after < rounds.size() && rounds[after].seconds < seconds) ++after;
  if (after == 0) return error(rounds.front());
  if (after == rounds.size()) {
    // With more samples noise falls, and bias stays.
    const StudyRound& last = rounds.back();
    const double noise = std::max(last.variance.value, 0.0) * last.seconds / seconds;
    return std::sqrt(std::max(noise + (last.hasBias() ? last.squaredBias.value : 0), 1e-12));
  }
  const StudyRound &a = rounds[after - 1], &b = rounds[after];
  const double share = std::log(seconds / a.seconds) / std::log(b.seconds / a.seconds);
  return std::exp(std::log(error(a)) * (1 - share) + std::log(error(b)) * share);
}

double convergenceRate(const StudyCase& study) {
  constexpr std::size_t roundsUsed = 4;
  const std::size_t first = study.rounds.size() > roundsUsed ? study.rounds.size() - roundsUsed : 0;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = first; i < study.rounds.size(); ++i) {
    const StudyRound& round = study.rounds[i];
    if (!(round.squaredError.value > 0) || !(round.seconds > 0)) continue;
    const double t = std::log(round.seconds), e = 0.5 * std::log(round.squaredError.value);
    ++n;
    x += t;
    y += e;
    xx += t * t;
    xy += t * e;
  }
  const double spread = n * xx - x * x;
  return n >= 2 && spread > 0 ? std::max(0.0, -(n * xy - x * y) / spread) : 0;
}

double costOfHalving(const StudyCase& study) {
  if (study.rounds.size() < 2) return 0;
  const StudyRound& last = study.rounds.back();
  if (last.hasBias()) {
    const double rest = last.squaredError.value / 4 - last.squaredBias.value;
    // The variance falls with the number of samples.
    return rest > 0 ? last.variance.value / rest : std::numeric_limits<double>::infinity();
  }
  const double rate = convergenceRate(study);
  return rate > 0.05 ? std::pow(2.0, 1 / rate) : 0;
}

double equalTime(const StudyResults& results) {
  double shortest = std::numeric_limits<double>::infinity(), least = 0;
  for (const StudyCase& study : results.cases) {
    if (study.rounds.empty()) continue;
    if (study.isComplete) shortest = std::min(shortest, study.rounds.back().seconds);
    // There is no render with less than its first samples.
    least = std::max(least, study.rounds.front().seconds);
  }
  return std::isfinite(shortest) ? std::max(shortest, least) : 0;
}

}  // namespace aerosol::app
