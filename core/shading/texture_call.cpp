#include "core/shading/texture_call.h"

#include <algorithm>

namespace aerosol::shading {

using lang::TextureOptionKind;

TextureCall::TextureCall(PointCall& call, const lang::TextureFunction& function) : call_(call), function_(function) {
  std::size_t next = function.argumentCount();
  for (; next < call.argumentCount() && (call.site().outputs >> next & 1u) != 0; ++next) {
    (call.type(next) == lang::types::string ? message_ : alpha_) = next;
  }
  for (; next + 1 < call.argumentCount(); next += 2) {
    const auto* name = std::get_if<std::vector<std::string>>(&call.site().constants[next]);
    const lang::TextureOption* option = name && !name->empty() ? lang::findTextureOption(name->front()) : nullptr;
    if (!option) continue;
    (options_.empty() && isKnown(*option, next + 1) ? known_ : options_)
        .push_back({option->kind, option->axis, next + 1});
  }
  resultChannels_ = static_cast<int>(call.componentCount(PointCall::result));
  channels_ = resultChannels_ + (alpha_ == none ? 0 : 1);
}

/// Is the value a constant that no lane has anything to report about?
bool TextureCall::isKnown(const lang::TextureOption& option, std::size_t value) const {
  const lang::ConstantValue& constant = call_.site().constants[value];
  if (std::holds_alternative<std::monostate>(constant)) return false;
  const auto* texts = std::get_if<std::vector<std::string>>(&constant);
  if (!texts || texts->empty()) return true;
  if (option.kind == TextureOptionKind::wrap) return textureWrap(texts->front()).has_value();
  return option.kind != TextureOptionKind::interpolation || textureInterpolation(texts->front()).has_value();
}

void TextureCall::readCoordinates(unsigned lane, TexturePoint& point) const {
  if (function_.coordinates == 2) {  // s, t, then dsdx, dtdx, dsdy, dtdy
    for (std::size_t i = 0; i < 2; ++i) {
      point.at[i] = call_.floating(1 + i, lane);
      point.dx[i] = call_.floating(3 + i, lane);
      point.dy[i] = call_.floating(5 + i, lane);
    }
    return;
  }
  float* const places[4] = {point.at, point.dx, point.dy, point.dz};
  for (std::size_t k = 0; k <= function_.derivatives; ++k)
    for (std::size_t c = 0; c < 3; ++c) places[k][c] = call_.floating(1 + k, lane, c);
}

void TextureCall::apply(const Option& option, unsigned lane, TexturePoint& point) {
  const auto forAxes = [&](auto* values, auto value) {
    for (int axis = 0; axis < 3; ++axis)
      if (option.axis < 0 || option.axis == axis) values[axis] = value;
  };
  const std::size_t at = option.value;
  switch (option.kind) {
    case TextureOptionKind::blur:
      return forAxes(point.blur, call_.floating(at, lane));
    case TextureOptionKind::width:
      return forAxes(point.width, call_.floating(at, lane));
    case TextureOptionKind::wrap:
      if (const auto wrap = textureWrap(call_.text(at, lane))) return forAxes(point.wrap, *wrap);
      return call_.report(lane, "unknown wrap mode \"" + std::string(call_.text(at, lane)) + "\"");
    case TextureOptionKind::firstChannel:
      point.firstChannel = call_.integer(at, lane);
      return;
    case TextureOptionKind::subimage:
      if (call_.type(at) == lang::types::string) {
        point.subimageName = call_.text(at, lane);
      } else {
        point.subimage = call_.integer(at, lane);
      }
      return;
    case TextureOptionKind::fill:
      point.fill = call_.floating(at, lane);
      return;
    case TextureOptionKind::missingColor:
      point.hasMissing = true;
      for (std::size_t c = 0; c < 3; ++c) point.missing[c] = call_.floating(at, lane, c);
      return;
    case TextureOptionKind::missingAlpha:
      point.missing[maximumTextureChannels - 1] = call_.floating(at, lane);
      return;
    case TextureOptionKind::time:
      point.time = call_.floating(at, lane);
      return;
    case TextureOptionKind::interpolation:
      if (const auto known = textureInterpolation(call_.text(at, lane))) {
        point.interpolation = *known;
        return;
      }
      return call_.report(lane, "unknown interpolation \"" + std::string(call_.text(at, lane)) + "\"");
    case TextureOptionKind::colorSpace:
      point.colorSpace = call_.text(at, lane);
      return;
    case TextureOptionKind::alpha:
    case TextureOptionKind::errorMessage:
      return;
  }
}

TexturePoint TextureCall::read(unsigned lane) {
  if (!common_) {
    common_.emplace();
    for (const Option& option : known_) apply(option, lane, *common_);
  }
  TexturePoint point = *common_;
  readCoordinates(lane, point);
  for (const Option& option : options_) apply(option, lane, point);
  // A single channel's alpha is the one behind it.
  if (alpha_ != none && resultChannels_ == 1) point.missing[1] = point.missing[maximumTextureChannels - 1];
  return point;
}

void TextureCall::write(unsigned lane, const float* values) {
  for (int c = 0; c < resultChannels_; ++c) call_.set(PointCall::result, lane, values[c], static_cast<std::size_t>(c));
  if (alpha_ != none) call_.set(alpha_, lane, values[resultChannels_]);
}

void TextureCall::fail(unsigned lane, std::string_view message) {
  if (message_ == none) {
    call_.report(lane, message);
  } else {
    call_.set(message_, lane, message);
  }
}

void TextureCall::clearMessages() {
  if (message_ == none) return;
  call_.forEachLane([&](unsigned lane) { call_.setHash(message_, lane, 0); });
}

}  // namespace aerosol::shading
