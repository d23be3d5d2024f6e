#include "core/app/tools/shade_messages.h"

#include <fmt/format.h>

#include <set>

namespace aerosol::app {

namespace {

std::string textOf(const ShadedMessage& message, const ShadedPlace& place) {
  switch (message.kind) {
    case AEROSOL_MESSAGE_WARNING:
      return fmt::format("WARNING: Shader warning [{}]: {}", place.shader, message.text);
    case AEROSOL_MESSAGE_ERROR:
      return fmt::format("ERROR: Shader error [{}]: {}", place.shader, message.text);
    case AEROSOL_REPORT_INDEX: {
      const std::int32_t index = message.values[0].i, length = message.values[1].i;
      return fmt::format("ERROR: Index [{}] out of range {}[0..{}]: {}:{} (group {}, layer {} {}, shader {})", index,
                         message.text, length - 1, message.location.file, message.location.line, place.group,
                         place.layerNumber, place.layer, place.shader);
    }
    case AEROSOL_REPORT_HOST:
      return fmt::format("ERROR: {}", message.text);
    default:
      return fmt::format("ERROR: {}: {}:{}", message.text, message.location.file, message.location.line);
  }
}

}  // namespace

void printShadedMessages(const std::vector<ShadedMessage>& messages, const ShadedPlace& place, const Console& console) {
  std::set<std::string> said;
  for (const ShadedMessage& message : messages) {
    if (message.kind == AEROSOL_MESSAGE_PRINT) {
      console.print(message.text);
      continue;
    }
    const std::string text = textOf(message, place);
    if (!said.insert(text).second) continue;
    std::fflush(console.out);
    console.note(text + "\n");
  }
}

}  // namespace aerosol::app
