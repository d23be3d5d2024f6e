#include "core/lang/preprocessor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace aerosol::lang {
namespace {

namespace fs = std::filesystem;

/// A folder of files for one test.
class Preprocessor : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / ("aerosol_preprocessor_" + std::string(test->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  PreprocessResult run(const std::string& text) {
    request_.mainFile = (folder_ / "main.osl").string();
    request_.text = text;
    return preprocess(request_);
  }

  static std::string joined(const PreprocessResult& result) {
    std::string text;
    for (const PpToken& token : result.tokens) text += (text.empty() ? "" : " ") + std::string(token.text);
    return text;
  }

  /// The tokens, or the messages when there are any.
  std::string outcome(const std::string& text) {
    const PreprocessResult result = run(text);
    return result.diagnostics.empty() ? joined(result) : format(result.diagnostics);
  }

  static bool dependsOn(const PreprocessResult& result, const fs::path& path, bool present) {
    return std::any_of(result.dependencies.begin(), result.dependencies.end(),
                       [&](const Dependency& d) { return d.path == path && d.contentHash.empty() != present; });
  }

  fs::path folder_;
  PreprocessRequest request_;
};

TEST_F(Preprocessor, ExpandsMacros) {
  EXPECT_EQ(outcome("#define SQ(x) ((x) * (x))\n#define N 3\nSQ(N) // comment\n/* another */ end"),
            "( ( 3 ) * ( 3 ) ) end");
  EXPECT_EQ(outcome("#define CALL(f, ...) f(__VA_ARGS__)\nCALL(g, 1, 2) CALL(h)"), "g ( 1 , 2 ) h ( )");
  EXPECT_EQ(outcome("#define CAT(a, b) a##b\n#define STR(a) #a\nCAT(x, 1) STR(y z)"), "x1 \"y z\"");
  EXPECT_EQ(outcome("#define P(f, ...) f(0, ##__VA_ARGS__)\nP(g) P(g, 1)"), "g ( 0 ) g ( 0 , 1 )");
  EXPECT_EQ(outcome("__LINE__\n__LINE__"), "1 2");
}

TEST_F(Preprocessor, SelectsByConditions) {
  EXPECT_EQ(outcome("#if OSL_VERSION >= 11200 && defined(OSL_VERSION_MAJOR)\nyes\n#else\nno\n#endif"), "yes");
  EXPECT_EQ(outcome("#ifdef __clang__\nleak\n#endif\n#ifndef __cplusplus\nfine\n#endif"), "fine");
  request_.defines = {"A", "B=2", "F(x)=x+x"};
  EXPECT_EQ(outcome("#if A == 1 && B == 2\nF(y)\n#endif"), "y + y");
}

TEST_F(Preprocessor, RefusesDefinesThatAreNone) {
  for (const char* define : {"", "1A", "A B", "A=1\n#include \"x\"", "A(x"}) {
    request_.defines = {define};
    const auto result = run("x");
    ASSERT_EQ(result.diagnostics.errorCount(), 1) << define;
    EXPECT_EQ(result.diagnostics.entries()[0].message, "this is not a macro definition");
    EXPECT_FALSE(result.complete);
  }
}

TEST_F(Preprocessor, FindsIncludesBesideTheFileAndOnThePath) {
  const auto beside = write("beside.h", "beside");
  const auto onPath = write("path/found.h", "#include \"neighbour.h\"\nfound");
  write("path/neighbour.h", "neighbour");
  request_.includePaths = {folder_ / "absent", folder_ / "path"};
  const auto result = run("#include \"beside.h\"\n#include <found.h>\nmain");
  EXPECT_TRUE(result.diagnostics.empty()) << format(result.diagnostics);
  EXPECT_EQ(joined(result), "beside neighbour found main");
  EXPECT_TRUE(dependsOn(result, beside, true));
  EXPECT_TRUE(dependsOn(result, onPath, true));
  EXPECT_TRUE(dependsOn(result, folder_ / "absent", false));
}

TEST_F(Preprocessor, RecordsWhereItSearchedInVain) {
  write("b/x.h", "x");
  fs::create_directories(folder_ / "a");
  request_.includePaths = {folder_ / "a", folder_ / "b"};
  const auto result = run("#include \"x.h\"\n#if __has_include(\"y.h\")\nno\n#endif");
  EXPECT_EQ(joined(result), "x");
  EXPECT_TRUE(dependsOn(result, folder_ / "x.h", false));
  EXPECT_TRUE(dependsOn(result, folder_ / "a/x.h", false));
  EXPECT_TRUE(dependsOn(result, folder_ / "b/x.h", true));
  EXPECT_TRUE(dependsOn(result, folder_ / "b/y.h", false));
}

TEST_F(Preprocessor, HashesContents) {
  const auto path = write("x.h", "one");
  const auto hashOf = [&] {
    const auto result = run("#include \"x.h\"");
    for (const Dependency& d : result.dependencies) {
      if (d.path == path) return d.contentHash;
    }
    return std::string();
  };
  const std::string before = hashOf();
  EXPECT_EQ(before.size(), 32u);
  EXPECT_EQ(hashOf(), before);
  write("x.h", "two");
  EXPECT_NE(hashOf(), before);
}

TEST_F(Preprocessor, IncludesThePreludeOnceAndFirst) {
  request_.prelude = write("lib/stdosl.h", "#pragma once\n#define M_PI 3.5\nprelude");
  write("stdosl.h", "another");
  EXPECT_EQ(outcome("M_PI"), "prelude 3.5");
  EXPECT_EQ(outcome("#include \"stdosl.h\"\n#include <stdosl.h>\nM_PI"), "prelude 3.5");
  const auto result = run("main");
  EXPECT_TRUE(result.sourceMap->isInPrelude(result.tokens[0].position));
  EXPECT_FALSE(result.sourceMap->isInPrelude(result.tokens[1].position));
  EXPECT_EQ(result.sourceMap->location(result.tokens[1].position).line, 1);
  EXPECT_TRUE(dependsOn(result, request_.prelude, true));
}

TEST_F(Preprocessor, ReportsAMissingPrelude) {
  request_.prelude = folder_ / "absent.h";
  const auto result = run("x");
  ASSERT_EQ(result.diagnostics.errorCount(), 1);
  EXPECT_EQ(result.diagnostics.entries()[0].location.file, request_.prelude.string());
}

TEST_F(Preprocessor, LocatesTokens) {
  write("inc.h", "\n  in");
  const auto result = run("a\r\n b\\\n c\n#include \"inc.h\"\n#define M x y\n  M\n\td");
  const auto place = [&](std::size_t i) {
    const auto location = result.sourceMap->location(result.tokens.at(i).position);
    return std::to_string(location.line) + ":" + std::to_string(location.column);
  };
  ASSERT_EQ(joined(result), "a b c in x y d");
  EXPECT_EQ(place(0), "1:1");
  EXPECT_EQ(place(1), "2:2");
  EXPECT_EQ(place(2), "3:2");
  EXPECT_EQ(result.sourceMap->location(result.tokens[3].position),
            (SourceLocation{(folder_ / "inc.h").string(), 2, 3}));
  EXPECT_EQ(place(4), "6:3");
  EXPECT_EQ(place(5), "6:3");
  EXPECT_EQ(place(6), "7:2");
  EXPECT_EQ(result.sourceMap->sourceLine(result.tokens[0].position), "a");
  EXPECT_EQ(result.sourceMap->sourceLine(result.tokens[6].position), "\td");
  EXPECT_EQ(result.sourceMap->expansionNote(result.tokens[5].position),
            "expanded from macro 'M', defined at " + request_.mainFile + ":5:9");
  EXPECT_EQ(result.sourceMap->expansionNote(result.tokens[6].position), "");
}

TEST_F(Preprocessor, HonoursLineDirectives) {
  write("inc.h", "in");
  const auto result = run("a\n#line 50 \"script.txt\"\nb\n#include \"inc.h\"\nc");
  ASSERT_EQ(joined(result), "a b in c");
  const auto at = [&](std::size_t i) { return result.sourceMap->location(result.tokens[i].position); };
  EXPECT_EQ(at(0), (SourceLocation{request_.mainFile, 1, 1}));
  EXPECT_EQ(at(1), (SourceLocation{"script.txt", 50, 1}));
  EXPECT_EQ(at(2), (SourceLocation{(folder_ / "inc.h").string(), 1, 1}));
  EXPECT_EQ(at(3), (SourceLocation{"script.txt", 52, 1}));
  EXPECT_EQ(result.sourceMap->sourceLine(result.tokens[3].position), "c");
}

TEST_F(Preprocessor, ReportsWhatDirectivesSay) {
  const auto result =
      run("#error stop\n#warning careful\n#pragma error \"again\"\n#pragma warning \"soft\"\n#pragma osl "
          "nowarn\n#warning silent\n#pragma whatever\n");
  const auto& entries = result.diagnostics.entries();
  ASSERT_EQ(entries.size(), 4u);
  EXPECT_EQ(entries[0].message, "stop");
  EXPECT_EQ(entries[0].location, (SourceLocation{request_.mainFile, 1, 2}));
  EXPECT_EQ(entries[0].sourceLine, "#error stop");
  EXPECT_EQ(entries[1].severity, Severity::warning);
  EXPECT_EQ(entries[2].message, "again");
  EXPECT_EQ(entries[2].severity, Severity::error);
  EXPECT_EQ(entries[3].message, "soft");
}

TEST_F(Preprocessor, UnderstandsThePragmaOperator) {
  EXPECT_EQ(outcome("a _Pragma(\"whatever\") b _Pragma(\"osl nowarn\")\n#warning silent\nc"), "a b c");
  for (const char* text : {"_Pragma", "_Pragma(", "_Pragma(\"x\"", "_Pragma(3) x"}) {
    const auto result = run(text);
    ASSERT_EQ(result.diagnostics.errorCount(), 1) << text;
    EXPECT_EQ(result.diagnostics.entries()[0].message, "_Pragma takes a string in parentheses");
    EXPECT_EQ(result.diagnostics.entries()[0].location.column, 1);
  }
}

TEST_F(Preprocessor, NamesMissingIncludesAndWhereItLooked) {
  request_.includePaths = {folder_ / "some"};
  const auto result = run("x\n  #include \"gone.h\"\n");
  ASSERT_EQ(result.diagnostics.errorCount(), 1);
  const Diagnostic& error = result.diagnostics.entries()[0];
  EXPECT_EQ(error.message, "cannot find the included file 'gone.h'");
  EXPECT_EQ(error.location, (SourceLocation{request_.mainFile, 2, 12}));
  EXPECT_EQ(error.notes, std::vector<std::string>{"searched in '" + (folder_ / "some").string() + "'"});
  EXPECT_FALSE(result.complete);
}

TEST_F(Preprocessor, ReportsAMainFileThatCannotBeRead) {
  request_.mainFile = (folder_ / "absent.osl").string();
  EXPECT_EQ(preprocess(request_).diagnostics.entries().at(0).message,
            "cannot read this file: No such file or directory");
  request_.mainFile = folder_.string();
  EXPECT_EQ(preprocess(request_).diagnostics.entries().at(0).message, "this is a folder, not a file");
}

TEST_F(Preprocessor, RefusesWhatIsNotUtf8) {
  const auto result = run("a\n b \xff c");
  ASSERT_EQ(result.diagnostics.errorCount(), 1);
  EXPECT_EQ(result.diagnostics.entries()[0].location, (SourceLocation{request_.mainFile, 2, 4}));
  EXPECT_TRUE(run("/* \xe9 */ a").diagnostics.empty());
}

TEST_F(Preprocessor, SurvivesHostileInput) {
  std::string parentheses(30000, '(');
  for (const std::string& text :
       {std::string("#include \"main.osl\"\n#include \"main.osl\"\nx"), std::string("/* open"), std::string("#if 1\nx"),
        std::string("#pragma clang __debug crash\nx"), std::string("_Pragma(\"clang __debug llvm_fatal_error\") x"),
        std::string("#pragma clang module build m\nmodule m {}\n#pragma clang module endbuild\n"),
        std::string("\0\xff\xfe\x01\\", 5), std::string("\xef\xbb\xbfx"), "#if " + parentheses + "\n#endif\nx",
        "#define A " + parentheses + "\n#if A A A A\n#endif\nx", std::string("#embed \"main.osl\"\n"),
        std::string("#define"), std::string("#"), std::string("#line 4294967295 \"x\"\ny\nz"), std::string(),
        std::string("#include <"), std::string("#include _Pragma(\"main.osl\"\nx"),
        std::string("#include \"/dev/zero\"\n"), std::string("\"a\\")}) {
    write("main.osl", text);
    const auto result = run(text);
    EXPECT_TRUE(result.complete || result.diagnostics.hasErrors()) << text.substr(0, 40);
  }
}

TEST_F(Preprocessor, LimitsSizes) {
  const auto tooLarge = run(std::string(maximumSourceBytes + 1, ' '));
  ASSERT_EQ(tooLarge.diagnostics.errorCount(), 1);
  EXPECT_EQ(tooLarge.diagnostics.entries()[0].message, "this file is larger than 16 MiB");

  const auto longDirective = run("x\n# if " + std::string(100000, '(') + "\n#endif");
  ASSERT_EQ(longDirective.diagnostics.errorCount(), 1);
  EXPECT_EQ(longDirective.diagnostics.entries()[0].location.line, 2);

  std::string bomb = "#define A0 x\n";
  for (int i = 1; i < 20; ++i) {
    const std::string a = " A" + std::to_string(i - 1);
    bomb += "#define A" + std::to_string(i) + a + a + a + a + "\n";
  }
  const auto tooMany = run(bomb + "A19");
  ASSERT_EQ(tooMany.diagnostics.errorCount(), 1);
  EXPECT_EQ(tooMany.diagnostics.entries()[0].message, "the source is too long after preprocessing");
  EXPECT_FALSE(tooMany.complete);
}

}  // namespace
}  // namespace aerosol::lang
