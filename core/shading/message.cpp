#include "core/shading/message.h"

#include <fmt/format.h>

#include "core/lang/fold.h"
#include "core/lang/format_text.h"

namespace aerosol::shading {

std::string formatMessage(const std::string& format, const std::vector<lang::Type>& types,
                          const std::vector<AerosolRecordValue>& values, const StringLookup& text) {
  std::vector<lang::FormatArgument> arguments;
  std::size_t next = 0;
  for (const lang::Type& type : types) {
    lang::FormatArgument& scalars = arguments.emplace_back();
    for (std::size_t left = lang::leafCount(type); left > 0 && next < values.size(); --left) {
      const AerosolRecordValue value = values[next++];
      if (type.base == lang::BaseType::integer) {
        scalars.emplace_back(value.i);
      } else if (type.base == lang::BaseType::string) {
        scalars.emplace_back(text(value.s));
      } else {
        scalars.emplace_back(value.f);
      }
    }
  }
  return lang::formatText(format, arguments);
}

std::string describe(const Record& record, const jit::KernelInterface& interface, const StringLookup& text) {
  if (record.kind == AEROSOL_REPORT_HOST) {
    const lang::HostSite& site = interface.hostSites[record.site];
    return fmt::format("{}: {}", site.function, record.values.empty() ? std::string_view{} : text(record.values[0].s));
  }
  const jit::MessageSite& site = interface.sites[record.site];
  switch (site.kind) {
    case AEROSOL_MESSAGE_FILE:
      return formatMessage(site.format, {site.arguments.begin() + 1, site.arguments.end()},
                           {record.values.begin() + 1, record.values.end()}, text);
    case AEROSOL_REPORT_INDEX: {
      const int index = record.values.empty() ? 0 : record.values[0].i;
      const int length = record.values.size() < 2 ? 0 : record.values[1].i;
      return fmt::format("index {} is outside of '{}', which has {} elements", index, site.format, length);
    }
    case AEROSOL_REPORT_SPACE:
      return fmt::format("there is no coordinate system \"{}\"",
                         record.values.empty() ? std::string_view{} : text(record.values[0].s));
    case AEROSOL_REPORT_BUDGET:
      return "loop stopped: it ran out of its budget of iterations";
    default:
      return formatMessage(site.format, site.arguments, record.values, text);
  }
}

std::string fileOf(const Record& record, const StringLookup& text) { return std::string(text(record.values.at(0).s)); }

const SourceLocation& locationOf(const Record& record, const jit::KernelInterface& interface) {
  return record.kind == AEROSOL_REPORT_HOST ? interface.hostSites[record.site].location
                                            : interface.sites[record.site].location;
}

}  // namespace aerosol::shading
