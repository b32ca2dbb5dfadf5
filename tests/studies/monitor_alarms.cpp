// How often alarms other than the one for a rate step are false for a healthy clock that is watched
// for years, and how long they take. Arguments: years of each clock (2), seed (1).
#include "alarms.hpp"
#include "rolling_numbers.hpp"

#include "goingrate/base/random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

using namespace goingrate;
using namespace goingrate::apps;

namespace {

constexpr double day_s = 86400.0, year_s = 31557600.0;

struct WatchedClock {
  const char* name;
  double period_s;
  double missed, spurious; // of the crossings, and of the periods
  double beat_error;       // of the period
  double sag, dip;         // of the amplitude: from winding to winding, and while it is wound
  double season, wander;   // of the amplitude: of a year, and with a memory of two days
  double amplitude_noise;  // of each, relative
};

const std::vector<WatchedClock> clocks{
    {"regulator", 2.0, 1e-4, 1e-4, 0.001, 0.0, 0.0, 0.02, 0.001, 0.002},
    {"longcase", 2.0, 0.01, 0.005, 0.005, 0.02, 0.1, 0.05, 0.01, 0.01},
    {"turret, wind", 3.0, 0.03, 0.01, 0.008, 0.0, 0.0, 0.1, 0.03, 0.03},
    {"bracket, spring", 1.0, 0.01, 0.002, 0.008, 0.1, 0.0, 0.05, 0.01, 0.01},
    {"bad sensor", 2.0, 0.04, 0.005, 0.002, 0.0, 0.0, 0.02, 0.005, 0.02},
};

// What goes wrong with a clock from some moment on.
struct Fault {
  const char* name;
  AlarmKind kind;
  bool stops = false;
  double missed = 0.0, beat_error = 0.0;
  double fall = 0.0, fall_a_day = 0.0; // of the amplitude
};

const std::vector<Fault> faults{
    {"it stops", AlarmKind::stopped, true},
    {"3 % out of beat", AlarmKind::out_of_beat, false, 0.0, 0.03},
    {"20 % of the beats missed", AlarmKind::sensor_failing, false, 0.2},
    {"the amplitude falls by 15 % at once", AlarmKind::amplitude_falling, false, 0.0, 0.0, 0.15},
    {"the amplitude falls by 1 % a day", AlarmKind::amplitude_falling, false, 0.0, 0.0, 0.0, 0.01},
};

// Crossings in order of time, one period at a time.
class Crossings {
public:
  Crossings(const WatchedClock& clock, std::uint64_t seed)
      : clock_(clock), noise_(seed, StreamPurpose::jitter), missed_(seed, StreamPurpose::missed),
        spurious_(seed, StreamPurpose::spurious), amplitude_(seed, StreamPurpose::amplitude_noise) {
  }

  void fail(const Fault& fault) {
    fault_ = fault;
    failed_s_ = now_s();
  }
  [[nodiscard]] double now_s() const { return static_cast<double>(cycle_) * clock_.period_s; }
  static Instant at(double seconds) { return Instant{1764201600, 0.0} + seconds; }

  // The events of the next period.
  std::vector<Beat> next() {
    std::vector<Beat> events;
    const double from_s = now_s(), amplitude = next_amplitude();
    const double half = 0.5 * (1.0 + clock_.beat_error + (fault_ ? fault_->beat_error : 0.0));
    for (const auto& [share, edge] : {std::pair{0.0, Edge::up}, std::pair{half, Edge::down}}) {
      constexpr double jitter_s = 2e-5;
      const double time_s = from_s + share * clock_.period_s + jitter_s * noise_.normal();
      if (missed_.uniform() < clock_.missed + (fault_ ? fault_->missed : 0.0)) continue;
      events.push_back(event_at(at(time_s), edge, 0, amplitude));
    }
    if (spurious_.uniform() < clock_.spurious)
      events.push_back(event_at(at(from_s + clock_.period_s * spurious_.uniform()),
                                spurious_.uniform() < 0.5 ? Edge::up : Edge::down));
    std::sort(events.begin(), events.end(),
              [](const Beat& a, const Beat& b) { return a.time < b.time; });
    ++cycle_;
    return events;
  }

private:
  double next_amplitude() {
    const double memory = 2.0 * day_s / clock_.period_s, now = now_s();
    wander_ += -wander_ / memory + std::sqrt(2.0 / memory) * amplitude_.normal();
    const double week = std::fmod(now, 7.0 * day_s);
    double relative = 1.0 + clock_.season * std::cos(2.0 * std::numbers::pi * now / year_s) +
                      clock_.wander * wander_ - clock_.sag * week / (7.0 * day_s);
    constexpr double wound_s = 180.0;
    if (week < wound_s) relative -= clock_.dip;
    if (fault_) relative *= 1.0 - fault_->fall - fault_->fall_a_day * (now - failed_s_) / day_s;
    return 0.03 * relative * (1.0 + clock_.amplitude_noise * amplitude_.normal());
  }

