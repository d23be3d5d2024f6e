#include "core/jit/compiler.h"

#include <chrono>
#include <fstream>
#include <iterator>
#include <mutex>

#include "core/base/code_version.h"
#include "core/base/hash.h"
#include "core/base/paths.h"
#include "core/jit/backend.h"
#include "core/jit/bytes.h"
#include "core/jit/code_loader.h"

namespace aerosol::jit {

namespace {

struct Runtime {
  std::string bitcode;
  std::string hash;
};

Diagnostic missingRuntime(const std::filesystem::path& path) {
  Diagnostic error;
  error.message = "cannot read the kernels' runtime library '" + path.string() + "'";
  return error;
}

void add(StrongHash& hash, const lang::ConstantValue& value) {
  hash.add(static_cast<std::uint64_t>(value.index()));
  std::visit(
      [&hash](const auto& leaves) {
        using Leaves = std::decay_t<decltype(leaves)>;
        if constexpr (std::is_same_v<Leaves, std::vector<std::string>>) {
          hash.add(static_cast<std::uint64_t>(leaves.size()));
          for (const std::string& text : leaves) hash.add(text);
        } else if constexpr (!std::is_same_v<Leaves, std::monostate>) {
          hash.add(std::string_view(reinterpret_cast<const char*>(leaves.data()), leaves.size() * sizeof(leaves[0])));
        }
      },
      value);
}

std::string keyOf(const KernelRequest& request, const std::string& programHash, const std::string& runtimeHash) {
  StrongHash hash;
  hash.add(codeVersion()).add(llvmVersion()).add(programHash).add(runtimeHash);
  hash.add(static_cast<std::uint64_t>(request.outputs.size()));
  for (const lang::Output& output : request.outputs) {
    hash.add(static_cast<std::uint64_t>(output.kind))
        .add(std::uint64_t{output.index})
        .add(std::uint64_t{output.subIndex});
  }
  hash.add(static_cast<std::uint64_t>(request.folded.size()));
  for (const FoldedParameter& folded : request.folded) {
    hash.add(std::uint64_t{folded.parameter});
    add(hash, folded.value);
  }
  hash.add(std::uint64_t{request.severalInstances}).add(static_cast<std::uint64_t>(request.domain));
  hash.add(std::uint64_t{request.counters}).add(std::uint64_t{request.messages});
  hash.add(static_cast<std::uint64_t>(request.target.width)).add(name(request.target.isa));
  hash.add(request.limits.frameBytes).add(request.limits.instructions);
  return "kernel-" + hash.hex();
}

}  // namespace

struct Compiler::State {
  CompilerOptions options;
  std::mutex mutex;
  std::map<std::pair<Domain, int>, std::shared_ptr<const Runtime>> runtimes;
  std::shared_ptr<CodeLoader> loader;

  Result<std::shared_ptr<const Runtime>> runtime(Domain domain, int width) {
    const std::lock_guard lock(mutex);
    std::shared_ptr<const Runtime>& known = runtimes[{domain, width}];
    if (known) return known;
    const std::string file =
        std::string("runtime_") + (domain == Domain::wide ? "wide_" : "range_") + std::to_string(width) + ".bc";
    const std::filesystem::path path = options.runtimeFolder / file;
    std::ifstream in(path, std::ios::binary);
    Runtime runtime;
    runtime.bitcode.assign(std::istreambuf_iterator<char>(in), {});
    if (!in || runtime.bitcode.empty()) return missingRuntime(path);
    runtime.hash = StrongHash().add(runtime.bitcode).hex();
    known = std::make_shared<const Runtime>(std::move(runtime));
    return known;
  }

  Result<std::shared_ptr<CodeLoader>> codeLoader() {
    const std::lock_guard lock(mutex);
    if (loader) return loader;
    auto made = CodeLoader::create();
    if (made) loader = *made;
    return made;
  }

  Result<Kernel> load(const std::string& object, KernelInterface interface, CompileTimes times);
  std::optional<Kernel> fromCache(const std::string& key);
};

Result<Kernel> Compiler::State::load(const std::string& object, KernelInterface interface, CompileTimes times) {
  const auto start = std::chrono::steady_clock::now();
  auto code = codeLoader();
  if (!code) return code.errors();
  auto loaded = (*code)->load(object);
  if (!loaded) return loaded.errors();
  times.loading += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return Kernel(loaded->code, loaded->function, std::make_shared<const KernelInterface>(std::move(interface)), times);
}

std::optional<Kernel> Compiler::State::fromCache(const std::string& key) {
  if (!options.cache) return {};
  const auto start = std::chrono::steady_clock::now();
  const std::optional<std::string> bytes = options.cache->get(key);
  if (!bytes) return {};
  ByteReader in(*bytes);
  std::string interfaceBytes, object;
  in >> interfaceBytes >> object;
  std::optional<KernelInterface> interface = deserialiseInterface(interfaceBytes);
  if (!in.atEnd() || !interface) return {};
  CompileTimes times;
  times.fromCache = true;
  times.loading = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  auto kernel = load(object, std::move(*interface), times);
  if (!kernel) return {};
  return std::move(*kernel);
}

Compiler::Compiler(std::unique_ptr<State> state) : state_(std::move(state)) {}
Compiler::~Compiler() = default;

Result<std::shared_ptr<Compiler>> Compiler::create(CompilerOptions options) {
  if (options.runtimeFolder.empty()) {
    auto installation = findInstallation();
    if (!installation) return installation.errors();
    options.runtimeFolder = installation->runtime;
  }
  auto state = std::make_unique<State>();
  state->options = std::move(options);
  return std::shared_ptr<Compiler>(new Compiler(std::move(state)));
}

Result<Kernel> Compiler::compile(const KernelRequest& request) {
  auto runtime = state_->runtime(request.domain, request.target.width);
  if (!runtime) return runtime.errors();
  std::string key;
  if (state_->options.cache) {
    const std::string program = request.programHash.empty() ? hashProgram(*request.program) : request.programHash;
    key = keyOf(request, program, (*runtime)->hash);
    if (auto kernel = state_->fromCache(key)) return std::move(*kernel);
  }
  auto generated = generateCode(request, (*runtime)->bitcode, CodeForm::object);
  if (!generated) return generated.errors();
  if (state_->options.cache) {
    ByteWriter out;
    out << serialise(generated->interface) << generated->code;
    state_->options.cache->put(key, out.take());
  }
  return state_->load(generated->code, std::move(generated->interface), generated->times);
}

std::optional<Kernel> Compiler::load(const KernelRequest& request) {
  if (!state_->options.cache) return {};
  auto runtime = state_->runtime(request.domain, request.target.width);
  if (!runtime) return {};
  if (request.programHash.empty() && !request.program) return {};
  const std::string program = request.programHash.empty() ? hashProgram(*request.program) : request.programHash;
  return state_->fromCache(keyOf(request, program, (*runtime)->hash));
}

Result<std::string> Compiler::intermediateText(const KernelRequest& request) {
  auto runtime = state_->runtime(request.domain, request.target.width);
  if (!runtime) return runtime.errors();
  auto generated = generateCode(request, (*runtime)->bitcode, CodeForm::intermediate);
  if (!generated) return generated.errors();
  return std::move(generated->code);
}

Result<std::string> Compiler::assemblyText(const KernelRequest& request) {
  auto runtime = state_->runtime(request.domain, request.target.width);
  if (!runtime) return runtime.errors();
  auto generated = generateCode(request, (*runtime)->bitcode, CodeForm::assembly);
  if (!generated) return generated.errors();
  return std::move(generated->code);
}

}  // namespace aerosol::jit
