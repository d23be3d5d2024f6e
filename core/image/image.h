// Image files: pictures in memory, and reading and writing them with metadata and display transforms.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace aerosol::image {

/// A note in a file. Texts are not empty: the formats drop empty ones.
struct Metadata {
  std::string key;
  std::variant<std::string, std::int32_t, double> value;

  bool operator==(const Metadata&) const = default;
};

/// Another picture of the same pixels: a part of its own in EXR files, which other formats drop.
struct ImageLayer {
  std::string name;
  std::vector<std::string> channels;  ///< Full names, such as "direct.R".
  std::vector<float> pixels;          ///< width * height * channels.size() values.
  bool isData = false;                ///< Stored as float32 whatever the picture is.
  std::vector<Metadata> metadata;
};

/// A picture, or the part of one that a crop left: rows from the top, channels interleaved.
struct ImageBuffer {
  int width = 0, height = 0;
  /// Where the top left pixel is in the whole picture, and the whole picture's size; 0 x 0 stands for the part itself.
  int originX = 0, originY = 0;
  int fullWidth = 0, fullHeight = 0;
  /// "R", "G", "B" and "A" are the picture; others, such as "albedo.R", are kept in EXR only. Colours are multiplied by
  /// alpha.
  std::vector<std::string> channels;
  std::vector<float> pixels;  ///< width * height * channels.size() values.
  std::vector<Metadata> metadata;
  std::vector<ImageLayer> layers;
  std::string attachment;  ///< Bytes that EXR keeps beside the picture, in its last part; other formats drop them.
};

enum class PixelType : std::uint8_t { automatic, float32, float16, uint8, uint16 };

/// How linear values become those of a display, by OpenColorIO. Without a config (here or in $OCIO) a built-in one is
/// used: working spaces "lin_rec709" and "ACEScg", display "sRGB" with the views "sRGB" (the plain encoding),
/// "ACES 1.0 SDR" and "Raw".
struct DisplayOptions {
  std::string config;        ///< A config file; empty: $OCIO, or else the built-in config.
  std::string workingSpace;  ///< Colour space of the image; empty: the config's role scene_linear.
  std::string display;       ///< Empty: the config's default.
  std::string view;          ///< Empty: the display's default.
  float exposure = 0;        ///< Stops; 1 doubles the light.
};

struct WriteOptions {
  PixelType pixelType = PixelType::automatic;  ///< EXR: float32 or float16; PNG: uint8 or uint16; JPEG: uint8.
  std::string compression = "zip";             ///< EXR: none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab.
  int jpegQuality = 95;                        ///< 1 to 100.
  DisplayOptions display;                      ///< PNG and JPEG.
};

struct WriteReport {
  std::uint64_t nonFinite =
      0;  ///< Values that were NaN (shown as 0) or infinite (shown as the brightest) on a display.
};

/// What is wrong with a file's name: an extension that is no format that can be written. Nothing is looked up.
std::optional<Diagnostic> checkFileName(const std::string& path);

/// Writes .exr (values as they are; float16 saturates), .png or .jpg (through the display transform, rounded; JPEG
/// without alpha). The file is there completely or not at all: what stood there before stays until the new one is on
/// disk. Errors name the file.
Result<WriteReport> writeImage(const std::string& path, const ImageBuffer& image, const WriteOptions& options = {});

/// Reads any format OpenImageIO knows: the first part of the file as the picture, others of the same size as layers.
/// Values are as stored, integers scaled to [0, 1]; no colour space is undone, and colours are multiplied by alpha only
/// where the file has them so.
Result<ImageBuffer> readImage(const std::string& path);

/// "OpenImageIO 2.4.7.1" and the like, one entry a library. Loads the libraries.
Result<std::vector<std::string>> libraryVersions();

}  // namespace aerosol::image
