// From numbered beats to periods and rates.
#pragma once

#include "goingrate/log/beats.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace goingrate {

/// Summary of the rates of a log, or of its longest segment if the log is split.
struct RateSummary {
  std::int64_t crossings = 0; ///< good upward crossings
  std::int64_t periods = 0;   ///< cycles from the first to the last of them
  double duration_s = 0.0;
  double nominal_period_s = 0.0;
  bool nominal_is_known = true; ///< false: the mean period stands in for it
  double mean_period_s = 0.0;
  double mean_period_sigma_s = 0.0;
  double last_period_s = 0.0;
  double rate_excess = 0.0;       ///< nominal / mean period - 1, from end to end (eq. ratemeas)
  double rate_excess_sigma = 0.0; ///< from jitter and the scatter of block rates, see below
  double slope_rate_excess = 0.0; ///< the same from a straight line fitted to the clock's error
  double time_base_sigma = 0.0;   ///< of the clock that took the times; the sigmas above include it
};

/// The period that a clock of about this period is likely to be meant to have, if one is within
/// 0.2 %: a multiple of a quarter second for a pendulum, of half a minute or half an hour for a
/// clock that is read or strikes.
std::optional<double> usual_period(double period_s);
/// The usual period, or the period itself if there is none.
double rounded_period(double period_s);

/// The nominal period to compare with: the one given, the log's own, or else a guess: the
/// usual period that the mean period is close to, else the mean period itself.
/// The guess and its reason are appended to `assumptions`.
double nominal_period(const ClockLog& log, const Beats& beats,
                      std::vector<Assumption>& assumptions);

/// Mean rate of a run of good beats (at least three), and its standard deviation.
///
/// The rate is that from end to end: the time gained over the time passed. That is what the hands
/// show, and the best estimate if the clock wanders by more than the jitter of its sensor. Its
/// sigma combines the jitter at both ends with s / sqrt(k), where s is the scatter of the rates of
/// k equal blocks in excess of the jitter, and k is the one of 4 to 64 that makes this largest. An
/// interval of one sigma holds the rate in 68 % of logs or somewhat more if the noise is jitter or
/// white noise of the rate; slower wander makes the sigma larger (RatesTest.MeanRateSigmaCovers,
/// RatesTest.JitterTellsOnTheEndsAlone).
RateSummary summarise_rates(std::span<const Beat> beats, double nominal_period_s);

/// Adds the standard deviation of the time base's rate to the sigmas of rate and period.
void add_time_base(RateSummary& summary, double time_base_sigma);

/// The sigma of a rate without the part of the time base, which cancels in differences of rates of
/// one log.
double own_rate_sigma(const RateSummary& summary);

/// The rate of a part of a log.
struct PartRate {
  std::uint32_t segment = 0;
  std::int64_t from_cycle = 0, to_cycle = 0;
  Instant start;    ///< of the first of its beats
  RateSummary rate; ///< its sigmas are NaN with fewer than 5 beats, which show no scatter
  double amplitude_rad = std::numeric_limits<double>::quiet_NaN(); ///< mean; NaN without any
};

/// Rates of blocks of `block_s` seconds, counted from the first beat of each segment; the last
/// block of a segment may be shorter. Blocks of fewer than 3 good beats are left out. `beats` are
/// all beats of a log. Throws ArgumentError if `block_s` is not positive.
std::vector<PartRate> block_rates(std::span<const Beat> beats, double nominal_period_s,
                                  double block_s);

/// The same for whole segments.
std::vector<PartRate> segment_rates(std::span<const Beat> beats, double nominal_period_s);

/// The same for the stretches of good beats between `cuts`, times in order. A beat at a cut ends one
/// stretch and begins the next; an interval in which a cut falls belongs to neither.
std::vector<PartRate> rates_between(std::span<const Beat> beats, std::span<const Instant> cuts,
                                    double nominal_period_s);

/// Rate excess from one beat to a later one, T0 (n_2 - n_1) / (t_2 - t_1) - 1 (eq. ratemeas); not
/// finite for two beats at one time.
double rate_between(const Beat& from, const Beat& to, double nominal_period_s);

/// Rate excess of each period: one value for each beat but the first.
std::vector<double> rate_per_period(std::span<const Beat> beats, double nominal_period_s);

/// The clock's error x_i = n_i T0 - (t_i - t_0), s, positive when fast; one value for each beat.
std::vector<double> clock_error(std::span<const Beat> beats, double nominal_period_s);

/// Rate excess of every cycle between the first and the last beat. The cycles of a gap have the
/// mean rate over the gap, so that the series adds up to the time that the clock gained.
std::vector<double> rate_on_every_cycle(std::span<const Beat> beats, double nominal_period_s);

/// A series with one value for each cycle, or for every `step`-th, from the first beat to the last;
/// NaN where a beat is missing. `values` has one value for each beat.
std::vector<double> on_every_cycle(std::span<const Beat> beats, std::span<const double> values,
                                   std::int64_t step = 1);

} // namespace goingrate
