// Time in two parts: whole seconds and a fraction, so that nothing of a long time stamp is lost.
//
// A double that holds Unix time resolves 0.24 us; an Instant resolves 1.1e-16 s at any date.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace goingrate {

/// A point in time, `seconds + fraction` with 0 <= fraction < 1. The epoch is the log's own.
struct Instant {
  std::int64_t seconds = 0;
  double fraction = 0.0;

  auto operator<=>(const Instant&) const = default;

  /// From a time in seconds; exact for every finite double below 9.2e18 in size.
  static Instant from_seconds(double t) {
    const double whole = std::floor(t);
    return {static_cast<std::int64_t>(whole), t - whole};
  }

  /// The nearest double of seconds since the epoch: loses digits, for display and plots only.
  [[nodiscard]] double to_double() const { return static_cast<double>(seconds) + fraction; }
};

/// `later - earlier` in seconds: rounded once, however far both are from the epoch.
inline double operator-(const Instant& later, const Instant& earlier) {
  return static_cast<double>(later.seconds - earlier.seconds) + (later.fraction - earlier.fraction);
}

/// `t + duration` (seconds); the fraction is rounded once to 1.1e-16 s.
Instant operator+(const Instant& t, double duration);

/// t - (origin + n * period) in seconds, without the cancellation of the naive expression.
///
/// The product n * period is formed exactly (fused multiply-add), so the result is good to a few
/// 1e-16 s even after 1e8 periods; shown by `InstantTest.ResidualKeepsDigits`.
double residual_from_grid(const Instant& t, const Instant& origin, std::int64_t n, double period);

/// Reads a decimal number (sign, digits, point, exponent) into two parts, keeping up to 15 digits
/// of the fraction exactly rounded; a number with an exponent goes through one double. Returns
/// nothing if `text` is not wholly such a number.
std::optional<Instant> parse_instant(std::string_view text);

/// Decimal text with `decimals` digits after the point (0 to 17), correctly rounded.
std::string format_instant(const Instant& t, int decimals);

} // namespace goingrate
