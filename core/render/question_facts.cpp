#include "core/render/question_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/hash.h"
#include "core/base/random.h"
#include "core/render/kernel_queue.h"
#include "core/render/mesh_user_data.h"
#include "core/render/prepared_scene.h"

namespace aerosol::render {

const Question& QuestionFacts::question(std::uint32_t point) const {
  const PendingQuestion& from = questions_[point];
  return paths_[from.slot]->questions()[from.question];
}

const shading::Instance& QuestionFacts::instance(std::uint32_t point) const {
  const Question& asked = question(point);
  return scene_.shading.instance(asked.medium ? scene_.mediumShaders[asked.medium->index] : asked.surface);
}

std::uint32_t QuestionFacts::rayTypes(std::uint32_t point) const { return question(point).rayTypes; }

bool QuestionFacts::isBackfacing(std::uint32_t point) const {
  const shading::ShadingPoint* surface = question(point).surfacePoint;
  if (!surface) return false;
  if (surface->isTurned()) return true;
  const auto component = [&](lang::Global global, std::size_t i) {
    return (*surface)[static_cast<std::size_t>(jit::globalPointer(global)) + i];
  };
  float cosine = 0;
  for (std::size_t i = 0; i < 3; ++i) cosine += component(lang::Global::I, i) * component(lang::Global::Ng, i);
  return cosine > 0;
}

std::uint64_t QuestionFacts::randomKey(std::uint32_t point) const {
  const PendingQuestion& from = questions_[point];
  PathContext& path = *paths_[from.slot];
  const std::uint64_t key = combineHashes(path.random().key(), path.random().sampleIndex());
  return combineHashes(key, path.questionNumber(from.question));
}

float QuestionFacts::surfaceArea(std::uint32_t point) const { return instance(point).surfaceArea; }

const shading::AttributeTable* QuestionFacts::attributes(std::uint32_t point) const {
  return instance(point).attributes.get();
}

/// Attributes of the mesh that the point lies on.
std::optional<lang::Type> QuestionFacts::userData(std::uint32_t point, std::uint64_t nameHash,
                                                  std::span<float, maximumUserData> values) const {
  const Question& asked = question(point);
  const accel::TriangleMesh* mesh = asked.surfacePoint ? scene_.meshWithAttributes(asked.surface) : nullptr;
  return mesh ? meshUserData(*mesh, asked.surfacePoint->place(), nameHash, values) : std::nullopt;
}

/// Whether an object is one of those that count: the one of that name, all but that with "-" in front, or any.
static bool belongs(const PreparedScene& scene, accel::ObjectId object, std::string_view set) {
  if (set.empty()) return true;
  const bool isExcluded = set.front() == '-';
  const auto& attributes = scene.shading.instance(scene.objects[object].material).attributes;
  const lang::Constant* name = attributes ? attributes->find(hashString("geom:name")) : nullptr;
  return (name && name->asString() == set.substr(isExcluded ? 1 : 0)) != isExcluded;
}

/// A ray from the point itself starts off its own surface.
bool QuestionFacts::trace(std::uint32_t point, const shading::TraceRequest& request,
                          shading::TraceAnswer& answer) const {
  const auto& [o, d] = std::pair(request.origin, request.direction);
  const float length = std::hypot(d[0], d[1], d[2]);
  Ray<World> ray;
  ray.origin = {o[0], o[1], o[2]};
  ray.direction = {d[0] / length, d[1] / length, d[2] / length};
  ray.tMin = std::max(request.least, 0.0f);
  ray.tMax = request.greatest;
  if (const shading::ShadingPoint* surface = question(point).surfacePoint) {
    const auto triple = [&](lang::Global global) {
      const auto first = static_cast<std::size_t>(jit::globalPointer(global));
      return std::array<float, 3>{(*surface)[first], (*surface)[first + 1], (*surface)[first + 2]};
    };
    const std::array<float, 3> n = triple(lang::Global::Ng);
    if (triple(lang::Global::P) == o) ray.origin = accel::offsetPoint(ray.origin, {n[0], n[1], n[2]}, ray.direction);
  }
  accel::SpanBuffer spans;
  accel::Counters counters;
  auto hit = scene_.geometry->closestHit(ray, spans, counters);
  while (hit && !belongs(scene_, hit->object, request.set)) {
    const accel::HitKey passed = hit->key();
    hit = scene_.geometry->closestHit(ray, spans, counters, &passed);
  }
  if (!hit) return false;
  const auto put = [](std::array<float, 3>& target, const auto& from) { target = {from.x, from.y, from.z}; };
  answer.isHit = true;
  answer.distance = static_cast<float>(hit->t);
  put(answer.position, hit->point);
  put(answer.normal, hit->shadingNormal);
  put(answer.geometricNormal, hit->geometricNormal);
  answer.u = hit->u;
  answer.v = hit->v;
  answer.object = scene_.shading.instance(scene_.objects[hit->object].material).attributes.get();
  return true;
}

}  // namespace aerosol::render
