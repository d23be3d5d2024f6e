#include "core/lang/group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "core/lang/array_lengths.h"
#include "core/lang/compile.h"
#include "core/lang/fold.h"
#include "tests/unit/lang/interpreter.h"

namespace aerosol::lang {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::PointInputs;
using testing::PointResult;

std::shared_ptr<const Program> layerOf(const std::string& text) {
  static std::map<std::string, std::shared_ptr<const Program>> known;
  auto& program = known[text];
  if (program) return program;
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  const auto result = compileString(text, "test.osl", options);
  EXPECT_TRUE(result) << format(result.errors());
  if (result) program = result->layer;
  return program;
}

/// A group written with few words: `add` layers, then connect "layer.part" to "layer.part".
struct Builder {
  Group group;
  GroupOptions options;

  Builder& add(const std::string& name, const std::string& source, std::vector<GivenValue> values = {}) {
    group.layers.push_back({name, layerOf(source), std::move(values), {name, 1, 1}});
    return *this;
  }
  Builder& connect(const std::string& from, const std::string& to) {
    const auto cut = [](const std::string& text) { return text.find('.'); };
    group.connections.push_back({from.substr(0, cut(from)),
                                 from.substr(cut(from) + 1),
                                 to.substr(0, cut(to)),
                                 to.substr(cut(to) + 1),
                                 {from, 1, 1},
                                 {to, 1, 1}});
    return *this;
  }
  Builder& output(const std::string& name) {
    group.outputs.push_back(name);
    return *this;
  }
  ResolvedGroup resolved() const {
    auto result = resolve(group, options);
    EXPECT_TRUE(result) << format(result.errors());
    return result ? *result : ResolvedGroup{};
  }
  std::string errors() const {
    const auto result = resolve(group, options);
    return result ? "" : format(result.errors());
  }
  Program merged() const {
    const auto program = merge(resolved());
    EXPECT_TRUE(program) << format(program.errors());
    return program ? **program : Program{};
  }
  PointResult run(PointInputs inputs = {}) const {
    const ResolvedGroup known = resolved();
    const auto program = merge(known);
    EXPECT_TRUE(program) << format(program.errors());
    if (!program) return {};
    for (const auto& [index, value] : known.values) inputs.parameters[(*program)->parameters.at(index).name] = value;
    const PointResult result = interpret(**program, inputs);
    // What is known when a kernel is made must not change the result.
    EXPECT_EQ(interpret(specialise(**program, known.values), inputs).messages, result.messages);
    return result;
  }
};

GivenValue given(const std::string& name, float value) {
  return {name, types::floating, std::vector<float>{value}, {name, 2, 3}};
}
GivenValue given(const std::string& name, int value) {
  return {name, types::integer, std::vector<std::int32_t>{value}, {name, 2, 3}};
}

std::vector<float> floats(const PointResult& result, const std::string& name) {
  const auto found = result.outputs.find(name);
  if (found == result.outputs.end()) return {};
  return std::get<std::vector<float>>(found->second.value);
}

const char* const wave =
    "shader wave(float scale = 2, output float value = 0, output color tint = 0) {\n"
    "  value = scale * u;\n  tint = color(u, v, scale);\n}";
const char* const sum = "shader sum(float a = 1, float b = 10, output float total = 0) { total = a + b; }";
const char* const paint = "shader paint(color c = 0.5, output color out = 0) { out = c * 2; }";
const char* const talk =
    "shader talk(string name = \"it\", float in = 0, output float out = 0) {\n"
    "  printf(\"%s %g\", name, in);\n  out = in + 1;\n}";

PointInputs at(float u, float v = 0) {
  PointInputs inputs;
  inputs.globals["u"] = {u};
  inputs.globals["v"] = {v};
  return inputs;
}

TEST(Group, PassesValuesOn) {
  Builder group;
  group.add("w", wave).add("s", sum).connect("w.value", "s.a");
  EXPECT_THAT(floats(group.run(at(3)), "s.total"), ElementsAre(16));
}

TEST(Group, ValuesBelongToTheirLayer) {
  Builder group;
  group.add("w1", wave, {given("scale", 5.0f)}).add("w2", wave, {given("scale", 7)}).add("s", sum);
  group.connect("w1.value", "s.a").connect("w2.value", "s.b");
  EXPECT_THAT(floats(group.run(at(1)), "s.total"), ElementsAre(12));
}

TEST(Group, ConvertsAsAssignmentsDo) {
  Builder group;
  group.add("w", wave).add("p", paint).connect("w.value", "p.c");
  EXPECT_THAT(floats(group.run(at(3)), "p.out"), ElementsAre(12, 12, 12));
  Builder ints;
  ints.add("i", "shader i(output int value = 3) { value = 4; }").add("s", sum).connect("i.value", "s.a");
  EXPECT_THAT(floats(ints.run(), "s.total"), ElementsAre(14));
  Builder triples;
  triples.add("n", "shader n(output normal value = 0) { value = normal(1, 2, 3); }").add("p", paint);
  triples.connect("n.value", "p.c");
  EXPECT_THAT(floats(triples.run(), "p.out"), ElementsAre(2, 4, 6));
}

TEST(Group, ConnectsComponents) {
  Builder group;
  group.add("w", wave).add("p", paint).connect("w.value", "p.c[1]").connect("w.tint.b", "p.c.r");
  EXPECT_THAT(floats(group.run(at(3)), "p.out"), ElementsAre(4, 12, 1));
  // With a default that is computed.
  Builder computed;
  computed.add("w", wave).add("q", "shader q(point p = P + 1, output point out = 0) { out = p; }");
  computed.connect("w.value", "q.p.y");
  PointInputs inputs = at(3);
  inputs.globals["P"] = {10, 20, 30};
  EXPECT_THAT(floats(computed.run(inputs), "q.out"), ElementsAre(11, 6, 31));
}

TEST(Group, ConnectsArrays) {
  const char* const source =
      "shader list(output float values[3] = {1, 2, 3}, output color tints[2] = {0, 0}) {\n"
      "  values[1] = u;\n  tints[1] = color(1, 2, 3);\n}";
  const char* const target =
      "shader use(float values[3] = {0, 0, 0}, color tints[2] = {0.5, 0.25},\n"
      "           output float out = 0, output color c = 0) {\n"
      "  out = values[0] + 10 * values[1] + 100 * values[2];\n  c = tints[0] + tints[1];\n}";
  Builder whole;
  whole.add("l", source).add("t", target).connect("l.values", "t.values").connect("l.tints", "t.tints");
  EXPECT_THAT(floats(whole.run(at(7)), "t.out"), ElementsAre(371));
  EXPECT_THAT(floats(whole.run(at(7)), "t.c"), ElementsAre(1, 2, 3));
  Builder parts;
  parts.add("l", source).add("t", target);
  parts.connect("l.values[1]", "t.values[2]")
      .connect("l.values[2]", "t.tints[0].y")
      .connect("l.tints[1]", "t.tints[1]");
  EXPECT_THAT(floats(parts.run(at(7)), "t.out"), ElementsAre(700));
  EXPECT_THAT(floats(parts.run(at(7)), "t.c"), ElementsAre(1.5f, 5, 3.5f));
}

TEST(Group, ConnectsStructures) {
  const char* const source =
      "struct S { float a; color b; };\n"
      "shader s(output S value = {1, 2}) { value.a = u; value.b = color(u, v, 0); }";
  const char* const target =
      "struct T { float a; color b; };\n"
      "shader t(T value = {5, 6}, output float a = 0, output color b = 0) {\n"
      "  a = value.a;\n  b = value.b;\n}";
  Builder whole;
  whole.add("s", source).add("t", target).connect("s.value", "t.value");
  EXPECT_THAT(floats(whole.run(at(3, 4)), "t.a"), ElementsAre(3));
  EXPECT_THAT(floats(whole.run(at(3, 4)), "t.b"), ElementsAre(3, 4, 0));
  Builder field;
  field.add("s", source).add("t", target).connect("s.value.b.g", "t.value.a");
  EXPECT_THAT(floats(field.run(at(3, 4)), "t.a"), ElementsAre(4));
  EXPECT_THAT(floats(field.run(at(3, 4)), "t.b"), ElementsAre(6, 6, 6));
}

TEST(Group, ConnectsClosures) {
  Builder group;
  group.add("d", "shader d(output closure color bsdf = 0) { bsdf = u * diffuse(N); }");
  group.add("t", "shader t(output closure color bsdf = 0) { bsdf = transparent(); }");
  group.add("m",
            "surface m(closure color a = 0, closure color b = 0, closure color c = emission()) {\n"
            "  Ci = 2 * a + 0.5 * b + c;\n}");
  group.connect("d.bsdf", "m.a").connect("t.bsdf", "m.b");
  PointInputs inputs = at(3);
  inputs.globals["N"] = {0, 0, 1};
  const PointResult result = group.run(inputs);
  EXPECT_THAT(floats(result, "siteWeight0"), ElementsAre(6, 6, 6));
  EXPECT_THAT(floats(result, "siteWeight1"), ElementsAre(0.5f, 0.5f, 0.5f));
  EXPECT_THAT(floats(result, "siteWeight2"), ElementsAre(1, 1, 1));
  EXPECT_THAT(floats(result, "siteParameter0.0"), ElementsAre(0, 0, 1));
}

TEST(Group, FeedsAVolume) {
  Builder group;
  group.add("w", wave).add("v", "volume v(float density = 1) { Ci = anisotropic_vdf(0.5, color(density), 0.25); }");
  group.connect("w.value", "v.density");
  EXPECT_THAT(floats(group.run(at(3)), "sigmaT"), ElementsAre(6, 6, 6));
  EXPECT_TRUE(group.merged().isVolume());
}

TEST(Group, LeavesOutWhatIsNotNeeded) {
  Builder group;
  group.add("unused", talk).add("w", wave).add("s", sum).connect("w.value", "s.a");
  EXPECT_THAT(group.run(at(1)).messages, IsEmpty());
}

TEST(Group, RunsALayerWhereItIsRead) {
  Builder group;
  group.add("t", talk).add("m",
                           "shader m(float x = 0, output float out = 0) {\n"
                           "  printf(\"before\");\n  if (u > 0) out = x;\n  printf(\"after\");\n}");
  group.connect("t.out", "m.x");
  EXPECT_THAT(group.run(at(1)).messages, ElementsAre("print: before", "print: it 0", "print: after"));
  EXPECT_THAT(group.run(at(-1)).messages, ElementsAre("print: before", "print: after"));
}

TEST(Group, RunsALayerOnce) {
  Builder group;
  group.add("t", talk).add("m",
                           "shader m(float x = 0, output float out = 0) {\n"
                           "  if (u > 0) out = x;\n  if (v > 0) out += x;\n  printf(\"end\");\n}");
  group.connect("t.out", "m.x");
  EXPECT_THAT(group.run(at(1, 1)).messages, ElementsAre("print: it 0", "print: end"));
  EXPECT_THAT(group.run(at(-1, 1)).messages, ElementsAre("print: it 0", "print: end"));
  EXPECT_THAT(group.run(at(-1, -1)).messages, ElementsAre("print: end"));
  EXPECT_THAT(floats(group.run(at(1, 1)), "m.out"), ElementsAre(2));
}

TEST(Group, RunsALayerOnceInLoops) {
  Builder group;
  group.add("t", talk, {given("in", 4.0f)});
  group.add("m",
            "shader m(float x = 0, output float out = 0) {\n"
            "  for (int i = 0; i < 3; ++i) {\n    if (i < u) continue;\n    out += x;\n  }\n}");
  group.connect("t.out", "m.x");
  EXPECT_THAT(group.run(at(1)).messages, ElementsAre("print: it 4"));
  EXPECT_THAT(floats(group.run(at(1)), "m.out"), ElementsAre(10));
  EXPECT_THAT(group.run(at(7)).messages, IsEmpty());
}

TEST(Group, RunsALayerAfterAnEarlyReturn) {
  Builder group;
  group.add("t", talk);
  group.add("m",
            "shader m(float x = 0, output float out = 0) {\n"
            "  if (u > 0) { out = x; return; }\n  if (v > 0) return;\n  out = 2 * x;\n}");
  group.connect("t.out", "m.x");
  for (const float u : {-1.0f, 1.0f})
    for (const float v : {-1.0f, 1.0f})
      EXPECT_EQ(group.run(at(u, v)).messages.size(), u > 0 || v < 0 ? 1u : 0u) << u << " " << v;
}

TEST(Group, SharesALayerThroughOthers) {
  // b and c read a; d reads b and c under different conditions.
  Builder group;
  group.add("a", talk).add("b", talk, {given("in", 1.0f)}).add("c", talk, {given("in", 1.0f)});
  group.add("d",
            "shader d(float x = 0, float y = 0, output float out = 0) {\n"
            "  if (u > 0) out += x;\n  if (v > 0) out += y;\n}");
  group.connect("a.out", "b.in").connect("a.out", "c.in").connect("b.out", "d.x").connect("c.out", "d.y");
  EXPECT_EQ(group.run(at(1, 1)).messages.size(), 3u);
  EXPECT_EQ(group.run(at(1, -1)).messages.size(), 2u);
  EXPECT_EQ(group.run(at(-1, 1)).messages.size(), 2u);
  EXPECT_EQ(group.run(at(-1, -1)).messages.size(), 0u);
  EXPECT_THAT(floats(group.run(at(1, 1)), "d.out"), ElementsAre(4));
}

TEST(Group, EvaluatesAConditionalLayerUnderItsCondition) {
  Builder group;
  group.add("w", wave).add("m", "shader m(float x = 0, output float out = 0) { if (v > 0) out = x; }");
  group.connect("w.value", "m.x");
  const Program program = group.merged();
  ASSERT_FALSE(program.body.empty());
  const Instruction& last = program.body.back();
  ASSERT_EQ(last.op, Op::branch);
  EXPECT_GE(last.bodies[0].size(), 2u) << toString(program);
}

TEST(Group, GlobalsAreShared) {
  const char* const move = "displacement move(output float done = 0) { P += 1; done = 1; }";
  const char* const where = "shader where(float x = 0, float y = 0, output point p = 0) { p = P + x + y; }";
  Builder group;
  group.add("m", move).add("w", where).connect("m.done", "w.x");
  PointInputs inputs;
  inputs.globals["P"] = {1, 2, 3};
  // P is read before x is: the layer that moves it runs in between.
  EXPECT_THAT(floats(group.run(inputs), "w.p"), ElementsAre(3, 4, 5));
  Builder eager;
  eager.add("m", move).add("w", where).options.lazyGlobals = false;
  EXPECT_THAT(floats(eager.run(inputs), "w.p"), ElementsAre(2, 3, 4));
}

TEST(Group, OptionsRunLayersInOrder) {
  Builder group;
  group.add("a", talk).add("b", talk, {given("in", 1.0f)}).add("c", talk, {given("in", 2.0f)});
  group.connect("a.out", "b.in");
  EXPECT_THAT(group.run().messages, ElementsAre("print: it 2"));
  group.options.lazyUnconnected = false;
  EXPECT_THAT(group.run().messages, ElementsAre("print: it 0", "print: it 1", "print: it 2"));
  group.options = {};
  group.options.lazyLayers = false;
  EXPECT_THAT(group.run().messages, ElementsAre("print: it 0", "print: it 1", "print: it 2"));
}

TEST(Group, RunsEntryLayersInOrder) {
  Builder group;
  group.add("a", talk).add("b", talk, {given("in", 1.0f)}).add("c", talk, {given("in", 2.0f)});
  group.group.entryLayers = {"b", "a"};
  EXPECT_THAT(group.run().messages, ElementsAre("print: it 0", "print: it 1"));
  EXPECT_THAT(floats(group.run(), "b.out"), ElementsAre(2));
}

TEST(Group, GivesOutputsOfAnyLayer) {
  Builder group;
  group.add("w", wave).add("s", sum).connect("w.value", "s.a").output("w.tint").output("b").output("s.a");
  const PointResult result = group.run(at(3, 4));
  EXPECT_THAT(floats(result, "w.tint"), ElementsAre(3, 4, 2));
  EXPECT_THAT(floats(result, "s.b"), ElementsAre(10));
  EXPECT_THAT(floats(result, "s.a"), ElementsAre(6));
  EXPECT_THAT(floats(result, "s.total"), ElementsAre(16));
}

TEST(Group, KnowsWhatIsConnected) {
  const char* const ask =
      "shader ask(float in = 0, float other = 0, output float a = 0, output float b = 0,\n"
      "           output int all = 0) {\n"
      "  a = in;\n  b = 2;\n"
      "  all = isconnected(in) + 10 * isconnected(other) + 100 * isconnected(a);\n}";
  Builder group;
  group.add("w", wave).add("ask", ask).add("s", sum);
  group.connect("w.value", "ask.in").connect("ask.a", "s.a").output("ask.all");
  EXPECT_EQ(group.run(at(1)).outputs.at("ask.all").asInt(), 201);
}

TEST(Group, MergesInstances) {
  Builder group;
  group.add("w1", wave).add("w2", wave).add("w3", wave, {given("scale", 3.0f)});
  group.add("s1", sum).add("s2", sum).add("end",
                                          "shader e(float a = 0, float b = 0, float c = 0, output float r = 0) {\n"
                                          "  r = a + b + c;\n}");
  group.connect("w1.value", "s1.a").connect("w2.value", "s2.a");
  group.connect("s1.total", "end.a").connect("s2.total", "end.b").connect("w3.value", "end.c");
  EXPECT_EQ(group.resolved().layers.size(), 4u);
  EXPECT_THAT(floats(group.run(at(1)), "end.r"), ElementsAre(27));
  group.options.mergeInstances = false;
  EXPECT_EQ(group.resolved().layers.size(), 6u);
  EXPECT_THAT(floats(group.run(at(1)), "end.r"), ElementsAre(27));
}

TEST(Group, AParameterThatIsWrittenKeepsItsSource) {
  Builder group;
  group.add("w", wave).add("m", "shader m(output float x = 0, output float y = 0) { x += 1; y = x * 2; }");
  group.add("s", sum).connect("w.value", "m.x").connect("m.x", "s.a").connect("w.value", "s.b");
  EXPECT_THAT(floats(group.run(at(3)), "s.total"), ElementsAre(13));
}

TEST(Group, ConstantsFold) {
  Builder group;
  group.add("w", "shader c(float x = 2, output float value = 0) { value = x * 3; }").add("s", sum);
  group.connect("w.value", "s.a");
  const ResolvedGroup resolved = group.resolved();
  ParameterValues values = resolved.values;
  const Program program = group.merged();
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) values.emplace(i, ConstantValue{});
  const Program known = specialise(program, values);
  ASSERT_EQ(known.outputs.size(), 1u);
  const Variable& total = known.variables[known.outputs[0].variable];
  ASSERT_EQ(total.storage, Storage::constant) << toString(known);
  EXPECT_EQ(std::get<std::vector<float>>(total.value)[0], 16);
}

