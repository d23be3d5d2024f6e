#include "core/shading/shader_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/base/archive.h"
#include "core/base/code_version.h"
#include "core/base/hash.h"
#include "core/lang/array_lengths.h"
#include "core/lang/native.h"
#include "core/lang/serialize.h"
#include "core/shading/native_plugins.h"

namespace aerosol::shading {

namespace fs = std::filesystem;

namespace {

/// What the cache keeps of a source: its layer, and the files that must be as they were for it to hold.
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

std::shared_ptr<const lang::Program> fromCache(jit::ObjectCache& cache, const std::string& key,
                                               lang::NativeSource* natives) {
  const auto bytes = cache.get(key);
  if (!bytes) return nullptr;
  ArchiveReader reader(*bytes);
  Manifest manifest;
  describeManifest(reader, manifest);
  if (!reader.succeeded() || !holds(manifest)) return nullptr;
  auto program = lang::deserialiseProgram(manifest.program);
  if (!program || !lang::attachNatives(*program, natives)) return nullptr;
  return std::make_shared<const lang::Program>(std::move(*program));
}

/// Sources with warnings are not kept: the warnings would be seen only the first time.
void intoCache(jit::ObjectCache& cache, const std::string& key, const lang::CompiledSource& source) {
  if (!source.warnings.empty()) return;
  Manifest manifest;
  for (const lang::Dependency& dependency : source.dependencies) {
    manifest.paths.push_back(dependency.path.string());
    manifest.hashes.push_back(dependency.contentHash);
  }
  manifest.program = lang::serialise(*source.layer);
  ArchiveWriter writer;
  describeManifest(writer, manifest);
  cache.put(key, writer.take());
}

}  // namespace

ShaderLibrary::ShaderLibrary(std::vector<fs::path> searchPath, lang::CompileOptions options,
                             std::shared_ptr<jit::ObjectCache> cache)
    : searchPath_(std::move(searchPath)), options_(std::move(options)), cache_(std::move(cache)) {
  if (!options_.natives) options_.natives = std::make_shared<NativePlugins>(folders());
}

std::vector<fs::path> ShaderLibrary::folders() const {
  std::vector<fs::path> all;
  for (const fs::path& folder : searchPath_) {
    all.push_back(folder);
    for (const char* kind : {"volume", "surface", "displacement", "light", "texture"}) all.push_back(folder / kind);
  }
  return all;
}

std::vector<std::string> ShaderLibrary::names() const {
  std::set<std::string> names;
  for (const fs::path& folder : folders()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".osl" || extension == ".oso" || isPluginFile(entry.path()))
        names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

Result<fs::path> ShaderLibrary::fileOf(const std::string& name, const SourceLocation& use) const {
  if (name.empty() || name.find('/') != std::string::npos) {
    return Diagnostic{Severity::error, use, fmt::format("'{}' is not a shader name", name), {}, {}};
  }
  for (const fs::path& folder : folders()) {
    const fs::path source = folder / (name + ".osl"), compiled = folder / (name + ".oso");
    std::error_code ignored;
    const bool hasSource = fs::is_regular_file(source, ignored);
    if (fs::is_regular_file(compiled, ignored)) {
      const bool isOlder = hasSource && fs::last_write_time(compiled, ignored) < fs::last_write_time(source, ignored);
      return isOlder ? source : compiled;
    }
    if (hasSource) return source;
    for (const char* extension : pluginExtensions)
      if (const fs::path plugin = folder / (name + extension); fs::is_regular_file(plugin, ignored)) return plugin;
  }
  Diagnostic missing{Severity::error, use, fmt::format("unknown shader '{}'", name), {}, {}};
  const std::vector<std::string> known = names();
  if (const std::string hint = didYouMean(name, known); !hint.empty()) missing.notes.push_back(hint);
  std::string list;
  for (const std::string& each : known) list += (list.empty() ? "" : ", ") + each;
  missing.notes.push_back(known.empty() ? "the shader search path has no shaders" : "known shaders: " + list);
  return missing;
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::find(const std::string& name, const SourceLocation& use,
                                                                 Diagnostics& warnings) {
  const auto file = fileOf(name, use);
  if (!file) return file.errors();
  return load(*file, warnings);
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::findLayer(const std::string& name,
                                                                      const SourceLocation& use,
                                                                      Diagnostics& warnings) {
  const auto file = fileOf(name, use);
  if (!file) return file.errors();
  return loadLayer(*file, warnings);
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::findLayer(const std::string& name,
                                                                      const SourceLocation& use, Diagnostics& warnings,
                                                                      const std::map<std::string, int>& lengths) const {
  const auto file = fileOf(name, use);
  if (!file) return file.errors();
  auto source = isPluginFile(*file) ? compilePlugin(*file, options_) : lang::compileFile(*file, options_, lengths);
  if (!source) return source.errors();
  warnings.append(source->warnings);
  return source->layer;
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
  auto shader = loadShader(file, warnings);
  if (!shader) return shader.errors();
  return shader->program;
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::loadLayer(const fs::path& file, Diagnostics& warnings) {
  auto shader = loadShader(file, warnings);
  if (!shader) return shader.errors();
  return shader->layer;
}

Result<ShaderLibrary::Shader> ShaderLibrary::loadShader(const fs::path& file, Diagnostics& warnings) {
  std::error_code ignored;
  fs::path absolute = fs::absolute(file, ignored).lexically_normal();
  if (const auto known = loaded_.find(absolute); known != loaded_.end()) return known->second;

  const std::string key = manifestKey(file, absolute);
  Shader shader;
  if (cache_) shader.layer = fromCache(*cache_, key, options_.natives.get());
  if (shader.layer) {
    shader.program = lang::programOf(*shader.layer);
  } else {
    auto compiled = isPluginFile(file) ? compilePlugin(file, options_) : lang::compileFile(file, options_);
    if (!compiled) return compiled.errors();
    warnings.append(compiled->warnings);
    if (cache_) intoCache(*cache_, key, *compiled);
    shader = {compiled->program, compiled->layer};
  }
  return loaded_[absolute] = shader;
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::compileLayer(const std::string& text,
                                                                         const SourceLocation& place,
                                                                         Diagnostics& warnings) {
  auto& known = texts_[format(Diagnostic{Severity::note, place, {}, {}, {}}) + text];
  if (known) return known;
  // Blank lines and blanks in front, so that lines and columns are those of the file around the text.
  const auto count = [](int value) { return static_cast<std::size_t>(std::max(0, value - 1)); };
  const std::string padded = std::string(count(place.line), '\n') + std::string(count(place.column), ' ') + text;
  auto compiled = lang::compileString(padded, place.file, options_);
  if (!compiled) return compiled.errors();
  warnings.append(compiled->warnings);
  known = compiled->layer;
  return known;
}

Result<std::shared_ptr<const lang::Program>> ShaderLibrary::compile(const std::string& text, const std::string& name,
                                                                    Diagnostics& warnings) const {
  auto compiled = lang::compileString(text, name, options_);
  if (!compiled) return compiled.errors();
  warnings.append(compiled->warnings);
  return compiled->program;
}

}  // namespace aerosol::shading
