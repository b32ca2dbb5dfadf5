#include "goingrate/log/tides.hpp"

#include "goingrate/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

constexpr double day_s = 86400.0;

// Longman's own way, after his paper of 1959: mean longitudes and a few terms of the Moon's and the
// Sun's motion, spherical triangles, the first two degrees of the tide. Shares nothing with the
// library's positions or frames.
double longman_pull(const Instant& utc, const Site& site) {
  const double since_1900 = (static_cast<double>(utc.seconds) + utc.fraction) / day_s + 25567.5;
  const double t = since_1900 / 36525.0, t2 = t * t, t3 = t2 * t;
  const double s = 4.72000889397 + 8399.70927456 * t + 3.45575191895e-05 * t2 + 3.49e-08 * t3;
  const double p = 5.83515162814 + 71.0180412089 * t - 1.80108282526e-04 * t2 - 1.7453e-07 * t3;
  const double h = 4.88162798259 + 628.331950894 * t + 5.23598775598e-06 * t2;
  const double n = 4.52360161181 - 33.757146295 * t + 3.6264063347e-05 * t2 + 3.3937e-08 * t3;
  const double p1 = 4.90822941839 + 0.03000526416 * t + 7.902463e-06 * t2 + 5.8178e-08 * t3;
  const double e = 0.05490, m = 0.074804, inclination = 0.08979719, omega = 0.4093146162;
  const double e1 = 0.01675104 - 4.18e-5 * t - 1.26e-7 * t2;
  const double tilt = std::acos(std::cos(omega) * std::cos(inclination) -
                                std::sin(omega) * std::sin(inclination) * std::cos(n));
  const double nu = std::asin(std::sin(inclination) * std::sin(n) / std::sin(tilt));
  const double cos_alpha =
      std::cos(n) * std::cos(nu) + std::sin(n) * std::sin(nu) * std::cos(omega);
  const double sin_alpha = std::sin(omega) * std::sin(n) / std::sin(tilt);
  const double xi = n - 2.0 * std::atan(sin_alpha / (1.0 + cos_alpha));
  const double sigma = s - xi;
  const double moon = sigma + 2 * e * std::sin(s - p) + 1.25 * e * e * std::sin(2 * (s - p)) +
                      3.75 * m * e * std::sin(s - 2 * h + p) +
                      1.375 * m * m * std::sin(2 * (s - h));
  const double sun = h + 2 * e1 * std::sin(h - p1);
  const double lat = site.latitude_deg * std::numbers::pi / 180.0;
  const double hours = std::fmod(since_1900 + 0.5, 1.0); // of the day, from midnight
  const double turn =
      2.0 * std::numbers::pi * (hours - 0.5) + site.longitude_deg * std::numbers::pi / 180.0;
  const auto zenith = [&](double longitude, double plane, double meridian) {
    const double c = std::pow(std::cos(0.5 * plane), 2), d = std::pow(std::sin(0.5 * plane), 2);
    return std::sin(lat) * std::sin(plane) * std::sin(longitude) +
           std::cos(lat) *
               (c * std::cos(longitude - meridian) + d * std::cos(longitude + meridian));
  };
  const double cos_moon = zenith(moon, tilt, turn + h - nu), cos_sun = zenith(sun, omega, turn + h);
  const double c = 3.84402e8, c1 = 1.495e11, gravity = 6.673e-11;
  const double a = 1.0 / (c * (1 - e * e)), a1 = 1.0 / (c1 * (1 - e1 * e1));
  const double moon_m =
      1.0 / (1 / c + a * e * std::cos(s - p) + a * e * e * std::cos(2 * (s - p)) +
             1.875 * a * m * e * std::cos(s - 2 * h + p) + a * m * m * std::cos(2 * (s - h)));
  const double sun_m = 1.0 / (1 / c1 + a1 * e1 * std::cos(h - p1));
  const double r = 6.378270e6 / std::sqrt(1.0 + 0.006738 * std::pow(std::sin(lat), 2));
  const auto squared = [](double x) { return 3.0 * x * x - 1.0; };
  return gravity * 7.3537e22 * r / std::pow(moon_m, 3) *
             (squared(cos_moon) + 1.5 * r / moon_m * (5.0 * std::pow(cos_moon, 3) - 3 * cos_moon)) +
         gravity * 1.993e30 * r / std::pow(sun_m, 3) * squared(cos_sun);
}

