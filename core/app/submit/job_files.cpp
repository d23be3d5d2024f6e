#include "core/app/submit/job_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/render/pixel_sum.h"

namespace aerosol::app {

namespace {

std::string commandOf(const SubmitJob& job, const std::vector<std::string>& words) {
  std::string text = shellQuote(job.program);
  for (const std::string& word : words) text += " " + shellQuote(word);
  return text;
}

std::string script(const SubmitJob& job, const std::vector<std::vector<std::string>>& commands, const char* what) {
  std::string text =
      fmt::format("#!/bin/sh\n# {} of {}: takes its number, from 0.\nset -e\ncase \"$1\" in\n", what, job.name);
  for (std::size_t i = 0; i < commands.size(); ++i)
    text += fmt::format("{}) exec {} ;;\n", i, commandOf(job, commands[i]));
  return text + fmt::format("*) echo \"there are {} such tasks, from 0\" >&2; exit 2 ;;\nesac\n", commands.size());
}

std::string slurmHeader(const SubmitJob& job, const char* kind, std::size_t count) {
  return fmt::format("#!/bin/sh\n#SBATCH --job-name={}\n#SBATCH --array=0-{}\n#SBATCH --output={}\n#SBATCH --requeue\n",
                     shellQuote(job.name + "-" + kind), count - 1,
                     shellQuote(fmt::format("{}/logs/{}-%a.txt", job.folder, kind)));
}

/// As Python writes a string.
std::string pythonText(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

}  // namespace

std::vector<SampleRange> splitSamples(int total, int count) {
  constexpr auto block = static_cast<int>(render::PixelSum::blockSize);
  const int unit = total >= count * block ? block : 1;
  const int units = (total + unit - 1) / unit, parts = std::clamp(count, 1, units);
  std::vector<SampleRange> ranges;
  for (int i = 0; i < parts; ++i) {
    const auto at = [&](int k) {
      return std::min(total, static_cast<int>(static_cast<long long>(units) * k / parts) * unit);
    };
    ranges.push_back({at(i), at(i + 1)});
  }
  return ranges;
}

std::string shellQuote(const std::string& word) {
  const auto isPlain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./=:,+%@").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), isPlain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string tasksScript(const SubmitJob& job) {
  std::vector<std::vector<std::string>> commands;
  for (const SubmitTask& task : job.renders) commands.push_back(task.words);
  return script(job, commands, "Renders");
}

std::string mergesScript(const SubmitJob& job) { return script(job, job.merges, "Merges"); }

std::string slurmArrayScript(const SubmitJob& job) {
  return slurmHeader(job, "render", job.renders.size()) +
         fmt::format("exec sh {} \"$SLURM_ARRAY_TASK_ID\"\n", shellQuote(job.folder + "/tasks.sh"));
}

std::string slurmMergeScript(const SubmitJob& job) {
  return slurmHeader(job, "merge", job.merges.size()) +
         fmt::format("exec sh {} \"$SLURM_ARRAY_TASK_ID\"\n", shellQuote(job.folder + "/merges.sh"));
}

std::string parallelScript(const SubmitJob& job) {
  std::string text = fmt::format(
      "#!/bin/sh\n# Runs {} by GNU parallel; takes what parallel takes, such as -j 4 or --sshlogin HOSTS.\nset -e\n"
      "seq 0 {} | parallel \"$@\" sh {}\n",
      job.name, job.renders.size() - 1, shellQuote(job.folder + "/tasks.sh"));
  if (!job.merges.empty()) {
    text +=
        fmt::format("seq 0 {} | parallel \"$@\" sh {}\n", job.merges.size() - 1, shellQuote(job.folder + "/merges.sh"));
  }
  return text;
}

std::string openCueOutline(const SubmitJob& job) {
  std::string text = fmt::format(
      "# Launches {0} on OpenCue: python3 opencue.py (needs PyOutline).\nimport outline\nimport outline.cuerun\n"
      "from outline.modules.shell import Shell\n\njob = outline.Outline({1}, frame_range='0-{2}')\n"
      "render = Shell('render', command=['sh', {3}, '#IFRAME#'], range='0-{2}', chunk=1)\njob.add_layer(render)\n",
      job.name, pythonText(job.name), job.renders.size() - 1, pythonText(job.folder + "/tasks.sh"));
  if (!job.merges.empty()) {
    text += fmt::format(
        "merge = Shell('merge', command=['sh', {}, '#IFRAME#'], range='0-{}', chunk=1)\nmerge.depend_all(render)\n"
        "job.add_layer(merge)\n",
        pythonText(job.folder + "/merges.sh"), job.merges.size() - 1);
  }
  return text + "outline.cuerun.launch(job, use_pycuerun=False)\n";
}

}  // namespace aerosol::app
