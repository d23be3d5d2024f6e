// Which conversions happen by themselves, and how well an argument fits a formal parameter.
#pragma once

#include "core/lang/type.h"

namespace aerosol::lang {

/// Whether `from` may be assigned to `to` without a cast: int to float, numbers to triples and matrices, any triple to
/// any triple, an array to an array of the same elements that is at least as long (or unsized). Zero for a closure is
/// the caller's case.
bool isAssignable(const Type& to, const Type& from);

/// Whether a value may stand as a condition.
bool isConditional(const Type& type);

/// How well an argument fits, as OSL scores it: 100 the same type, 77 int for float, 44 an array for an unsized one, 32
/// between point, vector and normal, 27 between colour and those, 23 any other conversion, 0 not at all. The candidate
/// with the greatest sum is called.
int matchScore(const Type& formal, const Type& actual);

/// Precedence of result types among candidates that fit equally well and whose result is not asked for: less is
/// preferred (float, int, color, vector, point, normal, matrix, string, closure, structures, void).
int resultRank(const Type& type);

}  // namespace aerosol::lang
