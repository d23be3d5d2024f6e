#include "core/render/path_context.h"

namespace aerosol::render {

namespace {

/// The deepest chain of coroutines (path, distance, tracker) takes about 2 kB; measured by `frameHeapBlocks`.
constexpr std::size_t frameBytes = 8192;

}  // namespace

PathContext::PathContext(const PreparedScene& scene, QuestionSink& sink, WorkerStatistics& statistics)
    : scene_(scene), sink_(sink), statistics_(statistics), frames_(frameBytes) {}

}  // namespace aerosol::render
