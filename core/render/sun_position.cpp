#include "core/render/sun_position.h"

#include <cmath>
#include <numbers>

namespace aerosol::render {

namespace {

constexpr double pi = std::numbers::pi;

/// Days since noon of 1 January 2000, universal time.
double daysSince2000(const scene::SunPlace& place, double universalHours) {
  // The day's Julian number by whole divisions that cut off towards zero (Fliegel and van Flandern 1968).
  const int early = (place.month - 14) / 12;
  const int day = 1461 * (place.year + 4800 + early) / 4 + 367 * (place.month - 2 - 12 * early) / 12 -
                  3 * ((place.year + 4900 + early) / 100) / 4 + place.day - 32075;
  return day - 0.5 + universalHours / 24 - 2451545;
}

}  // namespace

// Blanco-Muriel, Alarcón-Padilla, López-Moratalla and Lara-Coira, "Computing the Solar Vector", Solar Energy 70 (2001):
// the sun's ecliptic longitude by its mean anomaly, turned to the equator, then to the horizon by sidereal time, with
// the parallax of the earth's radius.
Vector<Object> sunDirection(const scene::SunPlace& place) {
  const double hours = static_cast<double>(place.hour) - static_cast<double>(place.timezone) +
                       (static_cast<double>(place.minute) + static_cast<double>(place.second) / 60) / 60;
  const double days = daysSince2000(place, hours);
  const double node = 2.1429 - 0.0010394594 * days;
  const double meanLongitude = 4.8950630 + 0.017202791698 * days, anomaly = 6.2400600 + 0.0172019699 * days;
  const double longitude = meanLongitude + 0.03341607 * std::sin(anomaly) + 0.00034894 * std::sin(2 * anomaly) -
                           0.0001134 - 0.0000203 * std::sin(node);
  const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(node);
  const double rightAscension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  const double sidereal = 6.6974243242 + 0.0657098283 * days + hours;
  const double hourAngle = (15 * sidereal + static_cast<double>(place.longitude)) * pi / 180 - rightAscension;
  const double latitude = static_cast<double>(place.latitude) * pi / 180;
  double zenith = std::acos(std::cos(latitude) * std::cos(hourAngle) * std::cos(declination) +
                            std::sin(declination) * std::sin(latitude));
  const double azimuth = std::atan2(
      -std::sin(hourAngle), std::tan(declination) * std::cos(latitude) - std::sin(latitude) * std::cos(hourAngle));
  zenith += 6371.01 / 149597890 * std::sin(zenith);
  const double sine = std::sin(zenith);
  return {static_cast<float>(-std::cos(azimuth) * sine), static_cast<float>(-std::sin(azimuth) * sine),
          static_cast<float>(std::cos(zenith))};
}

}  // namespace aerosol::render
