// The language tests by compiled kernels: at every width the values and messages that the comments state, and the same
// bits and messages for every point whether it runs alone or in a batch, in whatever lane, beside whatever neighbours,
// with parameters read from the instance or folded.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>

#include "core/base/hash.h"
#include "core/lang/compile.h"
#include "core/render/scene_services.h"
#include "core/shading/attributes.h"
#include "core/shading/host_functions.h"
#include "tests/language/language_case.h"
#include "tests/unit/jit/kernel_runner.h"

namespace aerosol::jit::test {
namespace {

using aerosol::testing::LanguageCase;
using aerosol::testing::LanguageExpectation;
using aerosol::testing::LanguagePoint;
using lang::BaseType;

constexpr std::array<int, 4> widths = {16, 8, 4, 1};
/// Where the language points of a batch stand among points at random; not a multiple of any width.
constexpr std::size_t batchSize = 53;

lang::ConstantValue converted(const lang::ConstantValue& value, const lang::Type& type) {
  const auto* floats = std::get_if<std::vector<float>>(&value);
  if (!floats || type.base != BaseType::integer) return value;
  return std::vector<std::int32_t>(floats->begin(), floats->end());
}

int componentsOf(lang::Global global) { return globalComponents(global); }

constexpr std::array<const char*, lang::globalCount> globalNames = {
    "P",    "I",    "N",    "Ng",   "u",    "v",    "dPdu", "dPdv", "Ps",   "time",  "dtime", "dPdtime",       "Ci",
    "dPdx", "dPdy", "dPdz", "dIdx", "dIdy", "dudx", "dudy", "dvdx", "dvdy", "dPsdx", "dPsdy", "flipHandedness"};

void setPoint(Batch& batch, std::size_t at, const LanguagePoint& point) {
  for (std::size_t i = 0; i < globalNames.size(); ++i) {
    const auto global = static_cast<lang::Global>(i);
    const auto given = point.globals.find(globalNames[i]);
    for (int c = 0; c < componentsOf(global); ++c) {
      const auto component = static_cast<std::size_t>(c);
      batch.global(global, c)[at] = given == point.globals.end() ? 0.0f : given->second.at(component);
    }
  }
}

/// Row vectors to "common" become rows of a map on column vectors, and back.
void setSpaces(AerosolInstanceHeader& header, const LanguageCase& test) {
  const auto identity = [](float* rows) {
    for (int i = 0; i < 3; ++i) rows[i * 5] = 1;
  };
  identity(header.objectToWorld);
  identity(header.worldToObject);
  identity(header.shaderToWorld);
  identity(header.worldToShader);
  const auto found = test.spaces.find("object");
  if (found == test.spaces.end()) return;
  // The tests' spaces are scaled and moved, not turned: the inverse follows from the diagonal.
  const auto& m = found->second;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) header.objectToWorld[row * 4 + column] = m[column * 4 + row];
    header.worldToObject[row * 5] = 1 / m[row * 5];
    header.worldToObject[row * 4 + 3] = -m[12 + row] / m[row * 5];
  }
}

/// Values of one output at one point, all components; strings as text.
struct Read {
  std::vector<float> numbers;
  std::vector<std::string> texts;
};

std::string nameOf(const lang::Program& program, const OutputComponent& output) {
  const std::string index = std::to_string(output.index);
  switch (output.kind) {
    case lang::OutputKind::sigmaT:
      return "sigmaT";
    case lang::OutputKind::sigmaS:
      return "sigmaS";
    case lang::OutputKind::emission:
      return "emission";
    case lang::OutputKind::lobeSigmaS:
      return "lobeSigmaS" + index;
    case lang::OutputKind::lobeAnisotropy:
      return "lobeAnisotropy" + index;
    case lang::OutputKind::siteWeight:
      return "siteWeight" + index;
    case lang::OutputKind::siteParameter:
      return "siteParameter" + index + "." + std::to_string(output.subIndex);
    case lang::OutputKind::parameter:
      return program.parameters[output.index].name;
    case lang::OutputKind::displaced:
      return output.index == 0 ? "displaced P" : "displaced N";
  }
  return {};
}

