#include "core/render/grid_answers.h"

#include <algorithm>

#include "core/grid/temporal_file.h"

namespace aerosol::render {

namespace {

using Texts = std::vector<std::string>;

/// The name that a shader asks for; empty where it has none.
std::string nameOf(const lang::Program& program, const std::vector<shading::ParameterValue>& values,
                   lang::VariableId variable) {
  const lang::Variable& name = program.variables[variable];
  const auto textOf = [](const lang::ConstantValue& value) {
    const auto* texts = std::get_if<Texts>(&value);
    return texts && !texts->empty() ? texts->front() : std::string();
  };
  if (name.storage == lang::Storage::constant) return textOf(name.value);
  const auto given = std::ranges::find(values, name.parameter, &shading::ParameterValue::parameter);
  return textOf(given == values.end() ? program.parameters[name.parameter].defaultValue : given->value);
}

/// Of the grid of that name in all of the files; 0 where one has none that can be looked up.
int channelsOf(const VolumeFiles& files, const std::string& name, shading::Services& services) {
  int channels = 0;
  for (const std::string& path : files.names) {
    std::string problem;
    const VoxelFile* const file = name.empty() ? nullptr : services.voxels(path, problem);
    const VoxelGrid* const grid = file ? file->find(name) : nullptr;
    const int own = grid ? grid->info().channels : 0;
    if (own == 0 || (channels != 0 && channels != own)) return 0;
    channels = own;
  }
  return channels;
}

}  // namespace

const GridAnswers::Known& GridAnswers::programOf(const std::shared_ptr<const lang::Program>& program,
                                                 const lang::GridReadOptions& options) {
  const auto [place, isNew] = known_.try_emplace({program.get(), options.isBlended, options.changesInTime});
  Known& known = place->second;
  if (isNew) {
    lang::GridReads bound = lang::bindGrids(*program, options);
    known.original = program;
    if (!bound.reads.empty()) known.program = std::make_shared<const lang::Program>(std::move(bound.program));
    known.reads = std::move(bound.reads);
    known.blend = bound.blend;
  }
  return known;
}

void GridAnswers::bind(shading::BoundGroup& bound, const VolumeFiles& files, shading::Services& services) {
  if (files.names.empty()) return;
  const bool isBlended = files.names.size() > 1;
  const Known& known = programOf(bound.program, {isBlended, grid::isTemporalFile(files.names.front())});
  if (!known.program) return;
  bound.program = known.program;
  for (const lang::GridRead& read : known.reads) {
    const int channels = channelsOf(files, nameOf(*known.program, bound.values, read.name), services);
    if (channels == 0 || (channels == 3 && !read.isTriple)) continue;
    const auto give = [&](const lang::GridRead::Files& parameters, const std::string& file) {
      bound.values.push_back({channels == 3 ? parameters.vector : parameters.scalar, Texts{file}});
    };
    give(read.first, files.names.front());
    if (isBlended) give(read.second, files.names.back());
  }
  if (isBlended) bound.values.push_back({known.blend, std::vector<float>{files.blend}});
}

}  // namespace aerosol::render
