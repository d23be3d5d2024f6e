#include "core/scene/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace aerosol::scene {

namespace {

/// The CIE 1931 standard observer's matching functions and daylight D65, every 5 nm from 380 to 780.
struct Row {
  double x, y, z, d65;
};
constexpr std::array<Row, 81> observer{{
    {0.0014, 0, 0.0065, 49.98},      {0.0022, 0.0001, 0.0105, 52.31}, {0.0042, 0.0001, 0.0201, 54.65},
    {0.0076, 0.0002, 0.0362, 68.7},  {0.0143, 0.0004, 0.0679, 82.75}, {0.0232, 0.0006, 0.1102, 87.12},
    {0.0435, 0.0012, 0.2074, 91.49}, {0.0776, 0.0022, 0.3713, 92.46}, {0.1344, 0.004, 0.6456, 93.43},
    {0.2148, 0.0073, 1.0391, 90.06}, {0.2839, 0.0116, 1.3856, 86.68}, {0.3285, 0.0168, 1.623, 95.77},
    {0.3483, 0.023, 1.7471, 104.9},  {0.3481, 0.0298, 1.7826, 110.9}, {0.3362, 0.038, 1.7721, 117},
    {0.3187, 0.048, 1.7441, 117.4},  {0.2908, 0.06, 1.6692, 117.8},   {0.2511, 0.0739, 1.5281, 116.3},
    {0.1954, 0.091, 1.2876, 114.9},  {0.1421, 0.1126, 1.0419, 115.4}, {0.0956, 0.139, 0.813, 115.9},
    {0.058, 0.1693, 0.6162, 112.4},  {0.032, 0.208, 0.4652, 108.8},   {0.0147, 0.2586, 0.3533, 109.1},
    {0.0049, 0.323, 0.272, 109.4},   {0.0024, 0.4073, 0.2123, 108.6}, {0.0093, 0.503, 0.1582, 107.8},
    {0.0291, 0.6082, 0.1117, 106.3}, {0.0633, 0.71, 0.0782, 104.8},   {0.1096, 0.7932, 0.0573, 106.2},
    {0.1655, 0.862, 0.0422, 107.7},  {0.2257, 0.9149, 0.0298, 106},   {0.2904, 0.954, 0.0203, 104.4},
    {0.3597, 0.9803, 0.0134, 104.2}, {0.4334, 0.995, 0.0087, 104},    {0.5121, 1, 0.0057, 102},
    {0.5945, 0.995, 0.0039, 100},    {0.6784, 0.9786, 0.0027, 98.17}, {0.7621, 0.952, 0.0021, 96.33},
    {0.8425, 0.9154, 0.0018, 96.06}, {0.9163, 0.87, 0.0017, 95.79},   {0.9786, 0.8163, 0.0014, 92.24},
    {1.0263, 0.757, 0.0011, 88.69},  {1.0567, 0.6949, 0.001, 89.35},  {1.0622, 0.631, 0.0008, 90.01},
    {1.0456, 0.5668, 0.0006, 89.8},  {1.0026, 0.503, 0.0003, 89.6},   {0.9384, 0.4412, 0.0002, 88.65},
    {0.8544, 0.381, 0.0002, 87.7},   {0.7514, 0.321, 0.0001, 85.49},  {0.6424, 0.265, 0, 83.29},
    {0.5419, 0.217, 0, 83.49},       {0.4479, 0.175, 0, 83.7},        {0.3608, 0.1382, 0, 81.86},
    {0.2835, 0.107, 0, 80.03},       {0.2187, 0.0816, 0, 80.12},      {0.1649, 0.061, 0, 80.21},
    {0.1212, 0.0446, 0, 81.25},      {0.0874, 0.032, 0, 82.28},       {0.0636, 0.0232, 0, 80.28},
    {0.0468, 0.017, 0, 78.28},       {0.0329, 0.0119, 0, 74},         {0.0227, 0.0082, 0, 69.72},
    {0.0158, 0.0057, 0, 70.67},      {0.0114, 0.0041, 0, 71.61},      {0.0081, 0.0029, 0, 72.98},
    {0.0058, 0.0021, 0, 74.35},      {0.0041, 0.0015, 0, 67.98},      {0.0029, 0.001, 0, 61.6},
    {0.002, 0.0007, 0, 65.74},       {0.0014, 0.0005, 0, 69.89},      {0.001, 0.0004, 0, 72.49},
    {0.0007, 0.0002, 0, 75.09},      {0.0005, 0.0002, 0, 69.34},      {0.0003, 0.0001, 0, 63.59},
    {0.0002, 0.0001, 0, 55.01},      {0.0002, 0.0001, 0, 46.42},      {0.0001, 0, 0, 56.61},
    {0.0001, 0, 0, 66.81},           {0.0001, 0, 0, 65.09},           {0, 0, 0, 63.38},
}};

}  // namespace

