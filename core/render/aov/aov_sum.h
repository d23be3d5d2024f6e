// The sums of all gathered values of one pixel, by the rules of the picture's own sums.
#pragma once

#include <span>
#include <vector>

#include "core/render/aov/cryptomatte.h"
#include "core/render/sample_tree.h"

namespace aerosol::render {

/// The gathered values of one sample. It counts as finite or not together with the picture's sample; single values that
/// are not finite were replaced before.
struct AovSample {
  std::vector<float> values;
  std::vector<MatteShare> mattes;  ///< One of each Cryptomatte; id 0: nothing is seen.
  bool isCounted = true;

  bool isFinite() const { return isCounted; }
};

struct AovSums {
  std::vector<double> values;       ///< Empty: all 0.
  std::vector<MatteShares> mattes;  ///< Of each Cryptomatte; empty: nothing was seen.

  void add(const AovSample& sample, std::uint32_t index);
  friend AovSums operator+(const AovSums& a, const AovSums& b);
  friend bool operator==(const AovSums& a, const AovSums& b) = default;
};

template <class A>
void describe(A& archive, AovSums& sums) {
  archive(sums.values, sums.mattes);
}
template <class A>
void describe(A& archive, AovSample& sample) {
  archive(sample.values, sample.mattes, sample.isCounted);
}

using AovSum = SampleTree<AovSums, AovSample>;
extern template class SampleTree<AovSums, AovSample>;

}  // namespace aerosol::render
