#include "core/scene/spectrum_reader.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

#include "core/scene/syntax.h"

namespace aerosol::scene {

namespace {

constexpr const char* kinds[] = {"uniform", "srgb", "d65", "blackbody", "regular", "irregular"};

/// The parameters inside of one `<spectrum type="…">`, as texts.
class Parameters {
 public:
  Parameters(const XmlElement& xml, ReadContext context) : context_(context), place_(context.source.at(xml.offset)) {
    for (const XmlElement& child : xml.children) {
      if (child.tag != "float" && child.tag != "string" && child.tag != "rgb") {
        fail(context.source.at(child.offset), fmt::format("<{}> does not belong in <spectrum>", child.tag));
        continue;
      }
      const Attributes attributes(child, {"name", "value"}, {}, context);
      if (!attributes.valid()) {
        valid_ = false;
        continue;
      }
      texts_[attributes.text("name")] = {attributes.text("value"), attributes.at("value")};
    }
  }

  std::vector<double> numbers(const std::string& name, std::optional<double> standard = {}) {
    const auto found = texts_.find(name);
    if (found == texts_.end()) {
      if (!standard) fail(place_, fmt::format("this spectrum lacks its parameter '{}'", name));
      return {standard.value_or(0)};
    }
    TextError error;
    auto read = parseNumbers(found->second.first, error);
    if (!read || read->empty()) fail(found->second.second, read ? "a number is missing" : error.message);
    texts_.erase(found);
    return read && !read->empty() ? *read : std::vector<double>{0};
  }
  double number(const std::string& name, std::optional<double> standard = {}) { return numbers(name, standard)[0]; }
  Color color(const std::string& name, std::optional<Color> standard = {}) {
    if (standard && !texts_.contains(name)) return *standard;
    const SourceLocation place = texts_.contains(name) ? texts_[name].second : place_;
    const std::vector<double> channels = numbers(name);
    if (channels.size() != 1 && channels.size() != 3) fail(place, "a colour has one number or three");
    const auto channel = [&](std::size_t i) { return static_cast<float>(channels[channels.size() == 3 ? i : 0]); };
    return {channel(0), channel(1), channel(2)};
  }
  void fail(const SourceLocation& place, std::string message) {
    context_.reporter.error(place, std::move(message));
    valid_ = false;
  }
  /// Reports what nothing asked for.
  bool finish() {
    for (const auto& [name, text] : texts_) fail(text.second, fmt::format("this spectrum has no parameter '{}'", name));
    return valid_;
  }

 private:
  ReadContext context_;
  SourceLocation place_;
  std::map<std::string, std::pair<std::string, SourceLocation>> texts_;
  bool valid_ = true;
};

bool ascend(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(values[i] > values[i - 1])) return false;
  }
  return true;
}

std::optional<Value> readKind(const XmlElement& xml, const Attributes& attributes, SpectrumUse use,
                              ReadContext context) {
  const std::string type = attributes.text("type");
  Parameters parameters(xml, context);
  std::optional<Color> color;
  if (type == "uniform") {
    color = Color(static_cast<float>(parameters.number("value", 1)));
  } else if (type == "d65") {
    color = parameters.color("color", Color(1)) * static_cast<float>(parameters.number("scale", 1));
  } else if (type == "srgb") {
    color = parameters.color("color");
  } else if (type == "blackbody") {
    const double temperature = parameters.number("temperature"), scale = parameters.number("scale", 1);
    if (!(temperature > 0)) parameters.fail(attributes.at("type"), "'temperature' has to be > 0 K");
    color = colorOf([=](double w) { return scale * blackbodyRadiance(w, temperature); }, use);
  } else if (type == "regular" || type == "irregular") {
    Spectrum spectrum;
    spectrum.values = parameters.numbers("values");
    if (type == "irregular") {
      spectrum.wavelengths_nm = parameters.numbers("wavelengths");
    } else {
      const double from = parameters.number("wavelength_min"), to = parameters.number("wavelength_max");
      const double steps = static_cast<double>(spectrum.values.size()) - 1;
      for (std::size_t i = 0; i < spectrum.values.size(); ++i) {
        spectrum.wavelengths_nm.push_back(from + (to - from) * static_cast<double>(i) / std::max(steps, 1.0));
      }
    }
    const std::size_t count = spectrum.wavelengths_nm.size();
    if (count < 2 || count != spectrum.values.size() || !ascend(spectrum.wavelengths_nm)) {
      parameters.fail(attributes.at("type"),
                      "a spectrum needs as many values as wavelengths, which ascend: two at least");
    } else {
      color = colorOf(spectrum, use);
    }
  } else {
    context.reporter.error(attributes.at("type"), fmt::format("unknown spectrum type '{}'", type),
                           alternatives(type, {std::begin(kinds), std::end(kinds)}, "known types:"));
    return std::nullopt;
  }
  if (!parameters.finish() || !color) return std::nullopt;
  return Value(*color);
}

