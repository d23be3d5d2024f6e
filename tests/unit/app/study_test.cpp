#include "core/app/study/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/app/study/report.h"

namespace aerosol::app {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::size_t values = 3 * 400;

/// Images of a known truth with known noise and bias.
class Synthetic {
 public:
  explicit Synthetic(std::uint64_t seed) : random_(seed) {
    for (std::size_t i = 0; i < values; ++i)
      truth_.push_back(1 + 0.5f * static_cast<float>(std::sin(0.1 * static_cast<double>(i))));
  }
  std::vector<StudyImage> images(int count, double noise, double bias) {
    std::vector<StudyImage> result;
    for (int k = 0; k < count; ++k) {
      StudyImage& image = result.emplace_back();
      for (std::size_t i = 0; i < values; ++i) {
        const double sign = i % 2 == 0 ? 1 : 0.5;
        image.push_back(truth_[i] + static_cast<float>(bias * sign + noise * normal_(random_)));
      }
    }
    return result;
  }
  StudyReference reference(double noise) {
    StudyReference reference;
    summarise(images(8, noise, 0), reference);
    return reference;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  StudyImage truth_;
};

TEST(StudyMeasure, SeparatesBiasFromNoise) {
  Synthetic images(3);
  const StudyReference reference = images.reference(0.02);
  EXPECT_NEAR(reference.scale, 1, 0.1);
  EXPECT_NEAR(reference.error * reference.scale, 0.02 / std::sqrt(8.0), 0.0005);
  const double scale = reference.scale * reference.scale;
  for (const double noise : {0.3, 0.05}) {
    for (const double bias : {0.0, 0.1}) {
      const StudyRound round = measureRound(images.images(8, noise, bias), reference);
      const double squaredBias = bias * bias * (1 + 0.25) / 2;
      const auto agrees = [&](const Measured& m, double expected) {
        EXPECT_GT(m.error, 0);
        EXPECT_LT(std::fabs(m.value * scale - expected), 4 * m.error * scale + 1e-5) << m.value << " " << expected;
      };
      agrees(round.variance, noise * noise);
      agrees(round.squaredBias, squaredBias);
      agrees(round.squaredError, noise * noise + squaredBias);
      EXPECT_NEAR(round.meanBias.value * reference.scale, 0.75 * bias, 4 * round.meanBias.error + 1e-4);
      EXPECT_EQ(round.hasBias(), bias > 0) << noise << ' ' << bias;
    }
  }
}

/// The stated errors are those that many studies scatter by.
TEST(StudyMeasure, StatesItsOwnErrors) {
  std::vector<double> biasScores, errorScores;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    Synthetic images(100 + seed);
    const StudyReference reference = images.reference(0.1);
    const StudyRound round = measureRound(images.images(8, 0.2, 0.05), reference);
    const double scale = reference.scale * reference.scale;
    biasScores.push_back((round.squaredBias.value * scale - 0.05 * 0.05 * 0.625) / (round.squaredBias.error * scale));
    errorScores.push_back((round.squaredError.value * scale - 0.04 - 0.05 * 0.05 * 0.625) /
                          (round.squaredError.error * scale));
  }
  for (const auto& scores : {biasScores, errorScores}) {
    double mean = 0, square = 0;
    for (const double z : scores) {
      mean += z / 120;
      square += z * z / 120;
    }
    EXPECT_LT(std::fabs(mean), 0.5);
    EXPECT_GT(square, 0.4);
    EXPECT_LT(square, 2.5);
  }
}

/// What one sample in 1,000 sees is in none of the repetitions: they agree about being too dark, and that is no bias.
TEST(StudyMeasure, WhatIsSeldomSeenIsNoBias) {
  std::mt19937_64 random(11);
  const auto render = [&](int samples) {
    StudyImage image;
    for (int i = 0; i < 300; ++i) {
      float sum = 0;
      for (int k = 0; k < samples; ++k) sum += 1 + (i % 30 == 0 && random() % 1000 == 0 ? 300.0f : 0.0f);
      image.push_back(sum / static_cast<float>(samples));
    }
    return image;
  };
  std::vector<StudyImage> longOnes;
  for (int k = 0; k < 8; ++k) longOnes.push_back(render(20000));
  StudyReference reference;
  summarise(longOnes, reference);
  reference.samples = 8 * 20000;
  const std::vector<StudyImage> short4(8, StudyImage(300, 1.0f));  // None has seen it, as most do not.
  EXPECT_TRUE(measureRound(short4, reference).hasBias()) << "as long as nobody says how many samples there were";
  const StudyRound round = measureRound(short4, reference, 4);
  EXPECT_FALSE(round.hasBias()) << round.squaredBias.value << " +- " << round.squaredBias.error;
  EXPECT_FALSE(round.hasMeanBias()) << round.meanBias.value << " +- " << round.meanBias.error;
}

TEST(StudyMeasure, SingleBrightValuesDecideNothing) {
  Synthetic images(5);
  const auto withLamp = [&](std::vector<StudyImage> all, float size) {
    for (StudyImage& image : all) {
      for (std::size_t i = 0; i < 6; ++i) image[100 + i] = size;
    }
    return all;
  };
  StudyReference plain, lamp, dim;
  const std::vector<StudyImage> many = images.images(8, 0.1, 0), few = images.images(8, 0.3, 0);
  summarise(many, plain);
  summarise(withLamp(many, 1e5f), lamp);
  summarise(withLamp(many, 10), dim);
  EXPECT_EQ(std::ranges::count(plain.leftOut, 1), 0);
  EXPECT_EQ(std::ranges::count(dim.leftOut, 1), 0) << "bright, but not alone";
  EXPECT_EQ(std::ranges::count(lamp.leftOut, 1), 6);
  EXPECT_NEAR(lamp.scale, plain.scale, 0.01);
  const StudyRound a = measureRound(few, plain), b = measureRound(withLamp(few, 0), lamp);
  EXPECT_NEAR(a.squaredError.value, b.squaredError.value, 0.02 * a.squaredError.value);
  EXPECT_FALSE(b.hasBias());
}

/// Where there is no bias, one study in a thousand may say that there is. Noise has rare large values, as renders do.
TEST(StudyMeasure, SeldomSeesBiasWhereThereIsNone) {
  int found = 0, foundInMean = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Synthetic images(1000 + seed);
    const StudyReference reference = images.reference(0.1);
    std::vector<StudyImage> repetitions = images.images(8, 0.2, 0);
    std::mt19937_64 random(seed);
    for (StudyImage& image : repetitions) {
      for (float& value : image) value += random() % 100 == 0 ? 0.99f * 2 : -0.01f * 2;
    }
    const StudyRound round = measureRound(repetitions, reference);
    found += round.hasBias();
    foundInMean += round.hasMeanBias();
  }
  EXPECT_LE(found, 3);
  EXPECT_LE(foundInMean, 4);
}

