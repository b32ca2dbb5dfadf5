#include "goingrate/clock/drive.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>

namespace goingrate {

void check(const DriveVariability& drive) {
  const auto relative = [](const char* name, double rms) {
    if (!(rms >= 0.0 && rms <= 100.0)) throw ArgumentError(name, rms, "between 0 and 100");
  };
  relative("fast_rms", drive.fast_rms);
  relative("slow_rms", drive.slow_rms);
  if (drive.slow_rms > 0.0 && !(drive.slow_time_s > 0.0))
    throw ArgumentError("slow_time", drive.slow_time_s, "a positive number of seconds");
}

DriveSequence::DriveSequence(const DriveVariability& drive, double period_s, std::uint64_t seed)
    : drive_(drive), fast_stream_(seed, StreamPurpose::fast_drive),
      slow_stream_(seed, StreamPurpose::slow_drive) {
  check(drive);
  if (drive.slow_rms > 0.0) {
    memory_ = std::exp(-period_s / drive.slow_time_s);
    innovation_ = std::sqrt(-std::expm1(-2.0 * period_s / drive.slow_time_s));
    slow_ = slow_stream_.normal();
  }
}

double DriveSequence::next() {
  double factor = 1.0;
  if (drive_.fast_rms > 0.0) factor += drive_.fast_rms * fast_stream_.normal();
  if (drive_.slow_rms > 0.0) {
    factor += drive_.slow_rms * slow_;
    slow_ = memory_ * slow_ + innovation_ * slow_stream_.normal();
  }
  return factor;
}

} // namespace goingrate
