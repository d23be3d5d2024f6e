#include "core/lang/voxel_reads.h"

#include <algorithm>
#include <optional>

#include "core/lang/texture_options.h"

namespace aerosol::lang {

namespace {

class Finder {
 public:
  explicit Finder(const Program& program) : program_(program) {}

  std::vector<VoxelRead> run() {
    walk(program_.body);
    return std::move(reads_);
  }

 private:
  bool isLookup(const Instruction& instruction) const {
    return instruction.op == Op::call && program_.functions[instruction.function].symbol == "texture3d";
  }

  void walk(const Code& code) {
    for (const Instruction& instruction : code) {
      if (isLookup(instruction)) add(instruction);
      for (const Code& body : instruction.bodies) walk(body);
    }
  }

  template <class Values>
  const Values* constant(VariableId id) const {
    const Variable& variable = program_.variables[id];
    const auto* values = std::get_if<Values>(&variable.value);
    return variable.storage == Storage::constant && values && values->size() == 1 ? values : nullptr;
  }

  void add(const Instruction& instruction) {
    const auto& arguments = instruction.arguments;
    const FunctionUse& function = program_.functions[instruction.function];
    const std::size_t fixed = findTextureFunction("texture3d")->argumentCount();
    // Of what it writes one may be the message of the error.
    if (function.outputs != 0 || arguments.size() < fixed) return;
    using Strings = std::vector<std::string>;
    const Strings* const file = constant<Strings>(arguments[0]);
    if (!file) return;
    VoxelRead read{.file = file->front(), .grid = {}, .location = instruction.location};
    for (std::size_t i = fixed; i + 1 < arguments.size(); i += 2) {
      const Strings* const name = constant<Strings>(arguments[i]);
      const TextureOption* const option = name ? findTextureOption(name->front()) : nullptr;
      if (!option) return;
      if (option->kind == TextureOptionKind::missingColor || option->kind == TextureOptionKind::missingAlpha) return;
      if (option->kind != TextureOptionKind::subimage) continue;
      const auto* const text = constant<Strings>(arguments[i + 1]);
      const auto* const number = constant<std::vector<std::int32_t>>(arguments[i + 1]);
      if (!text && !number) return;
      read.grid = text ? text->front() : std::string();
      read.number = number ? number->front() : 0;
    }
    reads_.push_back(std::move(read));
  }

  const Program& program_;
  std::vector<VoxelRead> reads_;
};

}  // namespace

std::vector<VoxelRead> findVoxelReads(const Program& program, const ParameterValues& values) {
  const bool mayRead =
      std::ranges::any_of(program.functions, [](const FunctionUse& f) { return f.symbol == "texture3d"; });
  return mayRead ? Finder(specialise(program, values)).run() : std::vector<VoxelRead>();
}

}  // namespace aerosol::lang
