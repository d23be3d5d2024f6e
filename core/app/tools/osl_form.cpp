#include "core/app/tools/osl_form.h"

#include <fmt/format.h>

namespace aerosol::app {

std::string asOslc(const Diagnostic& diagnostic) {
  const char* severity = diagnostic.severity == Severity::error     ? "error"
                         : diagnostic.severity == Severity::warning ? "warning"
                                                                    : "info";
  const SourceLocation& at = diagnostic.location;
  if (at.file.empty()) return fmt::format("{}: {}", severity, diagnostic.message);
  if (at.line == 0) return fmt::format("{}: {}: {}", at.file, severity, diagnostic.message);
  return fmt::format("{}:{}: {}: {}", at.file, at.line, severity, diagnostic.message);
}

void reportAsTestshade(const Diagnostics& diagnostics, const Console& console) {
  if (diagnostics.empty()) return;
  std::fflush(console.out);
  for (const Diagnostic& each : diagnostics.entries()) {
    const char* severity = each.severity == Severity::error ? "ERROR" : "WARNING";
    const bool isPlaced = each.location.line > 0;
    console.note(isPlaced ? format(each)
                          : fmt::format("{}: {}{}\n", severity,
                                        each.location.file.empty() ? "" : each.location.file + ": ", each.message));
  }
}

}  // namespace aerosol::app
