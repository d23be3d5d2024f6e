#include "core/app/merge_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/app/deep_picture.h"
#include "core/app/film_file.h"
#include "core/app/missing_samples.h"
#include "core/app/output_files.h"
#include "core/app/picture.h"
#include "core/app/quantity.h"
#include "core/render/film_archive.h"

namespace aerosol::app {

namespace {

using render::Film;
using render::PixelRect;

class Merge {
 public:
  Merge(const MergeArguments& arguments, const Console& console) : arguments_(arguments), console_(console) {}

  ExitCode run() {
    if (arguments_.outputs.empty()) {
      console_.note("aerosol: error: no output is given\n  note: -o FILE names the image to write\n");
      return ExitCode::usage;
    }
    if (!accept(checkOutputNames(arguments_.outputs)) || !checkNames()) return ExitCode::usage;
    std::vector<std::string> files = arguments_.outputs;
    if (!arguments_.deep.file.empty()) {
      if (auto mistake = image::checkDeepFileName(arguments_.deep.file)) {
        console_.report(*mistake);
        return ExitCode::usage;
      }
      files.push_back(arguments_.deep.file);
    }
    if (!accept(checkOutputPlaces(files))) return ExitCode::badInput;
    for (const std::string& name : arguments_.parts) {
      if (!join(name)) return ExitCode::badInput;
    }
    return checkComplete() && write() ? ExitCode::success : ExitCode::badInput;
  }

 private:
  bool accept(const Diagnostics& diagnostics) {
    console_.report(diagnostics);
    return !diagnostics.hasErrors();
  }
  bool fail(const std::string& file, std::string message, std::vector<std::string> notes = {}) {
    console_.report(Diagnostic{Severity::error, {file, 0, 0}, std::move(message), {}, std::move(notes)});
    return false;
  }

  bool checkNames() {
    const auto isExr = [](const std::string& name) { return name.size() > 4 && name.ends_with(".exr"); };
    if (!arguments_.allowMissing || std::any_of(arguments_.outputs.begin(), arguments_.outputs.end(), isExr))
      return true;
    return fail(arguments_.outputs.front(), "what is merged with --allow-missing is kept in EXR files alone");
  }

  bool join(const std::string& name) {
    auto file = readFilmFile(name);
    if (!file) return accept(file.errors());
    if (!first_) {
      if (!start(*file)) return false;
    } else if (!checkJob(*file)) {
      return false;
    }
    const PixelRect area = file->film->area();
    if (!film_->area().contains(area)) {
      return fail(name, "this part reaches beyond the pixels that are wanted",
                  {fmt::format("it shows {},{},{},{}", area.x0, area.y0, area.width(), area.height())});
    }
    if (film_->layout() != file->film->layout()) {
      const auto listOf = [](const Film& film) { return film.layout().isEmpty() ? "none" : film.layout().toText(); };
      return fail(name, fmt::format("this part has other AOVs than {}: {}, not {}", *first_, listOf(*file->film),
                                    listOf(*film_)));
    }
    if (film_->merge(*file->film).hasErrors()) return reportDoubled(*file);
    seconds_ += file->seconds;
    joined_.push_back(name);
    return true;
  }

  bool start(const FilmFile& file) {
    job_ = file.job;
    first_ = file.name;
    metadata_ = file.metadata;
    if (arguments_.crop) {
      const Crop& crop = *arguments_.crop;
      if (crop.width > job_.film.width - crop.x || crop.height > job_.film.height - crop.y) {
        return fail(file.name, fmt::format("--crop {},{},{},{} reaches beyond the film of {} x {} pixels", crop.x,
                                           crop.y, crop.width, crop.height, job_.film.width, job_.film.height));
      }
      job_.film.cropOffsetX = crop.x;
      job_.film.cropOffsetY = crop.y;
      job_.film.cropWidth = crop.width;
      job_.film.cropHeight = crop.height;
    }
    if (!arguments_.deep.file.empty() && !file.film->layout().deep.isWanted()) {
      return fail(file.name, "this part has gathered nothing for a deep image",
                  {"aerosol render --deep FILE.exr --samples ... makes parts that have"});
    }
    film_ = std::make_unique<Film>(cropOf(job_.film), file.film->layout());
    original_ = file.job;
    return true;
  }

  bool checkJob(const FilmFile& file) {
    if (const std::string difference = differenceOf(original_, file.job); !difference.empty()) {
      return fail(file.name, fmt::format("this is no part of the same image as {}: {}", *first_, difference));
    }
    const bool sameIsa = file.job.embreeIsa == original_.embreeIsa, sameCode = file.job.code == original_.code;
    if ((sameIsa && sameCode) || arguments_.mixed) {
      isMixed_ = isMixed_ || !sameIsa || !sameCode;
      return true;
    }
    const std::string what =
        sameIsa ? fmt::format("version {} of the program, {} from {}", file.job.code, *first_, original_.code)
                : fmt::format("the instruction set {}, {} with {}", file.job.embreeIsa, *first_, original_.embreeIsa);
    return fail(file.name, fmt::format("this part was rendered with {}", what),
                {"bits may differ; --mixed joins them all the same, equal only within noise",
                 "aerosol render --isa avx2 gives the same bits on all machines"});
  }

