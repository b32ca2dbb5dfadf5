// What Moon and Sun do to a pendulum: a cause outside the clock whose size is known beforehand.
//
// Their pull differs from the middle of the Earth to the place of the clock; the part along the
// vertical adds to gravity or takes from it (Longman, J. Geophys. Res. 64 (1959) 2351), and the
// Earth, which yields, makes that 1.16 times as large. A pendulum's rate follows by half of the
// relative change of g: 1e-7 at most, 0.3 ms of clock error within half a day.
#pragma once

#include "goingrate/base/instant.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// Where a clock stands: degrees on the ellipsoid WGS 84.
struct Site {
  double latitude_deg = 0.0;  ///< -90 to 90, north positive
  double longitude_deg = 0.0; ///< -180 to 360, east positive
};

/// "51.48,-0.0015", latitude first; nothing for any other text.
std::optional<Site> parse_site(std::string_view text);

/// The pull of Moon and Sun along the vertical of `site` at sea level, upwards, m/s^2, on an Earth
/// that does not yield. `utc` counts from 1970, 1900 to 2100. Newton's difference of the two pulls
/// with positions of ERFA, without nutation; 1e-8 m/s^2 rms, 4e-8 at most from Longman's series,
/// whose own error that is (TidesTest.AgreesWithLongman).
double tidal_pull(const Instant& utc, const Site& site);

/// The relative rate by theory, - 1.16/2 pull/g: negative where the pull is upwards.
double tidal_rate(const Instant& utc, const Site& site);

/// How far the tides have put a clock ahead by each of the times `elapsed_s` (rising, s since
/// `begin`), s; their mean rate over all of it is taken off. Within 1e-4 of the largest
/// (TidesTest.AdvanceIsTheIntegralOfTheRate). Cost: 10 us for every half hour of the log.
std::vector<double> tidal_advance(std::span<const double> elapsed_s, const Instant& begin,
                                  const Site& site);

} // namespace goingrate
