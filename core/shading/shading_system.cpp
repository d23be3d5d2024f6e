#include "core/shading/shading_system.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include "core/base/hash.h"
#include "core/lang/analysis.h"
#include "core/lang/reached_sites.h"

namespace aerosol::shading {

using lang::ConstantValue;

std::optional<std::uint32_t> findParameter(const lang::Program& program, const std::string& name) {
  for (std::uint32_t i = 0; i < program.parameters.size(); ++i) {
    if (program.parameters[i].name == name && !program.parameters[i].isOutput) return i;
  }
  return {};
}

const ConstantValue* valueOf(const lang::Program& program, const Instance& instance, std::uint32_t parameter) {
  for (const ParameterValue& given : instance.values) {
    if (given.parameter == parameter) return &given.value;
  }
  const lang::Parameter& p = program.parameters[parameter];
  return p.hasConstantDefault ? &p.defaultValue : nullptr;
}

InstanceRef ShadingSystem::add(std::shared_ptr<const lang::Program> program, Instance instance) {
  std::uint32_t f = 0;
  while (f < families_.size() && families_[f].program != program) ++f;
  if (f == families_.size()) {
    families_.emplace_back();
    families_.back().program = std::move(program);
  }
  families_[f].instances.push_back(std::move(instance));
  return {f, static_cast<std::uint32_t>(families_[f].instances.size() - 1)};
}

void ShadingSystem::describeObject(InstanceRef instance, std::shared_ptr<const AttributeTable> attributes,
                                   float surfaceArea) {
  Instance& described = families_[instance.family].instances[instance.index];
  described.attributes = std::move(attributes);
  described.surfaceArea = surfaceArea;
}

bool ShadingSystem::setVelocity(InstanceRef instance, const std::string& output) {
  std::string& known = families_[instance.family].velocityOutput;
  if (!known.empty() && known != output) return false;
  known = output;
  return true;
}

void ShadingSystem::showOutput(InstanceRef instance, std::uint32_t parameter) {
  std::vector<std::uint32_t>& shown = families_[instance.family].shownOutputs;
  if (std::ranges::count(shown, parameter) == 0) shown.push_back(parameter);
}

namespace {

/// Parameters with one value in all instances. Bits decide, so that -0 and 0 stay apart.
std::vector<jit::FoldedParameter> foldedParameters(const Family& family) {
  const auto sameBits = [](const ConstantValue& a, const ConstantValue& b) {
    if (a.index() != b.index()) return false;
    if (const auto* x = std::get_if<std::vector<float>>(&a)) {
      const auto& y = std::get<std::vector<float>>(b);
      return x->size() == y.size() && std::memcmp(x->data(), y.data(), x->size() * sizeof(float)) == 0;
    }
    return a == b;
  };
  std::vector<jit::FoldedParameter> folded;
  for (std::uint32_t p = 0; p < family.program->parameters.size(); ++p) {
    const ConstantValue* first = valueOf(*family.program, family.instances[0], p);
    bool equal = true;
    for (const Instance& instance : family.instances) {
      const ConstantValue* other = valueOf(*family.program, instance, p);
      equal = equal && (first && other ? sameBits(*first, *other) : first == other);
    }
    if (equal) folded.push_back({p, first ? *first : ConstantValue{}});
  }
  return folded;
}

/// Weights and parameters of the closures that some instance may return.
std::vector<lang::Output> surfaceOutputsOf(const Family& family, const std::vector<jit::FoldedParameter>& folded) {
  lang::ParameterValues values;
  for (const jit::FoldedParameter& parameter : folded) values[parameter.parameter] = parameter.value;
  const std::vector<bool> reached = lang::reachedSites(lang::specialise(*family.program, values));
  std::vector<lang::Output> chosen;
  for (const lang::Output& output : family.program->outputs) {
    const bool isOfSite = output.kind == lang::OutputKind::siteWeight || output.kind == lang::OutputKind::siteParameter;
    if (isOfSite && reached[output.index]) chosen.push_back(output);
  }
  return chosen;
}

std::vector<lang::Output> outputsOf(const Family& family, Variant variant) {
  const lang::Program& program = *family.program;
  using lang::OutputKind;
  std::size_t lobes = 0;
  bool emits = false;
  for (const lang::Output& output : program.outputs) lobes += output.kind == OutputKind::lobeAnisotropy;
  for (const lang::ClosureSite& site : program.closureSites) {
    emits = emits || site.closure == "emission" || site.closure == "uniform_edf";
  }
  std::vector<lang::Output> chosen;
  for (const lang::Output& output : program.outputs) {
    bool wanted = false;
    switch (variant) {
      case Variant::coefficients:
        wanted = output.kind == OutputKind::sigmaT || output.kind == OutputKind::sigmaS ||
                 output.kind == OutputKind::lobeAnisotropy || (output.kind == OutputKind::emission && emits) ||
                 (output.kind == OutputKind::lobeSigmaS && lobes > 1);
        break;
      case Variant::extinction:
        wanted = output.kind == OutputKind::sigmaT;
        break;
      case Variant::surface:  // See surfaceOutputsOf.
        break;
      case Variant::outputs:
        wanted = output.kind == OutputKind::parameter &&
                 (family.shownOutputs.empty() || std::ranges::count(family.shownOutputs, output.index) > 0);
        break;
      case Variant::velocity:
        wanted = output.kind == OutputKind::parameter && program.parameters[output.index].name == family.velocityOutput;
        break;
      case Variant::displacement:
        wanted = output.kind == OutputKind::displaced;
        break;
    }
    if (wanted) chosen.push_back(output);
  }
  return chosen;
}

/// No volume and no surface: it is there for its velocity.
bool givesVelocityAlone(const Family& family) {
  return !family.velocityOutput.empty() && !family.program->isVolume() && family.program->closureSites.empty();
}

void writeMatrix(const Matrix4& m, float* rows) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) rows[4 * i + j] = static_cast<float>(m[i][j]);
  }
}

}  // namespace