/// What the test's comments say of its points, which stand anywhere in a batch.
class Facts final : public shading::PointFacts {
 public:
  struct Place {
    const LanguagePoint* point = nullptr;  ///< Null: one at random.
    std::uint32_t number = 0;              ///< The same wherever it stands.
  };
  std::vector<Place> places;
  const shading::AttributeTable* own = nullptr;

  std::uint32_t rayTypes(std::uint32_t i) const override {
    if (i >= places.size()) return i;
    return places[i].point ? static_cast<std::uint32_t>(places[i].point->rayTypes) : places[i].number;
  }
  bool isBackfacing(std::uint32_t i) const override { return at(i).backfacing != 0; }
  float surfaceArea(std::uint32_t i) const override { return at(i).surfaceArea; }
  const shading::AttributeTable* attributes(std::uint32_t i) const override {
    return i < places.size() && places[i].point ? own : nullptr;
  }
  std::optional<lang::Type> userData(std::uint32_t i, std::uint64_t name,
                                     std::span<float, maximumUserData> values) const override {
    for (const auto& [known, data] : at(i).userData) {
      if (hashString(known) != name) continue;
      const auto& floats = std::get<std::vector<float>>(data.value);
      std::copy(floats.begin(), floats.end(), values.begin());
      return data.type;
    }
    return std::nullopt;
  }

 private:
  const LanguagePoint& at(std::uint32_t i) const {
    static const LanguagePoint none;
    return i < places.size() && places[i].point ? *places[i].point : none;
  }
};

/// Host functions as a renderer answers them.
class Answers final : public HostAnswers {
 public:
  Answers()
      : calls_([this](std::uint32_t site, std::uint32_t point,
                      std::string_view text) { report_(site, point, calls_.strings().add(text)); },
               services()) {}

  void begin(const KernelInterface& interface, std::size_t count, Report report) override {
    report_ = std::move(report);
    calls_.begin(interface, &ofInstance, count);
  }
  void call(const AerosolHostCall& call) override { calls_.call(call); }

  /// Of all strings of the last run.
  std::string text(std::uint64_t hash) const {
    const std::string_view text = calls_.strings().text(hash);
    return hash != 0 && text.empty() ? "unknown string" : std::string(text);
  }

  void setAttributes(const LanguageCase& test) {
    for (const auto& [object, values] : test.attributes) {
      shading::AttributeTable& table = object == "global" ? attributes_.global : attributes_.object(object);
      for (const auto& [name, value] : values) table.set(name, {value.type, value.value});
    }
    facts.own = attributes_.find(hashString("own"));
    calls_.setAttributes(&attributes_);
    calls_.setFacts(&facts);
  }

  shading::StringList ofInstance;
  Facts facts;

 private:
  static shading::Services* services() {
    static const auto made = render::makeServices({{AEROSOL_SOURCE_DIR "/tests/language"}, 64});
    return made.get();
  }

  shading::SceneAttributes attributes_;
  Report report_;
  shading::HostCalls calls_;
};

std::map<std::string, Read> readOutputs(const lang::Program& program, const KernelInterface& interface,
                                        const Answers& answers, const Outcome& outcome, std::size_t point) {
  std::map<std::string, Read> result;
  for (std::size_t i = 0; i < interface.outputs.size(); ++i) {
    const OutputComponent& output = interface.outputs[i];
    const std::uint64_t bits = outcome.outputs[i][point];
    Read& read = result[nameOf(program, output)];
    if (output.type == BaseType::string) {
      read.texts.push_back(answers.text(bits));
    } else if (output.type == BaseType::integer) {
      read.numbers.push_back(static_cast<float>(std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(bits))));
    } else {
      read.numbers.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
  }
  return result;
}

/// Places in a text without the folder of the test's file.
std::string withoutFolder(std::string text, const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
    text.erase(at, folder.size());
  return text;
}

