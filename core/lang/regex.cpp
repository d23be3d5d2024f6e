#include "core/lang/regex.h"

#include <algorithm>
#include <memory>
#include <string>

namespace aerosol::lang {

namespace {

using Op = Regex::Op;
using Instruction = Regex::Instruction;
using Set = Regex::Set;

constexpr std::size_t maximumCode = 1000;
constexpr int maximumDepth = 100;
constexpr std::uint32_t maximumRepeat = 1000;

bool isWordCharacter(unsigned char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Of the classes \d \w \s and [:names:]; nothing when there is none of that name.
std::optional<bool> isIn(std::string_view name, unsigned char c) {
  const bool lower = c >= 'a' && c <= 'z', upper = c >= 'A' && c <= 'Z', digit = c >= '0' && c <= '9';
  const bool graph = c > 32 && c < 127;
  if (name == "d" || name == "digit") return digit;
  if (name == "w") return isWordCharacter(c);
  if (name == "s" || name == "space") return c == ' ' || (c >= 9 && c <= 13);
  if (name == "alpha") return lower || upper;
  if (name == "alnum") return lower || upper || digit;
  if (name == "lower") return lower;
  if (name == "upper") return upper;
  if (name == "blank") return c == ' ' || c == '\t';
  if (name == "punct") return graph && !lower && !upper && !digit;
  if (name == "xdigit") return digit || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  if (name == "graph") return graph;
  if (name == "print") return graph || c == ' ';
  if (name == "cntrl") return c < 32 || c == 127;
  return std::nullopt;
}

using Code = std::vector<Instruction>;

/// Parses by descent; code is relative to its own beginning until it is joined.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::optional<Code> run() {
    Code code = alternatives(0);
    if (failed_ || at_ != text_.size()) return std::nullopt;
    return code;
  }
  std::vector<Set> takeSets() { return std::move(sets_); }
  std::size_t groups() const { return groups_; }

 private:
  bool atEnd() const { return at_ >= text_.size(); }
  char peek() const { return atEnd() ? '\0' : text_[at_]; }
  bool accept(std::string_view wanted) {
    if (text_.substr(at_, wanted.size()) != wanted) return false;
    at_ += wanted.size();
    return true;
  }
  Code fail() {
    failed_ = true;
    return {};
  }

  void append(Code& code, const Code& more) {
    if (code.size() + more.size() > maximumCode) failed_ = true;
    if (failed_) return;
    const auto base = static_cast<std::uint32_t>(code.size());
    for (Instruction instruction : more) {
      if (instruction.op == Op::split) instruction.y += base;
      if (instruction.op == Op::split || instruction.op == Op::jump) instruction.x += base;
      code.push_back(instruction);
    }
  }
  static std::uint32_t size(const Code& code) { return static_cast<std::uint32_t>(code.size()); }

  Code alternatives(int depth) {
    if (depth > maximumDepth) return fail();
    Code code = sequence(depth);
    while (!failed_ && accept("|")) {
      const Code second = sequence(depth);
      Code both = {{Op::split, 1, size(code) + 2}};
      append(both, code);
      both.push_back({Op::jump, size(code) + size(second) + 2, 0});
      append(both, second);
      code = std::move(both);
    }
    return code;
  }

  Code sequence(int depth) {
    Code code;
    while (!failed_ && !atEnd() && peek() != '|' && peek() != ')') {
      Code one = atom(depth);
      repeat(one);
      append(code, one);
    }
    return code;
  }

  /// What follows an atom: how often it comes.
  void repeat(Code& atom) {
    while (!failed_ && !atEnd()) {
      std::uint32_t least = 0, most = 0;
      bool unbounded = false;
      if (accept("*")) {
        unbounded = true;
      } else if (accept("+")) {
        least = 1;
        unbounded = true;
      } else if (accept("?")) {
        most = 1;
      } else if (peek() == '{') {
        if (!counts(least, most, unbounded)) return;
      } else {
        return;
      }
      const bool lazy = accept("?");
      Code code;
      for (std::uint32_t i = 0; i < least && !failed_; ++i) append(code, atom);
      if (unbounded) {
        Code loop = {choice(lazy, 1, size(atom) + 2)};
        append(loop, atom);
        loop.push_back({Op::jump, 0, 0});
        append(code, loop);
      } else {
        // Each further one may be left out, and all after it.
        for (std::uint32_t i = least; i < most && !failed_; ++i) {
          Code optional = {choice(lazy, 1, size(atom) + 1 + (most - i - 1) * (size(atom) + 1))};
          append(optional, atom);
          append(code, optional);
        }
      }
      atom = std::move(code);
    }
  }
  static Instruction choice(bool lazy, std::uint32_t go, std::uint32_t skip) {
    return lazy ? Instruction{Op::split, skip, go} : Instruction{Op::split, go, skip};
  }

