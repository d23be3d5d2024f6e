// A render cut into tasks, and the files by which queues run them.
#pragma once

#include <string>
#include <vector>

#include "core/app/arguments.h"

namespace aerosol::app {

/// A part of the samples of one frame.
struct SubmitTask {
  std::optional<int> frame;
  std::optional<SampleRange> samples;  ///< None: all of them.
  std::vector<std::string> words;      ///< Of the program, itself left out.
};

struct SubmitJob {
  std::string name, program, folder;  ///< Absolute paths.
  std::vector<SubmitTask> renders;
  std::vector<std::vector<std::string>> merges;  ///< Words; empty where every render is a whole image.
};

/// Cuts `total` samples into at most `count` ranges, at multiples of 64 as far as there are enough samples.
std::vector<SampleRange> splitSamples(int total, int count);

/// Text that a POSIX shell reads as the one word.
std::string shellQuote(const std::string& word);

/// tasks.sh and merges.sh, which take the number of a task; scripts of the queues call them.
std::string tasksScript(const SubmitJob& job);
std::string mergesScript(const SubmitJob& job);
std::string slurmArrayScript(const SubmitJob& job);
std::string slurmMergeScript(const SubmitJob& job);
std::string parallelScript(const SubmitJob& job);
std::string openCueOutline(const SubmitJob& job);

}  // namespace aerosol::app
