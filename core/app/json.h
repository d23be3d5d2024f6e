// JSON text, written piece by piece.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace aerosol::app {

/// Calls have to nest as the values do; members of objects are introduced by `key`. Numbers that are not finite become
/// null.
class JsonWriter {
 public:
  JsonWriter& beginObject() { return open('{'); }
  JsonWriter& endObject() { return close('}'); }
  JsonWriter& beginArray() { return open('['); }
  JsonWriter& endArray() { return close(']'); }
  JsonWriter& key(std::string_view name);
  JsonWriter& text(std::string_view value);
  JsonWriter& number(double value);
  JsonWriter& count(std::uint64_t value);
  JsonWriter& boolean(bool value);

  JsonWriter& text(std::string_view name, std::string_view value) { return key(name).text(value); }
  JsonWriter& number(std::string_view name, double value) { return key(name).number(value); }
  JsonWriter& count(std::string_view name, std::uint64_t value) { return key(name).count(value); }
  JsonWriter& boolean(std::string_view name, bool value) { return key(name).boolean(value); }

  /// Everything so far, with a line feed at the end.
  std::string finish() const { return text_ + "\n"; }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  void beginValue();
  void breakLine();

  std::string text_;
  int depth_ = 0;
  bool isFirst_ = true;
  bool afterKey_ = false;
};

}  // namespace aerosol::app