/// Lines of wavelength and value; # begins a comment.
std::optional<Value> readSpectrumFile(const Attributes& attributes, SpectrumUse use,
                                      const std::vector<std::filesystem::path>& searchPath, ReadContext context) {
  const std::string name = attributes.text("filename");
  const SourceLocation place = attributes.at("filename");
  const auto path = findFile(name, context.source.directory(), searchPath);
  if (!path) {
    context.reporter.error(place, fmt::format("there is no file '{}'", name),
                           {describeSearch(name, context.source.directory(), searchPath)});
    return std::nullopt;
  }
  std::string why;
  const std::optional<std::string> text = readFile(*path, why);
  if (!text) {
    context.reporter.error(place, fmt::format("'{}' cannot be read: {}", path->string(), why));
    return std::nullopt;
  }
  Spectrum spectrum;
  std::istringstream lines(*text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string_view content = trim(std::string_view(line).substr(0, line.find('#')));
    if (content.empty()) continue;
    TextError error;
    const auto pair = parseNumbers(content, error);
    if (!pair || pair->size() != 2) {
      context.reporter.error({path->string(), number, 1}, "a line of a spectrum holds a wavelength in nm and a value");
      return std::nullopt;
    }
    spectrum.wavelengths_nm.push_back((*pair)[0]);
    spectrum.values.push_back((*pair)[1]);
  }
  if (spectrum.values.size() < 2 || !ascend(spectrum.wavelengths_nm)) {
    context.reporter.error(place, "the file holds no two wavelengths, or they do not ascend");
    return std::nullopt;
  }
  return Value(colorOf(spectrum, use));
}

}  // namespace

std::optional<Value> readSpectrum(const XmlElement& xml, const Attributes& attributes, SpectrumUse use,
                                  const std::vector<std::filesystem::path>& searchPath, ReadContext context) {
  const int given = attributes.has("value") + attributes.has("type") + attributes.has("filename");
  if (given != 1) {
    context.reporter.error(context.source.at(xml.offset),
                           "<spectrum> needs 'value', 'filename' or 'type', one of them");
    return std::nullopt;
  }
  if (attributes.has("type")) return readKind(xml, attributes, use, context);
  if (attributes.has("filename")) return readSpectrumFile(attributes, use, searchPath, context);
  const Attribute& attribute = *attributes.find("value");
  TextError error;
  if (attribute.value.find(':') != std::string::npos) {
    const auto spectrum = parseSpectrum(attribute.value, error);
    if (spectrum) return Value(colorOf(*spectrum, use));
    attributes.report(attribute, error);
    return std::nullopt;
  }
  auto value = parseValue(ValueType::color, attribute.value, error);
  if (!value) {
    attributes.report(attribute, error);
    return std::nullopt;
  }
  const Color color = std::get<Color>(*value);
  const bool isOneNumber = attribute.value.find_first_of(", #") == std::string::npos;
  if (use == SpectrumUse::factor || !isOneNumber) return value;
  return Value(colorOf([](double) { return 1.0; }, use) * color.r);
}

}  // namespace aerosol::scene
