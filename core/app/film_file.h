// EXR files that hold a film's sums beside its picture: parts to be joined, and checkpoints.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/app/job.h"
#include "core/render/film.h"

namespace aerosol::app {

struct FilmFile {
  std::string name;
  Job job;
  std::unique_ptr<render::Film> film;
  std::vector<image::Metadata> metadata;
  double seconds = 0;  ///< That the render took.
};

/// Errors name the file.
Result<FilmFile> readFilmFile(const std::string& name);

/// Why two files are not parts of one image; empty when they are. Instruction sets and versions are left out.
std::string differenceOf(const Job& a, const Job& b);

/// Whether the image is there already: of the same job, by the same code, with exactly these samples, not interrupted.
bool isDone(const std::string& name, const Job& job, const SampleRange& range, const render::PixelRect& area);

/// "cloud.png" → "cloud.checkpoint.exr", in the same folder.
std::string checkpointName(const std::string& output);

}  // namespace aerosol::app
