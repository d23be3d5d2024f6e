#include "core/app/tools/shade_messages.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/app/shader_report.h"

namespace aerosol::app {

namespace {

std::string textOf(const ShadedMessage& message, const ShadeGroup& group) {
  const std::size_t number = group.layerAt(message.location);
  const ShadeGroup::Layer& layer = group.layers[number];
  switch (message.kind) {
    case AEROSOL_MESSAGE_WARNING:
      return fmt::format("WARNING: Shader warning [{}]: {}", layer.shader, message.text);
    case AEROSOL_MESSAGE_ERROR:
      return fmt::format("ERROR: Shader error [{}]: {}", layer.shader, message.text);
    case AEROSOL_REPORT_INDEX: {
      const std::int32_t index = message.values[0].i, length = message.values[1].i;
      // Parameters of a group are named with their layer.
      const std::string prefix = layer.name + ".";
      const std::string name = message.text.starts_with(prefix) ? message.text.substr(prefix.size()) : message.text;
      return fmt::format("ERROR: Index [{}] out of range {}[0..{}]: {}:{} (group {}, layer {} {}, shader {})", index,
                         name, length - 1, message.location.file, message.location.line, group.name, number, layer.name,
                         layer.shader);
    }
    case AEROSOL_REPORT_SPACE:
      return fmt::format("ERROR: Unknown transformation \"{}\"", message.text);
    case AEROSOL_REPORT_HOST:
      return fmt::format("ERROR: {}", message.text);
    default:
      return fmt::format("ERROR: {}: {}:{}", message.text, message.location.file, message.location.line);
  }
}

}  // namespace

Diagnostics printShadedMessages(const std::vector<ShadedMessage>& messages, const ShadeGroup& group,
                                const Console& console) {
  std::set<std::string> said;
  std::map<std::string, std::string> files;
  for (const ShadedMessage& message : messages) {
    if (message.kind == AEROSOL_MESSAGE_PRINT) {
      console.print(message.text);
      continue;
    }
    if (message.kind == AEROSOL_MESSAGE_FILE) {
      files[message.file] += message.text;
      continue;
    }
    const std::string text = textOf(message, group);
    if (!said.insert(text).second) continue;
    std::fflush(console.out);
    console.note(text + "\n");
  }
  return appendToFiles(files);
}

}  // namespace aerosol::app
