// Functions of native plugins, as shaders declare them: `float f(point p) [[ string native = "plugin" ]];`
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/diagnostic.h"
#include "core/base/result.h"
#include "core/lang/program.h"

namespace aerosol::lang {

/// A function of an opened plugin. What runs is the plugin layer's own.
struct NativeFunction {
  std::string symbol;     ///< Names the function, its plugin's file and what was in it: see `nativeSymbol`.
  std::string signature;  ///< As `nativeSignature` writes it.
  bool hasRange = false;
  /// LLVM bitcode with these functions in it; null: machine code.
  std::shared_ptr<const std::string> bitcode;
  std::string evaluateName, rangeName;

  virtual ~NativeFunction() = default;
};

/// What plugins there are. Safe to use from any thread.
class NativeSource {
 public:
  virtual ~NativeSource() = default;
  /// The function with that signature of the plugin of that name; otherwise an error at `place`.
  virtual Result<std::shared_ptr<const NativeFunction>> find(const std::string& plugin, const std::string& signature,
                                                             const SourceLocation& place) = 0;
  /// By symbol; null when the plugin is not there any more, or has changed.
  virtual std::shared_ptr<const NativeFunction> findSymbol(const std::string& symbol) = 0;
};

/// What a symbol is made of.
struct NativeName {
  std::filesystem::path file;
  std::string contentHash;
  std::string signature;
};
std::string nativeSymbol(const NativeName& name);
/// Nothing for the symbol of another function.
std::optional<NativeName> parseNativeSymbol(std::string_view symbol);

/// A declaration without names of parameters and superfluous blanks: "float f(point,output int,float[3])". Nothing when
/// the text is no declaration of a function.
std::optional<std::string> nativeSignature(std::string_view declaration);

/// Gives the functions of plugins to a program that was read from a cache. False when one is not to be had.
bool attachNatives(Program& program, NativeSource* source);

}  // namespace aerosol::lang
