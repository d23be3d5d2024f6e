#include "core/image/module/textures.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/image/module/texture_files.h"

namespace aerosol::image {

namespace {

using OIIO::ustring;

float numberOr0(float value) { return std::isnan(value) ? 0.0f : value; }

/// A coordinate whose texel index fits an int. Far outside the image only the phase within two periods matters to
/// repeating wraps, and only the side to the others.
float boundedCoordinate(float value) {
  constexpr float far = 16384;
  if (std::isnan(value)) return 0;
  if (std::abs(value) <= far) return value;
  const float phase = std::isfinite(value) ? std::fmod(std::abs(value), 2.0f) : 0.0f;
  return std::copysign(far + phase, value);
}

float boundedFootprint(float value) {
  constexpr float largest = 1e6f;  // far beyond where everything is the whole image's mean, and its square is finite
  return std::clamp(numberOr0(value), -largest, largest);
}

/// How a lookup changes from pixel to pixel, in s and t.
struct Footprint {
  std::array<float, 2> dx{}, dy{};
};

/// A blur widens the ellipse of the footprint, which OpenImageIO can do only of one that has an area: of a narrower one
/// the short axis becomes this part of the long one, of a point both become the least.
Footprint blurrable(Footprint f) {
  constexpr float narrowest = 1e-3f, least = 1e-6f;
  auto &longer = f.dx, &shorter = f.dy;
  if (std::hypot(shorter[0], shorter[1]) > std::hypot(longer[0], longer[1])) std::swap(longer, shorter);
  const float length = std::hypot(longer[0], longer[1]);
  if (!(length > least)) return {{least, 0}, {0, least}};
  const std::array<float, 2> along{longer[0] / length, longer[1] / length};
  const float across = along[0] * shorter[1] - along[1] * shorter[0];
  if (std::fabs(across) >= narrowest * length) return f;
  const float inside = along[0] * shorter[0] + along[1] * shorter[1];
  const float wide = std::copysign(narrowest * length, across);
  shorter = {inside * along[0] - wide * along[1], inside * along[1] + wide * along[0]};
  return f;
}

OIIO::TextureOpt::Wrap wrapOf(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::fromFile:
      return OIIO::TextureOpt::WrapDefault;
    case TextureWrap::black:
      return OIIO::TextureOpt::WrapBlack;
    case TextureWrap::clamp:
      return OIIO::TextureOpt::WrapClamp;
    case TextureWrap::periodic:
      return OIIO::TextureOpt::WrapPeriodic;
    case TextureWrap::mirror:
      return OIIO::TextureOpt::WrapMirror;
  }
  return OIIO::TextureOpt::WrapDefault;
}

OIIO::TextureOpt::InterpMode interpolationOf(TextureInterpolation interpolation) {
  switch (interpolation) {
    case TextureInterpolation::closest:
      return OIIO::TextureOpt::InterpClosest;
    case TextureInterpolation::linear:
      return OIIO::TextureOpt::InterpBilinear;
    case TextureInterpolation::cubic:
      return OIIO::TextureOpt::InterpBicubic;
    case TextureInterpolation::smartCubic:
      return OIIO::TextureOpt::InterpSmartBicubic;
  }
  return OIIO::TextureOpt::InterpSmartBicubic;
}

OIIO::TextureOpt optionsOf(const TexturePoint& point) {
  OIIO::TextureOpt options;
  options.firstchannel = std::max(point.firstChannel, 0);
  options.subimage = point.subimage;
  if (!point.subimageName.empty()) options.subimagename = ustring(point.subimageName);
  options.swrap = wrapOf(point.wrap[0]);
  options.twrap = wrapOf(point.wrap[1]);
  options.rwrap = wrapOf(point.wrap[2]);
  options.interpmode = interpolationOf(point.interpolation);
  options.sblur = std::max(boundedFootprint(point.blur[0]), 0.0f);
  options.tblur = std::max(boundedFootprint(point.blur[1]), 0.0f);
  options.rblur = std::max(boundedFootprint(point.blur[2]), 0.0f);
  options.swidth = boundedFootprint(point.width[0]);
  options.twidth = boundedFootprint(point.width[1]);
  options.rwidth = boundedFootprint(point.width[2]);
  options.fill = point.fill;
  options.time = numberOr0(point.time);
  options.missingcolor = point.hasMissing ? point.missing : nullptr;
  return options;
}

OIIO::TypeDesc typeOf(const TextureInfoType& type) {
  using OIIO::TypeDesc;
  const auto base = type.base == TextureInfoType::Base::integer    ? TypeDesc::INT
                    : type.base == TextureInfoType::Base::floating ? TypeDesc::FLOAT
                                                                   : TypeDesc::STRING;
  const auto aggregate = type.isMatrix ? TypeDesc::MATRIX44 : type.isTriple ? TypeDesc::VEC3 : TypeDesc::SCALAR;
  return TypeDesc(base, aggregate, type.isTriple ? TypeDesc::COLOR : TypeDesc::NOSEMANTICS, type.arrayLength);
}

class Session final : public TextureSession {
 public:
  explicit Session(TextureFiles& files)
      : files_(files), system_(files.system()), thread_(system_.create_thread_info()) {}
  ~Session() override { system_.destroy_thread_info(thread_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void lookup(TextureKind kind, std::string_view name, std::span<const TexturePoint> points, int channels,
              float* results, std::vector<TextureFailure>& failures) override {
    for (std::size_t i = 0; i < points.size(); ++i, results += channels) {
      TextureFile& file = find(name, points[i].colorSpace);
      std::string message = file.problem;
      if (!file.handle) {
        const bool hasMissing = points[i].hasMissing;
        for (int c = 0; c < channels; ++c) results[c] = hasMissing ? points[i].missing[c] : points[i].fill;
        if (!hasMissing) failures.push_back({i, std::move(message)});
        continue;
      }
      const Part part = partOf(kind, file, points[i]);
      if (!part.exists || !part.hasChannels) {
        std::fill(results, results + channels, points[i].fill);
        if (!part.exists) failures.push_back({i, noSubimage(name, points[i].subimage, part.subimages)});
        continue;
      }
      if (sample(kind, file, points[i], channels, results)) continue;
      message = system_.geterror();
      if (message.empty()) message = "no image for this place";
      failures.push_back({i, "cannot look up the texture \"" + std::string(name) + "\": " + message});
    }
  }

  std::optional<TextureInfo> info(std::string_view name, const float* st, std::string_view entry,
                                  const TextureInfoType& type) override {
    TextureFile& file = find(name, {});
    TextureInfo info;
    if (entry == "exists") {
      if (type.base != TextureInfoType::Base::integer || type.componentCount() != 1) return {};
      info.integers = {file.handle ? 1 : 0};
      return info;
    }
    OIIO::TextureSystem::TextureHandle* handle = file.handle;
    if (handle && st && file.isUdim) {
      handle = system_.resolve_udim(handle, thread_, boundedCoordinate(st[0]), boundedCoordinate(st[1]));
    }
    if (!handle || type.componentCount() > 1 << 16) return {};
    const auto count = static_cast<std::size_t>(type.componentCount());
    std::vector<ustring> strings;
    void* data = nullptr;
    if (type.base == TextureInfoType::Base::integer) {
      info.integers.resize(count);
      data = info.integers.data();
    } else if (type.base == TextureInfoType::Base::floating) {
      info.floats.resize(count);
      data = info.floats.data();
    } else {
      strings.resize(count);
      data = strings.data();
    }
    // OSL's name for what OpenImageIO calls texturetype.
    const ustring known(entry == "type" ? std::string_view("texturetype") : entry);
    const bool found = system_.get_texture_info(handle, thread_, 0, known, typeOf(type), data);
    (void)system_.geterror();
    if (!found) return {};
    for (const ustring& text : strings) info.strings.emplace_back(text.c_str() ? text.string() : std::string());
    return info;
  }

  std::optional<TextureRange> range(std::string_view name, std::string_view colorSpace) override {
    return files_.range(find(name, colorSpace));
  }

 private:
  TextureFile& find(std::string_view name, std::string_view colorSpace) {
    if (!colorSpace.empty()) {
      auto& converted = converted_[{std::string(name), std::string(colorSpace)}];
      if (!converted) converted = &files_.open(name, colorSpace);
      return *converted;
    }
    if (const auto known = opened_.find(name); known != opened_.end()) return *known->second;
    TextureFile& file = files_.open(name, {});
    opened_.emplace(name, &file);
    return file;
  }

  /// What of a file is asked for.
  struct Part {
    int subimages = 1;
    bool exists = true, hasChannels = true;
  };

  /// OpenImageIO reads subimages and first channels that a file does not have all the same.
  Part partOf(TextureKind kind, const TextureFile& file, const TexturePoint& point) {
    Part part;
    const bool isCounted = point.subimage != 0 && point.subimageName.empty();
    if (!isCounted && point.firstChannel <= 0) return part;
    OIIO::TextureSystem::TextureHandle* handle = file.handle;
    if (file.isUdim && kind == TextureKind::plane) {
      handle = system_.resolve_udim(handle, thread_, boundedCoordinate(point.at[0]), boundedCoordinate(point.at[1]));
    }
    if (!handle) return part;
    const auto number = [&](int subimage, const char* entry, int otherwise) {
      int value = otherwise;
      const bool isFound =
          system_.get_texture_info(handle, thread_, subimage, ustring(entry), OIIO::TypeDesc::INT, &value);
      if (!isFound) (void)system_.geterror();
      return isFound ? value : otherwise;
    };
    part.subimages = number(0, "subimages", 1);
    part.exists = !isCounted || (point.subimage > 0 && point.subimage < part.subimages);
    if (part.exists && point.firstChannel > 0) {
      const int subimage = isCounted ? point.subimage : 0;
      part.hasChannels = point.firstChannel < number(subimage, "channels", std::numeric_limits<int>::max());
    }
    return part;
  }

  static std::string noSubimage(std::string_view name, int subimage, int count) {
    return "the texture \"" + std::string(name) + "\" has no subimage " + std::to_string(subimage) + ", but " +
           std::to_string(count) + ", counted from 0";
  }

  /// The tile of a UDIM set, each of which is converted by itself.
  bool sampleTile(const TextureFile& file, const TexturePoint& point, int channels, float* result) {
    TexturePoint inside = point;
    for (int i = 0; i < 2; ++i) inside.at[i] = boundedCoordinate(point.at[i]);
    auto* const tile = system_.resolve_udim(file.handle, thread_, inside.at[0], inside.at[1]);
    if (!tile)
      return sample(TextureKind::plane, find(system_.filename_from_handle(file.handle).string(), {}), point, channels,
                    result);
    for (int i = 0; i < 2; ++i) inside.at[i] -= std::floor(inside.at[i]);
    TextureFile& converted = find(system_.filename_from_handle(tile).string(), file.convertedFrom);
    return converted.handle && sample(TextureKind::plane, converted, inside, channels, result);
  }

  bool sample(TextureKind kind, TextureFile& file, const TexturePoint& point, int channels, float* result) {
    if (!file.convertedFrom.empty() && kind == TextureKind::plane) return sampleTile(file, point, channels, result);
    OIIO::TextureOpt options = optionsOf(point);
    const auto triple = [](const float* v, auto&& bounded) {
      return Imath::V3f(bounded(v[0]), bounded(v[1]), bounded(v[2]));
    };
    switch (kind) {
      case TextureKind::plane: {
        Footprint footprint{{boundedFootprint(point.dx[0]), boundedFootprint(point.dx[1])},
                            {boundedFootprint(point.dy[0]), boundedFootprint(point.dy[1])}};
        if (options.sblur > 0 || options.tblur > 0) {
          for (auto* axis : {&footprint.dx, &footprint.dy}) {
            (*axis)[0] = boundedFootprint((*axis)[0] * options.swidth);
            (*axis)[1] = boundedFootprint((*axis)[1] * options.twidth);
          }
          options.swidth = options.twidth = 1;
          footprint = blurrable(footprint);
        }
        return system_.texture(file.handle, thread_, options, boundedCoordinate(point.at[0]),
                               boundedCoordinate(point.at[1]), footprint.dx[0], footprint.dx[1], footprint.dy[0],
                               footprint.dy[1], channels, result);
      }
      case TextureKind::volume:
        return system_.texture3d(file.handle, thread_, options, triple(point.at, boundedCoordinate),
                                 triple(point.dx, boundedFootprint), triple(point.dy, boundedFootprint),
                                 triple(point.dz, boundedFootprint), channels, result);
      case TextureKind::environment:
        return system_.environment(file.handle, thread_, options, triple(point.at, boundedCoordinate),
                                   triple(point.dx, boundedFootprint), triple(point.dy, boundedFootprint), channels,
                                   result);
    }
    return false;
  }

  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };

  TextureFiles& files_;
  OIIO::TextureSystem& system_;
  OIIO::TextureSystem::Perthread* thread_;
  std::unordered_map<std::string, TextureFile*, Hash, std::equal_to<>> opened_;
  std::map<std::pair<std::string, std::string>, TextureFile*> converted_;  ///< By file and colour space.
};

class Source final : public TextureSource {
 public:
  explicit Source(const TextureSettings& settings) : files_(settings) {}
  std::unique_ptr<TextureSession> openSession() override { return std::make_unique<Session>(files_); }

 private:
  TextureFiles files_;
};

}  // namespace

std::unique_ptr<TextureSource> makeTextures(const TextureSettings& settings, std::string& message) {
  if (settings.memory_MB < 16) {
    message = "textures need at least 16 MB of memory";
    return nullptr;
  }
  return std::make_unique<Source>(settings);
}

}  // namespace aerosol::image
