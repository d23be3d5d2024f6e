#include "core/render/question_facts.h"

#include "core/render/kernel_queue.h"
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
  const auto component = [&](lang::Global global, std::size_t i) {
    return (*surface)[static_cast<std::size_t>(jit::globalPointer(global)) + i];
  };
  float cosine = 0;
  for (std::size_t i = 0; i < 3; ++i) cosine += component(lang::Global::I, i) * component(lang::Global::Ng, i);
  return cosine > 0;
}

float QuestionFacts::surfaceArea(std::uint32_t point) const { return instance(point).surfaceArea; }

const shading::AttributeTable* QuestionFacts::attributes(std::uint32_t point) const {
  return instance(point).attributes.get();
}

}  // namespace aerosol::render
