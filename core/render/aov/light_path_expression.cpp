#include "core/render/aov/light_path_expression.h"

#include <algorithm>
#include <functional>

namespace aerosol::render {

namespace {

constexpr std::string_view types = "CRTVLOB";
constexpr std::string_view scatterings = "DGSs";
constexpr int mostRepetitions = 64;
constexpr int mostNesting = 100;
constexpr std::size_t mostStates = 20000;

/// Recursive descent; every rule returns the piece of automaton that it read.
class Parser {
 public:
  Parser(std::string_view text, const std::vector<std::string>& labels, LightPathExpression& out,
         ExpressionProblem& problem)
      : text_(text), labels_(labels), out_(out), problem_(problem) {}

  bool parse() {
    const Piece all = alternatives();
    if (!failed_ && at_ < text_.size()) fail(std::string("'") + text_[at_] + "' has no partner");
    if (failed_) return false;
    out_.start = all.start;
    out_.end = all.end;
    return true;
  }

 private:
  /// `end` has no arrow yet.
  struct Piece {
    std::int32_t start = 0, end = 0;
  };
  using Set = std::vector<bool>;

  void fail(std::string message, std::size_t at) {
    if (!failed_) problem_ = {std::move(message), at};
    failed_ = true;
  }
  void fail(std::string message) { fail(std::move(message), at_); }
  char peek() const { return !failed_ && at_ < text_.size() ? text_[at_] : '\0'; }
  bool accept(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  std::int32_t newState() {
    if (out_.states.size() >= mostStates) fail("this expression is too large");
    out_.states.emplace_back();
    return static_cast<std::int32_t>(out_.states.size() - 1);
  }
  LightPathExpression::State& state(std::int32_t index) { return out_.states[static_cast<std::size_t>(index)]; }
  void link(std::int32_t from, std::int32_t to) {
    (state(from).next == LightPathExpression::none ? state(from).next : state(from).other) = to;
  }
  Piece nothing() {
    const std::int32_t start = newState(), end = newState();
    link(start, end);
    return {start, end};
  }

  Piece alternatives() {
    if (++depth_ > mostNesting) fail("brackets are nested too deeply");
    Piece piece = sequence();
    while (accept('|')) {
      const Piece other = sequence();
      const std::int32_t start = newState(), end = newState();
      link(start, piece.start);
      link(start, other.start);
      link(piece.end, end);
      link(other.end, end);
      piece = {start, end};
    }
    --depth_;
    return piece;
  }

  Piece sequence() {
    Piece piece = nothing();
    for (char c = peek(); c != '\0' && c != '|' && c != ')'; c = peek()) {
      if (c == ' ' || c == '\t') {
        ++at_;
        continue;
      }
      const Piece next = repeated();
      link(piece.end, next.start);
      piece.end = next.end;
    }
    return piece;
  }

  /// An atom with what repeats it. To have it more than once, its text is read again.
  Piece repeated() {
    const std::size_t from = at_;
    Piece piece = atom();
    for (char c = peek(); c == '*' || c == '+' || c == '?' || c == '{'; c = peek()) {
      if (c == '{') {
        piece = counted(from, piece);
        continue;
      }
      ++at_;
      const std::int32_t start = newState(), end = newState();
      link(start, piece.start);
      if (c != '+') link(start, end);
      link(piece.end, end);
      if (c != '?') link(piece.end, piece.start);
      piece = {start, end};
    }
    return piece;
  }

  Piece counted(std::size_t from, Piece first) {
    const std::size_t brace = at_++;
    const int least = number();
    int most = least;
    bool isOpen = false;
    if (accept(',')) {
      isOpen = peek() == '}';
      if (!isOpen) most = number();
    }
    if (!accept('}')) fail("a repetition is {n}, {n,m} or {n,}", brace);
    if (!failed_ && most < least) fail("a repetition from more to fewer", brace);
    if (failed_) return first;
    const std::size_t after = at_;
    const auto again = [&] {
      at_ = from;
      return atomBefore(brace);
    };
    Piece all = nothing();
    const auto append = [&](const Piece& next) {
      link(all.end, next.start);
      all.end = next.end;
    };
    for (int i = 0; i < least && !failed_; ++i) append(i == 0 ? first : again());
    std::vector<std::int32_t> exits;
    for (int i = least; i < most && !failed_; ++i) {
      exits.push_back(all.end);
      append(i == 0 ? first : again());
    }
    if (isOpen && !failed_) {
      const Piece more = again();
      const std::int32_t start = newState(), end = newState();
      link(start, more.start);
      link(start, end);
      link(more.end, start);
      append({start, end});
    }
    const std::int32_t end = newState();
    for (const std::int32_t exit : exits) link(exit, end);
    link(all.end, end);
    at_ = after;
    return {all.start, end};
  }
  /// Reads what stands before a brace once more.
  Piece atomBefore(std::size_t brace) {
    Piece piece = atom();
    while (at_ < brace && !failed_) {
      const char c = text_[at_];
      if (c == '{') {
        fail("only one repetition by numbers may follow an event");
        return piece;
      }
      ++at_;
      const std::int32_t start = newState(), end = newState();
      link(start, piece.start);
      if (c != '+') link(start, end);
      link(piece.end, end);
      if (c != '?') link(piece.end, piece.start);
      piece = {start, end};
    }
    return piece;
  }

  int number() {
    int value = 0;
    const std::size_t from = at_;
    while (peek() >= '0' && peek() <= '9' && value <= mostRepetitions) value = 10 * value + (text_[at_++] - '0');
    if (at_ == from) fail("a number belongs here");
    if (value > mostRepetitions) fail("more than 64 repetitions", from);
    return value;
  }

  Piece atom() {
    if (accept('(')) {
      const std::size_t open = at_ - 1;
      const Piece piece = alternatives();
      if (!accept(')')) fail("'(' is not closed", open);
      return piece;
    }
    const Set set = eventSet();
    const std::int32_t start = newState(), end = newState();
    state(start).set = static_cast<std::int32_t>(out_.sets.size());
    state(start).next = end;
    out_.sets.push_back(set);
    return {start, end};
  }

  Set setWhere(const std::function<bool(EventLetters, std::size_t label)>& holds) const {
    Set set(pathEventCount * labels_.size());
    for (std::size_t event = 0; event < pathEventCount; ++event) {
      for (std::size_t label = 0; label < labels_.size(); ++label)
        set[event * labels_.size() + label] = holds(eventLetters[event], label);
    }
    return set;
  }

  /// One event of any kind: '.', a letter, a label, <TSL>, or a set.
  Set eventSet() {
    const char c = peek();
    if (accept('[')) return bracketed([this] { return eventSet(); });
    if (accept('.')) return setWhere([](EventLetters, std::size_t) { return true; });
    if (accept('<')) return fullEvent();
    if (c == '\'') {
      const std::size_t wanted = label();
      return setWhere([=](EventLetters, std::size_t given) { return given == wanted; });
    }
    if (c != '\0' && types.find(c) != types.npos) {
      ++at_;
      return setWhere([c](EventLetters e, std::size_t) { return e.type == c; });
    }
    if (c != '\0' && scatterings.find(c) != scatterings.npos) {
      ++at_;
      return setWhere([c](EventLetters e, std::size_t) { return e.scattering == c; });
    }
    fail(c == '\0' ? std::string("the expression ends too early")
                   : std::string("'") + c + "' is no event: types are C R T V L O B, scatterings D G S s");
    return setWhere([](EventLetters, std::size_t) { return false; });
  }

  /// What follows '[': the union of its items, or what is in none of them.
  Set bracketed(const std::function<Set()>& item) {
    const std::size_t open = at_ - 1;
    const bool isComplement = accept('^');
    Set all = setWhere([](EventLetters, std::size_t) { return false; });
    while (peek() != '\0' && peek() != ']') {
      const Set next = item();
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = all[i] || next[i];
    }
    if (!accept(']')) fail("'[' is not closed", open);
    if (isComplement) all.flip();
    return all;
  }

  /// What follows '<'.
  Set fullEvent() {
    const std::size_t open = at_ - 1;
    Set set = part([this] { return typeLetter(); });
    const auto restrict = [&](const Set& other) {
      for (std::size_t i = 0; i < set.size(); ++i) set[i] = set[i] && other[i];
    };
    if (peek() != '>' && peek() != '\'') restrict(part([this] { return scatteringLetter(); }));
    while (peek() != '>' && peek() != '\0' && !failed_) restrict(part([this] { return labelSet(); }));
    if (!accept('>')) fail("'<' is not closed", open);
    return set;
  }
  /// One position of an event: anything, a set, or one item.
  Set part(const std::function<Set()>& item) {
    if (accept('.')) return setWhere([](EventLetters, std::size_t) { return true; });
    if (accept('[')) return bracketed(item);
    return item();
  }
  Set typeLetter() {
    const char c = peek();
    if (c == '\0' || types.find(c) == types.npos) fail("an event's type is one of C R T V L O B");
    ++at_;
    return setWhere([c](EventLetters e, std::size_t) { return e.type == c; });
  }
  Set scatteringLetter() {
    const char c = peek();
    const bool isKnown = c != '\0' && (scatterings.find(c) != scatterings.npos || c == 'V');
    if (!isKnown) fail("an event's scattering is one of D G S s (and of O, what media emit: V)");
    ++at_;
    return setWhere([c](EventLetters e, std::size_t) { return e.scattering == c; });
  }
  Set labelSet() {
    const std::size_t wanted = label();
    return setWhere([=](EventLetters, std::size_t given) { return given == wanted; });
  }

  std::size_t label() {
    const std::size_t open = at_;
    if (!accept('\'')) {
      fail("a label stands in single quotes");
      return 0;
    }
    const std::size_t close = std::min(text_.find('\'', at_), text_.size());
    const std::string name(text_.substr(at_, close - at_));
    at_ = close;
    if (!accept('\'')) fail("this label is not closed", open);
    const auto found = std::find(labels_.begin() + 1, labels_.end(), name);
    if (found != labels_.end()) return static_cast<std::size_t>(found - labels_.begin());
    std::string known;
    for (std::size_t i = 1; i < labels_.size(); ++i) known += (i > 1 ? ", '" : " '") + labels_[i] + "'";
    fail("nothing has the label '" + name + "'" +
             (known.empty() ? std::string(": no emitter has a light_group, and no closure a label")
                            : "; known are" + known),
         open);
    return 0;
  }

  std::string_view text_;
  const std::vector<std::string>& labels_;
  LightPathExpression& out_;
  ExpressionProblem& problem_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool failed_ = false;
};

}  // namespace

bool parseLightPath(std::string_view text, const std::vector<std::string>& labels, LightPathExpression& expression,
                    ExpressionProblem& problem) {
  expression = {};
  return Parser(text, labels, expression, problem).parse();
}

}  // namespace aerosol::render
