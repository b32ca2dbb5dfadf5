#include "facts.hpp"

#include "account.hpp"
#include "evidence.hpp"
#include "reading_changes.hpp"

#include "base/readable.hpp"
#include "base/scaled_time.hpp"
#include "fit/displacements.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace goingrate::timing_model {

namespace {

std::string by_chance(double probability) {
  constexpr double least_probability = 1e-9; // smaller probabilities rest on the noise model alone
  return probability < least_probability
             ? std::string("practically never by chance")
             : fmt::format("by chance once in {:.1g} logs", 1.0 / probability);
}

bool is_hole(const TimingData& data, std::size_t beat) {
  return data.cycle[beat] > data.cycle[beat - 1] + 1.5;
}

// The share of all beats that are missing in holes of a few: a longer one is a break in the log.
double missed_share(const TimingData& data) {
  constexpr double longest_hole = 20.0; // beats
  double missed = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    const double hole = std::round(data.cycle[i] - data.cycle[i - 1]) - 1.0;
    missed += is_hole(data, i) && hole <= longest_hole ? hole : 0.0;
  }
  return missed / (missed + static_cast<double>(data.size()));
}

// A healthy sensor misses at most one beat in a thousand. Whether this one does is judged by the
// places, at which beats missing in a row count once: a break in the log is not the sensor's fault.
void look_at_missed(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  constexpr double usual_missed_share = 1e-3;
  double missed = 0.0;
  for (std::size_t i = 1; i < input.data->size(); ++i)
    missed += is_hole(*input.data, i) ? 1.0 : 0.0;
  const double beats = missed + static_cast<double>(input.data->size());
  const double share = missed / beats;
  // Random losses leave many pairs of neighbours. Above this share there are hardly any: the log
  // then holds every n-th beat only.
  constexpr double largest_random_share = 0.45;
  if (share <= usual_missed_share || share > largest_random_share) return;
  const double gain =
      2.0 * (missed * std::log(share / usual_missed_share) + (beats - missed) * std::log1p(-share) -
             (beats - missed) * std::log1p(-usual_missed_share)) -
      std::log(beats);
  CauseNumbers numbers;
  numbers.size = missed_share(*input.data);
  numbers.places = static_cast<std::size_t>(missed);
  if (gain > convincing_gain)
    all.push_back(
        {Cause::missed_beats,
         gain,
         fmt::format("beats are missing at {:.0f} points of the log, {:.2g} % of all beats", missed,
                     100.0 * numbers.size),
         {},
         "Clean and aim the sensor; the clock itself may be well.",
         numbers});
}

// The gain of a line is -2 log p, where p is the probability of a false alarm anywhere in the
// spectrum; p thus includes the price of the search.
void look_for_wheel(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  for (const SpectralLine& line : input.lines) {
    const double period_s = 1.0 / line.frequency_hz;
    constexpr double slowest_wheel_s = 4.0 * 3600.0; // no wheel of a going train turns more slowly
    const double gain = -2.0 * std::log(std::max(line.false_alarm, 1e-300));
    constexpr double least_gain = 18.0; // 2 log L: a false alarm in one of ten thousand logs
    if (period_s > slowest_wheel_s || gain < least_gain) continue;
    CauseNumbers numbers;
    numbers.size = line.amplitude;
    numbers.sigma = line.amplitude_sigma;
    numbers.period_s = period_s;
    all.push_back(
        {Cause::wheel,
         gain,
         fmt::format("the rate swings by {:+.3g} s/day every {:.5g} s, {}",
                     line.amplitude * seconds_per_day, period_s, by_chance(line.false_alarm)),
         {},
         "The numbers of teeth in the train show which wheel it is.",
         numbers});
    return;
  }
}

