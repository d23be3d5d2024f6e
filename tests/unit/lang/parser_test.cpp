#include "core/lang/parser.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/unit/lang/syntax_text.h"

namespace aerosol::lang {
namespace {

std::string parsed(const std::string& source) {
  const auto result = parseString(source, "test.osl", {});
  return result ? text(result->file) : format(result.errors());
}

/// The only statement of a shader, as text.
std::string statement(const std::string& source) {
  const std::string all = parsed("struct S { int a; };\nshader test() {\n" + source + "\n}");
  const std::string before = "struct S { int a }\nshader test() { ";
  if (!all.starts_with(before) || !all.ends_with("; }")) return all;
  return all.substr(before.size(), all.size() - before.size() - 3);
}

/// "line:column: message" of each error.
std::vector<std::string> errorsOf(const std::string& source, bool strict = false) {
  std::vector<std::string> lines;
  CompileOptions options;
  options.strict = strict;
  const auto result = parseString(source, "test.osl", options);
  if (result) return lines;
  for (const Diagnostic& entry : result.errors().entries()) {
    lines.push_back(fmt::format("{}:{}: {}", entry.location.line, entry.location.column, entry.message));
  }
  return lines;
}

std::string repeated(std::string_view piece, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += piece;
  return result;
}

TEST(Parser, BindsOperatorsAsC) {
  EXPECT_EQ(statement("a = b + c * d - e % f;"), "(= a (- (+ b (* c d)) (% e f)))");
  EXPECT_EQ(statement("a = b << c + d < e;"), "(= a (< (<< b (+ c d)) e))");
  EXPECT_EQ(statement("a = b & c == d | e ^ f && g || h;"), "(= a (|| (&& (| (& b (== c d)) (^ e f)) g) h))");
  EXPECT_EQ(statement("a = b - c - d;"), "(= a (- (- b c) d))");
  EXPECT_EQ(statement("a = not b and c or !d;"), "(= a (|| (&& (! b) c) (! d)))");
  EXPECT_EQ(statement("a = -b * ~c;"), "(= a (* (- b) (~ c)))");
  EXPECT_EQ(statement("a = -b[1].x++;"), "(= a (- (_++ (. ([] b 1) x))))");
  EXPECT_EQ(statement("++a, --b;"), "(, (++_ a) (--_ b))");
  EXPECT_EQ(statement("a = (b, c) * (d + e);"), "(= a (* (, b c) (+ d e)))");
}

TEST(Parser, GroupsAssignmentsAndConditionalsFromTheRight) {
  EXPECT_EQ(statement("a = b += c;"), "(= a (+= b c))");
  EXPECT_EQ(statement("a ? b : c ? d : e;"), "(? a b (? c d e))");
  EXPECT_EQ(statement("a = b ? c = d : e;"), "(= a (? b (= c d) e))");
  EXPECT_EQ(statement("a -= b; "), "(-= a b)");
  for (const std::string op : {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>"}) {
    EXPECT_EQ(statement("a[0] " + op + "= b;"), "(" + op + "= ([] a 0) b)");
  }
}

TEST(Parser, ReadsCallsConstructorsAndCasts) {
  EXPECT_EQ(statement("f(a, {1, 2}, g());"), "(call f a { 1 2 } (call g))");
  EXPECT_EQ(statement("color(\"hsv\", 1, 2, 3);"), "(new color \"hsv\" 1 2 3)");
  EXPECT_EQ(statement("x = S(1);"), "(= x (new S 1))");
  EXPECT_EQ(statement("x = (vector) P * 2;"), "(= x (* (cast vector P) 2))");
  EXPECT_EQ(statement("x = (float) -a;"), "(= x (cast float (- a)))");
  EXPECT_EQ(statement("x = (float(a));"), "(= x (new float a))");
  EXPECT_EQ(statement("x = f(a)[1][2];"), "(= x ([] ([] (call f a) 1) 2))");
  EXPECT_EQ(statement("x = a[b[c[0]]];"), "(= x ([] a ([] b ([] c 0))))");
}

TEST(Parser, ReadsLiterals) {
  EXPECT_EQ(statement("a = -2147483648;"), "(= a -2147483648)");
  EXPECT_EQ(statement("a = 0x1e+1;"), "(= a (+ 30 1))");
  EXPECT_EQ(statement("a = .5 + 1. + 1e3 + 2.5f;"), "(= a (+ (+ (+ 0.5f 1f) 1000f) 2.5f))");
  EXPECT_EQ(statement("a = \"x\" \"y\";"), "(= a \"xy\")");
}

TEST(Parser, ReadsDeclarations) {
  EXPECT_EQ(statement("float a, b = 3, c[2] = {1, 2};"), "float a; float b = 3; float[2] c = { 1 2 }");
  EXPECT_EQ(statement("closure color c = 0;"), "closure color c = 0");
  EXPECT_EQ(statement("S s = {1}, t[3];"), "S s = { 1 }; S[3] t");
  EXPECT_EQ(statement("int a[] = {1};"), "int[] a = { 1 }");
  EXPECT_EQ(statement("int a[2 * N];"), "int[] a@(* 2 N)");
  EXPECT_EQ(statement("float f(float x, output int n[]) { return x; }"),
            "function float f(float x; output int[] n) { return x; }");
}

TEST(Parser, ReadsControlFlow) {
  EXPECT_EQ(statement("if (a) b; else if (c) d; else { e; }"), "if a b if c d { e; }");
  EXPECT_EQ(statement("if (a) if (b) c; else d;"), "if a if b c d -");
  EXPECT_EQ(statement("while (a) { break; continue; }"), "loop - | a | - { break; continue; }");
  EXPECT_EQ(statement("do a++; while (a < 3);"), "do - | (< a 3) | - (_++ a)");
  EXPECT_EQ(statement("for (int i = 0, j = 1; i < j; ++i, --j) ;"),
            "loop int i = 0; int j = 1 | (< i j) | (, (++_ i) (--_ j)) { }");
  EXPECT_EQ(statement("for (i = 0;;) ;"), "loop (= i 0) | - | - { }");
  EXPECT_EQ(statement("for (;;) ;"), "loop - | - | - { }");
  EXPECT_EQ(statement("return;"), "return -");
  EXPECT_EQ(statement("return a, b;"), "return (, a b)");
}

TEST(Parser, ReadsShadersOfEveryKindWithMetadata) {
  EXPECT_EQ(parsed("surface a() { }"), "surface a() { }");
  EXPECT_EQ(parsed("displacement a() { }"), "displacement a() { }");
  EXPECT_EQ(
      parsed("volume a [[ string help = \"x\" \"y\", int n = 1 ]] (float b = c[d[0]] [[ float min = 0 ]],\n"
             "output color e = 0, string s[] = {\"a\"} [[ string options[2] = {\"p\", \"q\"} ]],) { }"),
      "volume a [[string help \"xy\"]] [[int n 1]](float b = ([] c ([] d 0)) [[float min 0]]; output color e = 0; "
      "string[] s = { \"a\" } [[string[2] options { \"p\" \"q\" }]]) { }");
}

TEST(Parser, ReadsKindsOfShadersAsNamesElsewhere) {
  EXPECT_EQ(parsed("float surface(float volume) { return volume; } shader shader() { float surface = 1; }"),
            "function float surface(float volume) { return volume; }\nshader shader() { float surface = 1; }");
}

TEST(Parser, ReadsFunctionsWithoutBodiesAndOperators) {
  EXPECT_EQ(parsed("float noise(string n, float x, ...) [[ int builtin = 1 ]];"),
            "function float noise(string n; float x...) [[int builtin 1]] -");
  EXPECT_EQ(parsed("struct V { float x, y[2]; color c; }; V __operator__add__(V a, V b) { return V(a.x, b.y, 0); }"),
            "struct V { float x; float[2] y; color c }\n"
            "function V __operator__add__(V a; V b) { return (new V (. a x) (. b y) 0); }");
}

TEST(Parser, PositionsPointAtOperatorsAndNames) {
  const auto result = parseString("shader a() {\n  x = b + f(c).d[1];\n}", "test.osl", {});
  ASSERT_TRUE(result);
  const auto& shader = std::get<std::unique_ptr<ShaderDeclaration>>(result->file.declarations[0]);
  const auto& body = std::get<Block>(shader->body->node);
  const auto& assign = *std::get<ExpressionStatement>(body.statements[0]->node).expression;
  const auto column = [&](const Expression& e) { return result->sourceMap->location(e.position).column; };
  EXPECT_EQ(result->sourceMap->location(assign.position).line, 2);
  EXPECT_EQ(column(assign), 5);
  const auto& sum = *std::get<Assign>(assign.node).value;
  EXPECT_EQ(column(sum), 9);
  const auto& index = *std::get<Binary>(sum.node).right;
  EXPECT_EQ(column(index), 17);
  const auto& field = *std::get<Index>(index.node).base;
  EXPECT_EQ(column(field), 16);
  EXPECT_EQ(column(*std::get<Field>(field.node).base), 11);
  EXPECT_EQ(result->sourceMap->location(shader->position).column, 8);
}

TEST(Parser, ReportsSeveralErrorsInOneRun) {
  const auto errors = errorsOf(
      "float f(float) { return 1; }\n"
      "shader a(float x = 1,\n"
      "         color = 2,\n"
      "         float z) {\n"
      "  float y = ;\n"
      "  if (x { y = 2 }\n"
      "  y = 3\n"
      "  y = 4;\n"
      "  foo(1, , 2);\n"
      "}\n"
      "shader b() { y = * 2; }\n");
  EXPECT_EQ(errors, (std::vector<std::string>{
                        "1:14: expected a parameter's name, found ')'",
                        "3:16: expected a parameter's name, found '='",
                        "4:17: expected '=' and the initial value of the parameter 'z', found ')'",
                        "5:13: expected an expression, found ';'",
                        "6:9: expected ')' after the condition, found '{'",
                        "8:3: expected ';' after the expression, found 'y'",
                        "9:10: expected an expression, found ','",
                        "11:18: expected an expression, found '*'",
                    }));
}

TEST(Parser, OnlyVariablesHaveElementsAndAreAssignedTo) {
  const auto of = [](const std::string& text) { return errorsOf("shader a() { " + text + " }", true); };
  const auto refused = [](int column, const std::string& found) {
    return std::vector<std::string>{"1:" + std::to_string(column) +
                                    ": expected an operator or the end of the expression, found '" + found +
                                    "': only variables have elements and components"};
  };
  EXPECT_EQ(of("x = f(a)[1];"), refused(22, "["));
  EXPECT_EQ(of("x = (a + b).x;"), refused(25, "."));
  EXPECT_EQ(of("x = color(1, 2, 3)[0];"), refused(32, "["));
  EXPECT_EQ(errorsOf("shader a() { x = f(a)[1] + (a + b).x; }").size(), 0u);
  EXPECT_EQ(of("(x) = 1;").size(), 1u);
  EXPECT_EQ(of("x %= 2;").size(), 1u);
  EXPECT_EQ(of("for (i = 0, j = 0; i < 2; ++i) ;").size(), 1u);
  EXPECT_EQ(of("for (i = 0; i < 2; ++i, ++j) ;").size(), 0u);
  EXPECT_EQ(of("float a[1 + 1];").size(), 1u);
  EXPECT_EQ(of("float a[2] = b;").size(), 1u);
  EXPECT_EQ(of("float catch = 1, new = 2, emit = 3;").size(), 0u);
  EXPECT_EQ(of("float union = 1;").size(), 1u);
  EXPECT_EQ(of("x = 1.5f;"), (std::vector<std::string>{"1:18: '1.5f' is not a number: numbers have no suffix"}));
  EXPECT_EQ(of("x = 0xff;").size(), 0u);
}

TEST(Parser, StopsAfterAHundredErrors) {
  const auto errors = errorsOf("shader a() {\n" + repeated("x = ;\n", 1000) + "}");
  ASSERT_EQ(errors.size(), static_cast<std::size_t>(maximumErrors));
  EXPECT_EQ(errors.back(), "101:5: expected an expression, found ';'");
}

TEST(Parser, GetsPastEveryErrorOnce) {
  for (const std::string& source :
       {"struct A { x) { int a; };", "shader a() { ) { x = 1; } }", "struct A { ; ; ) } }", "shader a(",
        "shader a() { {{1, ) { } }", "float f() { x = {1, {2; } y = ; }", "shader a(float b = {1, ) { }", ") { ) {",
        "}}}}", "shader a [[ int b = {1 ]] () { }"}) {
    const auto errors = errorsOf(source);
    EXPECT_FALSE(errors.empty()) << source;
    EXPECT_LE(errors.size(), 3u) << source;
  }
}

TEST(Parser, NamesTheBraceThatIsNotClosed) {
  EXPECT_EQ(errorsOf("shader a() {\n  if (1) {\n    x = 1;\n}\n"),
            std::vector<std::string>{"4:2: expected '}' to close the '{' on line 1, found the end of the file"});
}

TEST(Parser, LimitsNesting) {
  const auto nested = [](int n) { return "shader a() { x = " + repeated("(", n) + "1" + repeated(")", n) + "; }"; };
  EXPECT_TRUE(parseString(nested(200), "test.osl", {}));
  for (const std::string& source :
       {nested(100000), "shader a() " + repeated("{", 100000), "shader a() { x = " + repeated("-", 99999) + " 1; }",
        "shader a() { x = " + repeated("a ? b : ", 100000) + "c; }",
        "shader a() { x = " + repeated("{", 100000) + "; }", "shader a() { " + repeated("x = ", 100000) + "1; }",
        "shader a() { x = " + repeated("f(", 100000) + "; }", "shader a() { " + repeated("if (1) ", 100000) + "; }",
        "shader a() { x = " + repeated("a[", 100000) + "; }",
        "shader a() { x = " + repeated("(float) ", 100000) + "1; }"}) {
    const auto errors = errorsOf(source);
    ASSERT_EQ(errors.size(), 1u) << source.substr(0, 40);
    EXPECT_NE(errors[0].find("nested too deeply: more than 256 levels"), std::string::npos) << errors[0];
  }
}

TEST(Parser, LimitsChains) {
  EXPECT_TRUE(parseString("shader a() { x = 1" + repeated(" + a", 1000) + "; }", "test.osl", {}));
  EXPECT_TRUE(parseString("shader a() { if (1) ;" + repeated(" else if (2) ;", 1000) + " }", "test.osl", {}));
  for (const std::string& source :
       {"shader a() { x = 1" + repeated("+a", 100000) + "; }", "shader a() { x = a" + repeated("[0]", 100000) + "; }",
        "shader a() { x = a" + repeated(".x", 100000) + "; }", "shader a() { a" + repeated(",a", 100000) + "; }"}) {
    const auto errors = errorsOf(source);
    ASSERT_EQ(errors.size(), 1u) << source.substr(0, 40);
    EXPECT_NE(errors[0].find("too deep: more than 1024 operators"), std::string::npos) << errors[0];
  }
  const auto errors = errorsOf("shader a() { if (1) ;" + repeated(" else if (2) ;", 100000) + " }");
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_NE(errors[0].find("more than 1024 'else if'"), std::string::npos);
}

TEST(Parser, NotesTheMacroOfATokenThatCameFromOne) {
  const auto result = parseString("#define BAD x + ;\nshader a() {\n  y = BAD\n}", "test.osl", {});
  ASSERT_FALSE(result);
  const Diagnostic& error = result.errors().entries().at(0);
  EXPECT_EQ(error.location, (SourceLocation{"test.osl", 3, 7}));
  EXPECT_EQ(error.sourceLine, "  y = BAD");
  EXPECT_EQ(error.notes, std::vector<std::string>{"expanded from macro 'BAD', defined at test.osl:1:9"});
}

TEST(Parser, WarnsUnlessToldNotTo) {
  const auto loud = parseString("shader a() { s = \"\\d\"; }", "test.osl", {});
  ASSERT_TRUE(loud);
  ASSERT_EQ(loud->warnings.entries().size(), 1u);
  EXPECT_EQ(loud->warnings.entries()[0].location.column, 18);
  const auto quiet = parseString("shader a() {\n#pragma osl nowarn\ns = \"\\d\"; }", "test.osl", {});
  ASSERT_TRUE(quiet);
  EXPECT_TRUE(quiet->warnings.empty());
}

}  // namespace
}  // namespace aerosol::lang
