#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/app/quantity.h"
#include "core/app/study/measure.h"
#include "core/app/study/report.h"

namespace aerosol::app {

namespace {

constexpr std::string_view style = R"css(
:root { color-scheme: light; --ink: #26251f; --soft: #6d6a61; --line: #e3e1dc; --paper: #fbfaf7; --accent: #1b6ca8; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 940px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 30px; margin: 0 0 4px; } h2 { font-size: 20px; margin: 40px 0 8px; }
.soft { color: var(--soft); font-size: 14px; } p { max-width: 70ch; }
.answer { border-left: 4px solid var(--accent); background: #fff; padding: 12px 18px; margin: 20px 0; font-size: 18px; }
.answer p { margin: 4px 0; } ul.bias { padding-left: 20px; } ul.bias li { margin: 4px 0; }
svg.chart { width: 100%; height: auto; background: #fff; border: 1px solid var(--line); border-radius: 6px; }
svg.chart text { font: 12px system-ui, sans-serif; fill: #3b3a36; } svg.chart text.title { font-size: 16px; font-weight: 600; }
table { border-collapse: collapse; width: 100%; background: #fff; border: 1px solid var(--line); font-size: 14px; }
.wide { overflow-x: auto; } th, td { padding: 7px 8px; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } th { color: var(--soft); font-weight: 600; }
.dot { display: inline-block; width: 10px; height: 10px; border-radius: 5px; margin-right: 8px; }
.compare { display: flex; flex-wrap: wrap; gap: 12px; align-items: center; margin: 8px 0; }
select, button, input { font: inherit; } .compare label { font-size: 14px; color: var(--soft); }
canvas { width: 100%; image-rendering: pixelated; border: 1px solid var(--line); border-radius: 6px; background: #000; cursor: ew-resize; display: block; touch-action: none; }
code { background: #efede7; padding: 1px 5px; border-radius: 3px; font-size: 13px; }
)css";

constexpr std::string_view script = R"js(
const left = document.getElementById('left'), right = document.getElementById('right');
const difference = document.getElementById('difference'), gain = document.getElementById('gain');
const canvas = document.getElementById('canvas'), context = canvas.getContext('2d', { willReadFrequently: true });
const pictures = [...document.querySelectorAll('#pictures img')];
let split = 0.5;
function pixels(image) {
  const c = document.createElement('canvas'); c.width = image.naturalWidth; c.height = image.naturalHeight;
  const x = c.getContext('2d'); x.drawImage(image, 0, 0); return x.getImageData(0, 0, c.width, c.height);
}
function draw() {
  const a = pictures[left.value], b = pictures[right.value];
  if (!a || !b || !a.naturalWidth) return;
  const w = a.naturalWidth, h = a.naturalHeight; canvas.width = w; canvas.height = h;
  if (difference.checked) {
    const p = pixels(a), q = pixels(b), g = Number(gain.value);
    for (let i = 0; i < p.data.length; i += 4) {
      const d = (q.data[i] + q.data[i + 1] + q.data[i + 2] - p.data[i] - p.data[i + 1] - p.data[i + 2]) / 3 * g;
      p.data[i] = 128 + Math.max(-128, Math.min(127, d)); p.data[i + 1] = 128 - Math.min(128, Math.abs(d));
      p.data[i + 2] = 128 - Math.max(-127, Math.min(128, d)); p.data[i + 3] = 255;
    }
    context.putImageData(p, 0, 0);
    return;
  }
  context.drawImage(b, 0, 0);
  const cut = Math.round(split * w);
  if (cut > 0) context.drawImage(a, 0, 0, cut, h, 0, 0, cut, h);
  context.fillStyle = '#fff'; context.fillRect(cut - 0.1, 0, 0.2, h);
}
function move(event) {
  if (event.type === 'pointermove' && event.buttons === 0) return;
  const box = canvas.getBoundingClientRect();
  split = Math.max(0, Math.min(1, (event.clientX - box.left) / box.width)); slider.value = split * 1000; draw();
}
const slider = document.getElementById('slider');
slider.addEventListener('input', () => { split = slider.value / 1000; draw(); });
for (const element of [left, right, difference, gain]) element.addEventListener('input', draw);
canvas.addEventListener('pointerdown', move); canvas.addEventListener('pointermove', move);
window.addEventListener('load', draw); draw();
)js";

std::string base64(std::string_view bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

double positiveRoot(double square) { return std::sqrt(std::max(square, 0.0)); }

std::string answerOf(const StudyResults& results) {
  const auto sentences = conclusions(results);
  std::string html = "<div class=\"answer\">";
  for (std::size_t i = 0; i < std::min<std::size_t>(2, sentences.size()); ++i) {
    html += "<p>" + escapeHtml(sentences[i]) + "</p>";
  }
  html += "</div>\n<ul class=\"bias\">";
  for (std::size_t i = 2; i < sentences.size(); ++i) html += "<li>" + escapeHtml(sentences[i]) + "</li>";
  return html + "</ul>\n";
}

std::string tableOf(const StudyResults& results) {
  std::string html = fmt::format(
      "<div class=\"wide\"><table><thead><tr><th>method</th><th>error in {}</th><th>last "
      "error</th><th>noise</th><th>bias</th>"
      "<th>samples</th><th>time</th><th>half of it costs</th></tr></thead><tbody>\n",
      formatDuration(equalTime(results)));
  for (const StudyRow& row : sortRows(results)) {
    const StudyRound& last = row.study->rounds.back();
    const auto index = static_cast<std::size_t>(row.study - results.cases.data());
    const std::string bias = last.hasBias() ? formatError(positiveRoot(last.squaredBias.value)) : "none found";
    const double factor = costOfHalving(*row.study);
    const std::string cost = factor == 0              ? "not known"
                             : !std::isfinite(factor) ? "not possible"
                                                      : fmt::format("{:.1f} x the time", factor);
    html += fmt::format(
        "<tr><td><span class=\"dot\" "
        "style=\"background:{}\"></span>{}{}</td><td>{}{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td><td>{}</td><td>{}</td></tr>\n",
        chartColor(index), escapeHtml(row.study->name), row.study->isComplete ? "" : " (not finished)",
        formatError(row.error),
        row.isWithinNoise ? " <span class=\"soft\" title=\"within noise of the one above\">~</span>" : "",
        formatError(positiveRoot(last.squaredError.value)), formatError(positiveRoot(last.variance.value)), bias,
        last.samples, formatDuration(last.seconds), cost);
  }
  return html + "</tbody></table></div>\n<p class=\"soft\">~ within noise of the row above</p>\n";
}

std::string optionsOf(const StudyResults& results, std::size_t chosen) {
  std::string html = fmt::format("<option value=\"0\"{}>reference</option>", chosen == 0 ? " selected" : "");
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    if (results.cases[i].rounds.empty()) continue;
    html += fmt::format("<option value=\"{}\"{}>{}, {} samples</option>", i + 1, chosen == i + 1 ? " selected" : "",
                        escapeHtml(results.cases[i].name), results.cases[i].rounds.back().samples);
  }
  return html;
}

std::string comparison(const StudyResults& results, const std::vector<std::string>& pictures) {
  std::string html =
      "<div class=\"compare\"><label>left <select id=\"left\">" + optionsOf(results, 0) +
      "</select></label><label>right <select id=\"right\">" + optionsOf(results, 1) +
      "</select></label><label><input type=\"checkbox\" id=\"difference\"> difference, red where the right "
      "is brighter</label><label>times <select id=\"gain\"><option>1</option><option>4</option><option "
      "selected>8</option><option>32</option></select></label></div>\n<canvas id=\"canvas\"></canvas>\n"
      "<input type=\"range\" id=\"slider\" min=\"0\" max=\"1000\" value=\"500\" style=\"width:100%\" "
      "aria-label=\"where the left picture ends\">\n<div id=\"pictures\" hidden>";
  for (const std::string& picture : pictures) {
    html += picture.empty() ? "<img alt=\"\">" : "<img alt=\"\" src=\"data:image/png;base64," + base64(picture) + "\">";
  }
  return html + "</div>\n";
}

std::string method(const StudyResults& results) {
  const StudyReference& r = results.reference;
  std::string html = fmt::format(
      "<p>Every configuration was rendered {} times with independent random numbers, at {} x {} pixels on {}. What the "
      "repetitions share is bias; by what they scatter is noise. Errors are root mean squares over pixels and colours, "
      "parts of the mean of the image; bands are two standard errors wide on each side. The reference ({}, {} samples "
      "a "
      "pixel, {}) has a standard error of {} a pixel itself, which is taken off. A difference that these errors "
      "explain "
      "is called noise. Times are those of the processors, by threads: what a render takes where nothing else "
      "runs.</p>\n",
      results.repetitions, r.width, r.height, escapeHtml(results.machine), escapeHtml(r.method), r.samples,
      formatDuration(r.seconds), formatError(r.error));
  if (const auto count = std::ranges::count_if(r.leftOut, [](auto each) { return each != 0; }); count > 0) {
    html += fmt::format(
        "<p>{:.2g}% of the image takes no part in errors: what is more than 20 times as bright as the rest, such as a "
        "lamp that is seen, would decide them alone.</p>\n",
        100.0 * static_cast<double>(count) / static_cast<double>(r.leftOut.size()));
  }
  if (const double share = results.machineTime.share(); share < 0.8) {
    html += fmt::format(
        "<p>The machine was busy with other work: it gave these renders {:.0f}% of the processors that they could use. "
        "Waiting is not counted, but times are less even than on an idle machine; errors are what they are.</p>\n",
        100 * share);
  }
  html += "<p class=\"soft\">The same render again, with the samples of its last round:</p><ul class=\"soft\">";
  for (const StudyCase& study : results.cases) {
    if (study.rounds.empty()) continue;
    std::string command = "aerosol render " + results.scene;
    for (const std::string& argument : study.arguments) command += " " + argument;
    html += fmt::format("<li><code>{} --spp {}</code></li>", escapeHtml(command), study.rounds.back().samples);
  }
  return html + "</ul>\n";
}

}  // namespace

std::string studyPage(const StudyResults& results, const std::vector<std::string>& pictures) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>What accuracy costs: {0}</title>\n<style>{1}</style>"
      "</head>\n<body><main>\n<h1>What accuracy costs</h1>\n<p class=\"soft\">{0}, by {2}</p>\n",
      escapeHtml(results.scene), style, escapeHtml(results.program));
  html += answerOf(results);
  html +=
      "<h2>Error against time</h2>\n<p class=\"soft\">Down is better, and so is left. Error has two parts: noise, "
      "which time "
      "takes away, and bias, which stays however long it renders: where a line goes flat it has met its bias. Bands "
      "are "
      "what chance may have done.</p>\n" +
      chartSvg(errorChart(results));
  html += "<h2>Noise and bias apart</h2>\n" + chartSvg(partsChart(results));
  html += "<h2>In equal time</h2>\n" + tableOf(results);
  html += "<h2>Side by side</h2>\n" + comparison(results, pictures);
  html += "<h2>How this was measured</h2>\n" + method(results);
  html += fmt::format("</main>\n<script>{}</script>\n</body></html>\n", script);
  return html;
}

}  // namespace aerosol::app
