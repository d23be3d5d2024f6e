#include "core/scene/definitions.h"

#include <gtest/gtest.h>

namespace aerosol::scene {
namespace {

TEST(Definitions, ReplaceNamesAnywhere) {
  Definitions definitions({{"a", "1"}, {"ab", "2"}});
  TextError error;
  EXPECT_EQ(definitions.substitute("$a, $ab, ${a}b, x$a.y", error), "1, 2, 1b, x1.y");
  EXPECT_EQ(definitions.substitute("5 $$ and $$a", error), "5 $ and $a");
  EXPECT_EQ(definitions.substitute("none", error), "none");
}

TEST(Definitions, TellWhereAnUndefinedNameStands) {
  Definitions definitions({{"a", "1"}});
  TextError error;
  EXPECT_FALSE(definitions.substitute("$a $b", error));
  EXPECT_EQ(error.offset, 3u);
  EXPECT_EQ(error.message, "'$b' is not defined");
  for (const char* wrong : {"$", "$1", "${a", "${}", "$ a", "$-"})
    EXPECT_FALSE(definitions.substitute(wrong, error)) << wrong;
}

TEST(Definitions, TheCommandLineWinsAndThenTheFirstDefault) {
  Definitions definitions({{"a", "command"}});
  definitions.setDefault("a", "default", {"x", 1, 1});
  definitions.setDefault("b", "first", {"x", 2, 1});
  definitions.setDefault("b", "second", {"x", 3, 1});
  TextError error;
  EXPECT_EQ(definitions.substitute("$a $b", error), "command first");
}

TEST(Definitions, KnowWhatWasNotUsed) {
  Definitions definitions({{"used", "1"}, {"forgotten", "2"}});
  definitions.setDefault("idle", "3", {"x", 4, 2});
  TextError error;
  definitions.substitute("$used", error);
  EXPECT_EQ(definitions.unusedFromCommandLine(), std::vector<std::string>{"forgotten"});
  EXPECT_EQ(definitions.unusedDefaults().at("idle"), (SourceLocation{"x", 4, 2}));
}

TEST(Definitions, DoNotExplode) {
  Definitions definitions({});
  TextError error;
  std::string value = "0123456789";
  int level = 0;
  for (; level < 64; ++level) {
    const std::string name = "v" + std::to_string(level);
    definitions.setDefault(name, value, {});
    const auto next = definitions.substitute("$" + name + "$" + name, error);
    if (!next) break;
    value = *next;
  }
  EXPECT_LT(level, 20);
  EXPECT_NE(error.message.find("longer than"), std::string::npos);
}

}  // namespace
}  // namespace aerosol::scene
