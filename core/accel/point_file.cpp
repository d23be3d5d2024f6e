// Files of points.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/accel/ply_values.h"
#include "core/accel/point_cloud.h"

namespace aerosol::accel {

namespace {

bool isInt(double value) {
  return value == std::trunc(value) && std::abs(value) <= static_cast<double>(std::numeric_limits<std::int32_t>::max());
}

bool isFloat(double value) { return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()); }

class PlyPoints {
 public:
  PlyPoints(const TextSource& source, const PlyHeader& header)
      : source_(source), header_(header), reader_(source, header.format, header.dataOffset) {}

  Result<std::vector<PointColumn>> read() {
    for (const PlyElement& element : header_.elements) {
      const bool isVertices = element.name == "vertex";
      if (isVertices) makeColumns(element);
      for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) {
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
          if (!readProperty(element.properties[k], isVertices ? columnOf_[k] : none)) return errors_;
        }
      }
      if (isVertices) return std::move(columns_);
    }
    return source_.at(0, "the file has no element 'vertex'");
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  void makeColumns(const PlyElement& element) {
    for (const PlyProperty& property : element.properties) {
      columnOf_.push_back(property.countType ? none : columns_.size());
      if (property.countType) continue;
      const bool isColor = property.type == PlyType::uint8 && (property.name == "red" || property.name == "green" ||
                                                               property.name == "blue" || property.name == "alpha");
      PointColumn column;
      column.name = property.name;
      column.isInteger = isInteger(property.type) && property.type != PlyType::uint32 && !isColor;
      columns_.push_back(std::move(column));
      scale_.push_back(isColor ? 1.0 / 255 : 1.0);
    }
  }

  bool readProperty(const PlyProperty& property, std::size_t column) {
    double count = 1;
    if (property.countType) {
      const auto length = reader_.read(*property.countType);
      if (!length || *length < 0) return fail();
      count = *length;
    }
    for (double i = 0; i < count; ++i) {
      const auto value = reader_.read(property.type);
      if (!value) return fail();
      if (column == none) continue;
      if (!isFloat(*value)) {
        errors_.add(reader_.error("'" + property.name + "' is not a finite number"));
        return false;
      }
      columns_[column].numbers.push_back(*value * scale_[column]);
    }
    return true;
  }

  bool fail() {
    errors_.add(reader_.readError());
    return false;
  }

  const TextSource& source_;
  const PlyHeader& header_;
  PlyValueReader reader_;
  std::vector<PointColumn> columns_;
  std::vector<std::size_t> columnOf_;  ///< By property.
  std::vector<double> scale_;          ///< By column.
  Diagnostics errors_;
};

/// RFC 4180: fields between commas, quoted ones with doubled quotes inside. Blanks around a field do not count; lines
/// that are empty or begin with # are left out.
class CsvReader {
 public:
  explicit CsvReader(const TextSource& source) : source_(source) {}

  Result<std::vector<PointColumn>> read() {
    std::vector<Field> names;
    if (!readLine(names)) return source_.at(0, "the file has no line of column names");
    std::vector<PointColumn> columns(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) columns[i].name = names[i].text;
    std::vector<Field> fields;
    std::vector<std::vector<std::string>> texts(names.size());
    while (readLine(fields)) {
      if (fields.size() != names.size()) {
        return source_.at(fields.empty() ? position_ : fields[0].offset,
                          "the line has " + std::to_string(fields.size()) + " fields and not " +
                              std::to_string(names.size()) + ", one for each column");
      }
      for (std::size_t i = 0; i < fields.size(); ++i) {
        texts[i].push_back(fields[i].text);
        const auto number = parseNumber(fields[i].text);
        if (!number || !isFloat(*number)) {
          columns[i].isText = true;
          const std::string& name = columns[i].name;
          if (name == "x" || name == "y" || name == "z")
            return source_.at(fields[i].offset, "a coordinate is a finite number");
        }
        columns[i].numbers.push_back(number.value_or(0));
      }
    }
    if (error_) return *error_;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      columns[i].isInteger = !columns[i].isText && std::ranges::all_of(columns[i].numbers, isInt);
      if (columns[i].isText) columns[i].texts = std::move(texts[i]);
    }
    return columns;
  }

 private:
  struct Field {
    std::string text;
    std::size_t offset = 0;
  };

  bool readLine(std::vector<Field>& fields) {
    const std::string_view text = source_.text();
    fields.clear();
    while (position_ < text.size() && !error_) {
      const std::size_t end = std::min(text.find('\n', position_), text.size());
      const std::size_t first = text.find_first_not_of(" \t\r", position_);
      if (first < end && text[first] != '#') {
        readFields(fields);
        return !error_.has_value();
      }
      position_ = end + 1;
    }
    return false;
  }

  void readFields(std::vector<Field>& fields) {
    const std::string_view text = source_.text();
    for (;;) {
      position_ = std::min(text.find_first_not_of(" \t", position_), text.size());
      Field& field = fields.emplace_back();
      field.offset = position_;
      if (position_ < text.size() && text[position_] == '"') {
        if (!readQuoted(field)) return;
      } else {
        const std::size_t end = std::min(text.find_first_of(",\n", position_), text.size());
        field.text = text.substr(position_, end - position_);
        while (!field.text.empty() && std::string_view(" \t\r").find(field.text.back()) != std::string_view::npos)
          field.text.pop_back();
        position_ = end;
      }
      if (position_ >= text.size() || text[position_] == '\n') {
        ++position_;
        return;
      }
      ++position_;
    }
  }

  bool readQuoted(Field& field) {
    const std::string_view text = source_.text();
    for (++position_; position_ < text.size(); ++position_) {
      if (text[position_] != '"') {
        field.text += text[position_];
      } else if (position_ + 1 < text.size() && text[position_ + 1] == '"') {
        field.text += '"';
        ++position_;
      } else {
        const std::size_t next = std::min(text.find_first_not_of(" \t\r", position_ + 1), text.size());
        if (next < text.size() && text[next] != ',' && text[next] != '\n') {
          error_ = source_.at(next, "expected a comma after the quoted field");
          return false;
        }
        position_ = next;
        return true;
      }
    }
    error_ = source_.at(field.offset, "the quoted field has no end");
    return false;
  }

  const TextSource& source_;
  std::size_t position_ = 0;
  std::optional<Diagnostic> error_;
};

Result<std::vector<PointColumn>> readColumns(const TextSource& source, const std::string& extension) {
  if (extension == ".csv") return CsvReader(source).read();
  const auto header = parsePlyHeader(source);
  if (!header) return header.errors();
  return PlyPoints(source, *header).read();
}

}  // namespace

Result<std::shared_ptr<const PointCloud>> readPoints(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  if (extension != ".ply" && extension != ".csv") {
    return Diagnostic{Severity::error, {path, 0, 0}, "point clouds are .ply or .csv files", {}, {}};
  }
  const auto source = TextSource::read(path);
  if (!source) return source.errors();
  auto columns = readColumns(*source, extension);
  if (!columns) return columns.errors();
  auto attributes = attributesOf(std::move(*columns));
  if (!attributes) return source->at(0, "the points have no position: columns x, y and z that follow one another");
  return makePointCloud(std::move(*attributes));
}

}  // namespace aerosol::accel
