// Every library function that the language's table can ask for is in the kernels' runtime library, at every width and
// in every domain.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "core/lang/builtins.h"

namespace aerosol::jit::test {

namespace {

/// Is the name in a bitcode file's string table? Names stand there one after the other; a longer name of ours goes on
/// with a letter of a type, and none begins with one.
bool hasSymbol(const std::string& bitcode, const std::string& name) {
  for (std::size_t at = bitcode.find(name); at != std::string::npos; at = bitcode.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if (end == bitcode.size() || std::string_view("fisvmxFISVM_").find(bitcode[end]) == std::string_view::npos)
      return true;
  }
  return false;
}

std::string symbolOf(const lang::BuiltinRow& row, const lang::BuiltinOverload& overload) {
  const auto component = [&](const lang::Type& type) {
    return row.kind == lang::BuiltinKind::componentwise && type.isTriple() ? lang::types::floating : type;
  };
  std::vector<lang::Type> arguments;
  for (const lang::Type& type : overload.parameters) arguments.push_back(component(type));
  return lang::symbolOf(row.symbol, component(overload.result), arguments);
}

std::set<std::string> symbolsOfTheTable() {
  std::set<std::string> symbols;
  lang::BuiltinOverloads overloads;
  for (const lang::BuiltinRow& row : lang::builtinTable()) {
    if (row.kind == lang::BuiltinKind::special || row.kind == lang::BuiltinKind::derivative) continue;
    for (const auto& overload : overloads.find(row.name)) {
      // A name may have overloads that the host answers.
      if (overload->row->kind != lang::BuiltinKind::host) symbols.insert(symbolOf(row, *overload));
    }
  }
  return symbols;
}

/// What the lowering of special rows and of operators asks for.
std::set<std::string> symbolsOfTheLowering() {
  std::set<std::string> symbols = {"atan_f_f",        "atan2_f_ff",      "sincos_x_fff", "transformp_v_mv",
                                   "transformv_v_mv", "transformn_v_mv", "fmod_f_ff",    "inverse_m_m",
                                   "multiply_m_mm",   "divide_m_mm"};
  for (const std::string result : {"f", "v"}) {
    for (const std::string kind : {"perlin", "uperlin", "cell", "hash", "simplex", "usimplex"}) {
      for (const std::string arguments : {"f", "ff", "v", "vf"}) symbols.insert(kind + "_" + result + "_" + arguments);
    }
    for (const std::string kind : {"pperlin", "puperlin", "pcell", "phash"}) {
      for (const std::string arguments : {"ff", "ffff", "vv", "vfvf"})
        symbols.insert(kind + "_" + result + "_" + arguments);
    }
    // With partial derivatives.
    const bool isFloat = result == "f";
    for (const std::string kind : {"gperlin", "guperlin", "gsimplex", "gusimplex"}) {
      for (const std::string arguments :
           {isFloat ? "ff" : "fv", isFloat ? "ffff" : "ffvv", isFloat ? "vv" : "vvvv", isFloat ? "vfvf" : "vfvvvv"})
        symbols.insert(kind + "_" + result + "_" + arguments);
    }
    for (const std::string kind : {"gpperlin", "gpuperlin"}) {
      for (const std::string arguments : {isFloat ? "fff" : "ffv", isFloat ? "ffffff" : "ffffvv",
                                          isFloat ? "vvv" : "vvvvv", isFloat ? "vfvfvf" : "vfvfvvvv"})
        symbols.insert(kind + "_" + result + "_" + arguments);
    }
  }
  return symbols;
}

std::string readBitcode(const std::string& domain, int width) {
  const std::string path =
      std::string(AEROSOL_BINARY_DIR) + "/lib/aerosol/runtime/runtime_" + domain + "_" + std::to_string(width) + ".bc";
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(RuntimeSymbols, allAreThere) {
  std::set<std::string> symbols = symbolsOfTheTable();
  EXPECT_GT(symbols.size(), 60u);
  symbols.merge(symbolsOfTheLowering());
  for (const auto& [domain, prefix] : {std::pair("wide", "w_"), std::pair("range", "r_")}) {
    for (const int width : {1, 4, 8, 16}) {
      const std::string bitcode = readBitcode(domain, width);
      for (const std::string& symbol : symbols) {
        EXPECT_TRUE(hasSymbol(bitcode, "u_" + symbol)) << "u_" << symbol << " in " << domain << ' ' << width;
        EXPECT_TRUE(hasSymbol(bitcode, prefix + symbol)) << prefix << symbol << " in " << domain << ' ' << width;
      }
      EXPECT_FALSE(hasSymbol(bitcode, "u_no_such_f_f"));
      EXPECT_FALSE(hasSymbol(bitcode, "u_sin_f"));
    }
  }
}

}  // namespace

}  // namespace aerosol::jit::test