double Spectrum::operator()(double wavelength_nm) const {
  const auto above = std::upper_bound(wavelengths_nm.begin(), wavelengths_nm.end(), wavelength_nm);
  if (above == wavelengths_nm.begin()) return 0;
  const auto i = static_cast<std::size_t>(above - wavelengths_nm.begin());
  if (above == wavelengths_nm.end()) return wavelengths_nm.back() == wavelength_nm ? values.back() : 0;
  const double part = (wavelength_nm - wavelengths_nm[i - 1]) / (wavelengths_nm[i] - wavelengths_nm[i - 1]);
  return values[i - 1] * (1 - part) + values[i] * part;
}

Color colorOf(const std::function<double(double)>& spectrum, SpectrumUse use) {
  double x = 0, y = 0, z = 0, norm = 0;
  for (std::size_t i = 0; i < observer.size(); ++i) {
    const Row& row = observer[i];
    const double light = use == SpectrumUse::factor ? row.d65 : 1;
    const double value = spectrum(380 + 5 * static_cast<double>(i)) * light;
    x += value * row.x;
    y += value * row.y;
    z += value * row.z;
    norm += light * row.y;
  }
  x /= norm;
  y /= norm;
  z /= norm;
  Color c(static_cast<float>(3.240479 * x - 1.537150 * y - 0.498535 * z),
          static_cast<float>(-0.969256 * x + 1.875991 * y + 0.041556 * z),
          static_cast<float>(0.055648 * x - 0.204043 * y + 1.057311 * z));
  // Colours outside of the space's triangle.
  for (int i = 0; i < 3; ++i) c[i] = std::max(c[i], 0.0f);
  return c;
}

double blackbodyRadiance(double wavelength_nm, double temperature_K) {
  constexpr double planck = 6.62607015e-34, light = 299792458, boltzmann = 1.380649e-23;
  const double wavelength = wavelength_nm * 1e-9;
  const double exponent = planck * light / (wavelength * boltzmann * temperature_K);
  return 1e-9 * 2 * planck * light * light / (std::pow(wavelength, 5) * std::expm1(exponent));
}

std::optional<Spectrum> parseSpectrum(std::string_view text, TextError& error) {
  Spectrum spectrum;
  std::size_t at = 0;
  while (at < text.size()) {
    at = text.find_first_not_of(", \t\r\n", at);
    if (at == text.npos) break;
    const std::size_t end = std::min(text.find_first_of(", \t\r\n", at), text.size());
    const std::string_view pair = text.substr(at, end - at);
    const std::size_t colon = pair.find(':');
    TextError inner;
    const auto fail = [&](std::size_t offset, std::string message) {
      error = {at + offset, std::move(message)};
      return std::nullopt;
    };
    if (colon == pair.npos) return fail(0, "write pairs of wavelength in nm and value: 400:0.1, 700:0.3");
    const auto wavelength = parseNumber(pair.substr(0, colon), inner);
    if (!wavelength) return fail(inner.offset, inner.message);
    const auto value = parseNumber(pair.substr(colon + 1), inner);
    if (!value) return fail(colon + 1 + inner.offset, inner.message);
    if (!spectrum.wavelengths_nm.empty() && *wavelength <= spectrum.wavelengths_nm.back()) {
      return fail(0, "wavelengths have to ascend");
    }
    spectrum.wavelengths_nm.push_back(*wavelength);
    spectrum.values.push_back(*value);
    at = end;
  }
  if (spectrum.values.size() >= 2) return spectrum;
  error = {0, "a spectrum needs two wavelengths at least: 400:0.1, 700:0.3"};
  return std::nullopt;
}

}  // namespace aerosol::scene
