#include "core/shading/dictionary_functions.h"

#include <charconv>

#include "core/base/dictionary_source.h"

namespace aerosol::shading {

namespace {

constexpr std::size_t result = lang::HostCall::result;
constexpr std::string_view separators = " \t\r\n,";

/// As many numbers as are wanted, separated by blanks and commas; what follows is not looked at. Where there are fewer
/// the last one stands for the rest; nothing when there is none.
template <class Number>
std::optional<std::vector<Number>> parseNumbers(std::string_view text, std::size_t count) {
  std::vector<Number> numbers;
  while (numbers.size() < count) {
    text.remove_prefix(std::min(text.find_first_not_of(separators), text.size()));
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    Number number{};
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem != std::errc()) {
      if (numbers.empty()) return std::nullopt;
      number = numbers.back();
    }
    numbers.push_back(number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return numbers;
}

template <class Number>
bool assignNumbers(PointCall& call, unsigned lane, std::string_view text) {
  const auto numbers = parseNumbers<Number>(text, call.componentCount(2));
  if (!numbers) return false;
  for (std::size_t i = 0; i < numbers->size(); ++i) call.set(2, lane, (*numbers)[i], i);
  return true;
}

bool assign(PointCall& call, unsigned lane, const std::string& text) {
  if (call.type(2).base == lang::BaseType::integer) return assignNumbers<std::int32_t>(call, lane, text);
  if (call.type(2).base != lang::BaseType::string) return assignNumbers<float>(call, lane, text);
  if (call.type(2).isArray()) return false;
  call.set(2, lane, std::string_view(text));
  return true;
}

}  // namespace

void dictionaryFindFunction(PointCall& call) {
  DictionarySource* const source = call.host().services().dictionaries();
  const bool fromNode = call.type(0) == lang::types::integer;
  call.forEachLane([&](unsigned lane) {
    std::int32_t node = fromNode ? 0 : -1;
    std::string problem;
    if (source) {
      node = fromNode ? source->find(call.integer(0, lane), call.text(1, lane), problem)
                      : source->find(call.text(0, lane), call.text(1, lane), problem);
    }
    if (!problem.empty()) call.report(lane, problem);
    call.set(result, lane, node);
  });
}

void dictionaryNextFunction(PointCall& call) {
  DictionarySource* const source = call.host().services().dictionaries();
  call.forEachLane([&](unsigned lane) { call.set(result, lane, source ? source->next(call.integer(0, lane)) : 0); });
}

void dictionaryValueFunction(PointCall& call) {
  DictionarySource* const source = call.host().services().dictionaries();
  call.forEachLane([&](unsigned lane) {
    const auto text = source ? source->value(call.integer(0, lane), call.text(1, lane)) : std::nullopt;
    call.set(result, lane, std::int32_t{text && assign(call, lane, *text)});
  });
}

}  // namespace aerosol::shading
