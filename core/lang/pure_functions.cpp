#include "core/lang/pure_functions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <utility>

#include "core/base/hash.h"
#include "core/lang/string_functions.h"
#include "core/lang/units.h"

namespace aerosol::lang {

namespace {

constexpr std::array<std::pair<std::string_view, PureFunction>, 15> table = {{
    {"concat", concatFunction},
    {"strlen", lengthFunction},
    {"startswith", startsWithFunction},
    {"endswith", endsWithFunction},
    {"stoi", toIntFunction},
    {"stof", toFloatFunction},
    {"substr", substringFunction},
    {"getchar", characterFunction},
    {"stringhash", hashFunction},
    {"split", splitFunction},
    {"format", formatFunction},
    {"addclosuretext", addClosureTextFunction},
    {"unitratio",
     [](HostCall& call) {
       call.forEachLane([&](unsigned lane) {
         const double ratio = unitRatio(call.text(0, lane), call.text(1, lane));
         call.set(HostCall::result, lane, static_cast<float>(ratio));
       });
     }},
    {"regex_search", regexSearchFunction},
    {"regex_match", regexMatchFunction},
}};

/// Strings of one call.
class LocalStrings final : public Strings {
 public:
  std::string_view text(std::uint64_t hash) const override {
    const auto known = texts_.find(hash);
    return known == texts_.end() ? std::string_view{} : known->second;
  }
  std::uint64_t add(std::string_view text, unsigned) override {
    const std::uint64_t hash = hashString(text);
    texts_.emplace(hash, text);
    return hash;
  }

 private:
  std::map<std::uint64_t, std::string> texts_;
};

/// A value as a call has it in memory, with one lane.
struct Memory {
  std::vector<std::uint32_t> words;
  std::vector<std::uint64_t> hashes;

  Memory(const Type& type) {
    if (type.base == BaseType::string) {
      hashes.resize(leafCount(type));
    } else {
      words.resize(leafCount(type));
    }
  }
  void* address() { return hashes.empty() ? static_cast<void*>(words.data()) : hashes.data(); }
};

Memory memoryOf(const Constant& constant, Strings& strings) {
  Memory memory(constant.type);
  if (const auto* ints = std::get_if<std::vector<std::int32_t>>(&constant.value)) {
    std::transform(ints->begin(), ints->end(), memory.words.begin(),
                   [](std::int32_t x) { return std::bit_cast<std::uint32_t>(x); });
  } else if (const auto* floats = std::get_if<std::vector<float>>(&constant.value)) {
    std::transform(floats->begin(), floats->end(), memory.words.begin(),
                   [](float x) { return std::bit_cast<std::uint32_t>(x); });
  } else if (const auto* texts = std::get_if<std::vector<std::string>>(&constant.value)) {
    for (std::size_t i = 0; i < texts->size(); ++i) memory.hashes[i] = strings.add((*texts)[i], 0);
  }
  return memory;
}

ConstantValue valueOf(const Type& type, const Memory& memory, const Strings& strings) {
  if (type.base == BaseType::string) {
    std::vector<std::string> texts;
    for (const std::uint64_t hash : memory.hashes) texts.emplace_back(strings.text(hash));
    return texts;
  }
  if (type.base == BaseType::integer) {
    std::vector<std::int32_t> ints;
    for (const std::uint32_t word : memory.words) ints.push_back(std::bit_cast<std::int32_t>(word));
    return ints;
  }
  std::vector<float> floats;
  for (const std::uint32_t word : memory.words) floats.push_back(std::bit_cast<float>(word));
  return floats;
}

}  // namespace

PureFunction findPureFunction(std::string_view name) {
  for (const auto& [known, function] : table)
    if (known == name) return function;
  return nullptr;
}

std::optional<Constant> evaluateCall(std::string_view function, const Type& result, std::span<Constant> arguments,
                                     std::uint32_t outputs) {
  const PureFunction pure = findPureFunction(function);
  if (!pure) return std::nullopt;
  HostSite site;
  site.function = function;
  site.result = result;
  site.outputs = outputs;
  LocalStrings strings;
  std::vector<Memory> memory;
  if (!(result == types::none)) memory.emplace_back(result);
  const std::size_t first = memory.size();
  for (const Constant& argument : arguments) {
    if (argument.type.closure) return std::nullopt;
    site.arguments.push_back(argument.type);
    memory.push_back(memoryOf(argument, strings));
  }
  std::vector<void*> values;
  for (Memory& one : memory) values.push_back(one.address());
  HostCall call(site, values.data(), 1, 1, strings);
  pure(call);
  for (std::size_t i = 0; i < arguments.size() && i < 32; ++i) {
    if ((outputs >> i & 1u) != 0) arguments[i].value = valueOf(arguments[i].type, memory[first + i], strings);
  }
  if (result == types::none) return Constant{};
  return Constant{result, valueOf(result, memory[0], strings)};
}

}  // namespace aerosol::lang
