#include "core/app/tools/testrender_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/app/tools/option_table.h"

namespace aerosol::app {

namespace {

void appendFolders(std::string_view list, std::vector<std::filesystem::path>& folders) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(':'), list.size());
    if (end > 0) folders.emplace_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
}

struct Reader {
  RenderArguments render;
  int width = 640, height = 480, samples = 0;
  bool help = false, verbose = false;

  std::vector<OptionRow> rows() {
    const TakeOption ignore = [](const OptionUse&) -> std::optional<std::string> { return {}; };
    return {
        {"t", "N", "Render on N threads [all]", setInteger(render.threads, 0)},
        {"res,r", "W H", "Size of the image, in pixels [640 480]", setIntegers(width, height, 1)},
        {"aa", "N", "N by N samples a pixel [1]", setInteger(samples, 1)},
        {"path", "LIST", "Folders of shaders, with colons between",
         [this](const OptionUse& use) -> std::optional<std::string> {
           appendFolders(use.value(), render.kernels.shaderPath);
           return {};
         }},
        {"options", "LIST", "searchpath:shader=DIR; OSL's other options mean nothing here",
         [this](const OptionUse& use) -> std::optional<std::string> {
           constexpr std::string_view key = "searchpath:shader=";
           const std::size_t at = use.value().find(key);
           if (at == std::string::npos) return {};
           const std::string_view rest = std::string_view(use.value()).substr(at + key.size());
           appendFolders(rest.substr(0, rest.find(',')), render.kernels.shaderPath);
           return {};
         }},
        {"runstats,stats", "", "Tell what the render did", setFlag(render.statistics)},
        {"v", "", "Tell what is done", setFlag(verbose)},
        {"help,h", "", "Show this help", setFlag(help)},
        {"optix,debug,debug2,profile,saveptx,warmup,O0,O1,O2,debugnan,debug_uninit,userdata_isconnected,batched,"
         "use_rs_bitcode,gpu",
         "", "", ignore},
        {"iters,texoptions,llvm_opt", "VALUE", "", ignore},
    };
  }

  std::optional<std::string> addFile(const std::string& word) {
    if (render.scene.empty()) {
      render.scene = word;
    } else if (render.outputs.empty()) {
      render.outputs.push_back(word);
    } else {
      return fmt::format("unexpected argument '{}'", word);
    }
    return {};
  }

  std::string helpText() {
    return "Render a scene, in the manner of OSL's testrender\n"
           "Usage: testrender [OPTIONS] SCENE.xml IMAGE\n\n" +
           optionHelp(rows());
  }
};

}  // namespace

bool isTestrender(std::string_view program) { return program.substr(program.rfind('/') + 1) == "testrender"; }

std::variant<Arguments, Reply> parseTestrenderArguments(const std::vector<std::string>& words,
                                                        std::string_view shaderPath) {
  Reader reader;
  const auto refuse = [](const std::string& problem) { return Reply{ExitCode::usage, "error: " + problem + "\n"}; };
  const auto problem = readOptions(words, reader.rows(), [&](const std::string& word) { return reader.addFile(word); });
  if (problem) return refuse(*problem);
  if (reader.help) return Reply{ExitCode::success, reader.helpText()};
  if (reader.render.scene.empty()) return refuse("no scene is given");
  if (reader.render.outputs.empty()) return refuse("no image to write is given");
  appendFolders(shaderPath, reader.render.kernels.shaderPath);
  reader.render.quiet = !reader.verbose;
  reader.render.overrides = {fmt::format("film.width={}", reader.width), fmt::format("film.height={}", reader.height)};
  if (reader.samples > 0) reader.render.samplesPerPixel = reader.samples * reader.samples;
  return Arguments(std::move(reader.render));
}

}  // namespace aerosol::app
