#include "core/shading/shader_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/base/archive.h"
#include "core/base/code_version.h"
#include "core/base/hash.h"
#include "core/lang/serialize.h"

namespace aerosol::shading {

namespace fs = std::filesystem;

namespace {

/// What the cache keeps of a source: the program, and the files that must be as they were for it to hold.
struct Manifest {
  std::vector<std::string> paths;
  std::vector<std::string> hashes;
  std::string program;
};

template <class A>
void describeManifest(A& archive, Manifest& m) {
  archive(m.paths, m.hashes, m.program);
}

bool holds(const Manifest& manifest) {
  if (manifest.paths.size() != manifest.hashes.size()) return false;
  for (std::size_t i = 0; i < manifest.paths.size(); ++i) {
    if (hashFile(manifest.paths[i]).value_or("") != manifest.hashes[i]) return false;
  }
  return true;
}

std::shared_ptr<const lang::Program> fromCache(jit::ObjectCache& cache, const std::string& key) {
  const auto bytes = cache.get(key);
  if (!bytes) return nullptr;
  ArchiveReader reader(*bytes);
  Manifest manifest;
  describeManifest(reader, manifest);
  if (!reader.succeeded() || !holds(manifest)) return nullptr;
  auto program = lang::deserialiseProgram(manifest.program);
  return program ? std::make_shared<const lang::Program>(std::move(*program)) : nullptr;
}

/// Sources with warnings are not kept: the warnings would be seen only the first time.
void intoCache(jit::ObjectCache& cache, const std::string& key, const lang::CompiledSource& source) {
  if (!source.warnings.empty()) return;
  Manifest manifest;
  for (const lang::Dependency& dependency : source.dependencies) {
    manifest.paths.push_back(dependency.path.string());
    manifest.hashes.push_back(dependency.contentHash);
  }
  manifest.program = lang::serialise(*source.program);
  ArchiveWriter writer;
  describeManifest(writer, manifest);
  cache.put(key, writer.take());
}

}  // namespace

ShaderLibrary::ShaderLibrary(std::vector<fs::path> searchPath, lang::CompileOptions options,
                             std::shared_ptr<jit::ObjectCache> cache)
    : searchPath_(std::move(searchPath)), options_(std::move(options)), cache_(std::move(cache)) {}

std::vector<fs::path> ShaderLibrary::folders() const {
  std::vector<fs::path> all;
  for (const fs::path& folder : searchPath_) {
    all.push_back(folder);
    for (const char* kind : {"volume", "surface", "light", "texture"}) all.push_back(folder / kind);
  }
  return all;
}

std::vector<std::string> ShaderLibrary::names() const {
  std::set<std::string> names;
  for (const fs::path& folder : folders()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() == ".osl") names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::find(const std::string& name, const SourceLocation& use,
                                                                 Diagnostics& warnings) {
  if (name.empty() || name.find('/') != std::string::npos) {
    return Diagnostic{Severity::error, use, fmt::format("'{}' is not a shader name", name), {}, {}};
  }
  for (const fs::path& folder : folders()) {
    const fs::path file = folder / (name + ".osl");
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) return load(file, warnings);
  }
  Diagnostic missing{Severity::error, use, fmt::format("unknown shader '{}'", name), {}, {}};
  const std::vector<std::string> known = names();
  if (const std::string hint = didYouMean(name, known); !hint.empty()) missing.notes.push_back(hint);
  std::string list;
  for (const std::string& each : known) list += (list.empty() ? "" : ", ") + each;
  missing.notes.push_back(known.empty() ? "the shader search path has no shaders" : "known shaders: " + list);
  return missing;
}

std::string ShaderLibrary::manifestKey(const fs::path& file, const fs::path& absolute) const {
  StrongHash hash;
  hash.add("aerosol source").add(codeVersion()).add(file.string());
  hash.add(absolute.string());
  for (const fs::path& path : options_.includePaths) hash.add(path.string());
  hash.add("defines");
  for (const std::string& define : options_.defines) hash.add(define);
  hash.add("undefines");
  for (const std::string& name : options_.undefines) hash.add(name);
  hash.add(options_.standardLibrary.string());
  return "source-" + hash.hex();
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::load(const fs::path& file, Diagnostics& warnings) {
  std::error_code ignored;
  fs::path absolute = fs::absolute(file, ignored).lexically_normal();
  if (const auto known = loaded_.find(absolute); known != loaded_.end()) return known->second;

  const std::string key = manifestKey(file, absolute);
  std::shared_ptr<const lang::Program> program = cache_ ? fromCache(*cache_, key) : nullptr;
  if (!program) {
    auto compiled = lang::compileFile(file, options_);
    if (!compiled) return compiled.errors();
    warnings.append(compiled->warnings);
    if (cache_) intoCache(*cache_, key, *compiled);
    program = compiled->program;
  }
  return loaded_[absolute] = program;
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::compile(const std::string& text, const std::string& name,
                                                                    Diagnostics& warnings) const {
  auto compiled = lang::compileString(text, name, options_);
  if (!compiled) return compiled.errors();
  warnings.append(compiled->warnings);
  return compiled->program;
}

}  // namespace aerosol::shading
