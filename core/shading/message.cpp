#include "core/shading/message.h"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <cstring>

namespace aerosol::shading {

namespace {

/// One printf directive: `%`, flags, width, precision, conversion.
struct Directive {
  std::string flags;  ///< Between the percent sign and the conversion.
  char conversion = 's';
};

/// Reads a directive that begins behind a percent sign at `i`; leaves `i` behind it. False when the text ends too
/// early.
bool readDirective(const std::string& format, std::size_t& i, Directive& directive) {
  while (i < format.size() && std::strchr("-+ #0123456789.hlLqjzt", format[i])) {
    if (!std::strchr("hlLqjzt", format[i])) directive.flags += format[i];
    ++i;
  }
  if (i == format.size()) return false;
  directive.conversion = format[i++];
  return true;
}

int componentCount(const lang::Type& type) {
  const int elements = type.isArray() ? type.arrayLength : 1;
  return elements * (type.base == lang::BaseType::matrix ? 16 : type.isTriple() ? 3 : 1);
}

std::string formatComponent(const Directive& directive, lang::BaseType base, AerosolRecordValue value,
                            const StringLookup& text) {
  const char c = directive.conversion;
  const auto spec = [&](char conversion) { return "%" + directive.flags + conversion; };
  try {
    if (base == lang::BaseType::string) return fmt::sprintf(spec('s'), text(value.s));
    if (base == lang::BaseType::integer) {
      if (std::strchr("oxXc", c)) return fmt::sprintf(spec(c), value.i);
      if (std::strchr("eEfFgG", c)) return fmt::sprintf(spec(c), static_cast<double>(value.i));
      return fmt::sprintf(spec('d'), value.i);
    }
    if (std::strchr("di", c)) return fmt::sprintf(spec('d'), static_cast<long long>(value.f));
    return fmt::sprintf(spec(std::strchr("eEfFgG", c) ? c : 'g'), static_cast<double>(value.f));
  } catch (const fmt::format_error&) {
    return "%" + directive.flags + c;
  }
}

}  // namespace

std::string formatMessage(const std::string& format, const std::vector<lang::Type>& types,
                          const std::vector<AerosolRecordValue>& values, const StringLookup& text) {
  std::string result;
  std::size_t argument = 0;
  std::size_t value = 0;
  for (std::size_t i = 0; i < format.size();) {
    if (format[i] != '%') {
      result += format[i++];
      continue;
    }
    const std::size_t begin = i++;
    if (i < format.size() && format[i] == '%') {
      result += '%';
      ++i;
      continue;
    }
    Directive directive;
    if (!readDirective(format, i, directive) || argument == types.size()) {
      result += format.substr(begin, i - begin);
      continue;
    }
    const lang::Type& type = types[argument++];
    const lang::BaseType base =
        type.isTriple() || type.base == lang::BaseType::matrix ? lang::BaseType::floating : type.base;
    for (int k = 0; k < componentCount(type) && value < values.size(); ++k) {
      if (k > 0) result += ' ';
      result += formatComponent(directive, base, values[value++], text);
    }
  }
  return result;
}

std::string describe(const Record& record, const jit::MessageSite& site, const StringLookup& text) {
  switch (site.kind) {
    case AEROSOL_REPORT_INDEX: {
      const int index = record.values.empty() ? 0 : record.values[0].i;
      const int length = record.values.size() < 2 ? 0 : record.values[1].i;
      return fmt::format("index {} is outside of '{}', which has {} elements", index, site.format, length);
    }
    case AEROSOL_REPORT_BUDGET:
      return "loop stopped: it ran out of its budget of iterations";
    default:
      return formatMessage(site.format, site.arguments, record.values, text);
  }
}

}  // namespace aerosol::shading