/// A record as the tests write it: "print: text", "index: i n".
std::string messageOf(const KernelInterface& interface, const Answers& answers, const Record& record) {
  const auto asInt = [&](std::size_t i) {
    return std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(record.values.at(i)));
  };
  if (record.kind == AEROSOL_REPORT_BUDGET) return "budget";
  if (record.kind == AEROSOL_REPORT_SPACE) return "space: " + answers.text(record.values.at(0));
  if (record.kind == AEROSOL_REPORT_HOST) return "host: " + answers.text(record.values.at(0));
  if (record.kind == AEROSOL_REPORT_INDEX) return "index: " + std::to_string(asInt(0)) + " " + std::to_string(asInt(1));
  static constexpr std::array<const char*, 7> kinds = {"print: ", "warning: ", "error: ", "", "", "", "file "};
  std::string text = kinds.at(record.kind);
  const auto site = std::find_if(interface.sites.begin(), interface.sites.end(), [&](const MessageSite& known) {
    return known.kind == record.kind && known.location.line == record.line;
  });
  if (site == interface.sites.end()) return text + "unknown site";
  const std::string& format = site->format;
  std::size_t next = 0;
  if (record.kind == AEROSOL_MESSAGE_FILE) text += answers.text(record.values.at(next++)) + ": ";
  for (std::size_t k = 0; k < format.size(); ++k) {
    if (format[k] != '%') {
      text += format[k];
      continue;
    }
    if (format[k + 1] == '%') {
      text += format[k++];
      continue;
    }
    const std::size_t end = format.find_first_not_of("-+ #0123456789.", k + 1);
    const std::string piece = format.substr(k, end - k + 1);
    k = end;
    const BaseType type = site->arguments.at(next).base;
    char buffer[256];
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wformat-nonliteral"
    if (type == BaseType::integer) {
      std::snprintf(buffer, sizeof buffer, piece.c_str(), asInt(next));
    } else if (type == BaseType::string) {
      std::snprintf(buffer, sizeof buffer, piece.c_str(), answers.text(record.values.at(next)).c_str());
    } else {
      const float value = std::bit_cast<float>(static_cast<std::uint32_t>(record.values.at(next)));
      std::snprintf(buffer, sizeof buffer, piece.c_str(), static_cast<double>(value));
    }
#pragma clang diagnostic pop
    ++next;
    text += buffer;
  }
  return text;
}

void expectValue(const LanguageExpectation& expectation, const std::map<std::string, Read>& outputs) {
  const auto found = outputs.find(expectation.name);
  ASSERT_TRUE(found != outputs.end()) << "line " << expectation.line << ": no output " << expectation.name;
  if (const auto* texts = std::get_if<std::vector<std::string>>(&expectation.value)) {
    EXPECT_EQ(found->second.texts, *texts) << "line " << expectation.line;
    return;
  }
  const auto& wanted = std::get<std::vector<float>>(expectation.value);
  const auto& got = found->second.numbers;
  ASSERT_EQ(got.size(), wanted.size()) << "line " << expectation.line;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const bool same = got[i] == wanted[i] || (std::isnan(got[i]) && std::isnan(wanted[i])) ||
                      std::fabs(got[i] - wanted[i]) <= expectation.tolerance;
    EXPECT_TRUE(same) << "line " << expectation.line << ": " << expectation.name << " component " << i << " is "
                      << got[i] << ", not " << wanted[i];
  }
}

class Language : public ::testing::TestWithParam<std::filesystem::path> {
 protected:
  void SetUp() override {
    test_ = aerosol::testing::readLanguageCase(GetParam());
    ASSERT_TRUE(test_.error.empty()) << test_.error;
    lang::CompileOptions options;
    options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
    auto compiled = lang::compileFile(GetParam(), options);
    ASSERT_TRUE(compiled) << format(compiled.errors());
    program_ = compiled->program;
    for (const lang::Parameter& parameter : program_->parameters) {
      const auto given = test_.parameters.find(parameter.name);
      values_.push_back(given == test_.parameters.end() ? lang::ConstantValue{}
                                                        : converted(given->second, parameter.type));
    }
    answers_.setAttributes(test_);
    // Every point several times, in different lanes, between points at random.
    batch_ = Batch::random(batchSize, hashString(GetParam().filename().string()));
    std::mt19937 random(7);
    for (std::size_t at = 0; at < batchSize; ++at) {
      const std::size_t which = random() % (test_.points.size() + 1);
      places_.push_back(which);
      if (which < test_.points.size()) setPoint(batch_, at, test_.points[which]);
    }
    for (std::size_t i = 0; i < test_.points.size(); ++i) {
      places_[5 * i + 2] = i;
      setPoint(batch_, 5 * i + 2, test_.points[i]);
    }
  }

