#include "core/jit/native_code.h"

#include <llvm/Bitcode/BitcodeReader.h>
#include <llvm/Linker/Linker.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace aerosol::jit {

namespace {

/// Functions that code generation itself may call.
bool isSupport(llvm::StringRef name) { return name == "memcpy" || name == "memset" || name == "memmove"; }

/// Intrinsics that become calls of a mathematical library.
bool callsLibrary(llvm::StringRef name) {
  static constexpr std::array<const char*, 16> bases = {"sin",  "cos", "tan",  "asin",  "acos", "atan", "sinh",  "cosh",
                                                        "tanh", "exp", "exp2", "exp10", "log",  "log2", "log10", "pow"};
  return std::ranges::any_of(bases, [&](const char* base) {
    return name.starts_with((std::string("llvm.") + base + ".").c_str()) || name.starts_with("llvm.powi.");
  });
}

/// One plugin's module, with what is called of it under the names that kernels use, and all else internal.
void takeOver(llvm::Module& plugin, const std::map<std::string, std::string>& names) {
  for (const char* const list : {"aerosol_shader_plugin", "llvm.used", "llvm.compiler.used"})
    if (llvm::GlobalVariable* global = plugin.getNamedGlobal(list)) {
      global->replaceAllUsesWith(llvm::PoisonValue::get(global->getType()));
      global->eraseFromParent();
    }
  plugin.setModuleInlineAsm("");
  // Flags of the plugin's compilation have no say in the kernel's.
  if (llvm::NamedMDNode* flags = plugin.getModuleFlagsMetadata()) flags->eraseFromParent();
  for (llvm::GlobalVariable& global : plugin.globals())
    if (!global.isDeclaration()) global.setLinkage(llvm::GlobalValue::InternalLinkage);
  for (llvm::Function& function : plugin) {
    if (function.isDeclaration()) continue;
    function.setComdat(nullptr);
    function.removeFnAttr(llvm::Attribute::OptimizeNone);
    function.removeFnAttr(llvm::Attribute::NoInline);
    const auto used = names.find(function.getName().str());
    if (used == names.end()) {
      function.setLinkage(llvm::GlobalValue::InternalLinkage);
      continue;
    }
    function.setLinkage(llvm::GlobalValue::ExternalLinkage);
    function.setVisibility(llvm::GlobalValue::DefaultVisibility);
    function.addFnAttr(llvm::Attribute::AlwaysInline);
    function.setName(used->second);
  }
}

}  // namespace

std::string nativeCodeName(const lang::NativeFunction& function, const std::string& name) {
  const auto symbol = lang::parseNativeSymbol(function.symbol);
  return "native." + (symbol ? symbol->contentHash : std::string()) + "." + name;
}

std::string linkNatives(llvm::Module& module, const lang::Program& program) {
  struct Plugin {
    std::shared_ptr<const std::string> bitcode;
    std::map<std::string, std::string> names;
  };
  std::map<std::string, Plugin> plugins;  // By the hash of what is in them: equal ones are one.
  for (const lang::FunctionUse& use : program.functions) {
    if (!use.native || !use.native->bitcode) continue;
    for (const std::string& name : {use.native->evaluateName, use.native->rangeName}) {
      const std::string called = nativeCodeName(*use.native, name);
      if (name.empty() || !module.getFunction(called)) continue;
      Plugin& plugin = plugins[lang::parseNativeSymbol(use.symbol)->contentHash];
      plugin.bitcode = use.native->bitcode;
      plugin.names[name] = called;
    }
  }
  for (const auto& [hash, plugin] : plugins) {
    auto parsed = llvm::parseBitcodeFile(llvm::MemoryBufferRef(*plugin.bitcode, "plugin"), module.getContext());
    if (!parsed) return "a plugin's bitcode cannot be read: " + llvm::toString(parsed.takeError());
    takeOver(**parsed, plugin.names);
    (*parsed)->setTargetTriple(module.getTargetTriple());
    (*parsed)->setDataLayout(module.getDataLayout());
    if (llvm::Linker::linkModules(module, std::move(*parsed))) return "a plugin's bitcode does not link";
  }
  return {};
}

std::string findMissing(const llvm::Module& module) {
  std::string names;
  const auto add = [&](llvm::StringRef name) { names += (names.empty() ? "'" : ", '") + name.str() + "'"; };
  for (const llvm::Function& function : module) {
    if (!function.isDeclaration() || function.use_empty()) continue;
    if (function.isIntrinsic() ? callsLibrary(function.getName()) : !isSupport(function.getName()))
      add(function.getName());
  }
  for (const llvm::GlobalVariable& global : module.globals())
    if (global.isDeclaration() && !global.use_empty()) add(global.getName());
  if (!names.empty()) return "it needs " + names + ", which it does not bring (bitcode has no libraries)";
  if (module.getNamedGlobal("llvm.global_ctors")) return "it has initialisers, which bitcode cannot run";
  return {};
}

}  // namespace aerosol::jit
