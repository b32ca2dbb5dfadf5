// Whether the count that a monitor carries over a break is right as often as it states. A clock is
// heard for a day, then not for minutes to days, then again. Arguments: breaks of each length and
// clock (10), first seed (1).
#include "rolling_numbers.hpp"
#include "studies/monitor_clocks.hpp"

#include "goingrate/base/random.hpp"

#include <array>
#include <cstdlib>
#include <fmt/format.h>
#include <vector>

using namespace goingrate;
using namespace goingrate::apps;

namespace {

constexpr double period_s = 2.0, minute_s = 60.0, hour_s = 3600.0, day_s = 86400.0;
constexpr double heard_before_s = day_s, watched_days = 9.0;
constexpr std::size_t heard_after = 60; // beats

struct Length {
  const char* name;
  double s;
};
constexpr std::array lengths{Length{"10 min", 10.0 * minute_s}, Length{"1 h", hour_s},
                             Length{"6 h", 6.0 * hour_s},       Length{"1 day", day_s},
                             Length{"2 days", 2.0 * day_s},     Length{"4 days", 4.0 * day_s},
                             Length{"7 days", 7.0 * day_s}};

// Counts of breaks.
struct Share {
  int all = 0, right = 0, carried = 0, carried_wrong = 0;
  double claimed = 0.0;

  void add(double probability, bool is_right, bool is_carried) {
    ++all;
    claimed += probability;
    right += is_right ? 1 : 0;
    carried += is_carried ? 1 : 0;
    carried_wrong += is_carried && !is_right ? 1 : 0;
  }
};

constexpr std::array claims{0.5, 0.9, 0.99, 0.999, 1.1};
std::array<Share, claims.size()> by_claim;

std::vector<double> beat_times(const std::vector<double>& minute_rates, std::uint64_t seed) {
  constexpr double jitter_s = 2e-5;
  RandomStream jitter(seed, StreamPurpose::jitter);
  std::vector<double> times;
  for (double at = 0.0; at < minute_s * static_cast<double>(minute_rates.size());) {
    times.push_back(at + jitter_s * jitter.normal());
    at += period_s * (1.0 - minute_rates[static_cast<std::size_t>(at / minute_s)]);
  }
  return times;
}

// The first gap behind the beats before the break; a probability of 0 if none is told.
Gap told_gap(const std::vector<double>& times, std::size_t before, std::size_t after) {
  const LogOptions options;
  RollingNumbers numbers(options);
  ClockLog log;
  log.nominal_period_s = period_s;
  const auto hear = [&](std::size_t from, std::size_t to, std::size_t at_once) {
    std::vector<Gap> gaps;
    for (std::size_t i = from; i < to; ++i) {
      numbers.add(event_at(Instant::from_seconds(times[i]), Edge::up));
      if ((i + 1 - from) % at_once != 0 && i + 1 < to) continue;
      numbers.numbered(log);
      for (const Gap& gap : numbers.take_gaps())
        gaps.push_back(gap);
    }
    return gaps;
  };
  hear(0, before, 4096);
  const auto gaps = hear(after, after + heard_after, 1);
  return gaps.empty() ? Gap{} : gaps.front();
}

void judge_clock(const char* name, int count, const auto& rates_of) {
  std::array<Share, lengths.size()> by_length;
  for (int k = 0; k < count; ++k) {
    const auto times = beat_times(rates_of(k), static_cast<std::uint64_t>(k));
    for (std::size_t l = 0; l < lengths.size(); ++l) {
      const auto before =
          static_cast<std::size_t>(heard_before_s * (1.0 - 0.03 * k / count) / period_s);
      const auto after = before + static_cast<std::size_t>((lengths[l].s + 7.0) / period_s);
      if (after + heard_after > times.size()) continue;
      const Gap gap = told_gap(times, before, after);
      const bool is_right = gap.length == static_cast<std::int64_t>(after - before);
      by_length[l].add(gap.probability, is_right, gap.bridged);
      std::size_t c = 0;
      while (gap.probability >= claims[c])
        ++c;
      by_claim[c].add(gap.probability, is_right, gap.bridged);
    }
  }
  fmt::print("{:<41}", name);
  for (const Share& share : by_length)
    fmt::print(" {:>9}", fmt::format("{:.2f}/{:.2f}", share.claimed / share.all,
                                     static_cast<double>(share.right) / share.all));
  fmt::print("\n");
  std::fflush(stdout);
}

} // namespace

int main(int argument_count, char** words) {
  const int count = argument_count > 1 ? std::atoi(words[1]) : 10;
  const auto seed = static_cast<std::uint64_t>(argument_count > 2 ? std::atoll(words[2]) : 1);
  fmt::print("breaks of the monitor, {} of each length, a day heard before: mean probability that "
             "was told / share of counts\nthat were right\n{:<41}",
             count, "");
  for (const Length& length : lengths)
    fmt::print(" {:>9}", length.name);
  fmt::print("\n");
  const auto judge = [&](const auto& clocks) {
    for (const auto& clock : clocks)
      judge_clock(clock.name, count, [&](int k) {
        return minute_rates(clock, watched_days / 365.25, seed + static_cast<std::uint64_t>(k));
      });
  };
  judge(swung_clocks);
  judge(wandering_clocks);
  fmt::print("by the probability that was told; those that are carried over, and of them wrong\n");
  double from = 0.0;
  for (std::size_t c = 0; c < claims.size(); from = claims[c++]) {
    const Share& share = by_claim[c];
    if (share.all > 0)
      fmt::print(
          "  from {:<6g} {:>5} breaks, told {:.4f}, right {:.4f}; {:>4} carried over, {} wrong\n",
          from, share.all, share.claimed / share.all, static_cast<double>(share.right) / share.all,
          share.carried, share.carried_wrong);
  }
}
