#include "core/render/renderer.h"

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "core/render/film_archive.h"
#include "core/render/film_error.h"
#include "core/render/worker.h"

namespace aerosol::render {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Hands out what a film holds while it is being rendered. Copying and writing take at most a twentieth of the time.
class Checkpoints {
 public:
  Checkpoints(const RenderOptions& options, const TileSource& source, const Film& film, std::vector<std::mutex>& locks)
      : options_(options), source_(source), film_(film), locks_(locks), pause_(options.checkpointSeconds) {}

  void takeWhenDue() {
    if (!options_.checkpoint || secondsSince(last_) < pause_) return;
    const Clock::time_point start = Clock::now();
    FilmWriter writer(film_);
    for (std::size_t i = 0; i < locks_.size(); ++i) {
      const std::scoped_lock lock(locks_[i]);
      writer.add(film_, source_.tiles()[i]);
    }
    options_.checkpoint(writer.finish(film_));
    pause_ = std::max(options_.checkpointSeconds, 20 * secondsSince(start));
    last_ = Clock::now();
  }

 private:
  const RenderOptions& options_;
  const TileSource& source_;
  const Film& film_;
  std::vector<std::mutex>& locks_;
  double pause_;
  Clock::time_point last_ = Clock::now();
};

/// The error of a film that is being rendered, looked at now and then: that takes at most a fiftieth of the time.
class ErrorWatch {
 public:
  ErrorWatch(const TileSource& source, const Film& film, std::vector<std::mutex>& locks)
      : source_(source), film_(film), locks_(locks) {}

  double latest() {
    if (secondsSince(last_) < pause_) return error_;
    const Clock::time_point start = Clock::now();
    FilmError error;
    for (std::size_t i = 0; i < locks_.size(); ++i) {
      const std::scoped_lock lock(locks_[i]);
      error.add(film_, source_.tiles()[i]);
    }
    error_ = error.relative();
    pause_ = std::max(1.0, 50 * secondsSince(start));
    last_ = Clock::now();
    return error_;
  }

 private:
  const TileSource& source_;
  const Film& film_;
  std::vector<std::mutex>& locks_;
  double error_ = 0, pause_ = 1;
  Clock::time_point last_ = Clock::now();
};

/// Looks where the workers are.
class Profiler {
 public:
  explicit Profiler(std::size_t threads) : marks_(threads), seen_(threads) {}

  void watch(std::size_t thread, const PhaseMark* mark) {
    const std::scoped_lock lock(mutex_);
    marks_[thread] = mark;
  }
  void start() {
    thread_ = std::jthread([this](std::stop_token stop) {
      for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::microseconds(950))) look();
    });
  }
  void stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }
  const std::array<std::uint64_t, phaseCount>& seen(std::size_t thread) const { return seen_[thread]; }

 private:
  void look() {
    const std::scoped_lock lock(mutex_);
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if (marks_[i]) ++seen_[i][static_cast<std::size_t>(marks_[i]->get())];
    }
  }

  std::mutex mutex_;
  std::vector<const PhaseMark*> marks_;
  std::vector<std::array<std::uint64_t, phaseCount>> seen_;
  std::jthread thread_;
};

}  // namespace

RenderReport render(const PreparedScene& scene, const Integrator& integrator, Film& film,
                    const RenderOptions& options) {
  const Clock::time_point start = Clock::now();
  film.setScrambled(scene.sampler == SamplerKind::sobol);
  TileSource source(film, options.firstSample, options.endSample, options.map);
  std::vector<std::mutex> tileLocks(source.tiles().size());
  std::atomic<std::uint64_t> samplesDone{0};
  const SharedWork shared{scene, integrator, options, source, film, tileLocks, samplesDone};

  const int threadCount =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<WorkerStatistics> statistics(static_cast<std::size_t>(threadCount));
  std::mutex mutex;
  std::condition_variable finished;
  int running = threadCount;
  const auto total = static_cast<double>(source.totalSamples());
  const auto tellProgress = [&](double error) {
    if (!options.progress) return;
    const std::uint64_t done = samplesDone;
    options.progress({static_cast<double>(source.presentSamples() + done) / total, secondsSince(start), done,
                      static_cast<double>(source.presentSamples()) / total, error});
  };

  Profiler profiler(statistics.size());
  if (options.profile) profiler.start();
  ErrorWatch errors(source, film, tileLocks);
  RenderReport report;
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < statistics.size(); ++i) {
      threads.emplace_back([&, i] {
        Worker worker(shared);
        profiler.watch(i, &worker.phase());
        worker.run();
        profiler.watch(i, nullptr);
        const std::lock_guard lock(mutex);
        statistics[i] = worker.statistics();
        --running;
        finished.notify_one();
      });
    }
    Checkpoints checkpoints(options, source, film, tileLocks);
    std::unique_lock lock(mutex);
    while (!finished.wait_for(lock, std::chrono::milliseconds(200), [&] { return running == 0; })) {
      lock.unlock();
      tellProgress(options.progress ? errors.latest() : 0);
      checkpoints.takeWhenDue();
      lock.lock();
    }
  }
  profiler.stop();
  for (std::size_t i = 0; i < statistics.size(); ++i) {
    statistics[i].phases = profiler.seen(i);
    report.statistics += statistics[i];
  }
  report.seconds = secondsSince(start);
  report.interrupted = options.stop && *options.stop;
  tellProgress(options.progress ? relativeError(film) : 0);
  return report;
}

}  // namespace aerosol::render
