// A colour: three linear channels in the scene's working colour space.
#pragma once

#include <cmath>

namespace aerosol {

/// Linear red, green, blue. Also used for spectral coefficients (per scene unit) and throughputs (no unit).
struct Color {
  float r = 0, g = 0, b = 0;

  constexpr Color() = default;
  constexpr explicit Color(float grey) : r(grey), g(grey), b(grey) {}
  constexpr Color(float red, float green, float blue) : r(red), g(green), b(blue) {}

  constexpr float& operator[](int i) { return i == 0 ? r : i == 1 ? g : b; }
  constexpr float operator[](int i) const { return i == 0 ? r : i == 1 ? g : b; }

  constexpr Color& operator+=(Color o) { return *this = *this + o; }
  constexpr Color& operator*=(Color o) { return *this = *this * o; }
  constexpr Color& operator*=(float s) { return *this = *this * s; }

  friend constexpr Color operator+(Color p, Color q) { return {p.r + q.r, p.g + q.g, p.b + q.b}; }
  friend constexpr Color operator-(Color p, Color q) { return {p.r - q.r, p.g - q.g, p.b - q.b}; }
  friend constexpr Color operator*(Color p, Color q) { return {p.r * q.r, p.g * q.g, p.b * q.b}; }
  friend constexpr Color operator*(Color a, float s) { return {a.r * s, a.g * s, a.b * s}; }
  friend constexpr Color operator*(float s, Color a) { return a * s; }
  friend constexpr Color operator/(Color a, float s) { return {a.r / s, a.g / s, a.b / s}; }
  friend constexpr bool operator==(Color, Color) = default;
};

inline Color exp(Color c) { return {std::exp(c.r), std::exp(c.g), std::exp(c.b)}; }
inline Color abs(Color c) { return {std::fabs(c.r), std::fabs(c.g), std::fabs(c.b)}; }
constexpr float average(Color c) { return (c.r + c.g + c.b) * (1.0f / 3.0f); }
constexpr float maximum(Color c) { return c.r > c.g ? (c.r > c.b ? c.r : c.b) : (c.g > c.b ? c.g : c.b); }
constexpr float minimum(Color c) { return c.r < c.g ? (c.r < c.b ? c.r : c.b) : (c.g < c.b ? c.g : c.b); }
constexpr bool isBlack(Color c) { return c.r == 0 && c.g == 0 && c.b == 0; }
inline bool isFinite(Color c) { return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b); }

}  // namespace aerosol