  Kernel kernel(int width, bool folded, Domain domain = Domain::wide) {
    KernelRequest request = requestFor(program_, width);
    request.domain = domain;
    if (domain == Domain::range) {
      std::erase_if(request.outputs, [&](const lang::Output& output) {
        return program_->variables[output.variable].type.base == BaseType::string;
      });
    }
    if (folded) {
      for (std::uint32_t i = 0; i < values_.size(); ++i) {
        const bool isDefault = std::holds_alternative<std::monostate>(values_[i]);
        const lang::Parameter& parameter = program_->parameters[i];
        request.folded.push_back({i, isDefault && parameter.hasConstantDefault ? parameter.defaultValue : values_[i]});
      }
    }
    return compileOrFail(request);
  }

  Batch batchFor(const Kernel& kernel) const {
    Batch batch = batch_;
    AerosolInstanceHeader header{};
    setSpaces(header, test_);
    batch.instanceData = instanceBlock(kernel.interface(), *program_, values_, header);
    return batch;
  }

  /// Runs it with the strings that the instance gives.
  Outcome run(const Kernel& kernel, const Batch& batch) {
    answers_.ofInstance.clear();
    const auto add = [&](const lang::ConstantValue& value) {
      if (const auto* strings = std::get_if<std::vector<std::string>>(&value))
        for (const std::string& text : *strings) answers_.ofInstance.emplace_back(hashString(text), text);
    };
    for (const lang::Parameter& parameter : program_->parameters) add(parameter.defaultValue);
    for (const lang::ConstantValue& value : values_) add(value);
    return test::run(kernel, batch, {}, &answers_);
  }

  /// The batch stands for these places of the whole one; none: all.
  void placeFacts(const std::vector<std::size_t>& places = {}) {
    answers_.facts.places.clear();
    for (std::size_t i = 0; i < (places.empty() ? batchSize : places.size()); ++i) {
      const std::size_t number = places.empty() ? i : places[i];
      const std::size_t which = places_[number];
      answers_.facts.places.push_back(
          {which < test_.points.size() ? &test_.points[which] : nullptr, static_cast<std::uint32_t>(number)});
    }
  }

  LanguageCase test_;
  std::shared_ptr<const lang::Program> program_;
  Values values_;
  Batch batch_;
  Answers answers_;
  std::vector<std::size_t> places_;  ///< By place in the batch: the test's point, or their number.
};

TEST_P(Language, GivesWhatItsCommentsSayAtEveryWidth) {
  std::vector<std::vector<std::uint64_t>> first;
  for (const int width : widths) {
    for (const bool folded : {false, true}) {
      SCOPED_TRACE("width " + std::to_string(width) + (folded ? ", folded" : ""));
      const Kernel code = kernel(width, folded);
      placeFacts();
      const Outcome outcome = run(code, batchFor(code));
      for (std::size_t at = 0; at < batchSize; ++at) {
        if (places_[at] >= test_.points.size()) continue;
        const LanguagePoint& point = test_.points[places_[at]];
        const auto outputs = readOutputs(*program_, code.interface(), answers_, outcome, at);
        for (const LanguageExpectation& expectation : point.expectations) expectValue(expectation, outputs);
        std::vector<std::string> messages;
        for (const Record& record : outcome.recordsOf(at))
          messages.push_back(withoutFolder(messageOf(code.interface(), answers_, record), GetParam()));
        EXPECT_EQ(messages, point.messages);
        if (HasFailure()) return;
      }
      // All points, those at random too, have the same bits at all widths, folded or not.
      if (first.empty()) first = outcome.outputs;
      EXPECT_EQ(outcome.outputs, first);
    }
  }
}