TEST(Group, KeysTellStructuresApart) {
  Builder one, two, other;
  one.add("w", wave).add("s", sum).connect("w.value", "s.a");
  two.add("w", wave, {given("scale", 9.0f)}).add("s", sum).connect("w.value", "s.a");
  other.add("w", wave).add("s", sum).connect("w.value", "s.b");
  EXPECT_EQ(one.resolved().key, two.resolved().key);
  EXPECT_NE(one.resolved().key, other.resolved().key);
}

TEST(Group, ErrorsNameWhatThereIs) {
  Builder group;
  group.add("w", wave, {given("scal", 1.0f), {"scale", types::string, std::vector<std::string>{"x"}, {"text", 4, 5}}});
  group.add("s", sum);
  group.connect("w.valeu", "s.a").connect("w.value", "s.c").connect("x.value", "s.a").connect("s.total", "w.scale");
  group.connect("w.tint", "s.a").connect("w.scale", "s.a");
  const std::string errors = group.errors();
  EXPECT_THAT(errors, HasSubstr("scal:2:3: error: shader 'wave' has no parameter 'scal'"));
  EXPECT_THAT(errors,
              HasSubstr("text:4:5: error: parameter 'scale' of shader 'wave' is a float; a string does not fit"));
  EXPECT_THAT(errors, HasSubstr("layer 'w' (shader 'wave') has no output 'valeu'"));
  EXPECT_THAT(errors, HasSubstr("did you mean 'value'?"));
  EXPECT_THAT(errors, HasSubstr("its outputs: float value, color tint"));
  EXPECT_THAT(errors, HasSubstr("layer 's' (shader 'sum') has no parameter 'c'"));
  EXPECT_THAT(errors, HasSubstr("there is no layer 'x' in this group"));
  EXPECT_THAT(errors, HasSubstr("layer 's' does not come before layer 'w'"));
  EXPECT_THAT(errors, HasSubstr("'s.a' is a float: a color ('w.tint') cannot be connected to it"));
  EXPECT_THAT(errors, HasSubstr("'w.scale' (shader 'wave') is not an output"));
}

