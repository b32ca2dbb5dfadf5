#include "goingrate/log/tides.hpp"

#include "fields.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <erfa.h>
#include <erfam.h>
#include <numbers>

namespace goingrate {

namespace {

using Vector = Eigen::Vector3d;

constexpr double astronomical_unit_m = 149597870700.0;
constexpr double moon_m3_s2 = 4.9028e12, sun_m3_s2 = 1.32712440e20; // mass times G
constexpr double earth_yield_factor = 1.16; // of the solid Earth, 1 + h - 3/2 k (Longman)
constexpr double radians = std::numbers::pi / 180.0;
constexpr double seconds_a_day = 86400.0;

// Two parts of a Julian date, as ERFA takes times.
struct JulianDate {
  double day, fraction;
};

JulianDate julian(const Instant& utc, double later_s = 0.0) {
  constexpr double of_1970 = 2440587.5;
  const double seconds = static_cast<double>(utc.seconds) + utc.fraction + later_s;
  return {of_1970, seconds / seconds_a_day};
}

// Atomic time minus UTC changes by a second in years, in which the Moon moves by half an arc
// second.
constexpr double terrestrial_less_utc_s = 69.184;

// The position of the Moon and of the Sun, m, in the celestial frame.
Vector moon_at(const JulianDate& tt) {
  double moon[2][3];
  eraMoon98(tt.day, tt.fraction, moon);
  return astronomical_unit_m * Vector(moon[0][0], moon[0][1], moon[0][2]);
}
Vector sun_at(const JulianDate& tt) {
  double earth[2][3], barycentric[2][3];
  eraEpv00(tt.day, tt.fraction, earth, barycentric);
  return -astronomical_unit_m * Vector(earth[0][0], earth[0][1], earth[0][2]);
}

// Turns the celestial frame into that of the Earth. Nutation, 0.3 minutes of arc, is left out, and
// the Earth's own clock is taken for UTC, which it keeps to within a second.
Eigen::Matrix3d earth_frame(const JulianDate& ut, const JulianDate& tt) {
  double precession[3][3];
  eraPmat06(tt.day, tt.fraction, precession);
  eraRz(eraGmst06(ut.day, ut.fraction, tt.day, tt.fraction), precession);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&precession[0][0]);
}

Vector place_of(const Site& site) {
  double xyz[3];
  eraGd2gc(ERFA_WGS84, radians * site.longitude_deg, radians * site.latitude_deg, 0.0, xyz);
  return {xyz[0], xyz[1], xyz[2]};
}

Vector upwards(const Site& site) {
  const double lat = radians * site.latitude_deg, lon = radians * site.longitude_deg;
  return {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
}

// How much more a body pulls at a place than at the Earth's centre.
Vector excess_pull(double mass, const Vector& body, const Vector& place) {
  const Vector from_place = body - place;
  return mass * (from_place / std::pow(from_place.norm(), 3) - body / std::pow(body.norm(), 3));
}

// Normal gravity at sea level (WGS 84, Somigliana).
double gravity(const Site& site) {
  const double s2 = std::pow(std::sin(radians * site.latitude_deg), 2);
  return 9.7803253359 * (1.0 + 0.00193185265241 * s2) / std::sqrt(1.0 - 0.00669437999014 * s2);
}

// Equidistant rates and their integral from the first on, with a rate more at either end.
class TideTable {
public:
  TideTable(const Instant& begin, double duration_s, const Site& site) {
    const auto intervals = static_cast<std::size_t>(std::ceil(duration_s / step_s)) + 1;
    for (std::size_t i = 0; i < intervals + 3; ++i)
      rate_.push_back(tidal_rate(begin + (static_cast<double>(i) - 1.0) * step_s, site));
    integral_.push_back(0.0);
    for (std::size_t i = 1; i <= intervals; ++i) // of the cubic through four rates
      integral_.push_back(integral_.back() +
                          step_s / 24.0 *
                              (13.0 * (rate_[i] + rate_[i + 1]) - rate_[i - 1] - rate_[i + 2]));
  }

  // The integral by Hermite's cubic, whose slopes are the rates.
  [[nodiscard]] double integral_at(double elapsed_s) const {
    const double place = elapsed_s / step_s;
    const auto i = std::min(static_cast<std::size_t>(place), integral_.size() - 2);
    const double x = place - static_cast<double>(i), y = 1.0 - x;
    return y * y * ((1.0 + 2.0 * x) * integral_[i] + x * step_s * rate_[i + 1]) +
           x * x * ((1.0 + 2.0 * y) * integral_[i + 1] - y * step_s * rate_[i + 2]);
  }

private:
  static constexpr double step_s = 1800.0; // 1/25 of the shortest tide that matters

  std::vector<double> rate_; // from one step before the beginning
  std::vector<double> integral_;
};

} // namespace

std::optional<Site> parse_site(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == text.npos) return {};
  const auto latitude = parse_number(text.substr(0, comma), '.');
  std::string_view east = text.substr(comma + 1);
  east.remove_prefix(std::min(east.find_first_not_of(' '), east.size()));
  const auto longitude = parse_number(east, '.');
  if (!latitude || !longitude || !(std::abs(*latitude) <= 90.0) ||
      !(*longitude >= -180.0 && *longitude <= 360.0))
    return {};
  return Site{*latitude, *longitude};
}

double tidal_pull(const Instant& utc, const Site& site) {
  const JulianDate ut = julian(utc), tt = julian(utc, terrestrial_less_utc_s);
  const Eigen::Matrix3d turn = earth_frame(ut, tt);
  const Vector place = place_of(site);
  const Vector pull = excess_pull(moon_m3_s2, turn * moon_at(tt), place) +
                      excess_pull(sun_m3_s2, turn * sun_at(tt), place);
  return pull.dot(upwards(site));
}

double tidal_rate(const Instant& utc, const Site& site) {
  return -0.5 * earth_yield_factor * tidal_pull(utc, site) / gravity(site);
}

std::vector<double> tidal_advance(std::span<const double> elapsed_s, const Instant& begin,
                                  const Site& site) {
  if (elapsed_s.empty()) return {};
  const TideTable table(begin, elapsed_s.back(), site);
  std::vector<double> advance;
  advance.reserve(elapsed_s.size());
  for (const double t : elapsed_s)
    advance.push_back(table.integral_at(t));
  const double first = advance.front(), all = advance.back() - first;
  const double span = elapsed_s.back() - elapsed_s.front();
  for (std::size_t i = 0; i < advance.size(); ++i)
    advance[i] -= first + (span > 0.0 ? all * (elapsed_s[i] - elapsed_s.front()) / span : 0.0);
  return advance;
}

} // namespace goingrate
