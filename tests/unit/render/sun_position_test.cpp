#include "core/render/sun_position.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace aerosol::render {
namespace {

constexpr double degree = std::numbers::pi / 180;

struct Angles {
  double elevation = 0, azimuth = 0;  ///< Degrees; azimuth from north over east.
};

Angles anglesAt(const scene::SunPlace& place) {
  const Vector<Object> d = sunDirection(place);
  EXPECT_NEAR(length(d), 1, 1e-6);
  double azimuth = std::atan2(-static_cast<double>(d.y), -static_cast<double>(d.x)) / degree;
  if (azimuth < 0) azimuth += 360;
  return {std::asin(static_cast<double>(d.z)) / degree, azimuth};
}

scene::SunPlace greenwich(int month, int day, float hour) {
  scene::SunPlace place;
  place.latitude = 51.4779f;
  place.longitude = 0;
  place.timezone = 0;
  place.month = month;
  place.day = day;
  place.hour = hour;
  return place;
}

TEST(SunPosition, AtNoonOfTheSolsticesIsByTheObliquity) {
  // Solar noon is two minutes after (June) and before (December) the clock's.
  const Angles summer = anglesAt(greenwich(6, 21, 12.03f)), winter = anglesAt(greenwich(12, 21, 11.97f));
  EXPECT_NEAR(summer.elevation, 90 - 51.4779 + 23.44, 0.02);
  EXPECT_NEAR(summer.azimuth, 180, 0.5);
  EXPECT_NEAR(winter.elevation, 90 - 51.4779 - 23.44, 0.02);
  EXPECT_NEAR(winter.azimuth, 180, 0.5);
}

TEST(SunPosition, RisesInTheEastAndSetsInTheWestAtTheEquinox) {
  const Angles morning = anglesAt(greenwich(3, 20, 6.12f)), evening = anglesAt(greenwich(3, 20, 18.12f));
  EXPECT_NEAR(morning.elevation, 0, 0.3);
  EXPECT_NEAR(morning.azimuth, 90, 0.5);
  EXPECT_NEAR(evening.elevation, 0, 0.3);
  EXPECT_NEAR(evening.azimuth, 270, 0.5);
}

TEST(SunPosition, KnowsTimeZonesAndParts) {
  scene::SunPlace place = greenwich(7, 10, 15);
  scene::SunPlace same = place;
  same.timezone = 9;
  same.hour = 23;
  same.minute = 59;
  same.second = 60;
  const Vector<Object> a = sunDirection(place), b = sunDirection(same);
  EXPECT_NEAR(length(a - b), 0, 1e-5);
}

}  // namespace
}  // namespace aerosol::render
