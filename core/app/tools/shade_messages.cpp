#include "core/app/tools/shade_messages.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/app/shader_report.h"

namespace aerosol::app {

namespace {

/// What a host function reports, "function: text", as OSL words it.
std::string hostText(const ShadedMessage& message) {
  const std::size_t colon = message.text.find(": ");
  const std::string function = message.text.substr(0, colon);
  std::string text = colon == std::string::npos ? message.text : message.text.substr(colon + 2);
  const auto place = [&] { return fmt::format("{}:{}", message.location.file, message.location.line); };
  if (function == "setmessage" || function == "getmessage") return fmt::format("{} from {}", text, place());
  if (function == "dict_find") return text;
  if (function == "colors") return text.substr(0, text.find("\": ") + 1);  // Without the spaces that there are.
  if (function == "texture" || function == "texture3d" || function == "environment") {
    const std::size_t reason = text.find("Invalid image file");
    return fmt::format("[RendererServices::{}] {}", function, reason == std::string::npos ? text : text.substr(reason));
  }
  return message.text;
}

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
      return fmt::format("ERROR: {}", hostText(message));
    default:
      return fmt::format("ERROR: {}: {}:{}", message.text, message.location.file, message.location.line);
  }
}

}  // namespace

void printRemarks(const Diagnostics& remarks, const Console& console) {
  std::set<std::string> said;
  std::fflush(console.out);
  for (const Diagnostic& each : remarks.entries()) {
    const std::string text = fmt::format("ERROR: {} ({}:{})\n", each.message, each.location.file, each.location.line);
    if (said.insert(text).second) console.note(text);
  }
}

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
