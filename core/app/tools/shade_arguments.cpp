#include "core/app/tools/shade_arguments.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/app/tools/option_table.h"

namespace aerosol::app {

namespace {

using Problem = std::optional<std::string>;

bool isOn(const std::string& text) { return !text.empty() && text != "0"; }

/// NAME VALUE with the modifiers of an option such as --param:type=color:interpolated=1.
Problem readNamedValue(const OptionUse& use, const std::string& name, const std::string& text, NamedValue& target) {
  target.name = name;
  std::optional<lang::Type> type;
  for (const auto& [key, setting] : use.modifiers) {
    if (key == "type") {
      type = parseType(setting);
      if (!type) return fmt::format("'{}' is not a type", setting);
    } else if (key == "lockgeom") {
      target.interpolated = !isOn(setting);
    } else if (key == "interpolated") {
      target.interpolated = isOn(setting);
    } else if (key == "interactive") {
      target.interactive = isOn(setting);
    } else {
      return fmt::format("there is no modifier '{}'; known are type, lockgeom, interpolated, interactive", key);
    }
  }
  if (!type) {
    target.value = inferValue(text);
    return {};
  }
  auto value = parseValue(*type, text);
  if (!value) return fmt::format("'{}' is not a value of type {}", text, lang::toString(*type));
  target.value = std::move(*value);
  return {};
}

/// The shader around an expression of --expr: it may set `result` and `alpha`, and reads s and t.
std::string expressionShader(const std::string& name, const std::string& expression) {
  return "shader " + name +
         "(float s = u [[ int interpolated = 1 ]], float t = v [[ int interpolated = 1 ]],\n"
         "  output color result = 0, output float alpha = 1)\n{\n" +
         expression + "\n;\n}\n";
}

/// What is being read, and the option rows that read it.
class Reader {
 public:
  ShadeArguments arguments;
  bool help = false;

