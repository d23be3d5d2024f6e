// Preprocessor tokens become tokens of the language: words, numbers, strings.
#pragma once

#include "core/base/diagnostic.h"
#include "core/lang/preprocessor.h"
#include "core/lang/token.h"

namespace aerosol::lang {

/// Errors reported in one run; the lexer and the parser stop there.
inline constexpr int maximumErrors = 100;

/// Adjacent strings are joined and their escapes resolved; malformed numbers, strings and characters are errors (they
/// stand in the stream as plausible literals, so that parsing can go on).
TokenStream tokenize(const PreprocessResult& source, Diagnostics& diagnostics);

}  // namespace aerosol::lang
