// The clocks of the studies of a monitor.
#pragma once

#include "goingrate/dynamics/clock_run.hpp"

#include <cstdint>
#include <vector>

namespace goingrate {

/// A clock by the equations of its pendulum.
struct SwungClock {
  const char* name;
  ClockParameters clock;
  double fast_rms, slow_rms; ///< of the drive, relative
  double jitter_s;
  double daily_ppm; ///< of the length, by temperature; weather of some days has a third of it
};

inline const std::vector<SwungClock> swung_clocks{
    {"regulator, 2 s, Q 10,000", {2.0, 5e-5, 4e-6, 0.015}, 0.05, 0.0, 2e-5, 0.5},
    {"longcase, 2 s, Q 2000", {2.0, 2.5e-4, 4e-5, 0.03}, 0.2, 0.02, 5e-5, 10.0},
    {"turret, 3 s, Q 5000", {3.0, 1e-4, 1e-5, 0.02}, 0.1, 0.01, 2e-5, 5.0},
};

/// Rates of minutes over some years.
std::vector<double> minute_rates(const SwungClock& clock, double years, std::uint64_t seed);

/// A clock by what its rate does, ppm.
struct WanderingClock {
  const char* name;
  double minute_noise;  ///< of a minute's mean
  double saw_tooth;     ///< from winding to winding
  double wound_scatter; ///< standard deviation of the days between windings, of their mean
  double wound_days;
  double pulse; ///< for five minutes while it is wound
  double daily; ///< the wave of a day, with a harmonic; its size changes by 0.3 with the weather
  double yearly;
  double walk;    ///< a random walk: within a day
  double flicker; ///< in each octave of times from a minute to a year
};

inline const std::vector<WanderingClock> wandering_clocks{
    {"saw-tooth of 0.3, weekly", 0.03, 0.3, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"saw-tooth of 1, weekly", 0.03, 1.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"saw-tooth of 1, weekly, noisy", 0.5, 1.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"saw-tooth of 3, within a day of a week", 0.1, 3.0, 0.15, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"saw-tooth of 10, within a day of a week", 0.5, 10.0, 0.15, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"saw-tooth of 2, monthly", 0.1, 2.0, 0.05, 30.0, 0.0, 0.0, 0.0, 0.0, 0.0},
    {"10 for five minutes, weekly", 0.1, 0.0, 0.15, 7.0, 10.0, 0.0, 0.0, 0.0, 0.0},
    {"wave of a day of 1", 0.03, 0.0, 0.0, 7.0, 0.0, 1.0, 0.0, 0.0, 0.0},
    {"wave of a day of 5", 0.1, 0.0, 0.0, 7.0, 0.0, 5.0, 0.0, 0.0, 0.0},
    {"wave of a year of 5", 0.03, 0.0, 0.0, 7.0, 0.0, 0.0, 5.0, 0.0, 0.0},
    {"wave of a year of 20", 0.1, 0.0, 0.0, 7.0, 0.0, 0.0, 20.0, 0.0, 0.0},
    {"random walk of 0.1 a day", 0.03, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.1, 0.0},
    {"random walk of 1 a day", 0.1, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 1.0, 0.0},
    {"flicker of 0.1", 0.03, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.1},
    {"flicker of 1", 0.1, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 1.0},
    {"all: weekly 1, day 2, year 10, walk and flicker 0.1", 0.05, 1.0, 0.15, 7.0, 0.0, 2.0, 10.0,
     0.1, 0.1},
    {"all: weekly 3, day 3, year 10, walk 0.1, flicker 0.3", 0.5, 3.0, 0.15, 7.0, 0.0, 3.0, 10.0,
     0.1, 0.3},
};

/// Rates of minutes over some years. No clock goes for a fifth longer than it is made for.
std::vector<double> minute_rates(const WanderingClock& clock, double years, std::uint64_t seed);

} // namespace goingrate