  std::vector<OptionRow> rows() {
    std::vector<OptionRow> all;
    for (const auto& part : {groupRows(), gridRows(), outputRows(), runRows(), ignoredRows()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  Problem addShader(const std::string& shader, std::string layer = {}, std::string expression = {}) {
    if (layer.empty()) layer = std::exchange(layerName_, {});
    arguments.layers.push_back({shader, std::move(expression), std::move(layer), std::exchange(pending_, {})});
    return {};
  }

  /// What does not belong together.
  Problem findMistake() const {
    if (!pending_.empty()) {
      std::string names;
      for (const NamedValue& value : pending_) names += " " + value.name;
      return "parameters without a shader behind them:" + names + "\n  note: --param comes before its shader";
    }
    if (!arguments.group.empty() && !arguments.layers.empty()) return "--group and single shaders exclude each other";
    if (arguments.group.empty() && arguments.layers.empty()) return "no shader or group is given";
    return {};
  }

 private:
  std::vector<OptionRow> groupRows();
  std::vector<OptionRow> gridRows();
  std::vector<OptionRow> outputRows();
  std::vector<OptionRow> runRows();
  std::vector<OptionRow> ignoredRows();
  Problem readOptionList(const std::string& list);

  std::vector<NamedValue> pending_;  ///< Wait for their shader.
  std::string layerName_;
  int expressions_ = 0;
};

std::vector<OptionRow> Reader::groupRows() {
  return {
      {"param", "NAME VALUE", "Parameter of the next shader; --param:type=color gives its type",
       [this](const OptionUse& use) {
         return readNamedValue(use, use.values[0], use.values[1], pending_.emplace_back());
       }},
      {"shader", "SHADER LAYER", "Add a shader as a named layer; a shader's name alone does it too",
       [this](const OptionUse& use) { return addShader(use.values[0], use.values[1]); }},
      {"layer", "NAME", "Name of the next layer", setText(layerName_)},
      {"connect", "LAYER OUTPUT LAYER INPUT", "Connect an output to an input of a later layer",
       [this](const OptionUse& use) -> Problem {
         arguments.connections.push_back({use.values[0], use.values[1], use.values[2], use.values[3]});
         return {};
       }},
      {"group", "TEXT", "A whole group as text, or a file that holds it", setText(arguments.group)},
      {"groupname", "NAME", "Name of the group", setText(arguments.groupName)},
      {"expr", "CODE", "A shader that runs this code, which sets `result` and `alpha`",
       [this](const OptionUse& use) {
         const std::string name = fmt::format("expr_{}", expressions_++);
         return addShader(name, {}, expressionShader(name, use.value()));
       }},
      {"reparam", "LAYER NAME VALUE", "Change a parameter after the first iteration",
       [this](const OptionUse& use) {
         ShadeReparameter& change = arguments.reparameters.emplace_back();
         change.layer = use.values[0];
         return readNamedValue(use, use.values[1], use.values[2], change.value);
       }},
      {"archivegroup", "FILE", "Write the group as text", setText(arguments.archive)},
  };
}

std::vector<OptionRow> Reader::gridRows() {
  ShadeGrid& grid = arguments.grid;
  return {
      {"g,res", "XRES YRES", "Points of the grid [1 1]", setIntegers(grid.width, grid.height, 1)},
      {"center", "", "Points at the centres of pixels, not on the patch's border", setFlag(grid.pixelCentres)},
      {"offsetuv,offsetst", "U V", "Added to u and v [0 0]", setFloats(grid.uOffset, grid.vOffset)},
      {"scaleuv,scalest", "U V", "Factors of u and v [1 1]", setFloats(grid.uScale, grid.vScale)},
      {"vary_pdxdy", "", "Derivatives of P that differ from point to point", setFlag(grid.varyDP)},
      {"vary_udxdy", "", "The same of u", setFlag(grid.varyDU)},
      {"vary_vdxdy", "", "The same of v", setFlag(grid.varyDV)},
      {"raytype", "NAME", "What raytype() says of all points [camera]", setText(arguments.rayType)},
      {"userdata", "NAME VALUE", "What the geometry carries at all points; --userdata:type=color gives its type",
       [this](const OptionUse& use) {
         return readNamedValue(use, use.values[0], use.values[1], arguments.userData.emplace_back());
       }},
      {"userdata_isconnected", "", "Parameters that read such values count as connected",
       setFlag(arguments.userDataIsConnected)},
  };
}

std::vector<OptionRow> Reader::outputRows() {
  return {
      {"o", "VARIABLE FILE", "Write an output to an image; 'null' writes nothing; repeatable",
       [this](const OptionUse& use) -> Problem {
         arguments.outputs.push_back({use.values[0], use.values[1]});
         return {};
       }},
      {"d,od", "uint8|half|float", "Type of the pixels written [as computed]", setText(arguments.dataFormat)},
      {"print,print-outputs,print_outputs", "", "Print the outputs instead of writing images",
       setFlag(arguments.printValues)},
      {"entry", "LAYER", "Run this layer; repeatable [all that the last one needs]", addText(arguments.entryLayers)},
      {"entryoutput", "NAME", "Run what gives this output; repeatable", addText(arguments.entryOutputs)},
  };
}

/// "name=value,name=value" of --options. Those that choose how OSL compiles mean nothing here.
Problem Reader::readOptionList(const std::string& list) {
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string entry = list.substr(begin, end - begin);
    begin = end + 1;
    if (entry.starts_with("searchpath:shader=")) {
      arguments.shaderPath.push_back(entry.substr(entry.find('=') + 1));
    } else {
      arguments.ignored.push_back("--options " + entry);
    }
  }
  return {};
}

std::vector<OptionRow> Reader::runRows() {
  KernelArguments& kernels = arguments.kernels;
  return {
      {"path,shader-path", "DIR", "Look for shaders here too; repeatable", addText(arguments.shaderPath)},
      {"options", "LIST", "searchpath:shader=DIR; OSL's other options mean nothing here",
       [this](const OptionUse& use) { return readOptionList(use.value()); }},
      {"iters", "N", "Shade the grid N times [1]", setInteger(arguments.iterations, 0)},
      {"t,threads", "N", "Threads [one a processor]", setInteger(arguments.threads, 0)},
      {"runstats,stats,debug", "", "Print times and counts", setFlag(arguments.statistics)},
      {"oslquery", "", "Print the group's layers and parameters", setFlag(arguments.query)},
      {"v", "", "Say more", setFlag(arguments.verbose)},
      {"width", "16|8|4|1", "Points that compiled shaders work on at once [best of the machine]",
       [&kernels](const OptionUse& use) -> Problem {
         const std::string& text = use.value();
         if (text != "16" && text != "8" && text != "4" && text != "1") return "not one of 16, 8, 4, 1";
         kernels.width = std::stoi(text);
         return {};
       }},
      {"isa", "avx2|avx512", "Instruction set [best of the machine]", setText(kernels.isa)},
      {"no-cache", "", "Compile all shaders anew, keep nothing", setFlag(kernels.useCache, false)},
      {"help,h", "", "Show this help", setFlag(help)},
  };
}

/// Options of testshade that choose how OSL works inside, or where.
std::vector<OptionRow> Reader::ignoredRows() {
  const TakeOption ignore = [this](const OptionUse& use) -> Problem {
    arguments.ignored.push_back(use.spelling);
    return {};
  };
  std::vector<OptionRow> rows;
  rows.push_back(
      {"O0,O1,O2,debug2,llvm_debug,batched,profile,warmup,optix,saveptx,raytype_opt,debugnan,debuguninit,"
       "groupoutputs,inbuffer,no-output-placement,shadeimage,noshadeimage,"
       "use_rs_bitcode,print-groupdata,print-group-stats,optix_no_inline,optix_no_inline_layer_funcs,"
       "optix_no_merge_layer_funcs,optix_no_inline_rend_lib,optix_no_rend_lib_bitcode,"
       "optix_register_inline_funcs",
       "", "", ignore});
  rows.push_back({"llvm_opt,texoptions,colorspace,locale,jbufferMB,optix_no_inline_thresh,optix_force_inline_thresh",
                  "VALUE", "", ignore});
  return rows;
}

Reply refusal(const std::string& problem) { return {ExitCode::usage, "error: " + problem + "\n"}; }

}  // namespace

std::string shadeHelp() {
  Reader reader;
  return "Run shaders on a grid of points, print and save what they give\n"
         "Usage: aerosol shade [OPTIONS] SHADER...   (in the manner of OSL's testshade)\n\n" +
         optionHelp(reader.rows());
}

std::variant<ShadeArguments, Reply> parseShadeArguments(const std::vector<std::string>& words) {
  Reader reader;
  const auto addShader = [&reader](const std::string& name) { return reader.addShader(name); };
  if (const Problem problem = readOptions(words, reader.rows(), addShader)) return refusal(*problem);
  if (reader.help) return Reply{ExitCode::success, shadeHelp()};
  if (const Problem problem = reader.findMistake()) return refusal(*problem);
  return std::move(reader.arguments);
}

}  // namespace aerosol::app