TEST(Group, ExactTypesLeaveOutWhatDoesNotFit) {
  Builder group;
  group.options.exactTypes = true;
  group.add("s", sum, {given("a", 3), given("b", 4.0f), given("none", 1)});
  const std::string warnings = format(group.resolved().warnings);
  EXPECT_THAT(warnings, HasSubstr("attempting to set parameter with wrong type: a (expected 'float', received 'int')"));
  EXPECT_THAT(warnings, HasSubstr("nonexistent parameter: none"));
  EXPECT_THAT(floats(group.run(), "s.total"), ElementsAre(5));
}

TEST(Group, ALaterConnectionCounts) {
  Builder group;
  group.add("w", wave).add("p", paint).connect("w.value", "p.c.r").connect("w.tint", "p.c");
  EXPECT_THAT(format(group.resolved().warnings), HasSubstr("'p.c' was connected before"));
  EXPECT_THAT(floats(group.run(at(3, 4)), "p.out"), ElementsAre(6, 8, 4));
}

TEST(Group, LongChainsAndWideFansAreFast) {
  Builder chain;
  chain.add("l0", wave);
  for (int i = 1; i < 1000; ++i) {
    chain.add("l" + std::to_string(i), sum, {given("b", static_cast<float>(i % 7))});
    chain.connect("l" + std::to_string(i - 1) + (i == 1 ? ".value" : ".total"), "l" + std::to_string(i) + ".a");
  }
  float expected = 6;
  for (int i = 1; i < 1000; ++i) expected += static_cast<float>(i % 7);
  EXPECT_THAT(floats(chain.run(at(3)), "l999.total"), ElementsAre(expected));
}