bool Family::moves() const {
  return std::ranges::any_of(instances, [](const Instance& instance) { return instance.motion.has_value(); });
}

void writePlacement(const Instance& instance, const Transform<World, Object>& objectToWorld, unsigned char* block) {
  AerosolInstanceHeader header;
  writeMatrix(objectToWorld.matrix(), header.objectToWorld);
  writeMatrix(objectToWorld.inverseMatrix(), header.worldToObject);
  const auto& shaderToWorld = instance.shaderToWorld ? *instance.shaderToWorld : objectToWorld;
  writeMatrix(shaderToWorld.matrix(), header.shaderToWorld);
  writeMatrix(shaderToWorld.inverseMatrix(), header.worldToShader);
  std::memcpy(block, &header, sizeof header);
}

namespace {

void writeField(const jit::InstanceField& field, const ConstantValue* value, unsigned char* block, Family& family) {
  unsigned char* at = block + field.offset;
  if (field.isSetFlag) {
    const std::int32_t isSet = value != nullptr;
    std::memcpy(at, &isSet, sizeof isSet);
    return;
  }
  if (!value) return;
  if (const auto* floats = std::get_if<std::vector<float>>(value)) {
    std::memcpy(at, floats->data(), floats->size() * sizeof(float));
  } else if (const auto* ints = std::get_if<std::vector<std::int32_t>>(value)) {
    std::memcpy(at, ints->data(), ints->size() * sizeof(std::int32_t));
  } else if (const auto* texts = std::get_if<std::vector<std::string>>(value)) {
    for (std::size_t i = 0; i < texts->size(); ++i) {
      const std::uint64_t hash = hashString((*texts)[i]);
      std::memcpy(at + i * sizeof hash, &hash, sizeof hash);
      family.strings.emplace_back(hash, (*texts)[i]);
    }
  }
}

void writeInstanceData(Family& family, const jit::KernelInterface& interface) {
  const std::size_t stride = interface.instanceStride;
  family.instanceData.assign(stride * family.instances.size(), 0);
  for (std::size_t i = 0; i < family.instances.size(); ++i) {
    const Instance& instance = family.instances[i];
    unsigned char* block = family.instanceData.data() + i * stride;
    writePlacement(instance, instance.objectToWorld, block);
    for (const jit::InstanceField& field : interface.fields) {
      const ConstantValue* value = valueOf(*family.program, instance, field.parameter);
      const bool given = std::any_of(instance.values.begin(), instance.values.end(),
                                     [&](const ParameterValue& v) { return v.parameter == field.parameter; });
      writeField(field, field.isSetFlag && !given ? nullptr : value, block, family);
    }
  }
}

jit::KernelRequest requestFor(const Family& family, Variant variant, const ShadingOptions& options) {
  jit::KernelRequest request;
  request.program = family.program;
  request.folded = foldedParameters(family);
  request.outputs = variant == Variant::surface ? surfaceOutputsOf(family, request.folded) : outputsOf(family, variant);
  request.severalInstances = family.instances.size() > 1 || family.moves();
  request.counters = options.counters;
  // What a medium says at a point is said once.
  const bool isBeside = variant == Variant::extinction || variant == Variant::velocity ||
                        (variant == Variant::outputs && !options.outputsAlone);
  request.messages = !isBeside;
  request.target = options.target;
  return request;
}

/// Calls `run(i)` for all i < count on all processors.
template <class Run>
void inParallel(std::size_t count, const Run& run) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) run(i);
  };
  std::vector<std::jthread> threads;
  const std::size_t workers = std::min<std::size_t>(count, std::max(1u, std::thread::hardware_concurrency()));
  for (std::size_t i = 1; i < workers; ++i) threads.emplace_back(work);
  work();
}

}  // namespace

