// What a study has found: plain data, kept in a file while the study goes on.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace aerosol::app {

/// What all errors are measured against. Values are linear colours, row by row.
struct StudyReference {
  std::string method;
  bool isUnbiased = true;
  int width = 0, height = 0;
  std::vector<float> mean;            ///< 3 · width · height.
  std::vector<float> variance;        ///< Of that mean, as its repetitions scatter.
  std::vector<std::uint8_t> leftOut;  ///< Not 0: a value of no part in errors.
  double scale = 0;                   ///< Mean magnitude of the image: errors are parts of it.
  double error = 0;                   ///< Root mean square standard error, a part of the scale.
  double meanError = 0;               ///< Standard error of the image's mean, a part of the scale.
  std::uint32_t samples = 0;          ///< A pixel, all repetitions together.
  double seconds = 0;

  bool leavesOut(std::size_t value) const { return value < leftOut.size() && leftOut[value] != 0; }
};

/// A quantity and its standard error.
struct Measured {
  double value = 0, error = 0;
};

/// One configuration with one number of samples. All are parts of the reference's scale or squares of such.
struct StudyRound {
  std::uint32_t samples = 0;  ///< A pixel.
  double seconds = 0;         ///< Of one repetition, in the mean: of all processors, by threads.
  Measured squaredError;      ///< Mean over pixels, channels and repetitions; the reference's own error is taken off.
  Measured variance;          ///< The part of it by which repetitions scatter.
  Measured squaredBias;       ///< The part that all repetitions share; below 0 by chance where there is none.
  Measured meanBias;          ///< Of the whole image: positive is too bright.

  /// Whether the squared bias is told from noise.
  bool hasBias() const { return squaredBias.value > certainly * squaredBias.error; }
  /// The same of the mean of the whole image.
  bool hasMeanBias() const { return std::fabs(meanBias.value) > certainly * meanBias.error; }

  /// Errors come from 8 repetitions, and a study makes ten such comparisons: Student's t of 7 degrees of freedom is
  /// above this once in 1,000 times.
  static constexpr double certainly = 4.8;
};

/// One configuration.
struct StudyCase {
  std::string name;                    ///< For people: "marching, steps x 4".
  std::vector<std::string> arguments;  ///< Of `aerosol render`, beside the scene.
  double prepareSeconds = 0;
  std::vector<StudyRound> rounds;  ///< With more and more samples.
  std::vector<float> picture;      ///< One repetition of the last round.
  bool isComplete = false;
};

/// What a render had of the processors, in seconds of theirs.
struct StudyMachineTime {
  double had = 0, wanted = 0;

  StudyMachineTime& operator+=(const StudyMachineTime& other) {
    had += other.had;
    wanted += other.wanted;
    return *this;
  }
  /// 1 where nothing else ran.
  double share() const { return wanted > 0 ? had / wanted : 1; }
};

struct StudyResults {
  std::string key;  ///< Hash of all that decides the results but time.
  std::string scene;
  std::string program, machine;
  int repetitions = 8;
  double budget = 0;
  StudyMachineTime machineTime;
  StudyReference reference;
  std::vector<StudyCase> cases;
};

template <class A>
void describe(A& archive, StudyReference& r) {
  archive(r.method, r.isUnbiased, r.width, r.height, r.mean, r.variance, r.leftOut, r.scale, r.error, r.meanError,
          r.samples, r.seconds);
}
template <class A>
void describe(A& archive, Measured& m) {
  archive(m.value, m.error);
}
template <class A>
void describe(A& archive, StudyRound& r) {
  archive(r.samples, r.seconds, r.squaredError, r.variance, r.squaredBias, r.meanBias);
}
template <class A>
void describe(A& archive, StudyCase& c) {
  archive(c.name, c.arguments, c.prepareSeconds, c.rounds, c.picture, c.isComplete);
}
template <class A>
void describe(A& archive, StudyMachineTime& t) {
  archive(t.had, t.wanted);
}
template <class A>
void describe(A& archive, StudyResults& r) {
  archive(r.key, r.scene, r.program, r.machine, r.repetitions, r.budget, r.machineTime, r.reference, r.cases);
}

}  // namespace aerosol::app
