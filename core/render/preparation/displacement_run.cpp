#include "core/render/preparation/displacement_run.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/render/mesh_user_data.h"
#include "core/shading/batch.h"
#include "core/shading/message.h"
#include "core/shading/ray_type.h"

namespace aerosol::render {

namespace {

using lang::Global;

constexpr std::size_t atOnce = 1024;

/// What the shader may ask besides the globals.
class VertexFacts final : public shading::PointFacts {
 public:
  VertexFacts(const shading::Instance& instance, const accel::TriangleMesh& mesh) : instance_(instance), mesh_(mesh) {}

  void begin(std::span<const DisplacementVertex> vertices) { vertices_ = vertices; }

  std::uint32_t rayTypes(std::uint32_t) const override { return shading::ray::displacement; }
  const shading::AttributeTable* attributes(std::uint32_t) const override { return instance_.attributes.get(); }
  std::optional<lang::Type> userData(std::uint32_t point, std::uint64_t nameHash,
                                     std::span<float, maximumUserData> values) const override {
    return meshUserData(mesh_, vertices_[point].place, nameHash, values);
  }

 private:
  const shading::Instance& instance_;
  const accel::TriangleMesh& mesh_;
  std::span<const DisplacementVertex> vertices_;
};

shading::ShadingPoint shadingPointOf(const DisplacementVertex& vertex, float time) {
  shading::ShadingPoint point;
  point.set(Global::P, vertex.point);
  point.set(Global::N, vertex.normal);
  point.set(Global::Ng, vertex.normal);
  point.set(Global::u, vertex.u);
  point.set(Global::v, vertex.v);
  point.set(Global::dPdu, vertex.dPdu);
  point.set(Global::dPdv, vertex.dPdv);
  point.set(Global::time, time);
  const float alongU = length(vertex.dPdu), alongV = length(vertex.dPdv);
  const float du = alongU > 0 ? vertex.spacing / alongU : 0, dv = alongV > 0 ? vertex.spacing / alongV : 0;
  point.set(Global::dPdx, du * vertex.dPdu);
  point.set(Global::dPdy, dv * vertex.dPdv);
  point.set(Global::dudx, du);
  point.set(Global::dvdy, dv);
  const bool isFlipped = dot(cross(vertex.dPdu, vertex.dPdv), vertex.normal) < 0;
  point.set(Global::flipHandedness, isFlipped ? 1.0f : 0.0f);
  return point;
}

class Runner {
 public:
  Runner(const PreparedScene& scene, shading::InstanceRef shader, const accel::TriangleMesh& mesh, const PathId& path)
      : scene_(scene),
        shader_(shader),
        path_(path),
        family_(scene.shading.family(shader)),
        host_(scene.namedSpaces, scene.loopBudget, scene.services.get()),
        facts_(scene.shading.instance(shader), mesh),
        batch_(static_cast<int>(atOnce)) {
    points_.bind(family_, shading::Variant::displacement);
    host_.calls().setAttributes(&scene.attributes);
    host_.calls().setFacts(&facts_);
  }

  void run(std::span<const DisplacementVertex> vertices, std::uint32_t number, DisplacedVertex* displaced) {
    points_.shrink(0);
    for (const DisplacementVertex& vertex : vertices)
      points_.push(shadingPointOf(vertex, scene_.shutter.open), shader_.index);
    facts_.begin(vertices);
    batch_.run(host_, points_, 0);
    const auto& outputs = batch_.interface().outputs;
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const float* const values = batch_.output(k);
      const auto component = static_cast<int>(outputs[k].component);
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (outputs[k].index == 0) {
          displaced[i].point[component] = values[i];
        } else {
          displaced[i].normal[component] = values[i];
        }
      }
    }
    keepMessages(vertices.size(), number);
  }

 private:
  void keepMessages(std::size_t count, std::uint32_t number) {
    if (host_.records().empty()) return;
    const jit::KernelInterface& interface = batch_.interface();
    const auto text = [&](std::uint64_t hash) { return host_.calls().strings().text(hash); };
    std::vector<std::uint32_t> calls(count, 0);
    for (const shading::Record& record : host_.records()) {
      if (record.lane >= count) continue;
      scene_.messages->add({path_, number + record.lane, calls[record.lane]++, record.kind,
                            shading::locationOf(record, interface), shading::describe(record, interface, text),
                            record.kind == AEROSOL_MESSAGE_FILE ? shading::fileOf(record, text) : std::string()});
    }
    host_.records().clear();
  }

  const PreparedScene& scene_;
  shading::InstanceRef shader_;
  PathId path_;
  const shading::Family& family_;
  shading::KernelHost host_;
  VertexFacts facts_;
  shading::Batch batch_;
  shading::PointArrays points_;
};

}  // namespace

std::vector<DisplacedVertex> runDisplacement(const PreparedScene& scene, shading::InstanceRef shader,
                                             const accel::TriangleMesh& mesh,
                                             std::span<const DisplacementVertex> vertices, const PathId& path,
                                             std::uint32_t number) {
  std::vector<DisplacedVertex> displaced(vertices.size());
  tbb::enumerable_thread_specific<std::unique_ptr<Runner>> runners;
  tbb::parallel_for(std::size_t{0}, (vertices.size() + atOnce - 1) / atOnce, [&](std::size_t block) {
    auto& runner = runners.local();
    if (!runner) runner = std::make_unique<Runner>(scene, shader, mesh, path);
    const std::size_t first = block * atOnce;
    runner->run(vertices.subspan(first, std::min(atOnce, vertices.size() - first)),
                number + static_cast<std::uint32_t>(first), displaced.data() + first);
  });
  return displaced;
}

}  // namespace aerosol::render
