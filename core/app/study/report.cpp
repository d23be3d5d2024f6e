#include "core/app/study/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/app/json.h"
#include "core/app/output_files.h"
#include "core/app/study/measure.h"
#include "core/image/plain_image.h"

namespace aerosol::app {

namespace {

void writeMeasured(JsonWriter& json, const char* name, const Measured& m) {
  json.key(name).beginObject().number("value", m.value).number("standardError", m.error).endObject();
}

std::string slug(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const bool isKept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.';
    if (isKept) text += c;
    if (!isKept && !text.empty() && text.back() != '-') text += '-';
  }
  return text;
}

std::string csvText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// The picture as PNG; returns its bytes, empty when there is none or it cannot be written.
std::string writePicture(const std::vector<float>& pixels, const StudyReference& size, const std::string& file,
                         Diagnostics& errors) {
  if (pixels.empty()) return {};
  image::ImageBuffer picture;
  picture.width = size.width;
  picture.height = size.height;
  picture.channels = {"R", "G", "B"};
  picture.pixels = pixels;
  if (const auto written = image::writeImage(file, picture); !written) {
    errors.append(written.errors());
    return {};
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

void writeChart(const Chart& chart, const std::string& file, Diagnostics& errors) {
  image::ImageBuffer drawn = chartPicture(chart);
  const image::PlainImage plain{drawn.width, drawn.height, 3, std::move(drawn.pixels)};
  errors.append(image::writePlainImage(file, plain, {.type = image::PlainOptions::Type::uint8}));
}

}  // namespace

std::string studyJson(const StudyResults& results) {
  const StudyReference& r = results.reference;
  JsonWriter json;
  json.beginObject()
      .text("scene", results.scene)
      .text("program", results.program)
      .text("machine", results.machine)
      .count("repetitions", static_cast<std::uint64_t>(results.repetitions))
      .number("shareOfProcessors", results.machineTime.share())
      .number("equalTimeSeconds", equalTime(results));
  json.key("conclusions").beginArray();
  for (const std::string& sentence : conclusions(results)) json.text(sentence);
  json.endArray();
  json.key("reference")
      .beginObject()
      .text("method", r.method)
      .boolean("unbiased", r.isUnbiased)
      .count("width", static_cast<std::uint64_t>(r.width))
      .count("height", static_cast<std::uint64_t>(r.height))
      .count("samples", r.samples)
      .number("seconds", r.seconds)
      .number("relativeError", r.error)
      .number("relativeErrorOfMean", r.meanError)
      .endObject();
  json.key("cases").beginArray();
  for (const StudyRow& row : sortRows(results)) {
    json.beginObject()
        .text("name", row.study->name)
        .boolean("complete", row.study->isComplete)
        .number("errorInEqualTime", row.error)
        .boolean("withinNoiseOfPrevious", row.isWithinNoise)
        .number("convergenceRate", row.rate)
        .number("prepareSeconds", row.study->prepareSeconds);
    json.key("arguments").beginArray();
    for (const std::string& argument : row.study->arguments) json.text(argument);
    json.endArray();
    json.key("rounds").beginArray();
    for (const StudyRound& round : row.study->rounds) {
      json.beginObject().count("samples", round.samples).number("seconds", round.seconds);
      writeMeasured(json, "squaredError", round.squaredError);
      writeMeasured(json, "variance", round.variance);
      writeMeasured(json, "squaredBias", round.squaredBias);
      writeMeasured(json, "meanBias", round.meanBias);
      json.endObject();
    }
    json.endArray().endObject();
  }
  json.endArray().endObject();
  return json.finish();
}

std::string studyCsv(const StudyResults& results) {
  std::string csv =
      "case,samples,seconds,squared_error,squared_error_se,variance,variance_se,squared_bias,squared_bias_se,mean_bias,"
      "mean_bias_se\n";
  for (const StudyCase& study : results.cases) {
    for (const StudyRound& r : study.rounds) {
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csvText(study.name), r.samples, r.seconds,
                         r.squaredError.value, r.squaredError.error, r.variance.value, r.variance.error,
                         r.squaredBias.value, r.squaredBias.error, r.meanBias.value, r.meanBias.error);
    }
  }
  return csv;
}

Diagnostics writeStudy(const StudyResults& results, const std::string& folder) {
  Diagnostics errors;
  const auto in = [&](const std::string& name) { return (std::filesystem::path(folder) / name).string(); };
  std::vector<std::string> pictures{
      writePicture(results.reference.mean, results.reference, in("reference.png"), errors)};
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    const StudyCase& study = results.cases[i];
    pictures.push_back(writePicture(study.picture, results.reference,
                                    in(fmt::format("{:02}-{}.png", i + 1, slug(study.name))), errors));
  }
  writeChart(errorChart(results), in("error.png"), errors);
  writeChart(partsChart(results), in("parts.png"), errors);
  errors.append(writeTextFile(in("study.json"), studyJson(results)));
  errors.append(writeTextFile(in("study.csv"), studyCsv(results)));
  errors.append(writeTextFile(in("study.html"), studyPage(results, pictures)));
  return errors;
}

}  // namespace aerosol::app
