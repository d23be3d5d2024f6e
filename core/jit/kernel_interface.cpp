#include "core/jit/kernel_interface.h"

#include <array>
#include <type_traits>
#include <utility>

#include "core/jit/bytes.h"

namespace aerosol::jit {

namespace {

/// Changes whenever the layout below does.
constexpr std::uint32_t formatVersion = 4;

struct GlobalPointers {
  int first;
  int count;
};
constexpr std::array<GlobalPointers, lang::globalCount> globalPointers = {{
    {0, 3},   // P
    {3, 3},   // I
    {6, 3},   // N
    {9, 3},   // Ng
    {12, 1},  // u
    {13, 1},  // v
    {14, 3},  // dPdu
    {17, 3},  // dPdv
    {20, 3},  // Ps
    {23, 1},  // time
    {24, 1},  // dtime
    {25, 3},  // dPdtime
    {28, 0},  // Ci
    {28, 3},  // dPdx
    {31, 3},  // dPdy
    {34, 3},  // dPdz
    {37, 3},  // dIdx
    {40, 3},  // dIdy
    {43, 1},  // dudx
    {44, 1},  // dudy
    {45, 1},  // dvdx
    {46, 1},  // dvdy
    {47, 3},  // dPsdx
    {50, 3},  // dPsdy
    {53, 1},  // flipHandedness
}};

/// Walks the fields of what is kept, once for both directions: `Stream` is a ByteWriter or a ByteReader.
template <class Stream>
class Transfer {
 public:
  explicit Transfer(Stream& stream) : stream_(stream) {}

  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

 private:
  static constexpr bool reads = std::is_same_v<Stream, ByteReader>;
  template <class T>
  using Field = std::conditional_t<reads, T, const T>;

  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<std::remove_const_t<T>, std::string>)
  void one(T& value) {
    if constexpr (reads) {
      stream_ >> value;
    } else {
      stream_ << value;
    }
  }
  template <class T>
  void one(std::vector<T>& values) {
    values.resize(stream_.count());
    for (T& value : values) one(value);
  }
  template <class T>
  void one(const std::vector<T>& values) {
    stream_ << static_cast<std::uint64_t>(values.size());
    for (const T& value : values) one(value);
  }
  void one(Field<lang::Type>& type) { (*this)(type.base, type.closure, type.arrayLength); }
  void one(Field<SourceLocation>& location) { (*this)(location.file, location.line, location.column); }
  void one(Field<OutputComponent>& output) {
    (*this)(output.kind, output.index, output.subIndex, output.component, output.type, output.part);
  }
  void one(Field<InstanceField>& field) { (*this)(field.parameter, field.isSetFlag, field.offset, field.type); }
  void one(Field<MessageSite>& site) { (*this)(site.kind, site.location, site.format, site.arguments); }
  void one(Field<lang::HostSite>& site) {
    (*this)(site.function, site.location, site.result, site.arguments, site.outputs, site.constants);
  }
  void one(Field<lang::ConstantValue>& value) {
    auto kind = static_cast<std::uint8_t>(value.index());
    (*this)(kind);
    if constexpr (reads) {
      if (kind == 1) value = std::vector<std::int32_t>{};
      if (kind == 2) value = std::vector<float>{};
      if (kind == 3) value = std::vector<std::string>{};
    }
    std::visit(
        [this]<class T>(T& leaves) {
          if constexpr (!std::is_same_v<std::remove_const_t<T>, std::monostate>) this->one(leaves);
        },
        value);
  }
  void one(Field<lang::ClosureLayer>& layer) { (*this)(layer.top, layer.weight); }
  void one(Field<lang::ClosureSite>& site) {
    (*this)(site.closure, site.location, site.parameterTypes, site.parameterNames, site.layers);
  }
  void one(std::map<std::uint64_t, std::string>& strings) {
    for (std::size_t count = stream_.count(); count > 0 && !stream_.failed(); --count) {
      std::uint64_t hash = 0;
      std::string text;
      (*this)(hash, text);
      strings.emplace(hash, std::move(text));
    }
  }
  void one(const std::map<std::uint64_t, std::string>& strings) {
    stream_ << static_cast<std::uint64_t>(strings.size());
    for (const auto& [hash, text] : strings) (*this)(hash, text);
  }

  Stream& stream_;
};

template <class Stream, class Interface>
void transfer(Stream& stream, Interface& interface) {
  Transfer<Stream> fields(stream);
  fields(interface.domain, interface.width, interface.globalsRead, interface.readsInstances,
         interface.readsInstanceData, interface.asksHostForSpaces, interface.instanceStride, interface.fields,
         interface.outputs, interface.sites, interface.hostSites, interface.dependsOnHost, interface.hasDeclaredRanges,
         interface.strings, interface.closureSites, interface.staticCost);
}

}  // namespace

int globalPointer(lang::Global global) { return globalPointers[static_cast<std::size_t>(global)].first; }

int globalComponents(lang::Global global) { return globalPointers[static_cast<std::size_t>(global)].count; }

bool KernelInterface::reads(lang::Global global) const {
  const std::uint64_t bits = ((std::uint64_t{1} << globalComponents(global)) - 1) << globalPointer(global);
  return (globalsRead & bits) != 0;
}

std::string serialise(const KernelInterface& interface) {
  ByteWriter out;
  out << formatVersion;
  transfer(out, interface);
  return out.take();
}

std::optional<KernelInterface> deserialiseInterface(std::string_view bytes) {
  ByteReader in(bytes);
  std::uint32_t version = 0;
  in >> version;
  if (version != formatVersion) return {};
  KernelInterface interface;
  transfer(in, interface);
  if (!in.atEnd()) return {};
  return interface;
}

}  // namespace aerosol::jit
