#include "tests/unit/jit/kernel_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <stdexcept>

#include "core/base/hash.h"

namespace aerosol::jit::test {

namespace {

/// An array as kernels demand it: aligned to 64 bytes, padded to a multiple of 16 elements.
class Padded {
 public:
  Padded(std::size_t count, std::size_t elementBytes)
      : bytes_((count + 15) / 16 * 16 * elementBytes + 64),
        data_(static_cast<unsigned char*>(std::aligned_alloc(64, (bytes_ + 63) / 64 * 64)), &std::free) {
    std::memset(data_.get(), 0, bytes_);
  }
  void* get() const { return data_.get(); }

 private:
  std::size_t bytes_;
  std::unique_ptr<unsigned char, decltype(&std::free)> data_;
};

template <class T>
Padded padded(const std::vector<T>& values, std::size_t count) {
  Padded result(count, sizeof(T));
  if (!values.empty()) std::memcpy(result.get(), values.data(), std::min(count, values.size()) * sizeof(T));
  return result;
}

/// The host's side of a call. The context comes first, so that services find the rest.
struct Host {
  AerosolKernelContext context{};
  const KernelInterface* interface = nullptr;
  const HostSpaces* spaces = nullptr;
  HostAnswers* answers = nullptr;
  std::vector<Record> records;
};

Host& hostOf(AerosolKernelContext* context) { return *reinterpret_cast<Host*>(context); }

void recordService(AerosolKernelContext* context, std::uint32_t kind, std::uint32_t site, std::uint32_t lane,
                   const AerosolRecordValue* arguments, std::uint32_t count) {
  Host& host = hostOf(context);
  const MessageSite& known = host.interface->sites.at(site);
  EXPECT_EQ(known.kind, kind);
  Record record{kind, known.location.line, lane, {}};
  std::vector<lang::BaseType> types;
  for (const lang::Type& type : known.arguments) {
    const int elements = type.isArray() ? type.arrayLength : 1;
    const int components = type.base == lang::BaseType::matrix ? 16 : type.element().isTriple() ? 3 : 1;
    const bool isExact = type.base == lang::BaseType::integer || type.base == lang::BaseType::string;
    types.insert(types.end(), static_cast<std::size_t>(elements * components),
                 isExact ? type.base : lang::BaseType::floating);
  }
  EXPECT_EQ(types.size(), count);
  for (std::uint32_t i = 0; i < count; ++i) record.values.push_back(canonical(arguments[i].s, types.at(i)));
  host.records.push_back(std::move(record));
}

std::int32_t spaceService(AerosolKernelContext* context, std::uint64_t name, std::uint32_t instance, float time,
                          float* matrix) {
  const auto it = hostOf(context).spaces->find(name);
  if (it == hostOf(context).spaces->end()) return 0;
  std::copy(it->second.begin(), it->second.end(), matrix);
  matrix[3] += time;
  matrix[7] += static_cast<float>(instance);
  return 1;
}

void callService(AerosolKernelContext* context, const AerosolHostCall* call) {
  ASSERT_TRUE(hostOf(context).answers) << "the kernel calls a host function";
  hostOf(context).answers->call(*call);
}

}  // namespace

Batch Batch::random(std::size_t count, std::uint64_t seed) {
  Batch batch;
  batch.count = count;
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<float> uniform(-4.0f, 4.0f);
  for (std::vector<float>& values : batch.globals) {
    values.resize(count);
    for (float& value : values) value = uniform(generator);
  }
  return batch;
}

Batch Batch::pick(const std::vector<std::size_t>& points) const {
  Batch result;
  result.count = points.size();
  result.loopBudget = loopBudget;
  result.instanceData = instanceData;
  for (const std::size_t point : points) {
    for (std::size_t i = 0; i < globals.size(); ++i) {
      if (!globals[i].empty()) result.globals[i].push_back(globals[i][point]);
    }
    if (!instances.empty()) result.instances.push_back(instances[point]);
    if (!active.empty()) result.active.push_back(active[point]);
  }
  return result;
}

std::vector<Record> Outcome::recordsOf(std::size_t point) const {
  std::vector<Record> result;
  for (const Record& record : records) {
    if (record.lane != point) continue;
    result.push_back(record);
    result.back().lane = 0;
  }
  return result;
}

std::uint64_t canonical(std::uint64_t bits, lang::BaseType type) {
  if (type != lang::BaseType::floating) return bits;
  const float x = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  return x != x ? 0x7fc00000u : bits;
}

static AerosolHostServices makeServices() {
  AerosolHostServices services{};
  services.size = sizeof(services);
  services.record = &recordService;
  services.spaceToWorld = &spaceService;
  services.worldToSpace = &spaceService;
  services.call = &callService;
  return services;
}

Outcome run(const Kernel& kernel, const Batch& batch, const HostSpaces& spaces, HostAnswers* answers) {
  const KernelInterface& interface = kernel.interface();
  std::vector<Padded> arrays;
  std::vector<const float*> globals;
  for (const std::vector<float>& values : batch.globals) {
    const bool isRead = (interface.globalsRead >> globals.size() & 1u) != 0;
    arrays.push_back(padded(values, batch.count));
    globals.push_back(isRead ? static_cast<const float*>(arrays.back().get()) : nullptr);
  }
  Outcome outcome;
  std::vector<void*> outputs;
  for (const OutputComponent& output : interface.outputs) {
    const bool isText = output.type == lang::BaseType::string;
    arrays.emplace_back(batch.count, isText ? 8 : 4);
    outputs.push_back(arrays.back().get());
    for (std::size_t i = 0; i < (batch.count + 15) / 16 * 16; ++i) {
      if (isText) {
        static_cast<std::uint64_t*>(outputs.back())[i] = untouched;
      } else {
        static_cast<std::uint32_t*>(outputs.back())[i] = static_cast<std::uint32_t>(untouched);
      }
    }
  }
  const AerosolHostServices services = makeServices();
  Host host;
  host.context.services = &services;
  host.context.loopBudget = batch.loopBudget;
  host.interface = &interface;
  host.spaces = &spaces;
  host.answers = answers;
  if (answers) {
    answers->begin(interface, batch.count, [&](std::uint32_t site, std::uint32_t point, std::uint64_t text) {
      host.records.push_back({AEROSOL_REPORT_HOST, interface.hostSites.at(site).location.line, point, {text}});
    });
  }
  const Padded instances = padded(batch.instances, batch.count);
  const Padded active = padded(batch.active, batch.count);
  const Padded instanceData = padded(batch.instanceData, batch.instanceData.size());
  AerosolKernelArguments arguments{};
  arguments.context = &host.context;
  arguments.globals = globals.data();
  arguments.instances = interface.readsInstances ? static_cast<const std::int32_t*>(instances.get()) : nullptr;
  arguments.active = batch.active.empty() ? nullptr : static_cast<const std::uint32_t*>(active.get());
  arguments.instanceData =
      interface.readsInstanceData ? static_cast<const unsigned char*>(instanceData.get()) : nullptr;
  arguments.outputs = outputs.data();
  arguments.count = static_cast<std::int32_t>(batch.count);
  kernel(arguments);

  outcome.records = std::move(host.records);
  outcome.counters = host.context.counters;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const lang::BaseType type = interface.outputs[i].type;
    std::vector<std::uint64_t> bits;
    for (std::size_t point = 0; point < batch.count; ++point) {
      const std::uint64_t value = type == lang::BaseType::string ? static_cast<std::uint64_t*>(outputs[i])[point]
                                                                 : static_cast<std::uint32_t*>(outputs[i])[point];
      bits.push_back(canonical(value, type));
    }
    // Behind the last point nothing is written.
    for (std::size_t point = batch.count; point < (batch.count + 15) / 16 * 16; ++point) {
      const std::uint64_t value = type == lang::BaseType::string ? static_cast<std::uint64_t*>(outputs[i])[point]
                                                                 : static_cast<std::uint32_t*>(outputs[i])[point];
      EXPECT_EQ(value, untouched) << "output " << i << " was written behind its end";
    }
    outcome.outputs.push_back(std::move(bits));
  }
  return outcome;
}

