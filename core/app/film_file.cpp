#include "core/app/film_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/render/film_archive.h"

namespace aerosol::app {

namespace {

Diagnostic fileError(const std::string& name, std::string message, std::vector<std::string> notes = {}) {
  return {Severity::error, {name, 0, 0}, std::move(message), {}, std::move(notes)};
}

/// As formats without numbers keep it; empty when it is not there.
std::string textOf(const image::ImageBuffer& picture, const char* key) {
  for (const image::Metadata& entry : picture.metadata) {
    if (entry.key != key) continue;
    if (const auto* text = std::get_if<std::string>(&entry.value)) return *text;
    if (const auto* integer = std::get_if<std::int32_t>(&entry.value)) return std::to_string(*integer);
  }
  return {};
}

}  // namespace

Result<FilmFile> readFilmFile(const std::string& name) {
  auto picture = image::readImage(name);
  if (!picture) return picture.errors();
  const auto job = jobOf(*picture);
  if (!job || picture->attachment.empty()) {
    return fileError(name, "this image has no sums of samples",
                     {"aerosol render keeps them in EXR files with --samples or --keep-sums"});
  }
  auto film = render::decodeFilm(picture->attachment);
  if (!film) {
    Diagnostic error = film.errors().entries().front();
    error.location.file = name;
    return error;
  }
  FilmFile file{name, *job, std::move(*film), std::move(picture->metadata), 0};
  const render::PixelRect area = file.film->area();
  if (area.x0 < 0 || area.y0 < 0 || area.x1 > job->film.width || area.y1 > job->film.height) {
    return fileError(name, "the sums of samples in this file are damaged");
  }
  for (const image::Metadata& entry : file.metadata) {
    if (entry.key == "aerosol:renderSeconds") {
      if (const auto* seconds = std::get_if<double>(&entry.value)) file.seconds = *seconds;
    }
  }
  return file;
}

std::string differenceOf(const Job& a, const Job& b) {
  if (a.identity != b.identity) return "scene, shaders, seed or options differ";
  if (a.film.width != b.film.width || a.film.height != b.film.height) return "the films differ in size";
  if (a.film.cropOffsetX != b.film.cropOffsetX || a.film.cropOffsetY != b.film.cropOffsetY ||
      a.film.croppedWidth() != b.film.croppedWidth() || a.film.croppedHeight() != b.film.croppedHeight()) {
    return "the scene's crops differ";
  }
  if (hasAlpha(a.film.pixelFormat) != hasAlpha(b.film.pixelFormat)) return "one has alpha and the other has not";
  if (a.film.pixelFormat != b.film.pixelFormat) return "they have different pixel formats";
  if (a.sampleCount != b.sampleCount) {
    return fmt::format("one is of an image with {} samples a pixel, the other {}", a.sampleCount, b.sampleCount);
  }
  return {};
}

bool isDone(const std::string& name, const Job& job, const SampleRange& range, const render::PixelRect& area) {
  std::error_code missing;
  if (!std::filesystem::exists(name, missing)) return false;
  const auto picture = image::readImage(name);
  if (!picture) return false;
  const auto is = [&](const char* key, const std::string& expected) { return textOf(*picture, key) == expected; };
  return is("aerosol:job", job.identity) && is("aerosol:code", job.code) && is("aerosol:embreeIsa", job.embreeIsa) &&
         is("aerosol:firstSample", std::to_string(range.first)) && is("aerosol:endSample", std::to_string(range.end)) &&
         is("aerosol:interrupted", "0") && is("aerosol:aovs", job.aovs) &&
         is("aerosol:crop", fmt::format("{},{},{},{}", area.x0, area.y0, area.width(), area.height()));
}

std::string checkpointName(const std::string& output) {
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + ".checkpoint.exr")).string();
}

}  // namespace aerosol::app