Instant at_day(double days) { return Instant::from_seconds(days * day_s); }

TEST(TidesTest, AgreesWithLongman) {
  RandomStream random(1, StreamPurpose::jitter);
  double worst = 0.0, squares = 0.0, most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Instant when = at_day(25000.0 * random.uniform()); // to the year 2038
    const Site site{180.0 * random.uniform() - 90.0, 360.0 * random.uniform() - 180.0};
    const double pull = tidal_pull(when, site);
    const double off = pull - longman_pull(when, site);
    worst = std::max(worst, std::abs(off));
    squares += off * off / 2000.0;
    most = std::max(most, std::abs(pull));
  }
  // His longitudes of the Moon are good to some minutes of arc, which move its pull by 3e-8.
  EXPECT_LT(worst, 4e-8);
  EXPECT_LT(std::sqrt(squares), 1e-8);
  EXPECT_NEAR(most, 1.75e-6, 0.15e-6) << "both at perigee: 1.9e-7 of gravity";
}

// The Moon in the zenith at its mean distance pulls by 2GM r/d^3.
TEST(TidesTest, SizesAreThoseOfTheBooks) {
  double moon = 0.0, mean = 0.0;
  constexpr int hours = 24 * 365;
  for (int hour = 0; hour < hours; ++hour) {
    const double pull = tidal_pull(at_day(20000.0 + hour / 24.0), {0.0, 0.0});
    moon = std::max(moon, pull);
    mean += pull / hours;
  }
  EXPECT_NEAR(moon, 1.86e-6, 0.1e-6);  // 1.1 and 0.5 in the mean; 1.9e-7 of gravity at perigee
  EXPECT_NEAR(mean, 0.30e-6, 0.04e-6); // the permanent tide at the equator: 30 microgals
}

TEST(TidesTest, TheRateFallsWhereThePullIsUpwards) {
  const Site greenwich{51.48, 0.0};
  const Instant when = at_day(20454.3);
  // 1.16/2 over the gravity of Greenwich, 9.8119 m/s^2.
  EXPECT_NEAR(tidal_rate(when, greenwich), -0.58 * tidal_pull(when, greenwich) / 9.8119, 1e-12);
}

TEST(TidesTest, AdvanceIsTheIntegralOfTheRate) {
  const Site site{48.1, 11.6};
  const Instant begin = at_day(20454.3);
  std::vector<double> elapsed;
  for (double t = 0.0; t < 9.0 * day_s; t += 997.0)
    elapsed.push_back(t);
  const auto advance = tidal_advance(elapsed, begin, site);
  double sum = 0.0, largest = 0.0;
  std::vector<double> plain{0.0};
  constexpr int parts = 50; // of midpoints, 20 s each
  for (std::size_t i = 1; i < elapsed.size(); ++i) {
    for (int k = 0; k < parts; ++k)
      sum += tidal_rate(begin + (elapsed[i - 1] + (k + 0.5) * 997.0 / parts), site) * 997.0 / parts;
    plain.push_back(sum);
  }
  for (std::size_t i = 0; i < elapsed.size(); ++i) {
    const double without_mean = plain[i] - sum * elapsed[i] / elapsed.back();
    largest = std::max(largest, std::abs(without_mean));
    EXPECT_NEAR(advance[i], without_mean, 6e-8); // 1e-4 of the largest, 6.5e-4 s
  }
  EXPECT_GT(largest, 1e-4) << "s: tides put a clock forward and back";
}

TEST(TidesTest, PlacesAreRead) {
  const auto site = parse_site("51.48,-0.0015");
  ASSERT_TRUE(site);
  EXPECT_EQ(site->latitude_deg, 51.48);
  EXPECT_EQ(site->longitude_deg, -0.0015);
  EXPECT_TRUE(parse_site("-33.9, 151.2"));
  for (const char* wrong : {"", "51.48", "91,0", "10,361", "51.48;0", "north,0", "51.48,", "1,nan"})
    EXPECT_FALSE(parse_site(wrong)) << wrong;
}

} // namespace
} // namespace goingrate