std::filesystem::path runtimeFolder() {
  const char* const folder = std::getenv("AEROSOL_TEST_RUNTIME");
  return folder ? std::filesystem::path(folder)
                : std::filesystem::path(AEROSOL_BINARY_DIR) / "lib" / "aerosol" / "runtime";
}

Compiler& compiler() {
  static const std::shared_ptr<Compiler> shared = [] {
    auto made = Compiler::create({runtimeFolder(), nullptr});
    if (!made) throw std::runtime_error(format(made.errors()));
    return *made;
  }();
  return *shared;
}

std::vector<std::vector<Bounds>> runRange(const Kernel& kernel, const Boxes& boxes, HostAnswers* answers) {
  const KernelInterface& interface = kernel.interface();
  std::vector<Padded> arrays;
  std::vector<const float*> globals;
  for (std::size_t i = 0; i < boxes.low.size(); ++i) {
    for (const std::vector<float>* values : {&boxes.low[i], &boxes.high[i]}) {
      arrays.push_back(padded(*values, boxes.count));
      globals.push_back(static_cast<const float*>(arrays.back().get()));
    }
  }
  while (globals.size() < rangeLineStart) {
    // Nothing is known of P in object space.
    const float end = globals.size() % 2 == 0 ? -INFINITY : INFINITY;
    arrays.push_back(padded(std::vector<float>(boxes.count, end), boxes.count));
    globals.push_back(static_cast<const float*>(arrays.back().get()));
  }
  for (std::size_t component = 0; component < 3; ++component) {
    // The box's own axes.
    std::array<std::vector<float>, rangeLineParts> line;
    for (std::vector<float>& part : line) part.resize(boxes.count, 0.0f);
    for (std::size_t box = 0; box < boxes.count; ++box) {
      const float low = boxes.low[component][box], high = boxes.high[component][box];
      const float centre = std::clamp(low + 0.5f * (high - low), low, high);
      const float half = low == high ? 0.0f : std::nextafter(std::max(high - centre, centre - low), INFINITY);
      line[0][box] = centre;
      line[1 + component][box] = half;
      if (!std::isfinite(centre) || !std::isfinite(half)) line[4][box] = INFINITY;
    }
    for (const std::vector<float>& part : line) {
      arrays.push_back(padded(part, boxes.count));
      globals.push_back(static_cast<const float*>(arrays.back().get()));
    }
  }
  std::vector<void*> outputs;
  for (std::size_t i = 0; i < interface.outputs.size(); ++i) {
    arrays.emplace_back(boxes.count, 8);
    outputs.push_back(arrays.back().get());
  }
  const AerosolHostServices services = makeServices();
  const HostSpaces noSpaces;
  Host host;
  host.context.services = &services;
  host.context.loopBudget = boxes.loopBudget;
  host.interface = &interface;
  host.spaces = &noSpaces;
  host.answers = answers;
  if (answers) {
    answers->begin(interface, boxes.count, [](std::uint32_t, std::uint32_t point, std::uint64_t) {
      ADD_FAILURE() << "a report of box " << point;
    });
  }
  const Padded instanceData = padded(boxes.instanceData, boxes.instanceData.size());
  AerosolKernelArguments arguments{};
  arguments.context = &host.context;
  arguments.globals = globals.data();
  arguments.instanceData = static_cast<const unsigned char*>(instanceData.get());
  arguments.outputs = outputs.data();
  arguments.count = static_cast<std::int32_t>(boxes.count);
  kernel(arguments);

  std::vector<std::vector<Bounds>> result(boxes.count);
  for (std::size_t box = 0; box < boxes.count; ++box) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const OutputComponent& output = interface.outputs[i];
      const bool isFloat = output.type == lang::BaseType::floating;
      const double number = isFloat ? static_cast<double>(static_cast<const float*>(outputs[i])[box])
                                    : static_cast<const std::int32_t*>(outputs[i])[box];
      if (output.part == OutputPart::low) result[box].push_back({number, number, false});
      if (output.part == OutputPart::high) result[box].back().high = number;
      if (output.part == OutputPart::mayBeNan) {
        result[box].back().mayBeNan = static_cast<const std::uint32_t*>(outputs[i])[box] != 0;
      }
    }
  }
  return result;
}

