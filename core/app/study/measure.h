// Errors of independent repetitions of an image against a reference that has an error of its own.
#pragma once

#include <span>
#include <vector>

#include "core/app/study/results.h"

namespace aerosol::app {

/// Values of one image, 3 a pixel.
using StudyImage = std::vector<float>;

/// The mean of independent repetitions and the variance of that mean, value by value; scale and errors. Needs two
/// repetitions at least. Leaves single bright values out of all errors: what is above 20 times the mean of the rest,
/// but no more than a hundredth of the image.
void summarise(std::span<const StudyImage> repetitions, StudyReference& reference);

/// Splits the error of a configuration into variance and bias. With R repetitions I_r of mean M against a reference F
/// whose variance is v_F, everything averaged over the values of the image:
///
///     error² = ⟨(I_r - F)²⟩ - v_F        variance = Σ (I_r - M)² / (R - 1)
///     bias²  = ⟨(M - F)²⟩ - variance / R - v_F
///
/// All three are unbiased estimates, so that bias² of a method without bias is around 0, on either side. Their errors
/// come from leaving out one repetition at a time (Quenouille and Tukey's jackknife), that of bias² also from the noise
/// of the reference, and, where `samples` of a repetition are given, from what they may have missed as the scatter of
/// the reference tells. Values that are not finite count as 0.
StudyRound measureRound(std::span<const StudyImage> repetitions, const StudyReference& reference,
                        std::uint32_t samples = 0);

/// The error (not squared) at a time, along the straight line between rounds in logarithms. Before the first
/// round there is no render: its error. After the last one noise falls with time, and bias that was found stays.
double errorAtTime(const StudyCase& study, double seconds);

/// By which factor the time grows when the error is to be halved: noise falls at the rate of the last rounds (see
/// convergenceRate), bias that was found stays. Infinite where bias alone is more than half of the error, 0 where it
/// cannot be told: there are too few rounds, or the error rose between them without bias, by rare bright samples.
double costOfHalving(const StudyCase& study);

/// By which power of time the error falls, from the last rounds: 0.5 is what independent samples do. 0 where there are
/// too few rounds or it does not fall.
double convergenceRate(const StudyCase& study);

/// The longest time that all complete cases have reached, or the shortest in which all have a render at all.
double equalTime(const StudyResults& results);

}  // namespace aerosol::app