StudyCase falling(const char* name, double first, double floor, double timeFactor = 1) {
  StudyCase study{.name = name, .arguments = {}, .prepareSeconds = 0, .rounds = {}, .picture = {}, .isComplete = true};
  for (int n = 1; n <= 256; n *= 2) {
    const double variance = first * first / n;
    StudyRound round;
    round.samples = static_cast<std::uint32_t>(n);
    round.seconds = 0.1 * n * timeFactor;
    round.squaredError = {variance + floor * floor, 0.01 * variance + 1e-9};
    round.variance = {variance, 0.01 * variance};
    round.squaredBias = {floor * floor, 1e-7};
    study.rounds.push_back(round);
  }
  return study;
}

TEST(StudyMeasure, FindsTheRateAndErrorsAtATime) {
  const StudyCase plain = falling("plain", 0.4, 0);
  EXPECT_NEAR(convergenceRate(plain), 0.5, 1e-6);
  EXPECT_NEAR(errorAtTime(plain, 0.3), 0.4 / std::sqrt(3.0), 1e-6);
  // Beyond the last round, of 25.6 s.
  EXPECT_NEAR(errorAtTime(plain, 4 * 25.6), 0.4 / 16 / 2, 1e-6);
  EXPECT_NEAR(errorAtTime(falling("biased", 0.4, 0.2), 1e12), 0.2, 1e-6);
  EXPECT_LT(convergenceRate(falling("stuck", 0.01, 0.3)), 0.01);
}

