#include "core/render/aov/deep_pixels.h"

#include <array>
#include <cmath>

namespace aerosol::render {

namespace {

using Triple = std::array<double, 3>;

/// What is between two depths: opacity and light as parts of the whole pixel.
struct Piece {
  double front = 0, back = 0;
  Triple opacity{}, light{};

  bool isNothing() const {
    for (std::size_t c = 0; c < 3; ++c) {
      if (opacity[c] != 0 || light[c] != 0) return false;
    }
    return true;
  }
};

class PixelPieces {
 public:
  PixelPieces(const AovDeep& deep, std::span<const double> sums, std::uint32_t count)
      : deep_(deep), sums_(sums.subspan(deep.firstSlot)), scale_(count > 0 ? 1.0 / count : 0) {
    for (std::size_t slice = 0; slice < deep.slices(); ++slice) addSlice(slice);
    const std::uint32_t at = deep.backgroundAt();
    const double coverage = value(at + 3);
    add({deepBackground, deepBackground, {coverage, coverage, coverage}, triple(at)});
  }

  std::vector<Piece> take() { return std::move(pieces_); }

 private:
  double value(std::uint32_t at) const { return sums_[at] * scale_; }
  Triple triple(std::uint32_t at) const { return {value(at), value(at + 1), value(at + 2)}; }

  /// Of a slice that holds both, the medium comes first, and light is shared by opacity.
  void addSlice(std::size_t slice) {
    const std::uint32_t at = deep_.opacityAt(slice);
    const Triple opacity = deep_.isChromatic ? triple(at) : Triple{value(at), value(at), value(at)};
    const double all = (opacity[0] + opacity[1] + opacity[2]) / 3, surface = value(deep_.surfaceAt(slice));
    const double share = all > 0 ? std::fmin(std::fmax(surface / all, 0), 1) : 0;
    const Triple light = triple(deep_.lightAt(slice));
    Piece medium{static_cast<double>(deep_.depths[slice]), static_cast<double>(deep_.depths[slice + 1]), opacity,
                 light};
    Piece face = medium;
    face.front = face.back = surface > 0 ? value(deep_.surfaceAt(slice) + 1) / surface : medium.back;
    for (std::size_t c = 0; c < 3; ++c) {
      medium.opacity[c] -= face.opacity[c] *= share;
      medium.light[c] -= face.light[c] *= share;
    }
    // A surface near the front of its slice leaves the medium no more room.
    if (share > 0) medium.back = std::fmin(std::fmax(face.front, medium.front), medium.back);
    add(medium);
    if (share > 0) add(face);
  }

  void add(const Piece& piece) {
    if (!piece.isNothing()) pieces_.push_back(piece);
  }

  const AovDeep& deep_;
  std::span<const double> sums_;
  double scale_;
  std::vector<Piece> pieces_;
};

/// Estimates may be negative here and there. What is missing in a piece is taken from those behind it, and at the end
/// from those in front: each is 0 or more, and the sum stays.
void makeMonotone(std::vector<Piece>& pieces, Triple Piece::* part, std::size_t channel) {
  double sum = 0;
  for (const Piece& piece : pieces) sum += (piece.*part)[channel];
  if (sum <= 0) {
    // No order of things is darker than nothing: all of it is where the last piece is.
    for (Piece& piece : pieces) (piece.*part)[channel] = 0;
    if (!pieces.empty()) (pieces.back().*part)[channel] = sum;
    return;
  }
  double debt = 0;
  const auto pay = [&](Piece& piece) {
    double& own = (piece.*part)[channel];
    own += debt;
    debt = std::fmin(own, 0);
    own = std::fmax(own, 0);
  };
  for (Piece& piece : pieces) pay(piece);
  for (auto piece = pieces.rbegin(); piece != pieces.rend() && debt < 0; ++piece) pay(*piece);
}

/// Noise may also make more than all of the light end.
void limitOpacity(std::vector<Piece>& pieces) {
  for (std::size_t c = 0; c < 3; ++c) {
    double left = 1;
    for (Piece& piece : pieces) {
      piece.opacity[c] = std::fmin(std::fmax(piece.opacity[c], 0), left);
      left -= piece.opacity[c];
    }
  }
}

/// Runs of pieces that follow each other without a gap become one where the pieces' ends lie near enough to what it
/// says of them: inside of it transmittance falls like that of a constant medium, and light comes along with opacity
/// (the rule by which deep samples are cut).
class Joining {
 public:
  Joining(std::span<const Piece> pieces, double error) : pieces_(pieces), error_(error) {
    Triple through{1, 1, 1}, light{};
    transmittance_.push_back(through);
    light_.push_back(light);
    for (const Piece& piece : pieces) {
      for (std::size_t c = 0; c < 3; ++c) {
        through[c] -= piece.opacity[c];
        light[c] += piece.light[c];
      }
      transmittance_.push_back(through);
      light_.push_back(light);
    }
    for (const double whole : light) most_ = std::fmax(most_, std::fabs(whole));
  }