  bool number(std::uint32_t& value) {
    const std::size_t begin = at_;
    for (value = 0; peek() >= '0' && peek() <= '9'; ++at_)
      value = std::min(value * 10 + static_cast<std::uint32_t>(peek() - '0'), maximumRepeat + 1);
    return at_ > begin;
  }
  bool counts(std::uint32_t& least, std::uint32_t& most, bool& unbounded) {
    ++at_;
    if (!number(least)) {
      failed_ = true;
      return false;
    }
    most = least;
    if (accept(",")) unbounded = !number(most);
    if (!accept("}") || least > maximumRepeat || most > maximumRepeat || (!unbounded && most < least)) failed_ = true;
    return !failed_;
  }

  Code atom(int depth) {
    const char c = peek();
    ++at_;
    switch (c) {
      case '(':
        return group(depth);
      case '[':
        return bracket();
      case '.':
        return {{Op::any, 0, 0}};
      case '^':
        return {{Op::begin, 0, 0}};
      case '$':
        return {{Op::end, 0, 0}};
      case '\\':
        return escape();
      case '*':
      case '+':
      case '?':
      case '{':
        return fail();
      default:
        return literal(c);
    }
  }

  Code group(int depth) {
    const bool isCounted = !accept("?:");
    const auto number = static_cast<std::uint32_t>(isCounted ? groups_++ : 0);
    const Code inner = alternatives(depth + 1);
    if (!accept(")")) return fail();
    if (!isCounted) return inner;
    Code code = {{Op::save, 2 * number, 0}};
    append(code, inner);
    code.push_back({Op::save, 2 * number + 1, 0});
    return code;
  }

  Code useSet(const Set& set) {
    sets_.push_back(set);
    if (sets_.size() > maximumCode) return fail();
    return {{Op::set, static_cast<std::uint32_t>(sets_.size() - 1), 0}};
  }
  Code literal(char c) {
    Set set{};
    set[static_cast<unsigned char>(c)] = true;
    return useSet(set);
  }
  static void addClass(Set& set, std::string_view name, bool negated) {
    for (std::size_t c = 0; c < set.size(); ++c)
      set[c] = set[c] || isIn(name, static_cast<unsigned char>(c)).value_or(false) != negated;
  }

  /// The character that `\c` stands for, of those that are one.
  static char plain(char c) {
    constexpr std::string_view names = "nrtfv", values = "\n\r\t\f\v";
    const std::size_t known = names.find(c);
    return known == std::string_view::npos ? c : values[known];
  }

  Code escape() {
    if (atEnd()) return fail();
    const char c = text_[at_++];
    if (c == 'b') return {{Op::edge, 0, 0}};
    if (c == 'B') return {{Op::noEdge, 0, 0}};
    if (std::string_view("dwsDWS").find(c) != std::string_view::npos) {
      Set set{};
      const char lower = static_cast<char>(c | 32);
      addClass(set, {&lower, 1}, c != lower);
      return useSet(set);
    }
    if (c >= '1' && c <= '9') return fail();
    return literal(plain(c));
  }

  Code bracket() {
    Set set{};
    const bool negated = accept("^");
    for (bool first = true; first || peek() != ']'; first = false) {
      if (atEnd()) return fail();
      if (accept("[:")) {
        const std::size_t end = text_.find(":]", at_);
        const std::string_view name = text_.substr(at_, end == std::string_view::npos ? 0 : end - at_);
        if (!isIn(name, 'a')) return fail();
        addClass(set, name, false);
        at_ = end + 2;
        continue;
      }
      char low = text_[at_++];
      if (low == '\\' && !atEnd()) {
        const char c = text_[at_++];
        if (std::string_view("dwsDWS").find(c) != std::string_view::npos) {
          const char lower = static_cast<char>(c | 32);
          addClass(set, {&lower, 1}, c != lower);
          continue;
        }
        low = plain(c);
      }
      char high = low;
      if (peek() == '-' && at_ + 1 < text_.size() && text_[at_ + 1] != ']') {
        ++at_;
        high = text_[at_++];
        if (high == '\\' && !atEnd()) high = plain(text_[at_++]);
      }
      if (static_cast<unsigned char>(high) < static_cast<unsigned char>(low)) return fail();
      for (unsigned c = static_cast<unsigned char>(low); c <= static_cast<unsigned char>(high); ++c) set[c] = true;
    }
    ++at_;
    if (negated)
      for (bool& member : set) member = !member;
    return useSet(set);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t groups_ = 1;
  std::vector<Set> sets_;
  bool failed_ = false;
};

/// All ways to match that are open at one position, in order of preference, each with the positions it has noted.
struct Threads {
  std::vector<std::uint32_t> places;
  std::vector<std::int32_t> slots;  ///< slotCount for each.
  std::vector<std::uint32_t> seenAt;

