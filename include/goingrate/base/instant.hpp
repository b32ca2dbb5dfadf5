// Time in two parts, whole seconds and a fraction, so that long time stamps keep all their digits.
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
inline double residual_from_grid(const Instant& t, const Instant& origin, std::int64_t n,
                                 double period) {
  const auto count = static_cast<double>(n);
  const double product = count * period;
  const double product_low = std::fma(count, period, -product);
  const auto whole = static_cast<std::int64_t>(product); // its rest is exact
  const double fractions = (t.fraction - origin.fraction) - (product - static_cast<double>(whole));
  return (static_cast<double>(t.seconds - origin.seconds - whole) + fractions) - product_low;
}

/// The unit of a number in a file: `seconds` * 10^`power` seconds.
struct TimeUnit {
  std::uint32_t seconds = 1;
  int power = 0;
  bool operator==(const TimeUnit&) const = default;
};
inline constexpr TimeUnit in_seconds{1, 0}, in_milliseconds{1, -3}, in_microseconds{1, -6},
    in_nanoseconds{1, -9}, in_minutes{60, 0}, in_hours{3600, 0}, in_days{86400, 0};

/// Reads a decimal number (sign, digits, `point`, digits, exponent) of the given unit into two
/// parts. The arithmetic is that of whole numbers, so nothing is lost: the seconds are exact, the
/// fraction is the nearest double if the number has at most 15 decimals (or 19 digits in another
/// unit: then to 1.2e-16 s). Digits beyond the 19th after the first are not read where an exponent
/// or another unit is in play. Returns nullopt if `text` is not wholly such a number or is beyond
/// 9.2e18 s (InstantTest.ReadsEveryUnitExactly, InstantTest.MillionTimesComeBack).
std::optional<Instant> parse_instant(std::string_view text, TimeUnit unit = in_seconds,
                                     char point = '.');

/// `count` (not negative) units as an Instant, by whole-number arithmetic; nothing beyond 9.2e18 s.
std::optional<Instant> whole_units(std::int64_t count, TimeUnit unit);

/// Decimal text with `decimals` digits after the point (0 to 17), correctly rounded.
std::string format_instant(const Instant& t, int decimals);

} // namespace goingrate
