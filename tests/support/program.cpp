#include "tests/support/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace aerosol::test {

namespace fs = std::filesystem;

namespace {

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Between fork and exec: system calls alone.
[[noreturn]] void becomeProgram(const char* folder, const char* out, const char* err, char* const* arguments) {
  const int outFile = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int errFile = open(err, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(outFile, STDOUT_FILENO);
  dup2(errFile, STDERR_FILENO);
  if (chdir(folder) == 0) execv(arguments[0], arguments);
  _exit(127);
}

}  // namespace

ProgramFolder::~ProgramFolder() {
  std::error_code ignored;
  for (const char* stream : {".out", ".err"}) fs::remove(folder_.string() + stream, ignored);
}

void ProgramFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
}

image::ImageBuffer ProgramFolder::picture(const std::string& name) const {
  auto read = image::readImage(path(name));
  if (!read) ADD_FAILURE() << format(read.errors());
  return read ? std::move(*read) : image::ImageBuffer{};
}

std::string ProgramFolder::read(const std::string& name) const { return contentOf(folder_ / name); }

std::vector<std::string> ProgramFolder::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder_).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

pid_t ProgramFolder::start(const std::vector<std::string>& arguments) const {
  std::vector<std::string> words{AEROSOL_BINARY_DIR "/bin/aerosol"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string folder = folder_.string(), out = folder + ".out", err = folder + ".err";
  const pid_t child = fork();
  if (child == 0) becomeProgram(folder.c_str(), out.c_str(), err.c_str(), pointers.data());
  return child;
}

Outcome ProgramFolder::outcomeOf(int status) const {
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  outcome.out = contentOf(folder_.string() + ".out");
  outcome.err = contentOf(folder_.string() + ".err");
  return outcome;
}

Outcome ProgramFolder::run(const std::vector<std::string>& arguments,
                           std::optional<std::chrono::milliseconds> killAfter) const {
  const pid_t child = start(arguments);
  const auto begin = std::chrono::steady_clock::now();
  int status = 0;
  while (killAfter && std::chrono::steady_clock::now() < begin + *killAfter) {
    if (waitpid(child, &status, WNOHANG) == child) return outcomeOf(status);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (killAfter) kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return outcomeOf(status);
}

Outcome ProgramFolder::runUntil(const std::string& file, const std::vector<std::string>& arguments) const {
  const pid_t child = start(arguments);
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (has(file)) kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return outcomeOf(status);
}

}  // namespace aerosol::test