  std::vector<Piece> run() const {
    std::vector<Piece> joined;
    for (std::size_t first = 0; first < pieces_.size();) {
      std::size_t end = first + 1;
      while (end < pieces_.size() && follows(end) && fits(first, end + 1)) ++end;
      Piece whole{pieces_[first].front, pieces_[end - 1].back, {}, {}};
      for (std::size_t c = 0; c < 3; ++c) {
        whole.opacity[c] = transmittance_[first][c] - transmittance_[end][c];
        whole.light[c] = light_[end][c] - light_[first][c];
      }
      joined.push_back(whole);
      first = end;
    }
    return joined;
  }

 private:
  bool follows(std::size_t piece) const {
    const Piece &before = pieces_[piece - 1], &here = pieces_[piece];
    return before.back == here.front && before.front < before.back && here.front < here.back;
  }

  bool fits(std::size_t first, std::size_t end) const {
    const double length = pieces_[end - 1].back - pieces_[first].front;
    for (std::size_t i = first + 1; i < end; ++i) {
      const double part = (pieces_[i].front - pieces_[first].front) / length;
      for (std::size_t c = 0; c < 3; ++c) {
        const double t0 = transmittance_[first][c], t1 = std::fmax(transmittance_[end][c], 0);
        const double ratio = t0 > 0 ? std::fmax(t1 / t0, 1e-30) : 1, there = std::pow(ratio, part);
        if (std::fabs(t0 * there - transmittance_[i][c]) > error_) return false;
        const double share = ratio < 1 - 1e-9 ? (1 - there) / (1 - ratio) : part;
        const double light = light_[first][c] + (light_[end][c] - light_[first][c]) * share;
        if (std::fabs(light - light_[i][c]) > error_ * most_) return false;
      }
    }
    return true;
  }

  std::span<const Piece> pieces_;
  double error_, most_ = 0;
  std::vector<Triple> transmittance_, light_;  ///< Before each piece, and behind all.
};

}  // namespace

std::vector<DeepSample> deepSamples(const AovDeep& deep, std::span<const double> sums, std::uint32_t count,
                                    double error) {
  if (sums.empty() || count == 0) return {};
  std::vector<Piece> pieces = PixelPieces(deep, sums, count).take();
  for (std::size_t c = 0; c < 3; ++c) {
    makeMonotone(pieces, &Piece::opacity, c);
    makeMonotone(pieces, &Piece::light, c);
  }
  limitOpacity(pieces);
  // Behind this nothing is seen; light that noise has left there comes from the last place that is.
  constexpr double least = 1e-6;
  std::vector<DeepSample> samples;
  Triple left{1, 1, 1}, lastLeft{1, 1, 1};
  std::array<std::size_t, 3> last{};  // The last sample that is seen, by channel, and what is left in front of it.
  for (const Piece& piece : Joining(pieces, error).run()) {
    const bool isHidden = !(left[0] > least || left[1] > least || left[2] > least);
    if (!isHidden) samples.push_back({static_cast<float>(piece.front), static_cast<float>(piece.back), {}, {}});
    for (std::size_t c = 0; c < 3; ++c) {
      const int channel = static_cast<int>(c);
      if (left[c] > least) {
        last[c] = samples.size() - 1;
        lastLeft[c] = left[c];
        samples.back().opacity[channel] = static_cast<float>(std::fmin(piece.opacity[c] / left[c], 1));
      } else if (!isHidden) {
        samples.back().opacity[channel] = 1;
      }
      samples[last[c]].light[channel] += static_cast<float>(piece.light[c] / lastLeft[c]);
      left[c] -= piece.opacity[c];
    }
  }
  return samples;
}

DeepSample flatten(std::span<const DeepSample> samples) {
  DeepSample flat;
  Color left(1.0f);
  if (!samples.empty()) flat.front = samples.front().front;
  for (const DeepSample& sample : samples) {
    flat.light += left * sample.light;
    left *= Color(1.0f) - sample.opacity;
    flat.back = sample.back;
  }
  flat.opacity = Color(1.0f) - left;
  return flat;
}

}  // namespace aerosol::render