TEST_P(Language, GivesEveryPointTheSameBitsInAnyCompany) {
  std::mt19937 random(11);
  for (const int width : {16, 4}) {
    const Kernel code = kernel(width, false);
    const Batch batch = batchFor(code);
    placeFacts();
    const Outcome whole = run(code, batch);
    std::vector<std::size_t> order(batchSize);
    for (std::size_t i = 0; i < batchSize; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    Batch shuffled = batch.pick(order);
    for (std::size_t i = 0; i < batchSize; ++i) shuffled.active.push_back(random() % 3 == 0 ? 0u : ~0u);
    placeFacts(order);
    const Outcome mixed = run(code, shuffled);
    for (std::size_t i = 0; i < batchSize; ++i) {
      for (std::size_t output = 0; output < whole.outputs.size(); ++output) {
        const BaseType type = code.interface().outputs[output].type;
        const std::uint64_t none = type == BaseType::string ? untouched : canonical(untouched, type);
        EXPECT_EQ(mixed.outputs[output][i], shuffled.active[i] != 0 ? whole.outputs[output][order[i]] : none)
            << "width " << width << ", point " << order[i] << " in place " << i;
      }
      EXPECT_EQ(mixed.recordsOf(i), shuffled.active[i] != 0 ? whole.recordsOf(order[i]) : std::vector<Record>{});
    }
    for (std::size_t i = 0; i < 6; ++i) {
      placeFacts({order[i]});
      const Outcome alone = run(code, batch.pick({order[i]}));
      for (std::size_t output = 0; output < whole.outputs.size(); ++output)
        EXPECT_EQ(alone.outputs[output][0], whole.outputs[output][order[i]]) << "width " << width;
      EXPECT_EQ(alone.recordsOf(0), whole.recordsOf(order[i]));
    }
    if (HasFailure()) return;
  }
}

/// Boxes from single points to some units, around the test's points and elsewhere: no point of a box leaves its bounds.
TEST_P(Language, StaysWithinTheBoundsOfBoxes) {
  constexpr std::size_t pointsInBox = 16;
  const Kernel range = kernel(8, true, Domain::range), wide = kernel(8, true);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Boxes boxes;
  boxes.count = batchSize;
  for (std::size_t box = 0; box < batchSize; ++box) {
    for (std::size_t i = 0; i < batch_.globals.size(); ++i) {
      const float size = box % 4 == 0 ? 0.0f : std::exp2(-8.0f + 10.0f * unit(random));
      const float at = batch_.globals[i][box];
      boxes.low[i].push_back(at - (box % 4 == 0 ? 0.0f : size * unit(random)));
      boxes.high[i].push_back(std::max(boxes.low[i].back() + size, at));
    }
  }
  AerosolInstanceHeader header{};
  setSpaces(header, test_);
  boxes.instanceData = instanceBlock(range.interface(), *program_, values_, header);
  const auto bounds = runRange(range, boxes, &answers_);
  // Outputs of the range kernel, by the wide kernel's pointers: strings have no bounds.
  std::vector<std::size_t> pointers;
  for (std::size_t i = 0; i < wide.interface().outputs.size(); ++i)
    if (wide.interface().outputs[i].type != BaseType::string) pointers.push_back(i);
  for (std::size_t box = 0; box < boxes.count; ++box) {
    Batch points;
    points.count = pointsInBox;
    points.instanceData = instanceBlock(wide.interface(), *program_, values_, header);
    for (std::size_t i = 0; i < points.globals.size(); ++i) {
      for (std::size_t point = 0; point < pointsInBox; ++point) {
        const float low = boxes.low[i][box], high = boxes.high[i][box];
        const float t = point < 4 ? static_cast<float>(random() % 2) : unit(random);
        points.globals[i].push_back(std::clamp(low + t * (high - low), low, high));
      }
    }
    const Outcome outcome = run(wide, points);
    ASSERT_EQ(bounds[box].size(), pointers.size());
    for (std::size_t k = 0; k < pointers.size(); ++k) {
      const OutputComponent& output = wide.interface().outputs[pointers[k]];
      for (std::size_t point = 0; point < pointsInBox; ++point) {
        const auto bits = static_cast<std::uint32_t>(outcome.outputs[pointers[k]][point]);
        const double value = output.type == BaseType::floating ? static_cast<double>(std::bit_cast<float>(bits))
                                                               : std::bit_cast<std::int32_t>(bits);
        ASSERT_TRUE(bounds[box][k].holds(value))
            << nameOf(*program_, output) << " component " << output.component << ", box " << box << ": " << value
            << " is not in [" << bounds[box][k].low << ", " << bounds[box][k].high << "]";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Language,
                         ::testing::ValuesIn(aerosol::testing::languageFiles(AEROSOL_SOURCE_DIR "/tests/language")),
                         [](const auto& info) { return info.param.stem().string(); });

}  // namespace
}  // namespace aerosol::jit::test
