// Textures as shaders ask for them: the interface between the host services of compiled shaders and the library that
// filters images. It stands in the base layer because neither of the two layers sees the other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/color_source.h"

namespace aerosol {

enum class TextureKind : std::uint8_t {
  plane,       ///< At (s, t), with derivatives by x and y.
  volume,      ///< At a position in common space, with derivatives by x, y and z.
  environment  ///< By direction, with derivatives by x and y.
};

enum class TextureWrap : std::uint8_t { fromFile, black, clamp, periodic, mirror };
enum class TextureInterpolation : std::uint8_t { closest, linear, cubic, smartCubic };

/// By the names that shaders use, such as "periodic" and "smartcubic"; nothing when there is none of that name.
std::optional<TextureWrap> textureWrap(std::string_view name);
std::optional<TextureInterpolation> textureInterpolation(std::string_view name);

inline constexpr int maximumTextureChannels = 4;

/// One lookup: where, over which footprint, and how. Any value is allowed; those that are no numbers count as 0.
struct TexturePoint {
  float at[3] = {};
  float dx[3] = {}, dy[3] = {}, dz[3] = {};
  float blur[3] = {};          ///< In s, t and r, as parts of the whole image.
  float width[3] = {1, 1, 1};  ///< Factors on the derivatives in s, t and r.
  TextureWrap wrap[3] = {};
  TextureInterpolation interpolation = TextureInterpolation::smartCubic;
  std::int32_t firstChannel = 0;
  std::int32_t subimage = 0;
  std::string_view subimageName;  ///< Used instead of the number when it is not empty.
  std::string_view colorSpace;    ///< In which the file's colours are; empty: those of the render, or of no matter.
  float fill = 0;                 ///< Stands for channels that the file does not have.
  float time = 0;
  bool hasMissing = false;  ///< A file that cannot be read gives `missing` and is no failure.
  float missing[maximumTextureChannels] = {};
};

/// A lookup that found nothing to look up: its results are its fill value.
struct TextureFailure {
  std::size_t point = 0;
  std::string message;
};

/// The value of one entry of information about a file.
struct TextureInfoType {
  enum class Base : std::uint8_t { integer, floating, string } base = Base::integer;
  bool isTriple = false, isMatrix = false;
  int arrayLength = 0;  ///< 0: no array.

  int componentCount() const { return (isMatrix ? 16 : isTriple ? 3 : 1) * (arrayLength > 0 ? arrayLength : 1); }
};
struct TextureInfo {
  std::vector<std::int32_t> integers;
  std::vector<float> floats;
  std::vector<std::string> strings;
};

/// Least and greatest value of each channel over all levels of all subimages.
struct TextureRange {
  std::vector<float> least, greatest;
  bool hasNan = false;
};

/// Lookups of one thread. Results depend on the arguments alone, whatever other threads do.
class TextureSession {
 public:
  virtual ~TextureSession() = default;

  /// `points.size() * channels` values, channels (1 to 4) together. Failures are added in the order of the points.
  virtual void lookup(TextureKind kind, std::string_view file, std::span<const TexturePoint> points, int channels,
                      float* results, std::vector<TextureFailure>& failures) = 0;

  /// A value of the file's header, or of the tile of a UDIM set that (s, t) is in; nothing when there is none of that
  /// name and type, or no such file.
  virtual std::optional<TextureInfo> info(std::string_view file, const float* st, std::string_view name,
                                          const TextureInfoType& type) = 0;

  /// Nothing when the file cannot be read as one image (a set of UDIM tiles included). Reads the whole file once.
  /// Of the file as it is in the render, its colours taken for those of a colour space as in TexturePoint.
  virtual std::optional<TextureRange> range(std::string_view file, std::string_view colorSpace) = 0;
};

struct TextureSettings {
  std::vector<std::string> searchPath;  ///< Folders for names that are not absolute, the current one not included.
  int memory_MB = 1024;                 ///< For decoded texels of all threads together.
  ColorSettings colors;
};

class TextureSource {
 public:
  virtual ~TextureSource() = default;
  /// For one thread; it ends before the source does.
  virtual std::unique_ptr<TextureSession> openSession() = 0;
};

}  // namespace aerosol
