#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/app/tools/compile_tool.h"
#include "core/app/tools/option_table.h"

namespace aerosol::app {

namespace {

using Problem = std::optional<std::string>;

std::string_view macroName(std::string_view define) { return define.substr(0, define.find_first_of("=(")); }

/// -Dx, -Ux and -Ix of a compiler's command line: the letter and the value are one word, or two.
class Reader {
 public:
  CompileArguments arguments;
  bool help = false;

  std::vector<OptionRow> rows();

  void define(const std::string& text) { arguments.defines.push_back(text); }
  void undefine(const std::string& name) {
    std::erase_if(arguments.defines, [&](const std::string& known) { return macroName(known) == name; });
    arguments.undefines.push_back(name);
  }
  void include(const std::string& folder) { arguments.kernels.shaderPath.emplace_back(folder); }

  /// True when the word was one of these.
  bool takeAttached(const std::string& word) {
    if (word.size() < 3 || word[0] != '-') return false;
    const std::string rest = word.substr(2);
    switch (word[1]) {
      case 'D':
        define(rest);
        return true;
      case 'U':
        undefine(rest);
        return true;
      case 'I':
        include(rest);
        return true;
      default:
        break;
    }
    if (word.starts_with("-MF") && word.size() > 3) return setDependencyText(arguments.dependencies.file, word);
    if (word.starts_with("-MT") && word.size() > 3) return setDependencyText(arguments.dependencies.target, word);
    return false;
  }

 private:
  static bool setDependencyText(std::string& target, const std::string& word) {
    target = word.substr(3);
    return true;
  }
  TakeOption dependencies(bool system, bool alone) {
    return [this, system, alone](const OptionUse&) -> Problem {
      DependencyArguments& wanted = arguments.dependencies;
      wanted.wanted = true;
      wanted.standardLibrary = wanted.standardLibrary || system;
      wanted.alone = wanted.alone || alone;
      return {};
    };
  }
};

std::vector<OptionRow> Reader::rows() {
  const TakeOption ignore = [this](const OptionUse& use) -> Problem {
    arguments.ignored.push_back(use.spelling);
    return {};
  };
  KernelArguments& kernels = arguments.kernels;
  const auto take = [](auto function) -> TakeOption {
    return [function](const OptionUse& use) -> Problem {
      function(use.value());
      return {};
    };
  };
  return {
      {"o", "FILE", "Write a compiled file [called as oslc: the shader's name with .oso]",
       setText(arguments.outputFile)},
      {"I,shader-path", "DIR", "Look for includes here; repeatable", take([this](const auto& x) { include(x); })},
      {"D", "NAME[=VALUE]", "Define a macro; repeatable", take([this](const auto& x) { define(x); })},
      {"U", "NAME", "Remove a macro; repeatable", take([this](const auto& x) { undefine(x); })},
      {"E", "", "Print what the preprocessor gives, without the standard library, and stop",
       setFlag(arguments.preprocessOnly)},
      {"Werror", "", "Warnings are errors", setFlag(arguments.warningsAreErrors)},
      {"q", "", "No word of success", setFlag(arguments.quiet)},
      {"v", "", "Say more", setFlag(arguments.verbose)},
      {"M,dependencies", "", "Print what the shader depends on, as a rule for make, and stop",
       dependencies(true, true)},
      {"MM,user-dependencies", "", "The same without the standard library", dependencies(false, true)},
      {"MD,write-dependencies", "", "Write that rule to a file beside the shader, and compile",
       dependencies(true, false)},
      {"MMD,write-user-dependencies", "", "The same without the standard library", dependencies(false, false)},
      {"MF", "FILE", "Write the rule there", setText(arguments.dependencies.file)},
      {"MT", "TARGET", "Name of the rule's target", setText(arguments.dependencies.target)},
      {"Wall,Wextra", "", "As oslc: warn of what is unused, hidden, never reached … too, as compile always does",
       setFlag(arguments.advice)},
      {"O,O0,O1,O2,O3,d,g,embed-source,buffer", "", "", ignore},
      {"width", "16|8|4|1", "Points that compiled shaders work on at once [best of the machine]",
       [&kernels](const OptionUse& use) -> Problem {
         const std::string& text = use.value();
         if (text != "16" && text != "8" && text != "4" && text != "1")
           return fmt::format("'{}' is not one of 16, 8, 4, 1", text);
         kernels.width = std::stoi(text);
         return {};
       }},
      {"isa", "avx2|avx512", "Instruction set [best of the machine]", setText(kernels.isa)},
      {"no-cache", "", "Compile all shaders anew, keep nothing", setFlag(kernels.useCache, false)},
      {"help,h", "", "Show this help", setFlag(help)},
  };
}

}  // namespace

std::string compileHelp() {
  Reader reader;
  return "Check and compile shaders: report about them, or write compiled files\n"
         "Usage: aerosol compile [OPTIONS] FILE...   (in the manner of OSL's oslc)\n\n" +
         optionHelp(reader.rows()) +
         "\nExamples:\n"
         "  aerosol compile cloud.osl                  errors, or what kernels cost\n"
         "  aerosol compile --width 8 --isa avx2 shaders/*.osl\n"
         "  aerosol compile -Iinclude -DQUALITY=2 -o cloud.oso cloud.osl\n";
}

std::variant<CompileArguments, Reply> parseCompileArguments(const std::vector<std::string>& words) {
  Reader reader;
  const auto addFile = [&reader](const std::string& name) -> Problem {
    reader.arguments.shaders.emplace_back(name);
    return {};
  };
  // Attached values are taken out first; all that they do is independent of the other words.
  std::vector<std::string> rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool isValue = i > 0 && (words[i - 1] == "-o" || words[i - 1] == "-MF" || words[i - 1] == "-MT");
    if (isValue || !reader.takeAttached(words[i])) rest.push_back(words[i]);
  }
  if (const Problem problem = readOptions(rest, reader.rows(), addFile))
    return Reply{ExitCode::usage, "aerosol: error: " + *problem + "\n"};
  if (reader.help) return Reply{ExitCode::success, compileHelp()};
  if (reader.arguments.shaders.empty())
    return Reply{ExitCode::usage, "aerosol: error: no shader is given\n  note: see: aerosol help compile\n"};
  if (reader.arguments.shaders.size() > 1 && !reader.arguments.outputFile.empty())
    return Reply{ExitCode::usage, "aerosol: error: -o names one file, but there are several shaders\n"};
  return std::move(reader.arguments);
}

}  // namespace aerosol::app
