#include "core/accel/obj.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "core/accel/text_source.h"
#include "core/accel/triangulate.h"

namespace aerosol::accel {

namespace {

constexpr std::uint32_t absent = 0xFFFFFFFFu;

struct Corner {
  std::uint32_t position = absent, uv = absent, normal = absent;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = c.position * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 32) ^ c.uv) * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 32) ^ c.normal) * 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

/// A word of the file and where it stands.
struct Token {
  std::string_view text;
  std::size_t offset = 0;
};

/// Which of a file's faces are wanted.
struct FaceChoice {
  explicit FaceChoice(std::string_view text) {
    for (std::string_view word = nextWord(text); !word.empty(); word = nextWord(text)) words.emplace_back(word);
    const auto drop = [&](std::string_view first) {
      const bool isThere = !words.empty() && words.front() == first;
      if (isThere) words.erase(words.begin());
      return isThere;
    };
    all = words.empty();
    isOthers = drop("not");
    byMaterial = drop("usemtl");
    if (!byMaterial) drop("o");
  }

  bool takes(std::string_view material, std::string_view object) const {
    if (all) return true;
    return (std::ranges::find(words, byMaterial ? material : object) != words.end()) != isOthers;
  }

  bool all = true, byMaterial = false, isOthers = false;
  std::vector<std::string> words;

 private:
  static std::string_view nextWord(std::string_view& text) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
  }
};

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

class ObjParser {
 public:
  ObjParser(const TextSource& source, Diagnostics& warnings, std::string_view faces)
      : source_(source), warnings_(warnings), choice_(faces), isTaken_(choice_.takes({}, {})) {}