  explicit Threads(std::size_t code) : seenAt(code, 0) {}
  void clear() {
    places.clear();
    slots.clear();
  }
};

}  // namespace

std::optional<Regex> Regex::compile(std::string_view expression) {
  Parser parser(expression);
  auto inner = parser.run();
  if (!inner) return std::nullopt;
  Regex regex;
  regex.code_ = std::move(*inner);
  regex.code_.push_back({Op::match, 0, 0});
  regex.sets_ = parser.takeSets();
  regex.groups_ = parser.groups();
  return regex;
}

std::optional<Regex::Match> Regex::search(std::string_view text, bool whole) const {
  const std::size_t slotCount = 2 * groups_;
  Threads now(code_.size()), next(code_.size());
  std::vector<std::pair<std::uint32_t, std::vector<std::int32_t>>> open;
  std::uint32_t generation = 0;
  std::optional<std::vector<std::int32_t>> best;

  const auto isWordAt = [&](std::size_t i) {
    return i < text.size() && isWordCharacter(static_cast<unsigned char>(text[i]));
  };
  const auto holds = [&](Op op, std::size_t position) {
    if (op == Op::begin) return position == 0;
    if (op == Op::end) return position == text.size();
    const bool isEdge = (position > 0 && isWordAt(position - 1)) != isWordAt(position);
    return (op == Op::edge) == isEdge;
  };
  // Follows everything that takes no character, the preferred way first.
  const auto follow = [&](Threads& threads, std::uint32_t start, std::vector<std::int32_t> slots,
                          std::size_t position) {
    open.clear();
    open.emplace_back(start, std::move(slots));
    while (!open.empty()) {
      auto [place, noted] = std::move(open.back());
      open.pop_back();
      if (threads.seenAt[place] == generation) continue;
      threads.seenAt[place] = generation;
      const Instruction& instruction = code_[place];
      switch (instruction.op) {
        case Op::jump:
          open.emplace_back(instruction.x, std::move(noted));
          break;
        case Op::split:
          open.emplace_back(instruction.y, noted);
          open.emplace_back(instruction.x, std::move(noted));
          break;
        case Op::save:
          noted[instruction.x] = static_cast<std::int32_t>(position);
          open.emplace_back(place + 1, std::move(noted));
          break;
        case Op::begin:
        case Op::end:
        case Op::edge:
        case Op::noEdge:
          if (holds(instruction.op, position)) open.emplace_back(place + 1, std::move(noted));
          break;
        default:
          threads.places.push_back(place);
          threads.slots.insert(threads.slots.end(), noted.begin(), noted.end());
      }
    }
  };

  for (std::size_t position = 0;; ++position) {
    if (position == 0) ++generation;
    if (!best && (!whole || position == 0)) {
      std::vector<std::int32_t> slots(slotCount, -1);
      slots[0] = static_cast<std::int32_t>(position);
      follow(now, 0, std::move(slots), position);
    }
    if (now.places.empty() && (best || whole)) break;
    ++generation;
    next.clear();
    for (std::size_t i = 0; i < now.places.size(); ++i) {
      const Instruction& instruction = code_[now.places[i]];
      const auto first = now.slots.begin() + static_cast<std::ptrdiff_t>(i * slotCount);
      std::vector<std::int32_t> slots(first, first + static_cast<std::ptrdiff_t>(slotCount));
      if (instruction.op == Op::match) {
        if (whole && position != text.size()) continue;
        slots[1] = static_cast<std::int32_t>(position);
        best = std::move(slots);
        break;  // What comes later is preferred less.
      }
      if (position == text.size()) continue;
      const auto c = static_cast<unsigned char>(text[position]);
      if (instruction.op == Op::any || sets_[instruction.x][c])
        follow(next, now.places[i] + 1, std::move(slots), position + 1);
    }
    std::swap(now, next);
    if (position == text.size()) break;
  }
  if (!best) return std::nullopt;
  Match match;
  for (std::size_t i = 0; i < groups_; ++i) match.emplace_back((*best)[2 * i], (*best)[2 * i + 1]);
  return match;
}

}  // namespace aerosol::lang
