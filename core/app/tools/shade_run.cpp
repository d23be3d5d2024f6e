#include "core/app/tools/shade_run.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "core/app/tools/shade_grid.h"
#include "core/shading/batch.h"
#include "core/shading/kernel_host.h"
#include "core/shading/message.h"

namespace aerosol::app {

namespace {

constexpr int blockPoints = 2048;
constexpr std::uint32_t loopBudget = std::numeric_limits<std::uint32_t>::max();

int componentsOf(const lang::Type& type) {
  const int elements = type.isArray() ? type.arrayLength : 1;
  return elements * (type.base == lang::BaseType::matrix ? 16 : type.element().isTriple() ? 3 : 1);
}

}  // namespace

/// Consecutive points that are shaded together.
struct GridShader::Block {
  shading::PointArrays& points;
  shading::Batch& batch;
  shading::KernelHost& host;
  GridFacts& facts;
  int first = 0, count = 0;
  std::vector<ShadedMessage> messages;
};

Result<GridShader> GridShader::create(const Toolchain& toolchain, std::shared_ptr<const lang::Program> program,
                                      std::vector<shading::ParameterValue> values,
                                      std::shared_ptr<const ShadeHost> host) {
  GridShader shader;
  shader.host_ = std::move(host);
  shading::Instance instance;
  instance.values = std::move(values);
  instance.objectToWorld = gridObjectSpace();
  instance.shaderToWorld = gridShaderSpace();
  shader.system_.add(std::move(program), std::move(instance));
  shading::ShadingOptions options;
  options.target = toolchain.target;
  options.outputsAlone = true;
  Diagnostics errors = shader.system_.compile(*toolchain.compiler, options);
  if (errors.hasErrors()) return errors;
  return shader;
}

Shaded GridShader::emptyOutputs(const ShadeGrid& grid) const {
  Shaded shaded;
  const std::size_t points = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  for (const lang::Output& asked : program().outputs) {
    if (asked.kind != lang::OutputKind::parameter) continue;
    const lang::Parameter& parameter = program().parameters[asked.index];
    ShadedOutput output{parameter.name, parameter.type, componentsOf(parameter.type), {}};
    const std::size_t count = points * static_cast<std::size_t>(output.components);
    if (parameter.type.base == lang::BaseType::integer) {
      output.values = std::vector<std::int32_t>(count);
    } else if (parameter.type.base == lang::BaseType::string) {
      output.values = std::vector<std::string>(count);
    } else {
      output.values = std::vector<float>(count);
    }
    shaded.outputs.push_back(std::move(output));
  }
  return shaded;
}

void GridShader::shadeBlock(const ShadeGrid& grid, Block& block, Shaded& shaded) const {
  block.points.shrink(0);
  for (int point = block.first; point < block.first + block.count; ++point)
    block.points.push(gridPoint(grid, point % grid.width, point / grid.width), 0);
  block.facts.begin(block.first);
  block.batch.run(block.host, block.points, 0);

  const jit::KernelInterface& interface = block.batch.interface();
  for (std::size_t i = 0; i < interface.outputs.size(); ++i) {
    const jit::OutputComponent& component = interface.outputs[i];
    const std::string& name = program().parameters[component.index].name;
    const auto output = std::ranges::find(shaded.outputs, name, &ShadedOutput::name);
    const auto place = [&](int lane) {
      return static_cast<std::size_t>(block.first + lane) * static_cast<std::size_t>(output->components) +
             component.component;
    };
    const float* lanes = block.batch.output(i);
    if (auto* floats = std::get_if<std::vector<float>>(&output->values)) {
      for (int lane = 0; lane < block.count; ++lane) (*floats)[place(lane)] = lanes[lane];
    } else if (auto* integers = std::get_if<std::vector<std::int32_t>>(&output->values)) {
      for (int lane = 0; lane < block.count; ++lane)
        (*integers)[place(lane)] = std::bit_cast<std::int32_t>(lanes[lane]);
    } else {
      auto& texts = std::get<std::vector<std::string>>(output->values);
      const auto* hashes = reinterpret_cast<const std::uint64_t*>(lanes);
      for (int lane = 0; lane < block.count; ++lane)
        texts[place(lane)] = block.host.calls().strings().text(hashes[lane]);
    }
  }

  const auto textOf = [&](std::uint64_t hash) { return block.host.calls().strings().text(hash); };
  // One point's records are in call order; points come one after the other.
  std::vector<shading::Record> records = std::move(block.host.records());
  block.host.records().clear();
  std::vector<std::pair<std::uint32_t, std::size_t>> order;
  for (std::size_t i = 0; i < records.size(); ++i) order.emplace_back(records[i].lane, i);
  std::ranges::sort(order);
  for (const auto& [lane, i] : order) {
    shading::Record& record = records[i];
    std::string text, file;
    if (record.kind == AEROSOL_REPORT_INDEX) {
      text = interface.sites[record.site].format;
    } else if (record.kind == AEROSOL_REPORT_SPACE) {
      text = textOf(record.values.at(0).s);
    } else {
      text = shading::describe(record, interface, textOf);
    }
    if (record.kind == AEROSOL_MESSAGE_FILE) file = shading::fileOf(record, textOf);
    block.messages.push_back({record.kind, shading::locationOf(record, interface), std::move(text),
                              std::move(record.values), std::move(file)});
  }
}

Shaded GridShader::run(const ShadeGrid& grid, int threads) const {
  Shaded shaded = emptyOutputs(grid);
  const int points = grid.width * grid.height;
  const int blocks = (points + blockPoints - 1) / blockPoints;
  std::vector<std::vector<ShadedMessage>> messages(static_cast<std::size_t>(blocks));
  const shading::NamedSpaces spaces = gridSpaces(grid);
  std::atomic<int> next{0};
  const auto work = [&] {
    shading::Batch batch(std::min(points, blockPoints));
    shading::PointArrays arrays;
    arrays.bind(family(), shading::Variant::outputs);
    shading::KernelHost host(spaces, loopBudget, host_->services.get());
    GridFacts facts(grid, *host_);
    host.calls().setAttributes(&host_->attributes);
    host.calls().setFacts(&facts);
    for (int i = next++; i < blocks; i = next++) {
      Block block{arrays, batch, host, facts, i * blockPoints, std::min(blockPoints, points - i * blockPoints), {}};
      shadeBlock(grid, block, shaded);
      messages[static_cast<std::size_t>(i)] = std::move(block.messages);
    }
  };
  {
    const int wanted = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::jthread> others;
    for (int i = 1; i < std::min(wanted, blocks); ++i) others.emplace_back(work);
    work();
  }
  for (std::vector<ShadedMessage>& block : messages) std::ranges::move(block, std::back_inserter(shaded.messages));
  return shaded;
}

}  // namespace aerosol::app
