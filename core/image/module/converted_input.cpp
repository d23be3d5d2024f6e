#include "core/image/module/converted_input.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace aerosol::image {

namespace {

constexpr const char* fileEntry = "aerosol:file";
constexpr const char* transformEntry = "aerosol:transform";
constexpr const char* straightEntry = "oiio:UnassociatedAlpha";

/// The first three channels, or those that there are in front of an alpha, are colour.
class Converter {
 public:
  Converter(const ColorTransform& transform, const OIIO::ImageSpec& spec)
      : transform_(transform),
        channels_(static_cast<std::size_t>(spec.nchannels)),
        alpha_(spec.alpha_channel),
        colors_(std::min(spec.nchannels, spec.alpha_channel < 0 ? 3 : std::min(3, spec.alpha_channel))) {}

  /// Alpha stays; colours are multiplied by it in files, and not when they are converted.
  void apply(float* texels, std::size_t count) const {
    if (colors_ <= 0) return;
    const auto last = static_cast<std::size_t>(colors_ - 1);
    for (std::size_t i = 0; i < count; ++i, texels += channels_) {
      const float alpha = alpha_ >= 0 ? texels[alpha_] : 1.0f;
      const float scale = alpha > 0 ? alpha : 1.0f;
      float color[3];
      for (std::size_t c = 0; c < 3; ++c) color[c] = texels[std::min(c, last)] / scale;
      transform_.apply(color, 1);
      for (std::size_t c = 0; c <= last; ++c) texels[c] = color[c] * scale;
    }
  }

 private:
  const ColorTransform& transform_;
  std::size_t channels_;
  int alpha_, colors_;
};

class ConvertedInput final : public OIIO::ImageInput {
 public:
  const char* format_name() const override { return "converted"; }
  int supports(OIIO::string_view feature) const override { return inner_ ? inner_->supports(feature) : 0; }

  bool open(const std::string&, OIIO::ImageSpec&) override { return false; }
  bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
    std::uint64_t address = 0;
    const bool isStraight = config.get_int_attribute(straightEntry) != 0;
    if (!config.getattribute(transformEntry, OIIO::TypeUInt64, &address) || (address == 0 && !isStraight)) return false;
    std::memcpy(&transform_, &address, sizeof(transform_));
    OIIO::ImageSpec hints;
    if (isStraight) hints.attribute(straightEntry, 1);
    inner_ = OIIO::ImageInput::open(std::string(config.get_string_attribute(fileEntry)), &hints);
    if (!inner_) {
      errorfmt("{}", OIIO::geterror());
      return false;
    }
    takeSpec();
    spec = m_spec;
    return true;
  }
  bool close() override {
    const bool isClosed = !inner_ || inner_->close();
    inner_.reset();
    return isClosed;
  }
  int current_subimage() const override { return inner_ ? inner_->current_subimage() : -1; }
  int current_miplevel() const override { return inner_ ? inner_->current_miplevel() : -1; }
  bool seek_subimage(int subimage, int level) override {
    if (!inner_ || !inner_->seek_subimage(subimage, level)) return false;
    takeSpec();
    return true;
  }
  bool read_native_scanline(int subimage, int level, int y, int z, void* data) override {
    const lock_guard lock(*this);
    if (!seek_subimage(subimage, level)) return false;
    if (!inner_->read_scanline(y, z, OIIO::TypeFloat, data)) return fail();
    if (transform_)
      Converter(*transform_, m_spec).apply(static_cast<float*>(data), static_cast<std::size_t>(m_spec.width));
    return true;
  }
  bool read_native_tile(int subimage, int level, int x, int y, int z, void* data) override {
    const lock_guard lock(*this);
    if (!seek_subimage(subimage, level)) return false;
    if (!inner_->read_tile(x, y, z, OIIO::TypeFloat, data)) return fail();
    if (transform_)
      Converter(*transform_, m_spec).apply(static_cast<float*>(data), static_cast<std::size_t>(m_spec.tile_pixels()));
    return true;
  }

 private:
  void takeSpec() {
    m_spec = inner_->spec();
    m_spec.set_format(OIIO::TypeFloat);
    m_spec.channelformats.clear();
  }
  bool fail() {
    errorfmt("{}", inner_->geterror());
    return false;
  }

  std::unique_ptr<OIIO::ImageInput> inner_;
  const ColorTransform* transform_ = nullptr;
};

OIIO::ImageInput* makeInput() { return new ConvertedInput; }

}  // namespace

void addConverted(OIIO::ImageCache& cache, OIIO::ustring name, const std::string& file,
                  const ColorTransform* transform) {
  OIIO::ImageSpec config;
  std::uint64_t address = 0;
  std::memcpy(&address, &transform, sizeof(transform));
  if (!transform) config.attribute(straightEntry, 1);
  config.attribute(fileEntry, file);
  config.attribute(transformEntry, OIIO::TypeUInt64, &address);
  cache.add_file(name, makeInput, &config);
}

}  // namespace aerosol::image
