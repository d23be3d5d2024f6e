#include "core/shading/native_call.h"

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace aerosol::shading {

namespace {

/// The host's table as one call sees it.
struct HostOfCall {
  AerosolShaderHost table;  // First: plugins give its address back.
  PointCall* call;
  std::string text;

  static const HostOfCall& of(const AerosolShaderHost* table) { return *reinterpret_cast<const HostOfCall*>(table); }
};

const char* textOf(const AerosolShaderHost* table, std::uint64_t string) {
  // Texts are not ended by a 0 where they are kept.
  auto& host = const_cast<HostOfCall&>(HostOfCall::of(table));
  host.text = host.call->strings().text(string);
  return host.text.c_str();
}

std::uint64_t stringOf(const AerosolShaderHost* table, std::uint32_t lane, const char* text, std::size_t length) {
  return HostOfCall::of(table).call->strings().add({text, length}, lane);
}

void reportOf(const AerosolShaderHost* table, std::uint32_t lane, const char* text) {
  HostOfCall::of(table).call->report(lane, text);
}

/// Copies of what is in lanes that make no call.
class OtherLanes {
 public:
  OtherLanes(const AerosolHostCall& raw, const PointCall& call) : raw_(raw) {
    const std::uint32_t all = raw.lanes == 1 ? 1u : (1u << raw.lanes) - 1;
    const std::uint32_t active = raw.lanes == 1 ? 1u : raw.active;
    if ((active & all) == all) return;
    others_ = all & ~active;
    std::size_t place = 0;
    const auto keep = [&](std::size_t argument) {
      const std::size_t width = call.type(argument).base == lang::BaseType::string ? 8 : 4;
      rows_.push_back({static_cast<char*>(raw.values[place]), call.componentCount(argument), width, {}});
      save(rows_.back());
    };
    if (!(call.site().result == lang::types::none)) {
      keep(PointCall::result);
      ++place;
    }
    for (std::size_t i = 0; i < call.argumentCount(); ++i, ++place)
      if ((call.site().outputs >> i & 1u) != 0) keep(i);
  }

  void restore() const {
    for (const Rows& rows : rows_) {
      const char* from = rows.saved.data();
      forEach(rows, [&](char* to) {
        std::memcpy(to, from, rows.width);
        from += rows.width;
      });
    }
  }

 private:
  struct Rows {
    char* memory;
    std::size_t components, width;
    std::vector<char> saved;
  };

  template <class Visit>
  void forEach(const Rows& rows, Visit&& visit) const {
    for (std::size_t c = 0; c < rows.components; ++c)
      for (std::uint32_t left = others_; left != 0; left &= left - 1)
        visit(rows.memory + (c * raw_.lanes + static_cast<std::size_t>(__builtin_ctz(left))) * rows.width);
  }
  void save(Rows& rows) const {
    forEach(rows, [&](const char* from) { rows.saved.insert(rows.saved.end(), from, from + rows.width); });
  }

  const AerosolHostCall& raw_;
  std::uint32_t others_ = 0;
  std::vector<Rows> rows_;
};

}  // namespace

void callNativeFunction(const ObjectFunction& function, const AerosolHostCall& raw, PointCall& call) {
  HostOfCall host{{sizeof(AerosolShaderHost), &textOf, &stringOf, &reportOf}, &call, {}};
  alignas(64) std::array<std::uint32_t, AEROSOL_MAXIMUM_WIDTH> mask{};
  for (std::uint32_t lane = 0; lane < raw.lanes; ++lane)
    mask[lane] = raw.lanes == 1 || (raw.active >> lane & 1u) != 0 ? ~0u : 0u;
  const AerosolLanes lanes{raw.lanes, 0, mask.data(), &host.table};
  if (raw.high) {
    function.range(&lanes, raw.values, raw.high);
    return;
  }
  const OtherLanes others(raw, call);
  function.evaluate(&lanes, raw.values);
  others.restore();
}

}  // namespace aerosol::shading