  /// Names the earlier part that has samples of this one.
  bool reportDoubled(const FilmFile& file) {
    for (const std::string& name : joined_) {
      const auto earlier = readFilmFile(name);
      if (!earlier) continue;
      const PixelRect a = earlier->film->area(), b = file.film->area();
      for (int y = std::max(a.y0, b.y0); y < std::min(a.y1, b.y1); ++y) {
        for (int x = std::max(a.x0, b.x0); x < std::min(a.x1, b.x1); ++x) {
          const render::PixelSum &p = earlier->film->pixel(x, y), &q = file.film->pixel(x, y);
          if (!p.overlaps(q)) continue;
          return fail(
              file.name,
              fmt::format("samples of this part are in {} too, such as in pixel ({}, {}): it has {}, this one {}", name,
                          x, y, formatRanges(p.ranges()), formatRanges(q.ranges())));
        }
      }
    }
    return fail(file.name, "samples of this part are there already");
  }

  bool checkComplete() {
    const auto missing = findMissing(*film_, static_cast<std::uint64_t>(job_.sampleCount));
    if (missing.empty()) return true;
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < std::min<std::size_t>(missing.size(), 10); ++i) notes.push_back(describe(missing[i]));
    if (missing.size() > notes.size()) notes.push_back(fmt::format("and {} more", missing.size() - notes.size()));
    if (arguments_.allowMissing) {
      isIncomplete_ = true;
      console_.report(
          Diagnostic{Severity::warning, {arguments_.outputs.front(), 0, 0}, "samples are missing", {}, notes});
      return true;
    }
    notes.push_back("--allow-missing writes what there is");
    return fail(arguments_.outputs.front(), "samples are missing, no image is written", notes);
  }

  bool write() {
    const SampleCounts counts = countSamples(*film_);
    image::ImageBuffer picture = makePicture(*film_, job_.film);
    picture.metadata = metadataOf(counts);
    picture.layers = makeLayers(*film_);
    if (isIncomplete_) picture.attachment = render::encodeFilm(*film_);
    if (!accept(writeOutputs(arguments_.outputs, picture, job_.film, arguments_.display))) return false;
    std::string deepNote;
    if (!arguments_.deep.file.empty() &&
        !accept(writeDeepPicture(arguments_.deep, *film_, job_.film, picture.metadata, deepNote)))
      return false;
    if (arguments_.quiet) return true;
    console_.note(deepNote);
    for (const std::string& name : arguments_.outputs) {
      console_.note(fmt::format("wrote {}: {} x {} pixels, {} samples a pixel, from {}\n", name, picture.width,
                                picture.height, formatMean(counts.mean), formatCount(arguments_.parts.size(), "part")));
    }
    return true;
  }

  /// That of the first part, with what is true of the whole.
  std::vector<image::Metadata> metadataOf(const SampleCounts& counts) const {
    std::map<std::string, image::Metadata> changed;
    const auto set = [&](const char* key, auto value) { changed[key] = {key, value}; };
    set("aerosol:spp", counts.mean);
    set("aerosol:sppMinimum", static_cast<std::int32_t>(counts.minimum));
    set("aerosol:sppMaximum", static_cast<std::int32_t>(counts.maximum));
    set("aerosol:samples", static_cast<double>(counts.total));
    set("aerosol:firstSample", std::int32_t{0});
    set("aerosol:endSample", static_cast<std::int32_t>(job_.sampleCount));
    const render::PixelRect area = film_->area();
    set("aerosol:crop", fmt::format("{},{},{},{}", area.x0, area.y0, area.width(), area.height()));
    set("aerosol:interrupted", static_cast<std::int32_t>(isIncomplete_));
    set("aerosol:renderSeconds", seconds_);
    if (isMixed_) {
      set("aerosol:embreeIsa", std::string("mixed"));
      set("aerosol:code", std::string("mixed"));
    }
    std::vector<image::Metadata> metadata;
    for (const image::Metadata& entry : metadata_) {
      const bool isOurs = entry.key.starts_with("aerosol:") || entry.key == "Software" || entry.key == "DateTime";
      if (!isOurs) continue;
      const auto found = changed.find(entry.key);
      metadata.push_back(found == changed.end() ? entry : found->second);
    }
    return metadata;
  }

  const MergeArguments& arguments_;
  const Console& console_;
  std::optional<std::string> first_;
  Job original_, job_;
  std::unique_ptr<Film> film_;
  std::vector<std::string> joined_;  ///< Names.
  std::vector<image::Metadata> metadata_;
  double seconds_ = 0;
  bool isMixed_ = false, isIncomplete_ = false;
};

}  // namespace

ExitCode mergeCommand(const MergeArguments& arguments, const Console& console) {
  return Merge(arguments, console).run();
}

}  // namespace aerosol::app
