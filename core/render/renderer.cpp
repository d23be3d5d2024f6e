#include "core/render/renderer.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "core/render/worker.h"

namespace aerosol::render {

RenderReport render(const PreparedScene& scene, const Integrator& integrator, Film& film,
                    const RenderOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };

  TileSource source(film.area(), options.firstSample, options.endSample);
  std::vector<std::mutex> tileLocks(source.tileCount());
  std::atomic<std::uint64_t> samplesDone{0};
  const SharedWork shared{scene, integrator, options, source, film, tileLocks, samplesDone};

  const int threadCount =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<WorkerStatistics> statistics(static_cast<std::size_t>(threadCount));
  std::mutex mutex;
  std::condition_variable finished;
  int running = threadCount;

  RenderReport report;
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      threads.emplace_back([&, i] {
        Worker worker(shared);
        worker.run();
        const std::lock_guard lock(mutex);
        statistics[i] = worker.statistics();
        --running;
        finished.notify_one();
      });
    }
    const double total =
        static_cast<double>(options.endSample - options.firstSample) * static_cast<double>(film.area().pixelCount());
    std::unique_lock lock(mutex);
    while (!finished.wait_for(lock, std::chrono::milliseconds(200), [&] { return running == 0; })) {
      if (!options.progress) continue;
      const std::uint64_t done = samplesDone;
      options.progress({static_cast<double>(done) / total, seconds(), done});
    }
  }
  for (const WorkerStatistics& each : statistics) report.statistics += each;
  report.seconds = seconds();
  report.interrupted = options.stop && *options.stop;
  if (options.progress) {
    const double total =
        static_cast<double>(options.endSample - options.firstSample) * static_cast<double>(film.area().pixelCount());
    options.progress({static_cast<double>(samplesDone) / total, report.seconds, samplesDone});
  }
  return report;
}

}  // namespace aerosol::render