TEST(StudyMeasure, KnowsWhatHalvingCosts) {
  EXPECT_NEAR(costOfHalving(falling("plain", 0.4, 0)), 4, 1e-3);
  StudyCase biased = falling("biased", 0.4, 0.01);
  const double noise = 0.025 * 0.025, bias = 0.01 * 0.01;
  EXPECT_NEAR(costOfHalving(biased), noise / ((noise + bias) / 4 - bias), 1e-2);
  EXPECT_FALSE(std::isfinite(costOfHalving(falling("stuck", 0.4, 0.1))));
  biased.rounds.resize(1);
  EXPECT_EQ(costOfHalving(biased), 0);
  StudyCase risen = falling("a firefly in the last round", 0.4, 0);
  risen.rounds.back().variance = risen.rounds.back().squaredError = {1, 0.9};
  EXPECT_EQ(costOfHalving(risen), 0);
}

/// A method of which one sample takes longer than all rounds of another one is compared in its own time.
TEST(StudyMeasure, NoCaseIsShownInLessTimeThanItCanRender) {
  StudyResults results;
  results.cases = {falling("fast", 0.4, 0), falling("slow", 0.4, 0, 1000)};
  EXPECT_NEAR(equalTime(results), 100, 1e-9);
  const auto rows = sortRows(results);
  EXPECT_EQ(rows[0].study->name, "fast");
  EXPECT_NEAR(rows[0].error, 0.4 / std::sqrt(1000.0), 1e-6);
  EXPECT_NEAR(rows[1].error, 0.4, 1e-6);
}

TEST(StudyReport, SaysWhatHalvingTheErrorCosts) {
  StudyResults results;
  results.scene = "a.xml";
  results.reference.width = 20;
  results.reference.height = 20;
  results.cases = {falling("unbiased", 0.4, 0), falling("biased <&>", 0.1, 0.2)};
  const auto sentences = conclusions(results);
  ASSERT_EQ(sentences.size(), 4u);
  EXPECT_THAT(sentences[0], HasSubstr("unbiased has the smallest error: 2.5%"));
  EXPECT_THAT(sentences[1], HasSubstr("To halve the error costs 4.0 times the time"));
  EXPECT_THAT(sentences[2], HasSubstr("unbiased: no bias is found"));
  EXPECT_THAT(sentences[3], HasSubstr("biased <&>: bias of 20%"));
  StudyResults quick = results;  // The biased one is the best for a short time.
  quick.cases[1].rounds.resize(1);
  EXPECT_THAT(conclusions(quick)[0], HasSubstr("biased <&> has the smallest error"));
  EXPECT_THAT(conclusions(quick)[0], HasSubstr("Of those in which no bias is found it is unbiased: 40%"));
  StudyResults single = results;
  single.cases.resize(1);
  EXPECT_THAT(conclusions(single)[0], HasSubstr("its error is 2.5% (unbiased)"));
  const auto rows = sortRows(results);
  EXPECT_EQ(rows[0].study->name, "unbiased");
  EXPECT_FALSE(rows[1].isWithinNoise);
  const std::string page = studyPage(results, {"", "", ""});
  EXPECT_THAT(page, HasSubstr("biased &lt;&amp;&gt;"));
  EXPECT_EQ(page.find("biased <&>"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page needs no other file";
  EXPECT_THAT(page, Not(HasSubstr("busy with other work")));
  results.machineTime = {2, 4};
  EXPECT_THAT(studyPage(results, {"", "", ""}), HasSubstr("it gave these renders 50% of the processors"));
  EXPECT_THAT(studyCsv(results), HasSubstr("\"unbiased\",1,0.1,"));
  EXPECT_THAT(studyJson(results), HasSubstr("\"errorInEqualTime\": 0.025"));
}

TEST(StudyReport, CallsADifferenceWithinNoiseSo) {
  StudyResults results;
  results.cases = {falling("a", 0.4, 0), falling("b", 0.4005, 0)};
  EXPECT_TRUE(sortRows(results)[1].isWithinNoise);
  EXPECT_THAT(conclusions(results)[0], HasSubstr("b with 2.5% is not told from it"));
}

TEST(StudyReport, DrawsChartsOfOnePointAndOfNone) {
  StudyResults results;
  EXPECT_THAT(chartSvg(errorChart(results)), HasSubstr("</svg>"));
  results.cases = {falling("a", 0.4, 0)};
  results.cases[0].rounds.resize(1);
  EXPECT_THAT(chartSvg(errorChart(results)), HasSubstr("<circle"));
  const image::ImageBuffer picture = chartPicture(errorChart(results));
  EXPECT_LT(*std::min_element(picture.pixels.begin(), picture.pixels.end()), 0.5f) << "something is drawn";
}

}  // namespace
}  // namespace aerosol::app
