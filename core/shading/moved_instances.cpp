#include "core/shading/moved_instances.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "core/lang/abi.h"
#include "core/lang/analysis.h"
#include "core/shading/shading_system.h"

namespace aerosol::shading {

namespace {

std::string_view textOf(const lang::Program& program, lang::VariableId id) {
  const lang::Variable& variable = program.variables[id];
  const auto* texts = std::get_if<std::vector<std::string>>(&variable.value);
  return variable.storage == lang::Storage::constant && texts && !texts->empty() ? std::string_view(texts->front())
                                                                                 : std::string_view();
}

}  // namespace

void MovedInstances::place(const Family& family, std::size_t stride, std::span<const std::int32_t> instances,
                           std::span<const float> times, std::size_t padded) {
  const std::size_t count = instances.size();
  blocks_.resize(std::max<std::size_t>(count, 1) * stride);
  numbers_.assign((std::max(padded, count) + 15) / 16, {});
  for (std::size_t i = 0; i < count; ++i) {
    numbers_[i / 16][i % 16] = static_cast<std::int32_t>(i);
    unsigned char* const block = blocks_.data() + i * stride;
    if (i > 0 && instances[i] == instances[i - 1] && times[i] == times[i - 1]) {
      std::memcpy(block, block - stride, stride);
      continue;
    }
    const auto index = static_cast<std::size_t>(instances[i]);
    std::memcpy(block, family.instanceData.data() + index * stride, stride);
    const Instance& instance = family.instances[index];
    if (instance.motion) writePlacement(instance, instance.motion->at(times[i]), block);
  }
}

bool usesPlaceBeyondP(const lang::Program& program) {
  std::set<lang::VariableId> toObject, written;
  bool more = false;
  lang::forEachInstruction(program.body, [&](const lang::Instruction& instruction) {
    lang::forEachWritten(program, instruction, [&](lang::VariableId id) { written.insert(id); });
    if (instruction.op != lang::Op::call || program.functions[instruction.function].symbol != "getmatrix_i_ssm") return;
    const std::string_view from = textOf(program, instruction.arguments[0]);
    const std::string_view to = textOf(program, instruction.arguments[1]);
    more = more || from == "object" || from == "shader" || to == "shader";
    if (to == "object") toObject.insert(instruction.arguments[2]);
  });
  lang::forEachInstruction(program.body, [&](const lang::Instruction& instruction) {
    const bool isCall = instruction.op == lang::Op::call;
    const std::string_view symbol = isCall ? std::string_view(program.functions[instruction.function].symbol) : "";
    if (symbol == "getmatrix_i_ssm") return;
    for (std::size_t i = 0; i < instruction.arguments.size(); ++i) {
      if (!toObject.contains(instruction.arguments[i])) continue;
      if (symbol != "transformp_v_mv" || i != 0) {
        more = true;
        return;
      }
      const lang::VariableId point = instruction.arguments[1];
      const lang::Variable& variable = program.variables[point];
      const bool isP = variable.storage == lang::Storage::global && variable.global == lang::Global::P;
      more = more || !isP || written.contains(point);
    }
  });
  for (const lang::VariableId matrix : toObject)
    more = more || program.variables[matrix].storage != lang::Storage::temporary;
  return more;
}

}  // namespace aerosol::shading
