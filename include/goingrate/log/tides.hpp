// The effect of Moon and Sun on a pendulum, whose size is known from theory.
//
// Their pull at the clock differs from that at the centre of the Earth. The vertical part of the
// difference adds to gravity or reduces it (Longman, J. Geophys. Res. 64 (1959) 2351); the tidal
// deformation of the Earth makes it 1.16 times as large. A pendulum's rate changes by half of the
// relative change of g: 1e-7 at most, 0.3 ms of clock error within half a day.
#pragma once

#include "goingrate/base/instant.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// The location of a clock: degrees on the ellipsoid WGS 84.
struct Site {
  double latitude_deg = 0.0;  ///< -90 to 90, north positive
  double longitude_deg = 0.0; ///< -180 to 360, east positive
};

/// "51.48,-0.0015", latitude first; nullopt for any other text.
std::optional<Site> parse_site(std::string_view text);

/// The pull of Moon and Sun along the vertical of `site` at sea level, upwards, m/s^2, on a rigid
/// Earth. `utc` counts from 1970 and is a date of 1900 to 2100. Newton's difference of the two
/// pulls with positions of ERFA, without nutation. Differs from Longman's series by 1e-8 m/s^2 rms
/// and 4e-8 at most, which is the error of that series (TidesTest.AgreesWithLongman).
double tidal_pull(const Instant& utc, const Site& site);

/// The relative rate by theory, - 1.16/2 pull/g: negative where the pull is upwards.
double tidal_rate(const Instant& utc, const Site& site);

/// The time, s, that a clock has gained by the tides at each of the times `elapsed_s` (rising, s
/// since `begin`), without the mean rate over the log. The error is below 1e-4 of the largest value
/// (TidesTest.AdvanceIsTheIntegralOfTheRate). Cost: 10 us for every half hour of the log.
std::vector<double> tidal_advance(std::span<const double> elapsed_s, const Instant& begin,
                                  const Site& site);

} // namespace goingrate