Diagnostics ShadingSystem::compile(jit::Compiler& compiler, const ShadingOptions& options) {
  struct Job {
    Family* family;
    Variant variant;
    Diagnostics errors;
  };
  std::vector<Job> jobs;
  for (Family& family : families_) {
    if (!family.velocityOutput.empty()) jobs.push_back({&family, Variant::velocity, {}});
    if (options.outputsAlone || !family.shownOutputs.empty()) jobs.push_back({&family, Variant::outputs, {}});
    if (options.outputsAlone) continue;
    if (family.program->isVolume()) {
      jobs.push_back({&family, Variant::coefficients, {}});
      jobs.push_back({&family, Variant::extinction, {}});
    } else if (family.program->kind == "displacement") {
      jobs.push_back({&family, Variant::displacement, {}});
    } else if (!givesVelocityAlone(family)) {
      jobs.push_back({&family, Variant::surface, {}});
    }
  }
  inParallel(jobs.size(), [&](std::size_t i) {
    Job& job = jobs[i];
    auto kernel = compiler.compile(requestFor(*job.family, job.variant, options));
    if (kernel) {
      job.family->kernels[static_cast<std::size_t>(job.variant)] = std::move(*kernel);
    } else {
      job.errors = kernel.errors();
    }
  });
  Diagnostics errors;
  for (Job& job : jobs) {
    if (job.variant == Variant::extinction && errors.hasErrors()) continue;  // The full variant said it already.
    errors.append(job.errors);
  }
  if (errors.hasErrors()) return errors;
  for (Family& family : families_) {
    const Variant any = options.outputsAlone                     ? Variant::outputs
                        : family.program->isVolume()             ? Variant::coefficients
                        : family.program->kind == "displacement" ? Variant::displacement
                        : givesVelocityAlone(family)             ? Variant::velocity
                                                                 : Variant::surface;
    writeInstanceData(family, family.kernel(any).interface());
  }
  return errors;
}

Diagnostics ShadingSystem::compileBounds(jit::Compiler& compiler, const ShadingOptions& options) {
  std::vector<Family*> families;
  for (Family& family : families_) {
    const auto& kernel = family.kernels[static_cast<std::size_t>(Variant::coefficients)];
    if (kernel && !kernel->interface().isConstant()) families.push_back(&family);
  }
  std::vector<Family*> moving;
  for (Family& family : families_) {
    if (!family.velocityOutput.empty()) moving.push_back(&family);
  }
  std::vector<Diagnostics> errors(families.size() + moving.size());
  inParallel(errors.size(), [&](std::size_t i) {
    const bool isVelocity = i >= families.size();
    Family& family = isVelocity ? *moving[i - families.size()] : *families[i];
    jit::KernelRequest request = requestFor(family, isVelocity ? Variant::velocity : Variant::coefficients, options);
    request.domain = jit::Domain::range;
    request.messages = false;
    auto kernel = compiler.compile(request);
    if (kernel) {
      (isVelocity ? family.velocityBounds : family.bounds) = std::move(*kernel);
    } else {
      errors[i] = kernel.errors();
    }
  });
  Diagnostics all;
  for (const Diagnostics& each : errors) all.append(each);
  return all;
}

}  // namespace aerosol::shading