  const WatchedClock& clock_;
  RandomStream noise_, missed_, spurious_, amplitude_;
  double wander_ = 0.0, failed_s_ = 0.0;
  std::optional<Fault> fault_;
  std::int64_t cycle_ = 0;
};

// What ClockWatch does, without an archive.
class Watch {
public:
  explicit Watch(double period_s) : period_s_(period_s) { log_.nominal_period_s = period_s; }

  void add(const Beat& event) {
    numbers_.add(event);
    if (numbers_.is_full()) number();
  }
  void number() {
    for (const Beat& beat : numbers_.numbered(log_)) {
      std::int64_t missed = 0;
      if (beat.flag == BeatFlag::good && going_.last()) {
        missed = std::max<std::int64_t>(0, beat.cycle - going_.last()->cycle - 1);
        // The last moment before it is heard.
        silent(beat.time - going_.last()->time, beat.time);
      }
      going_.add(beat, missed);
      if (beat.flag == BeatFlag::good) alarms_.heard(going_, period_s_, false);
    }
  }
  void silent(double silence_s, const Instant& at) {
    if (silence_s > 2.0 * period_s_) alarms_.silent(silence_s, period_s_, going_, at);
  }
  // How often each kind was raised since the last call.
  std::array<int, alarm_kinds> take_raised() {
    std::array<int, alarm_kinds> raised{};
    for (const AlarmChange& change : alarms_.take_changes())
      raised[static_cast<std::size_t>(change.kind)] += change.is_raised ? 1 : 0;
    return raised;
  }
  [[nodiscard]] Instant last_good() const { return going_.last()->time; }

private:
  static inline const LogOptions options_{};
  double period_s_;
  ClockLog log_;
  RollingNumbers numbers_{options_};
  Going going_;
  Alarms alarms_{0.0};
};

// Seconds from the fault to its alarm; infinity if none comes within sixty days.
double delay_of(const Fault& fault, Crossings crossings, Watch watch) {
  watch.number();
  watch.take_raised();
  const double from_s = crossings.now_s();
  const auto kind = static_cast<std::size_t>(fault.kind);
  if (fault.stops) {
    const Instant last = watch.last_good();
    for (double silence_s = 0.0; silence_s < day_s; silence_s += 0.1) {
      watch.silent(silence_s, last + silence_s);
      if (watch.take_raised()[kind] > 0) return silence_s;
    }
    return std::numeric_limits<double>::infinity();
  }
  crossings.fail(fault);
  while (crossings.now_s() < from_s + 60.0 * day_s) {
    for (int period = 0; period < 30; ++period)
      for (const Beat& event : crossings.next())
        watch.add(event);
    watch.number();
    if (watch.take_raised()[kind] > 0) return crossings.now_s() - from_s;
  }
  return std::numeric_limits<double>::infinity();
}

std::string duration(double s) {
  if (std::isinf(s)) return "never";
  if (s < 120.0) return fmt::format("{:.0f} s", s);
  if (s < 2.0 * 3600.0) return fmt::format("{:.0f} min", s / 60.0);
  return s < 2.0 * day_s ? fmt::format("{:.0f} h", s / 3600.0) : fmt::format("{:.1f} d", s / day_s);
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

void print_clock(const WatchedClock& clock, double years, std::uint64_t seed) {
  Crossings crossings(clock, seed);
  Watch watch(clock.period_s);
  constexpr double faults_of_each = 5.0;
  std::vector<std::vector<double>> delays(faults.size());
  std::array<int, alarm_kinds> raised{};
  for (double next_fault_s = years * year_s / (faults_of_each + 1.0);
       crossings.now_s() < years * year_s;) {
    for (const Beat& event : crossings.next())
      watch.add(event);
    if (crossings.now_s() < next_fault_s) continue;
    next_fault_s += years * year_s / (faults_of_each + 1.0);
    watch.number();
    const auto so_far = watch.take_raised();
    for (std::size_t k = 0; k < alarm_kinds; ++k)
      raised[k] += so_far[k];
    if (crossings.now_s() < years * year_s - 1.0)
      for (std::size_t f = 0; f < faults.size(); ++f)
        delays[f].push_back(delay_of(faults[f], crossings, watch));
  }
  fmt::print("{:<16}", clock.name);
  for (const AlarmKind kind :
       {AlarmKind::stopped, AlarmKind::out_of_beat, AlarmKind::sensor_failing,
        AlarmKind::amplitude_falling, AlarmKind::rate_step})
    fmt::print(" {:>9}", raised[static_cast<std::size_t>(kind)]);
  for (const auto& delay : delays)
    fmt::print(" {:>9}", duration(median(delay)));
  fmt::print("\n");
  std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
  const double years = count > 1 ? std::atof(words[1]) : 2.0;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  fmt::print(
      "the other alarms: false ones in {:g} years of each clock, beat by beat; median time to "
      "that of a fault\n{:<16}",
      years, "");
  for (const char* column : {"stopped", "out beat", "sensor", "amplitude", "rate", "stops",
                             "3 % out", "20 % miss", "-15 %", "-1 %/day"})
    fmt::print(" {:>9}", column);
  fmt::print("\n");
  for (const WatchedClock& clock : clocks)
    print_clock(clock, years, seed);
}
