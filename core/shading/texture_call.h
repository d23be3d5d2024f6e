// A call of a texture function, read from its arguments. Internal to the host functions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/texture_source.h"
#include "core/lang/texture_options.h"
#include "core/shading/host_functions.h"

namespace aerosol::shading {

/// Arguments are laid out as TextureFunction says.
class TextureCall {
 public:
  TextureCall(PointCall& call, const lang::TextureFunction& function);

  /// Components of the result, and alpha behind them when it is asked for.
  int channels() const { return channels_; }
  /// What a lane asks for. Names of wraps and interpolations that there are not are reported.
  TexturePoint read(unsigned lane);
  /// Puts a lane's result in its place: `values` are `channels()` floats.
  void write(unsigned lane, const float* values);
  /// A lane's lookup went wrong: into its variable where there is one, otherwise a report.
  void fail(unsigned lane, std::string_view message);
  /// Sets the variable for messages to "" in all active lanes.
  void clearMessages();

 private:
  struct Option {
    lang::TextureOptionKind kind;
    int axis;
    std::size_t value;  ///< The argument's number.
  };
  bool isKnown(const lang::TextureOption& option, std::size_t value) const;
  void apply(const Option& option, unsigned lane, TexturePoint& point);
  void readCoordinates(unsigned lane, TexturePoint& point) const;

  PointCall& call_;
  const lang::TextureFunction& function_;
  std::vector<Option> known_;           ///< Constants of the program in front of the others: the same in every lane.
  std::vector<Option> options_;         ///< The others.
  std::optional<TexturePoint> common_;  ///< What the constants say; made for the first lane.
  std::size_t alpha_ = none, message_ = none;
  int resultChannels_ = 1, channels_ = 1;
  static constexpr std::size_t none = ~std::size_t{0};
};

}  // namespace aerosol::shading
