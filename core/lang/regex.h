// Regular expressions for shaders: no expression and no text can make matching fail, or take more time than their
// lengths multiplied.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace aerosol::lang {

/// A compiled expression: literals, . [classes] with [:names:] and ranges, \d \w \s (and capitals), (groups), (?:…), |,
/// * + ? {n} {n,} {n,m} and their lazy forms, ^ $ \b \B. Where several matches begin at one place the one that the
/// expression names first counts, as in Perl. After Pike's virtual machine (Cox 2009, "Regular Expression Matching: the
/// Virtual Machine Approach"): all ways to match advance together, character by character.
class Regex {
 public:
  /// Nothing when the expression is malformed, or longer than the engine takes once repetitions are written out.
  static std::optional<Regex> compile(std::string_view expression);

  /// Begin and end of the match and of each group; -1 where a group took no part.
  using Match = std::vector<std::pair<std::int32_t, std::int32_t>>;

  /// The first match in the text; with `whole`, of the whole text. Nothing when there is none.
  std::optional<Match> search(std::string_view text, bool whole) const;

  enum class Op : std::uint8_t {
    any,    ///< One character.
    set,    ///< One character of set number x.
    split,  ///< Goes on at x, or else at y.
    jump,   ///< Goes on at x.
    save,   ///< Notes the position in slot x.
    begin,  ///< Assertions: at the beginning, at the end, at the edge of a word, not there.
    end,
    edge,
    noEdge,
    match
  };
  struct Instruction {
    Op op{};
    std::uint32_t x = 0, y = 0;
  };
  using Set = std::array<bool, 256>;

 private:
  std::vector<Instruction> code_;
  std::vector<Set> sets_;
  std::size_t groups_ = 1;
};

}  // namespace aerosol::lang
