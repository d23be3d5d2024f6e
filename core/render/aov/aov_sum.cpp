#include "core/render/aov/aov_sum.h"

#include "core/render/sample_tree_impl.h"

namespace aerosol::render {

void AovSums::add(const AovSample& sample, std::uint32_t) {
  values.resize(sample.values.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += static_cast<double>(sample.values[i]);
  mattes.resize(sample.mattes.size());
  for (std::size_t i = 0; i < mattes.size(); ++i) {
    if (sample.mattes[i].id != 0) addMatteShare(mattes[i], sample.mattes[i]);
  }
}

AovSums operator+(const AovSums& a, const AovSums& b) {
  if (a.values.empty()) return b;
  AovSums sum = a;
  for (std::size_t i = 0; i < b.values.size(); ++i) sum.values[i] += b.values[i];
  for (std::size_t i = 0; i < b.mattes.size(); ++i) sum.mattes[i] = sum.mattes[i] + b.mattes[i];
  return sum;
}

template class SampleTree<AovSums, AovSample>;

}  // namespace aerosol::render
