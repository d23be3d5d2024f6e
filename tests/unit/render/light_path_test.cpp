#include "core/render/aov/light_path_automaton.h"

#include <gtest/gtest.h>

#include <regex>

#include "core/base/random.h"

namespace aerosol::render {
namespace {

const std::vector<std::string> labels = {"", "key", "rim"};

std::optional<ExpressionProblem> problemOf(const std::string& text) {
  LightPathExpression expression;
  ExpressionProblem problem;
  if (parseLightPath(text, labels, expression, problem)) return {};
  return problem;
}

LightPathExpression parsed(const std::string& text) {
  LightPathExpression expression;
  ExpressionProblem problem;
  EXPECT_TRUE(parseLightPath(text, labels, expression, problem)) << text << ": " << problem.message;
  return expression;
}

LightPathAutomaton automatonOf(const std::vector<std::string>& texts) {
  std::vector<LightPathExpression> expressions;
  for (const std::string& text : texts) expressions.push_back(parsed(text));
  return {expressions, pathEventCount * labels.size()};
}

/// "C RD Ts V L:key": events by their letters, labels behind a colon.
std::vector<PathSymbol> path(const std::string& text) {
  std::vector<PathSymbol> symbols;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t colon = std::min(word.find(':'), word.size());
    const std::string name = word.substr(0, colon), label = colon < word.size() ? word.substr(colon + 1) : "";
    const std::size_t index = static_cast<std::size_t>(std::find(labels.begin(), labels.end(), label) - labels.begin());
    bool isFound = false;
    for (std::size_t event = 0; event < pathEventCount; ++event) {
      const EventLetters letters = eventLetters[event];
      const std::string known =
          letters.scattering == '-' ? std::string{letters.type} : std::string{letters.type, letters.scattering};
      if (known != name) continue;
      isFound = true;
      symbols.push_back(symbolOf(static_cast<PathEvent>(event), index, labels.size()));
    }
    EXPECT_TRUE(isFound) << word;
  }
  return symbols;
}

std::vector<std::uint32_t> matchesOf(const LightPathAutomaton& automaton, const std::vector<PathSymbol>& symbols) {
  LightPathAutomaton::State state = automaton.start();
  for (const PathSymbol symbol : symbols) state = automaton.next(state, symbol);
  const auto found = automaton.matches(state);
  return {found.begin(), found.end()};
}

bool matches(const std::string& expression, const std::string& events) {
  return !matchesOf(automatonOf({expression}), path(events)).empty();
}

TEST(LightPaths, MatchEventsByTypeAndScattering) {
  EXPECT_TRUE(matches("C<RD>L", "C RD L"));
  EXPECT_FALSE(matches("C<RD>L", "C RG L"));
  EXPECT_FALSE(matches("C<RD>L", "C TD L"));
  EXPECT_FALSE(matches("C<RD>L", "C RD RD L"));
  EXPECT_FALSE(matches("C<RD>L", "C RD"));
  EXPECT_TRUE(matches("CDL", "C TD L"));
  EXPECT_TRUE(matches("CRL", "C RS L"));
  EXPECT_TRUE(matches("C<.S>L", "C TS L"));
  EXPECT_TRUE(matches("C<T.>B", "C Ts B"));
  EXPECT_TRUE(matches("C<[RT][DG]>L", "C TG L"));
  EXPECT_FALSE(matches("C<[RT][DG]>L", "C TS L"));
  EXPECT_TRUE(matches("CVL", "C V L"));
  EXPECT_FALSE(matches("CDL", "C V L"));
  EXPECT_TRUE(matches("C[^D]L", "C V L"));
  EXPECT_FALSE(matches("C[^DV]L", "C V L"));
  EXPECT_TRUE(matches("C<[^T]G>L", "C RG L"));
  EXPECT_FALSE(matches("C<[^T]G>L", "C TG L"));
  EXPECT_TRUE(matches("C<OV>", "C OV"));
  EXPECT_FALSE(matches("C<O[^V]>", "C OV"));
  EXPECT_TRUE(matches("CO", "C OV"));
}

TEST(LightPaths, Repeat) {
  EXPECT_TRUE(matches("CD*L", "C L"));
  EXPECT_TRUE(matches("CD*L", "C RD TD RD L"));
  EXPECT_FALSE(matches("CD+L", "C L"));
  EXPECT_TRUE(matches("CD?S+L", "C RS RS L"));
  EXPECT_TRUE(matches("C (D|S S)* L", "C RD RS TS RD L"));
  EXPECT_FALSE(matches("C (D|S S)* L", "C RD RS RD L"));
  for (int n = 0; n < 7; ++n) {
    std::string events = "C";
    for (int i = 0; i < n; ++i) events += " RD";
    events += " L";
    EXPECT_EQ(matches("CD{3}L", events), n == 3) << n;
    EXPECT_EQ(matches("CD{2,4}L", events), n >= 2 && n <= 4) << n;
    EXPECT_EQ(matches("CD{2,}L", events), n >= 2) << n;
    EXPECT_EQ(matches("CD{0,1}L", events), n <= 1) << n;
    EXPECT_EQ(matches("CD{0,}L", events), true) << n;
    EXPECT_EQ(matches("C(DD)?{2}L", events), n == 0 || n == 2 || n == 4) << n;
  }
}

TEST(LightPaths, KnowLabels) {
  EXPECT_TRUE(matches("C.*<L.'key'>", "C RD L:key"));
  EXPECT_TRUE(matches("C.*<L'key'>", "C L:key"));
  EXPECT_FALSE(matches("C.*<L.'key'>", "C RD L:rim"));
  EXPECT_FALSE(matches("C.*<L.'key'>", "C RD L"));
  EXPECT_TRUE(matches("C.*'rim'", "C RD B:rim"));
  EXPECT_TRUE(matches("C.*<[LB].[^'key']>", "C RD B:rim"));
  EXPECT_TRUE(matches("C.*<[LB].[^'key']>", "C RD L"));
  EXPECT_FALSE(matches("C.*<[LB].[^'key']>", "C RD L:key"));
}

TEST(LightPaths, AreRefusedWithTheirPlace) {
  const auto check = [](const std::string& text, std::size_t at, const std::string& part) {
    const auto problem = problemOf(text);
    ASSERT_TRUE(problem) << text;
    EXPECT_EQ(problem->at, at) << text;
    EXPECT_NE(problem->message.find(part), std::string::npos) << problem->message;
  };
  check("CXL", 1, "'X' is no event");
  check("C<RX>L", 3, "one of D G S s");
  check("C<DR>L", 2, "one of C R T V L O B");
  check("C(DL", 1, "is not closed");
  check("C[DL", 1, "is not closed");
  check("C<RD", 1, "is not closed");
  check("CD)L", 2, "no partner");
  check("CD{2", 2, "a repetition is");
  check("CD{3,2}L", 2, "from more to fewer");
  check("CD{99}L", 3, "more than 64");
  check("C<L.'fill'>", 4, "known are 'key', 'rim'");
  check("C<L.'fill>", 4, "is not closed");
  check("CD{2}{3}L", 2, "only one repetition");
  check("CD{", 3, "a number");
  check("C<", 2, "one of C R T V L O B");
  EXPECT_NE(problemOf("((((.{60}){60}){60}){60})L")->message.find("too large"), std::string::npos);
}

/// Random expressions with all operators against the standard library's, each event a letter of its own there.
TEST(LightPaths, AgreeWithRegularExpressions) {
  const std::vector<std::string> events = {"C", "RD", "RG", "TS", "Ts", "V", "L", "B"};
  const std::string letters = "cdgtsvlb";
  std::uint64_t seed = 7;
  const auto random = [&](std::uint64_t n) { return (seed = mixBits(seed + 0x9e37)) % n; };
  // An atom in both notations: events by index.
  const auto atom = [&](std::string& ours, std::string& theirs) {
    const std::uint64_t kind = random(4);
    const std::uint64_t a = 1 + random(5), b = 1 + random(5);
    const auto full = [&](std::uint64_t i) { return "<" + events[i] + ">"; };
    if (kind == 0) {
      ours += ".";
      theirs += ".";
    } else if (kind == 1) {
      ours += "[^" + full(a) + full(b) + "]";
      theirs += std::string("[^") + letters[a] + letters[b] + "]";
    } else {
      ours += full(a);
      theirs += letters[a];
    }
  };
  int matched = 0;
  for (int round = 0; round < 300; ++round) {
    std::string ours = "C", theirs = "c";
    for (std::uint64_t part = 0; part < 1 + random(4); ++part) {
      const bool isGroup = random(2) == 0;
      if (isGroup) ours += "(", theirs += "(";
      atom(ours, theirs);
      if (isGroup) {
        ours += "|", theirs += "|";
        atom(ours, theirs);
        atom(ours, theirs);
        ours += ")", theirs += ")";
      }
      const char* const suffixes[] = {"", "*", "+", "?", "{2}", "{1,3}", "{2,}"};
      const char* const suffix = suffixes[random(7)];
      ours += suffix;
      theirs += suffix;
    }
    ours += "[LB]";
    theirs += "[lb]";
    const LightPathAutomaton automaton = automatonOf({ours});
    const std::regex expected(theirs);
    for (int sample = 0; sample < 60; ++sample) {
      std::vector<PathSymbol> symbols = path("C");
      std::string word = "c";
      for (std::uint64_t n = random(7); n > 0; --n) {
        const std::uint64_t i = 1 + random(5);
        symbols.push_back(path(events[i])[0]);
        word += letters[i];
      }
      symbols.push_back(path(random(2) == 0 ? "L:key" : "B")[0]);
      word += symbols.back() == path("B")[0] ? 'b' : 'l';
      const bool isMatch = std::regex_match(word, expected);
      ASSERT_EQ(!matchesOf(automaton, symbols).empty(), isMatch) << ours << " on " << word;
      matched += isMatch;
    }
  }
  EXPECT_GT(matched, 500);
}

TEST(LightPaths, ExpressionsDoNotChangeEachOther) {
  const std::vector<std::string> texts = {"CD*L", "C.*L", "CD+L", "C<RD>L", "C.*B"};
  const LightPathAutomaton all = automatonOf(texts);
  EXPECT_EQ(matchesOf(all, path("C RD L")), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(matchesOf(all, path("C L")), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(matchesOf(all, path("C RG B")), (std::vector<std::uint32_t>{4}));
  // Nothing is left to find out behind a light.
  LightPathAutomaton::State state = all.start();
  for (const PathSymbol symbol : path("C L L L")) state = all.next(state, symbol);
  EXPECT_TRUE(all.matches(state).empty() || state != LightPathAutomaton::dead);
  // States that nothing can tell apart are one: of two expressions that mean the same, each state serves both.
  EXPECT_EQ(automatonOf({"C(D|D)*L", "CD*L"}).stateCount(), automatonOf({"CD*L"}).stateCount());
  EXPECT_LE(automatonOf({"CD*L"}).stateCount(), 4u);
}

}  // namespace
}  // namespace aerosol::render
