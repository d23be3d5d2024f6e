// What a correct source computes in vain or reads too early.
#pragma once

#include "core/base/diagnostic.h"
#include "core/lang/ast.h"
#include "core/lang/source_map.h"

namespace aerosol::lang {

/// Warns of local variables that nothing reads or that are read where nothing can have set them, of statements that are
/// never reached (all this is `advice`, which oslc does not give), and of commas that drop a value. The source has been
/// checked without errors; the standard library is left out.
void warnAboutUsage(const SourceFile& file, const SourceMap& sourceMap, Diagnostics& diagnostics, bool advice);

}  // namespace aerosol::lang
