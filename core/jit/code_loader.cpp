#include "core/jit/code_loader.h"

#include <llvm/ExecutionEngine/JITLink/JITLinkMemoryManager.h>
#include <llvm/ExecutionEngine/Orc/Core.h>
#include <llvm/ExecutionEngine/Orc/ExecutorProcessControl.h>
#include <llvm/ExecutionEngine/Orc/ObjectLinkingLayer.h>

#include <atomic>
#include <cstring>

namespace aerosol::jit {

namespace orc = llvm::orc;

namespace {

Diagnostic loadError(llvm::Error error) {
  Diagnostic diagnostic;
  diagnostic.message = "a compiled shader cannot be loaded: " + llvm::toString(std::move(error));
  return diagnostic;
}

}  // namespace

struct CodeLoader::State {
  explicit State(std::unique_ptr<orc::ExecutorProcessControl> control)
      : session(std::move(control)), linker(session, session.getExecutorProcessControl().getMemMgr()) {}

  orc::ExecutionSession session;
  orc::ObjectLinkingLayer linker;
  orc::JITDylib* support = nullptr;  ///< What code generation itself may call.
  std::atomic<std::uint64_t> count{0};
};

struct detail::LoadedCode {
  std::shared_ptr<CodeLoader> loader;
  orc::JITDylib* library = nullptr;

  LoadedCode(std::shared_ptr<CodeLoader> owner, orc::JITDylib& code) : loader(std::move(owner)), library(&code) {}
  LoadedCode(const LoadedCode&) = delete;
  LoadedCode& operator=(const LoadedCode&) = delete;
  ~LoadedCode() { llvm::consumeError(loader->state_->session.removeJITDylib(*library)); }
};

CodeLoader::CodeLoader(std::unique_ptr<State> state) : state_(std::move(state)) {}

CodeLoader::~CodeLoader() { llvm::consumeError(state_->session.endSession()); }

Result<std::shared_ptr<CodeLoader>> CodeLoader::create() {
  auto control = orc::SelfExecutorProcessControl::Create(nullptr, std::make_unique<orc::InPlaceTaskDispatcher>());
  if (!control) return loadError(control.takeError());
  auto state = std::make_unique<State>(std::move(*control));
  orc::ExecutionSession& session = state->session;
  session.setErrorReporter([](llvm::Error error) { llvm::consumeError(std::move(error)); });
  state->support = &session.createBareJITDylib("support");
  orc::SymbolMap symbols;
  const auto add = [&](const char* name, auto* function) {
    symbols[session.intern(name)] = {orc::ExecutorAddr::fromPtr(function),
                                     llvm::JITSymbolFlags::Exported | llvm::JITSymbolFlags::Callable};
  };
  add("memcpy", &std::memcpy);
  add("memmove", &std::memmove);
  add("memset", &std::memset);
  if (llvm::Error error = state->support->define(orc::absoluteSymbols(std::move(symbols)))) {
    return loadError(std::move(error));
  }
  return std::shared_ptr<CodeLoader>(new CodeLoader(std::move(state)));
}

Result<CodeLoader::Loaded> CodeLoader::load(const std::string& object) {
  orc::ExecutionSession& session = state_->session;
  const std::string name = "kernel." + std::to_string(state_->count.fetch_add(1));
  orc::JITDylib& library = session.createBareJITDylib(name);
  Loaded loaded;
  loaded.code = std::make_shared<const detail::LoadedCode>(shared_from_this(), library);
  library.addToLinkOrder(*state_->support);
  if (llvm::Error error = state_->linker.add(library, llvm::MemoryBuffer::getMemBufferCopy(object, name))) {
    return loadError(std::move(error));
  }
  auto symbol = session.lookup({&library}, session.intern("kernel"));
  if (!symbol) return loadError(symbol.takeError());
  loaded.function = symbol->getAddress().toPtr<AerosolKernel>();
  return loaded;
}

}  // namespace aerosol::jit