/// Arrays without a length take that of what is given or connected, through several layers.
TEST(Group, fitsArraysWithoutALength) {
  const std::map<std::string, std::string> sources = {
      {"from", "shader from(output float out[3] = {1, 2, 3}) { }"},
      {"through", "shader through(float x[] = {5, 6}, output float more[] = {7}) { more[0] = x[arraylength(x) - 1]; }"},
      {"to",
       "shader to(float a[] = {1}, float b[] = {1, 2, 3, 4, 5}, string s[] = {\"s\"}) {\n"
       "  printf(\"%d %d %d %g\", arraylength(a), arraylength(b), arraylength(s), a[0] + b[1]);\n}"}};
  Builder b;
  b.add("from", sources.at("from"));
  b.add("through", sources.at("through"), {{"more", types::floating.arrayOf(4), std::vector<float>{0, 1, 2, 3}, {}}});
  b.add("to", sources.at("to"), {{"b", types::floating.arrayOf(2), std::vector<float>{10, 20}, {}}});
  b.connect("from.out", "through.x").connect("through.more", "to.a");
  CompileOptions options;
  options.standardLibrary = AEROSOL_SOURCE_DIR "/shaders/stdosl.h";
  std::vector<ArrayLengths> asked;
  const auto recompile = [&](std::size_t layer, const ArrayLengths& lengths) -> Result<std::shared_ptr<const Program>> {
    asked.push_back(lengths);
    auto source = compileString(sources.at(b.group.layers[layer].name), "test.osl", options, lengths);
    if (!source) return source.errors();
    return source->layer;
  };
  EXPECT_FALSE(fitArrays(b.group, recompile).hasErrors());
  EXPECT_EQ(asked, (std::vector<ArrayLengths>{{{"x", 3}, {"more", 4}}, {{"a", 4}, {"b", 2}}}));
  EXPECT_THAT(b.run().messages, ElementsAre("print: 4 2 1 23"));
}

}  // namespace
}  // namespace aerosol::lang
