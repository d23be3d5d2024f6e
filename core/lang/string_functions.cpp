#include "core/lang/string_functions.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <limits>
#include <string>

#include "core/base/farm_hash.h"
#include "core/lang/closures.h"
#include "core/lang/format_text.h"
#include "core/lang/regex.h"

namespace aerosol::lang {

namespace {

constexpr std::string_view blanks = " \t\n\r\f\v";
constexpr std::size_t result = HostCall::result;

/// What comes before a number's digits is left out.
std::string_view fromSign(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  return text;
}

/// The number at the beginning of a text, blanks and a sign before it allowed; 0 when there is none, the nearest int
/// when it is beyond them all.
std::int32_t intAt(std::string_view text) {
  text = fromSign(text);
  std::int32_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec == std::errc::result_out_of_range)
    return text.starts_with('-') ? std::numeric_limits<std::int32_t>::min() : std::numeric_limits<std::int32_t>::max();
  return parsed.ec == std::errc() ? number : 0;
}

/// The same as a float: also hexadecimal digits behind 0x, infinite when it is too large.
float floatAt(std::string_view text) {
  text = fromSign(text);
  const bool isNegative = text.starts_with('-');
  if (isNegative) text.remove_prefix(1);
  const bool isHexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (isHexadecimal) text.remove_prefix(2);
  const auto form = isHexadecimal ? std::chars_format::hex : std::chars_format::general;
  const auto parse = [&](auto& number) {
    return std::from_chars(text.data(), text.data() + text.size(), number, form);
  };
  float number = 0;
  if (!text.starts_with('-') && parse(number).ec == std::errc::result_out_of_range) {
    double wide = 0;  // It tells what is too small from what is too large.
    const bool isKnown = parse(wide).ec == std::errc();
    number = isKnown && wide < 1 ? 0 : std::numeric_limits<float>::infinity();
  }
  return isNegative ? -number : number;
}

FormatArgument formatArgument(const HostCall& call, std::size_t argument, unsigned lane) {
  FormatArgument scalars;
  const BaseType base = call.type(argument).base;
  for (std::size_t i = 0; i < call.componentCount(argument); ++i) {
    if (base == BaseType::integer) {
      scalars.emplace_back(call.integer(argument, lane, i));
    } else if (base == BaseType::string) {
      scalars.emplace_back(call.text(argument, lane, i));
    } else {
      scalars.emplace_back(call.floating(argument, lane, i));
    }
  }
  return scalars;
}

/// The parts of a text between separators; of an empty separator, its words.
class Parts {
 public:
  Parts(std::string_view text, std::string_view separator) : rest_(text), separator_(separator), ended_(text.empty()) {
    skipBlanks();
  }

  bool atEnd() const { return ended_; }
  std::string_view next() {
    const std::size_t at = separator_.empty() ? rest_.find_first_of(blanks) : rest_.find(separator_);
    if (at == std::string_view::npos) return rest();
    const std::string_view part = rest_.substr(0, at);
    rest_.remove_prefix(at + separator_.size());
    skipBlanks();
    return part;
  }
  /// All that is left, as one part. (A last word is one without the blanks behind it.)
  std::string_view rest() {
    ended_ = true;
    const std::size_t end = separator_.empty() ? rest_.find_first_of(blanks) : std::string_view::npos;
    const bool isWord = end != std::string_view::npos && rest_.find_first_not_of(blanks, end) == std::string_view::npos;
    return isWord ? rest_.substr(0, end) : rest_;
  }

 private:
  void skipBlanks() {
    if (!separator_.empty()) return;
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
    ended_ = rest_.empty();
  }

  std::string_view rest_;
  std::string_view separator_;
  bool ended_;
};

}  // namespace

void concatFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) {
    std::string joined;
    for (std::size_t i = 0; i < call.argumentCount(); ++i) joined += call.text(i, lane);
    call.set(result, lane, joined);
  });
}

void lengthFunction(HostCall& call) {
  call.forEachLane(
      [&](unsigned lane) { call.set(result, lane, static_cast<std::int32_t>(call.text(0, lane).size())); });
}

void startsWithFunction(HostCall& call) {
  call.forEachLane(
      [&](unsigned lane) { call.set(result, lane, std::int32_t{call.text(0, lane).starts_with(call.text(1, lane))}); });
}

void endsWithFunction(HostCall& call) {
  call.forEachLane(
      [&](unsigned lane) { call.set(result, lane, std::int32_t{call.text(0, lane).ends_with(call.text(1, lane))}); });
}

void toIntFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) { call.set(result, lane, intAt(call.text(0, lane))); });
}

void toFloatFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) { call.set(result, lane, floatAt(call.text(0, lane))); });
}

void substringFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) {
    const std::string_view text = call.text(0, lane);
    const auto length = static_cast<std::int64_t>(text.size());
    std::int64_t start = call.integer(1, lane);
    if (start < 0) start += length;
    start = std::clamp<std::int64_t>(start, 0, length);
    const std::int64_t wanted = call.argumentCount() > 2 ? std::max(call.integer(2, lane), 0) : length;
    call.set(result, lane, text.substr(static_cast<std::size_t>(start), static_cast<std::size_t>(wanted)));
  });
}

void characterFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) {
    const std::string_view text = call.text(0, lane);
    const std::int32_t at = call.integer(1, lane);
    const bool isInside = at >= 0 && static_cast<std::size_t>(at) < text.size();
    call.set(result, lane, isInside ? std::int32_t{static_cast<unsigned char>(text[static_cast<std::size_t>(at)])} : 0);
  });
}

void hashFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) {
    const std::string_view text = call.text(0, lane);
    const std::uint64_t hash = text.empty() ? 0 : farmHash(text);
    call.set(result, lane, std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(hash)));
  });
}

void splitFunction(HostCall& call) {
  const auto room = static_cast<std::int64_t>(call.componentCount(1));
  call.forEachLane([&](unsigned lane) {
    const std::string_view text = call.text(0, lane);
    const std::string_view separator = call.argumentCount() > 2 ? call.text(2, lane) : std::string_view{};
    std::int64_t limit = room;
    if (call.argumentCount() > 3) limit = std::clamp<std::int64_t>(call.integer(3, lane), 0, room);
    std::int32_t count = 0;
    for (Parts parts(text, separator); !parts.atEnd() && count < limit; ++count) {
      call.set(1, lane, count + 1 < limit ? parts.next() : parts.rest(), static_cast<std::size_t>(count));
    }
    for (std::int64_t i = count; i < room; ++i) call.set(1, lane, std::string_view{}, static_cast<std::size_t>(i));
    call.set(result, lane, count);
  });
}

void formatFunction(HostCall& call) {
  call.forEachLane([&](unsigned lane) {
    std::vector<FormatArgument> arguments;
    for (std::size_t i = 1; i < call.argumentCount(); ++i) arguments.push_back(formatArgument(call, i, lane));
    call.set(result, lane, formatText(call.text(0, lane), arguments));
  });
}

namespace {

/// Positions that no group has are set to the length of the expression, as OSL does.
void regexFunction(HostCall& call, bool whole) {
  const std::size_t last = call.argumentCount() - 1;
  std::optional<Regex> regex;
  std::optional<std::uint64_t> compiled;
  call.forEachLane([&](unsigned lane) {
    const std::string_view expression = call.text(last, lane);
    if (compiled != call.hash(last, lane)) {
      compiled = call.hash(last, lane);
      regex = Regex::compile(expression);
    }
    const std::string_view text = call.text(0, lane);
    const auto match = regex ? regex->search(text, whole) : std::nullopt;
    call.set(result, lane, std::int32_t{match.has_value()});
    for (std::size_t i = 0; last == 2 && i < call.componentCount(1); ++i) {
      auto position = static_cast<std::int32_t>(expression.size());
      if (match && i / 2 < match->size()) {
        const auto [begin, end] = (*match)[i / 2];
        position = i % 2 == 0 ? begin : end;
        if (begin < 0) position = static_cast<std::int32_t>(text.size());
      }
      call.set(1, lane, position, i);
    }
  });
}

}  // namespace

void regexSearchFunction(HostCall& call) { regexFunction(call, false); }
void regexMatchFunction(HostCall& call) { regexFunction(call, true); }

void addClosureTextFunction(HostCall& call) {
  constexpr std::size_t firstParameter = 3;
  call.forEachLane([&](unsigned lane) {
    // Of layers, the parameters are texts of closures.
    const bool isLayer = call.text(1, lane) == layerClosure;
    const auto show = [&](std::size_t argument) {
      const bool isString = call.type(argument).base == BaseType::string && !isLayer;
      const FormatArgument scalars = formatArgument(call, argument, lane);
      std::string text;
      for (const FormatScalar& scalar : scalars) {
        text += text.empty() ? "" : ", ";
        text += isString ? "\"" + formatScalar("%s", scalar) + "\""
                         : formatScalar(isLayer && scalar.index() == 2 ? "%s"
                                        : scalar.index() == 0          ? "%d"
                                                                       : "%g",
                                        scalar);
      }
      return scalars.size() > 1 ? "(" + text + ")" : text;
    };
    std::string text(call.text(0, lane));
    const bool isBlack =
        call.floating(2, lane, 0) == 0 && call.floating(2, lane, 1) == 0 && call.floating(2, lane, 2) == 0;
    if (!isBlack) {
      text += text.empty() ? "" : "\n\t+ ";
      text += show(2) + " * " + std::string(call.text(1, lane)) + " (";
      for (std::size_t i = firstParameter; i < call.argumentCount(); ++i) {
        text += (i > firstParameter ? ", " : "") + show(i);
      }
      text += ")";
    }
    call.set(result, lane, text);
  });
}

}  // namespace aerosol::lang