std::vector<unsigned char> instanceBlock(const KernelInterface& interface, const lang::Program& program,
                                         const Values& values, const AerosolInstanceHeader& header) {
  std::vector<unsigned char> block(interface.instanceStride, 0);
  std::memcpy(block.data(), &header, sizeof(header));
  for (const InstanceField& field : interface.fields) {
    const lang::ConstantValue* value = &program.parameters[field.parameter].defaultValue;
    const bool isGiven =
        field.parameter < values.size() && !std::holds_alternative<std::monostate>(values[field.parameter]);
    if (isGiven) value = &values[field.parameter];
    unsigned char* const to = block.data() + field.offset;
    const std::int32_t flag = isGiven ? 1 : 0;
    if (field.isSetFlag) {
      std::memcpy(to, &flag, sizeof(flag));
    } else if (const auto* ints = std::get_if<std::vector<std::int32_t>>(value)) {
      std::memcpy(to, ints->data(), ints->size() * sizeof(std::int32_t));
    } else if (const auto* floats = std::get_if<std::vector<float>>(value)) {
      std::memcpy(to, floats->data(), floats->size() * sizeof(float));
    } else if (const auto* texts = std::get_if<std::vector<std::string>>(value)) {
      for (std::size_t i = 0; i < texts->size(); ++i) {
        const std::uint64_t hash = hashString((*texts)[i]);
        std::memcpy(to + i * sizeof(hash), &hash, sizeof(hash));
      }
    }
  }
  return block;
}

KernelRequest requestFor(std::shared_ptr<const lang::Program> program, int width, std::optional<Isa> isa) {
  KernelRequest request;
  request.outputs = program->outputs;
  request.program = std::move(program);
  request.target = {width, isa ? *isa : *hostIsa()};
  return request;
}

Kernel compileOrFail(const KernelRequest& request) {
  auto kernel = compiler().compile(request);
  if (!kernel) throw std::runtime_error(format(kernel.errors()));
  return std::move(*kernel);
}

}  // namespace aerosol::jit::test
