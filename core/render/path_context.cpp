#include "core/render/path_context.h"

#include "core/render/prepared_scene.h"

namespace aerosol::render {

namespace {

/// The deepest chain of coroutines (path, distance, tracker) takes about 2 kB; measured by `frameHeapBlocks`.
constexpr std::size_t frameBytes = 16384;

}  // namespace

PathContext::PathContext(const PreparedScene& scene, QuestionSink& sink, WorkerStatistics& statistics)
    : keepsFootprints_(scene.keepsFootprints),
      scene_(scene),
      sink_(sink),
      statistics_(statistics),
      frames_(frameBytes) {}

}  // namespace aerosol::render
