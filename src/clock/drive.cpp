#include "goingrate/clock/drive.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

void check(const DriveVariability& drive) {
  const auto relative = [](const char* name, double rms) {
    if (!(rms >= 0.0 && rms <= 100.0)) throw ArgumentError(name, rms, "between 0 and 100");
  };
  relative("fast_rms", drive.fast_rms);
  relative("slow_rms", drive.slow_rms);
  if (drive.slow_rms > 0.0 && !(drive.slow_time_s > 0.0))
    throw ArgumentError("slow_time", drive.slow_time_s, "a positive number of seconds");
  for (const auto& sine : drive.sines) {
    if (!(std::abs(sine.amplitude) <= 100.0))
      throw ArgumentError("sine.amplitude", sine.amplitude, "between -100 and 100");
    if (!(sine.period_s > 0.0 && std::isfinite(sine.period_s)))
      throw ArgumentError("sine.period", sine.period_s, "a positive number of seconds");
  }
  if (drive.series && (drive.fast_rms > 0.0 || drive.slow_rms > 0.0))
    throw ArgumentError("drive.series", "with fast_rms or slow_rms",
                        "either a series or random variations");
}

DriveSequence::DriveSequence(const DriveVariability& drive, double period_s, std::uint64_t seed)
    : drive_(drive), fast_stream_(seed, StreamPurpose::fast_drive),
      slow_stream_(seed, StreamPurpose::slow_drive) {
  check(drive);
  unusual_ = drive.series != nullptr || !drive.sines.empty();
  if (drive.slow_rms > 0.0) {
    memory_ = std::exp(-period_s / drive.slow_time_s);
    innovation_ = std::sqrt(-std::expm1(-2.0 * period_s / drive.slow_time_s));
    slow_ = slow_stream_.normal();
  }
}

double DriveSequence::unusual(double time_s) {
  double factor = 1.0;
  if (drive_.series) {
    if (used_ == drive_.series->size())
      throw ArgumentError("drive.series", static_cast<double>(used_),
                          "as many factors as the run has periods");
    factor = (*drive_.series)[used_++];
  }
  for (const auto& sine : drive_.sines)
    factor += sine.amplitude * std::sin(2.0 * std::numbers::pi * time_s / sine.period_s);
  return factor;
}

} // namespace goingrate