// A drive that varies by less than 8 % from period to period is that of a healthy clock.
void look_at_roughness(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  if (!input.fast_drive) return;
  constexpr double usual_drive_rms = 0.08;
  const RmsEstimate& fast = *input.fast_drive;
  const double sigma = fast.rms - fast.low68;
  if (!(fast.low68 > usual_drive_rms) || !(sigma > 0.0)) return;
  // The uncertainty of an rms is relative, so it is compared by its logarithm.
  const double gain = std::pow(std::log(fast.rms / usual_drive_rms) * fast.rms / sigma, 2) -
                      std::log(static_cast<double>(input.data->size()));
  if (gain < convincing_gain) return;
  const std::string size =
      std::isfinite(fast.high68)
          ? fmt::format("{:.2g} % from period to period (rms; {:.2g} to {:.2g})", 100.0 * fast.rms,
                        100.0 * fast.low68, 100.0 * fast.high68)
          : fmt::format(
                "at least {:.2g} ± {:.1g} % from period to period (rms), if the amplitude is at "
                "most four times the angle of the escapement",
                100.0 * fast.rms, 100.0 * sigma);
  all.push_back({Cause::rough_drive,
                 gain,
                 fmt::format("the drive varies by {}", size),
                 {},
                 "Look for a loose suspension or a worn escapement; a hand on the case may feel "
                 "it."});
}

void look_at_stop(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  if (!input.stopped_s) return;
  // A clock that went on while nothing was logged resumes where a beat is due, within its jitter of
  // about a thousandth of a period. One that resumes anywhere else in a period was stopped.
  constexpr double odds = 1e3;
  CauseNumbers numbers;
  numbers.at_s = *input.stopped_s;
  all.push_back({Cause::stop,
                 2.0 * std::log(odds),
                 fmt::format("{} after the start the clock stopped, and was started again",
                             time_words(*input.stopped_s)),
                 {},
                 "Analyse the other side of the stop as a log of its own.",
                 numbers});
}

} // namespace

void look_at_displacements(const DiagnosisInput& input, const std::vector<Displacement>& found,
                           std::vector<Suspicion>& all) {
  if (found.empty()) return;
  // Pushes that wait for the swing and vary displace the times by themselves.
  if (const auto& pushes = input.data->impulses; pushes && !pushes->is_regular) return;
  const Displacement& first = found.front();
  double gain = 0.0;
  for (const Displacement& d : found)
    gain += d.gain;
  std::string evidence = fmt::format(
      "{} after the start all later times are displaced by {} ms, while the rate stays the same",
      time_words(input.data->elapsed_s[first.beat]), readable_signed(1e3 * first.late_s, 3));
  CauseNumbers numbers;
  numbers.at_s = input.data->elapsed_s[first.beat];
  numbers.size = first.late_s;
  numbers.places = found.size();
  if (input.data->reference_period_s > longest_swing_s) { // a clock that is read
    all.push_back({Cause::sensor_shift, gain, std::move(evidence), {}, "", numbers});
    return;
  }
  if (found.size() == 1) {
    std::vector<Cause> alternatives{Cause::knock};
    if (is_hole(*input.data, first.beat)) alternatives.push_back(Cause::stop);
    all.push_back({Cause::sensor_shift, gain, std::move(evidence), std::move(alternatives),
                   "If the sensor was moved, beats of the other direction are displaced the "
                   "opposite way.",
                   numbers});
    return;
  }
  evidence += fmt::format("; {} more such displacements", found.size() - 1);
  all.push_back({Cause::knock,
                 gain,
                 std::move(evidence),
                 {Cause::sensor_shift},
                 "Check whether doors, traffic or people coincide with those times.",
                 numbers});
}

// A clock whose times leap more often does so by its nature, as one that is pushed now and then.
Undisplaced::Undisplaced(const TimingData& data) : data_(&data) {
  if (are_few_readings(data)) {
    level_settings(corrected_.emplace(data));
    data_ = &*corrected_;
    return;
  }
  constexpr std::size_t most_displaced = 8;
  while (const auto next = greatest_displacement(*data_)) {
    if (data_->displaced.size() == most_displaced) {
      data_ = &data;
      return;
    }
    if (!corrected_) data_ = &corrected_.emplace(data);
    take_off(*next, *corrected_);
  }
}

std::vector<Suspicion> suspicions_of_facts(const DiagnosisInput& input,
                                           const std::vector<Displacement>& displaced) {
  std::vector<Suspicion> all;
  look_at_displacements(input, displaced, all);
  look_at_missed(input, all);
  look_for_wheel(input, all);
  look_at_roughness(input, all);
  look_at_stop(input, all);
  return all;
}

} // namespace goingrate::timing_model
