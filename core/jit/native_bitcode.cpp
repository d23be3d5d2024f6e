#include "core/jit/native_bitcode.h"

#include <llvm/Analysis/ConstantFolding.h>
#include <llvm/Analysis/ValueTracking.h>
#include <llvm/Bitcode/BitcodeReader.h>

#include <cstddef>

#include "core/jit/llvm.h"
#include "core/jit/native_code.h"
#include "plugins/sdk/aerosol_shader.h"

namespace aerosol::jit {

namespace {

/// Reads constants out of a global variable, by the offsets that C gives its fields.
class ConstantReader {
 public:
  ConstantReader(const llvm::Module& module, const llvm::GlobalVariable& global)
      : layout_(module.getDataLayout()), initial_(global.hasInitializer() ? global.getInitializer() : nullptr) {}

  std::uint64_t integer(std::size_t offset) const {
    const auto* value = llvm::dyn_cast_or_null<llvm::ConstantInt>(at(offset, llvm::Type::getInt32Ty(context())));
    return value ? value->getZExtValue() : 0;
  }
  const llvm::Constant* pointer(std::size_t offset) const {
    const llvm::Constant* value = at(offset, llvm::PointerType::getUnqual(context()));
    return value && !value->isNullValue() ? value : nullptr;
  }
  std::string text(std::size_t offset) const {
    llvm::StringRef text;
    const llvm::Constant* value = pointer(offset);
    return value && llvm::getConstantStringInfo(value, text) ? text.str() : std::string();
  }
  std::string functionName(std::size_t offset) const {
    const llvm::Constant* value = pointer(offset);
    const auto* function = value ? llvm::dyn_cast<llvm::Function>(value->stripPointerCastsAndAliases()) : nullptr;
    return function ? function->getName().str() : std::string();
  }
  explicit operator bool() const { return initial_ != nullptr; }

 private:
  llvm::LLVMContext& context() const { return initial_->getContext(); }
  llvm::Constant* at(std::size_t offset, llvm::Type* type) const {
    if (!initial_) return nullptr;
    return llvm::ConstantFoldLoadFromConst(const_cast<llvm::Constant*>(initial_), type, llvm::APInt(64, offset),
                                           layout_);
  }

  const llvm::DataLayout& layout_;
  const llvm::Constant* initial_;
};

Diagnostic problem(std::string text) { return Diagnostic{.message = std::move(text)}; }

}  // namespace

Result<NativeBitcode> readNativeBitcode(std::string_view bytes) {
  llvm::LLVMContext context;
  auto module = llvm::parseBitcodeFile(llvm::MemoryBufferRef(bytes, "plugin"), context);
  if (!module) return problem("this is no bitcode of LLVM 19 or older: " + llvm::toString(module.takeError()));
  const llvm::GlobalVariable* global = (*module)->getNamedGlobal("aerosol_shader_plugin");
  if (!global || !global->hasInitializer()) return problem("it does not export 'aerosol_shader_plugin'");
  const ConstantReader plugin(**module, *global);
  if (const std::uint64_t abi = plugin.integer(offsetof(AerosolShaderPlugin, abi)); abi != AEROSOL_SHADER_ABI) {
    return problem("it was built for version " + std::to_string(abi) +
                   " of the plugin interface, and this is version " + std::to_string(AEROSOL_SHADER_ABI));
  }
  if (plugin.pointer(offsetof(AerosolShaderPlugin, initialise)))
    return problem("it has an initialiser, which only shared objects may have");
  if (const std::string missing = findMissing(**module); !missing.empty()) return problem(missing);

  NativeBitcode result;
  result.name = plugin.text(offsetof(AerosolShaderPlugin, name));
  result.shader = plugin.text(offsetof(AerosolShaderPlugin, shader));
  const llvm::Constant* table = plugin.pointer(offsetof(AerosolShaderPlugin, functions));
  const auto* tableGlobal = table ? llvm::dyn_cast<llvm::GlobalVariable>(table->stripPointerCasts()) : nullptr;
  const std::uint64_t count = plugin.integer(offsetof(AerosolShaderPlugin, functionCount));
  if (count > 0 && (!tableGlobal || !tableGlobal->hasInitializer()))
    return problem("its table of functions is missing");
  for (std::uint64_t i = 0; i < count; ++i) {
    const ConstantReader rows(**module, *tableGlobal);
    const std::size_t row = i * sizeof(AerosolShaderFunction);
    NativeBitcode::Function function;
    function.declaration = rows.text(row + offsetof(AerosolShaderFunction, declaration));
    function.evaluate = rows.functionName(row + offsetof(AerosolShaderFunction, evaluate));
    function.range = rows.functionName(row + offsetof(AerosolShaderFunction, range));
    if (function.declaration.empty() || function.evaluate.empty())
      return problem("its function number " + std::to_string(i + 1) + " has no declaration or no code");
    result.functions.push_back(std::move(function));
  }
  return result;
}

}  // namespace aerosol::jit
