#include "core/base/diagnostic.h"

#include <gtest/gtest.h>

namespace aerosol {
namespace {

TEST(Diagnostic, ShowsThePlaceTheLineAndACaret) {
  const Diagnostic error{Severity::error, {"a.osl", 3, 4}, "no", "\tx = y;", {"because"}};
  EXPECT_EQ(format(error), "a.osl:3:4: error: no\n  \tx = y;\n  \t  ^\n  note: because\n");
}

TEST(Diagnostic, NeverSteersTheTerminal) {
  const Diagnostic error{Severity::error, {"a\x1b.obj", 1, 3}, "\x1b]0;title\x07 and\r", "a\x1b[2Jb\x7f", {"\x08\x08"}};
  EXPECT_EQ(format(error), "a?.obj:1:3: error: ?]0;title? and?\n  a?[2Jb?\n    ^\n  note: ??\n");
}

TEST(Diagnostic, KeepsLettersBeyondAscii) {
  const Diagnostic error{Severity::warning, {}, "Wölkchen", {}, {}};
  EXPECT_EQ(format(error), "warning: Wölkchen\n");
}

}  // namespace
}  // namespace aerosol