  Result<TriangleMesh> parse() {
    while (readLine()) {
      if (!tokens_.empty()) parseStatement();
      if (errors_.hasErrors()) return errors_;
    }
    if (mesh_.triangles.empty()) warn(0, choice_.all ? "the file has no faces" : "the file has no such faces");
    if (!hasNormals_) mesh_.normals.clear();
    if (!hasUvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  /// Splits the next line, continued by a \ at its end, into `tokens_`; false at the end of the file.
  bool readLine() {
    const std::string_view text = source_.text();
    tokens_.clear();
    if (position_ >= text.size()) return false;
    while (position_ < text.size() && text[position_] != '\n') {
      const char c = text[position_];
      if (c == '\\' && isLineEnd(position_ + 1)) {
        position_ = text.find('\n', position_);
        if (position_ == std::string_view::npos) position_ = text.size();
        if (position_ < text.size()) ++position_;
      } else if (isBlank(c)) {
        ++position_;
      } else if (c == '#') {
        position_ = std::min(text.find('\n', position_), text.size());
      } else {
        readToken();
      }
    }
    ++position_;
    return true;
  }

  bool isLineEnd(std::size_t i) const {
    const std::string_view text = source_.text();
    if (i < text.size() && text[i] == '\r') ++i;
    return i >= text.size() || text[i] == '\n';
  }

  void readToken() {
    const std::string_view text = source_.text();
    const std::size_t start = position_;
    while (position_ < text.size() && !isBlank(text[position_]) && text[position_] != '\n' && text[position_] != '#' &&
           !(text[position_] == '\\' && isLineEnd(position_ + 1))) {
      ++position_;
    }
    tokens_.push_back({text.substr(start, position_ - start), start});
  }

  void parseStatement() {
    const std::string_view word = tokens_[0].text;
    if (word == "v") {
      parsePosition();
    } else if (word == "vt") {
      parseUv();
    } else if (word == "vn") {
      parseNormal();
    } else if (word == "f" || word == "fo") {
      parseFace();
    } else if (word == "usemtl" || word == "o" || word == "g") {
      (word == "usemtl" ? material_ : object_) = tokens_.size() > 1 ? tokens_[1].text : std::string_view();
      isTaken_ = choice_.takes(material_, object_);
    } else if (word == "p" || word == "l") {
      warnOnce(word == "p" ? pointsWarned_ : linesWarned_, word == "p" ? "points are left out" : "lines are left out");
    } else if (!isMeaningless(word)) {
      fail(tokens_[0], "'" + std::string(word) +
                           "' is not a polygonal OBJ statement; known are: v vt vn f o g s usemtl "
                           "mtllib p l");
    }
  }

  static bool isMeaningless(std::string_view word) {
    constexpr std::string_view words[] = {"s", "mg", "mtllib", "usemap", "maplib"};
    return std::ranges::find(words, word) != std::end(words);
  }

  /// Between `least` and `most` numbers after the keyword, each finite as a float.
  bool parseNumbers(std::size_t least, std::size_t most, float* values) {
    const std::size_t count = tokens_.size() - 1;
    if (count < least || count > most) {
      fail(tokens_[0], "'" + std::string(tokens_[0].text) + "' takes " + std::to_string(least) + " to " +
                           std::to_string(most) + " numbers, not " + std::to_string(count));
      return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = parseNumber(tokens_[i + 1].text);
      if (!value || std::abs(*value) > static_cast<double>(std::numeric_limits<float>::max())) {
        fail(tokens_[i + 1], "'" + std::string(tokens_[i + 1].text) + "' is not a finite number");
        return false;
      }
      values[i] = static_cast<float>(*value);
    }
    return true;
  }

  /// A weight or a colour may follow; neither is used.
  void parsePosition() {
    float v[7];
    if (parseNumbers(3, 7, v)) positions_.push_back({v[0], v[1], v[2]});
  }

  void parseUv() {
    float v[3] = {0, 0, 0};
    if (parseNumbers(1, 3, v)) uvs_.push_back({v[0], v[1]});
  }

  void parseNormal() {
    float v[3];
    if (parseNumbers(3, 3, v)) normals_.push_back(normalize(Normal<World>(v[0], v[1], v[2])));
  }

  void parseFace() {
    if (!isTaken_) return;
    if (tokens_.size() < 4) return fail(tokens_[0], "a face takes at least three corners");
    face_.clear();
    facePositions_.clear();
    for (std::size_t i = 1; i < tokens_.size(); ++i) {
      Corner corner;
      if (!parseCorner(tokens_[i], corner)) return;
      face_.push_back(vertexOf(corner));
      facePositions_.push_back(positions_[corner.position]);
    }
    if (face_.size() > mostCorners) {
      return fail(tokens_[0], "a face has at most " + std::to_string(mostCorners) + " corners");
    }
    faceTriangles_.clear();
    triangulate(facePositions_, faceTriangles_);
    for (const auto& t : faceTriangles_) mesh_.triangles.push_back({face_[t[0]], face_[t[1]], face_[t[2]]});
  }

  /// position, position/uv, position//normal or position/uv/normal.
  bool parseCorner(Token token, Corner& corner) {
    const std::size_t first = token.text.find('/');
    const std::size_t second = first == std::string_view::npos ? first : token.text.find('/', first + 1);
    const auto part = [&](std::size_t begin, std::size_t end) {
      return Token{token.text.substr(begin, end - begin), token.offset + begin};
    };
    if (!parseIndex(part(0, std::min(first, token.text.size())), positions_.size(), "v", corner.position)) return false;
    if (first == std::string_view::npos) return true;
    const Token uv = part(first + 1, std::min(second, token.text.size()));
    const bool mayBeEmpty = second != std::string_view::npos;
    if (!(uv.text.empty() && mayBeEmpty) && !parseIndex(uv, uvs_.size(), "vt", corner.uv)) return false;
    if (second == std::string_view::npos) return true;
    return parseIndex(part(second + 1, token.text.size()), normals_.size(), "vn", corner.normal);
  }

  bool parseIndex(Token token, std::size_t count, const char* kind, std::uint32_t& index) {
    const auto number = parseInteger(token.text);
    if (!number || *number == 0) {
      fail(token, "'" + std::string(token.text) +
                      "' is not an index; indices are whole numbers, 1 is the first and -1 "
                      "the last so far");
      return false;
    }
    const long long zeroBased = *number > 0 ? *number - 1 : static_cast<long long>(count) + *number;
    if (zeroBased < 0 || zeroBased >= static_cast<long long>(count) || zeroBased >= absent) {
      fail(token, "index " + std::string(token.text) + " is out of range: " + std::to_string(count) + " '" + kind +
                      "' come before");
      return false;
    }
    index = static_cast<std::uint32_t>(zeroBased);
    return true;
  }

  std::uint32_t vertexOf(const Corner& corner) {
    const auto [entry, isNew] = vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (isNew) {
      mesh_.positions.push_back(positions_[corner.position]);
      mesh_.uvs.push_back(corner.uv == absent ? TexCoord{} : uvs_[corner.uv]);
      mesh_.normals.push_back(corner.normal == absent ? Normal<World>() : normals_[corner.normal]);
      hasUvs_ |= corner.uv != absent;
      hasNormals_ |= corner.normal != absent;
    }
    return entry->second;
  }

  void fail(Token token, std::string message) { errors_.add(source_.at(token.offset, std::move(message))); }
  void warn(std::size_t offset, std::string message) {
    warnings_.add(source_.at(offset, std::move(message), Severity::warning));
  }
  void warnOnce(bool& isWarned, const char* message) {
    if (!isWarned) warn(tokens_[0].offset, message);
    isWarned = true;
  }

  const TextSource& source_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  FaceChoice choice_;
  std::string_view material_, object_;  ///< Of the faces to come: the last word of each kind.
  bool isTaken_;
  std::size_t position_ = 0;
  std::vector<Token> tokens_;
  std::vector<Point<World>> positions_;
  std::vector<TexCoord> uvs_;
  std::vector<Normal<World>> normals_;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;
  std::vector<std::uint32_t> face_;
  std::vector<Point<World>> facePositions_;
  std::vector<std::array<std::uint32_t, 3>> faceTriangles_;
  TriangleMesh mesh_;
  bool hasUvs_ = false, hasNormals_ = false, pointsWarned_ = false, linesWarned_ = false;
};

Result<TriangleMesh> parse(const TextSource& source, const Transform<World, Object>& toWorld, Diagnostics& warnings,
                           std::string_view faces) {
  auto mesh = ObjParser(source, warnings, faces).parse();
  if (mesh) transformMesh(*mesh, toWorld);
  return mesh;
}

}  // namespace

Result<TriangleMesh> loadObj(const std::string& path, const Transform<World, Object>& toWorld, Diagnostics& warnings,
                             std::string_view faces) {
  const auto source = TextSource::read(path);
  if (!source) return source.errors();
  return parse(*source, toWorld, warnings, faces);
}

Result<TriangleMesh> parseObj(const std::string& file, std::string text, const Transform<World, Object>& toWorld,
                              Diagnostics& warnings, std::string_view faces) {
  return parse(TextSource(file, std::move(text)), toWorld, warnings, faces);
}

}  // namespace aerosol::accel
