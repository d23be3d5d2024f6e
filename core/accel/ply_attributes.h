// Which properties of a PLY element make an attribute of the mesh. Internal to this folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/accel/mesh.h"
#include "core/accel/ply_header.h"

namespace aerosol::accel {

/// Properties, by index, that are the channels of one attribute.
struct PlyAttribute {
  std::string name;  ///< With its prefix.
  std::vector<std::size_t> properties;
  bool isColor = false;  ///< Whole numbers are colours encoded by sRGB; a fourth channel is linear.
};

/// Of the properties for which `isTaken` is false, lists left out. Mitsuba's rules: red green blue [alpha], or r g b
/// [a], are "color"; consecutive ones with the endings _x _y _z _w, _r _g _b _a, _0 _1 _2 _3 or _1 _2 _3 _4 belong
/// together under what stands before; any other is an attribute of its own. `prefix` is put in front of names that do
/// not have it.
std::vector<PlyAttribute> groupPlyAttributes(const PlyElement& element, std::string_view prefix,
                                             const std::vector<bool>& isTaken);

/// The values of one element's attributes while records are read, and where they go.
class PlyAttributeReader {
 public:
  PlyAttributeReader(const PlyElement& element, std::string_view prefix, const std::vector<bool>& isTaken);

  /// Whether a property belongs to an attribute.
  bool takes(std::size_t property) const { return channels_[property] >= 0; }
  /// A value of the record that is being read.
  void set(std::size_t property, double value);
  /// Appends the record to all attributes, `copies` times.
  void append(std::size_t copies);
  /// All attributes; the reader is empty afterwards.
  std::vector<MeshAttribute> finish() { return std::move(attributes_); }

 private:
  struct Channel {
    double scale = 1;
    bool isEncoded = false;
  };
  std::vector<int> channels_;  ///< By property: its place in `record_`, or -1.
  std::vector<Channel> decoding_;
  std::vector<float> record_;
  std::vector<MeshAttribute> attributes_;
};

}  // namespace aerosol::accel
