// Logs that are read in parts, against the same logs read whole.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/phases.hpp"

#include "goingrate/base/random.hpp"
#include "support/scratch_folder.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

class LoadPartsTest : public test::ScratchFolderTest {
protected:
  struct Scene {
    const char* name;
    const char* header = "";
    bool other_columns = false;   // amplitude and temperature
    bool both_directions = false; // out of beat, without labels
    double missed = 0.0, false_events = 0.0;
    double period_s = 1.5;
    int gap_every = 0; // cycles: then 30 are missing
  };

  static constexpr int cycles = 100'000;

  static std::string text_of(const Scene& scene) {
    RandomStream random(20261201, StreamPurpose::jitter);
    std::string text = scene.header;
    double walk_s = 0.0;
    const auto add = [&](double time_s) {
      text += fmt::format("{:.6f}", time_s);
      if (scene.other_columns)
        text +=
            fmt::format(",{:.6f},{:.2f}", 0.05 + 1e-5 * random.normal(), 20.0 + random.uniform());
      text += '\n';
    };
    for (int n = 0; n < cycles; ++n) {
      walk_s += 2e-6 * random.normal();
      const double time_s = 100.0 + scene.period_s * n + walk_s + 1e-5 * random.normal();
      const bool in_gap = scene.gap_every > 0 && n > 0 && n % scene.gap_every < 30;
      const bool is_missed = random.uniform() < scene.missed;
      if (!in_gap && !is_missed) add(time_s);
      if (random.uniform() < scene.false_events) add(time_s + 0.1 + 0.5 * random.uniform());
      if (scene.both_directions && !in_gap) add(time_s + 0.71 + 1e-5 * random.normal());
    }
    return text;
  }

  [[nodiscard]] LoadRequest request_for(const Scene& scene) const {
    LoadRequest request;
    request.path = path(scene.name);
    put(scene.name, text_of(scene));
    return request;
  }
};

LoadRequest in_parts(LoadRequest request, std::size_t events) {
  request.part_events = events;
  return request;
}

// The parts begin and end at other places in each run, so that every kind of event comes to lie in
// an overlap.
TEST_F(LoadPartsTest, EveryEventIsAsInTheWholeLog) {
  for (const Scene& scene : {Scene{"plain"},
                             Scene{.name = "columns",
                             .header = "time,amplitude rad,temperature C\n",
                             .other_columns = true},
                             Scene{.name = "directions", .both_directions = true},
                             Scene{.name = "faults", .missed = 0.03, .false_events = 0.02},
                             Scene{.name = "odd period", .period_s = 1.10034},
                             Scene{.name = "gaps", .missed = 0.001, .gap_every = 700}}) {
    const LoadRequest request = request_for(scene);
    const NumberedLog whole = load(request);
    ASSERT_EQ(whole.beats.segments, 1u) << scene.name;
    for (const std::size_t events : {16'000u, 23'000u, 40'000u}) {
      SCOPED_TRACE(fmt::format("{} in parts of {}", scene.name, events));
      std::vector<Beat> beats;
      std::vector<double> temperatures;
      std::size_t parts = 0;
      const NumberedLog joined = load(in_parts(request, events), [&](const LogPart& part) {
        ++parts;
        for (std::size_t i = part.first; i < part.end; ++i) {
          beats.push_back(part.log.beats.beats[i]);
          if (scene.other_columns) temperatures.push_back(part.log.log.columns.temperature_c[i]);
        }
      });
      EXPECT_GT(parts, 2u);
      ASSERT_EQ(beats.size(), whole.beats.beats.size());
      std::size_t different = 0;
      for (std::size_t i = 0; i < beats.size(); ++i) {
        const Beat &part = beats[i], &all = whole.beats.beats[i];
        different += part.time != all.time || part.cycle != all.cycle || part.flag != all.flag ||
                             part.edge != all.edge || part.segment != all.segment
                         ? 1
                         : 0;
      }
      EXPECT_EQ(different, 0u);
      EXPECT_EQ(temperatures, whole.log.columns.temperature_c);
      EXPECT_EQ(joined.beats.spurious, whole.beats.spurious);
      EXPECT_EQ(joined.beats.missed, whole.beats.missed);
      EXPECT_EQ(joined.beats.segments, whole.beats.segments);
      ASSERT_EQ(joined.beats.gaps.size(), whole.beats.gaps.size());
      for (std::size_t i = 0; i < joined.beats.gaps.size(); ++i)
        EXPECT_EQ(joined.beats.gaps[i].after_cycle, whole.beats.gaps[i].after_cycle);
      EXPECT_EQ(joined.crossings, static_cast<std::int64_t>(whole.good.size()));
      const RateSummary rate = mean_rate(joined), expected = mean_rate(whole);
      EXPECT_EQ(rate.mean_period_s, expected.mean_period_s);
      // Of errors against two means of the period, where none is usual.
      EXPECT_NEAR(rate.rate_excess_sigma / expected.rate_excess_sigma, 1.0, 1e-6);
      EXPECT_EQ(rate.crossings, expected.crossings);
    }
  }
}

TEST_F(LoadPartsTest, KeepsEveryKthBeatAndTheLast) {
  const Scene scene{.name = "log",
                    .header = "time,amplitude rad,temperature C\n",
                    .other_columns = true,
                    .missed = 0.01};
  LoadRequest request = request_for(scene);
  const NumberedLog whole = load(request);
  request.most_beats = 3000;
  const NumberedLog kept = load(in_parts(request, 16'000));
  EXPECT_EQ(kept.beats.step, 64); // 100 000 / 64 is below 3000, / 32 is not
  ASSERT_LE(kept.beats.beats.size(), 3001u);
  ASSERT_GT(kept.beats.beats.size(), 1500u);
  EXPECT_EQ(kept.log.columns.temperature_c.size(), kept.beats.beats.size());
  EXPECT_EQ(kept.beats.beats.back().cycle, whole.good.back().cycle);
  for (std::size_t i = 0; i + 1 < kept.beats.beats.size(); ++i)
    EXPECT_EQ(kept.beats.beats[i].cycle % 64, 0);
  EXPECT_EQ(kept.beats.missed, whole.beats.missed);
  const RateSummary rate = mean_rate(kept), expected = mean_rate(whole);
  EXPECT_EQ(rate.crossings, expected.crossings);
  EXPECT_EQ(rate.rate_excess, expected.rate_excess);
  // The scatter of blocks of the same walk, whose ends differ by some beats.
  EXPECT_NEAR(rate.rate_excess_sigma / expected.rate_excess_sigma, 1.0, 0.2);
  const PhaseSeries phase = phase_series(kept);
  EXPECT_EQ(phase.tau0_s, 96.0);
  EXPECT_EQ(phase.phase_s.size(), static_cast<std::size_t>((cycles - 1) / 64 + 1));
}

// The jitter of the beats that are kept is that of all, and the rates between them are so long.
TEST_F(LoadPartsTest, AnAnalysisOfEveryKthBeatFindsTheSameNoise) {
  LoadRequest request = request_for({.name = "log"});
  request.most_beats = 30'000;
  AnalysisRequest of;
  of.traces_profiles = false;
  const Analysis data = analyse(load(in_parts(request, 16'000)), of);
  EXPECT_EQ(data.numbered.step, 4);
  EXPECT_EQ(data.rate.crossings, cycles);
  EXPECT_EQ(data.drive.interval_s, 6.0);
  EXPECT_EQ(data.drive.rates.size(), data.beats.size() - 2); // the last beat is off the grid
  EXPECT_EQ(data.deviation.rows[0].tau_s, 6.0);
  ASSERT_TRUE(data.fit.has_result());
  // 25 000 beats tell it to 0.5 %, and the walk of 2 µs a beat adds to it
  EXPECT_NEAR(data.fit["jitter_rms"].value, 1e-5, 3e-7);
}

TEST_F(LoadPartsTest, ASetClockBeginsASegmentInAnyPart) {
  std::string text;
  for (int n = 0; n < 40'000; ++n)
    text += fmt::format("{:.6f}\n", 100.0 + 1.5 * n + (n >= 30'000 ? 0.6 : 0.0));
  LoadRequest request;
  request.path = path("set");
  put("set", text);
  const NumberedLog whole = load(request), joined = load(in_parts(request, 16'000));
  EXPECT_EQ(whole.beats.segments, 2u);
  EXPECT_EQ(joined.beats.segments, 2u);
  EXPECT_EQ(joined.good.size(), 30'000u);
  EXPECT_EQ(joined.beats.beats.back().cycle, whole.beats.beats.back().cycle);
}

// No period is usual here: that of the first part is compared with, in all parts.
TEST_F(LoadPartsTest, PhasesAreThoseOfTheWholeLog) {
  LoadRequest request =
      request_for({.name = "log", .missed = 0.01, .false_events = 0.01, .period_s = 1.10034});
  const PhaseSeries expected = phase_series(load(request));
  PhaseCollector phases;
  request.most_beats = 1000;
  NumberedLog log = load(in_parts(request, 16'000), [&](const LogPart& part) { phases.add(part); });
  const PhaseSeries series = phases.series(std::move(log));
  EXPECT_NEAR(series.tau0_s, expected.tau0_s, 1e-4); // two samples, in which false events tell
  ASSERT_EQ(series.phase_s.size(), expected.phase_s.size());
  const double rate_s = series.tau0_s - expected.tau0_s; // a cycle
  for (std::size_t i = 0; i < series.phase_s.size(); ++i) {
    ASSERT_EQ(std::isnan(series.phase_s[i]), std::isnan(expected.phase_s[i])) << i;
    if (std::isnan(series.phase_s[i])) continue;
    const double apart_s = series.phase_s[i] - expected.phase_s[i];
    ASSERT_NEAR(apart_s, rate_s * static_cast<double>(i), 1e-10) << i; // roundings of 1e5 s
  }
}

// A logger that wrote a time long past: it is put in order before events that were given out.
TEST_F(LoadPartsTest, AStrayTimeInALaterPartMovesNothing) {
  std::string text;
  for (int n = 0; n < 80'000; ++n)
    text += n == 50'000 ? "99.000000\n" : fmt::format("{:.6f}\n", 100.0 + 1.5 * n);
  LoadRequest request;
  request.path = path("stray");
  put("stray", text);
  request.reading.wrap_s = 0.0; // not a clock of a day that began again
  std::vector<std::int64_t> cycles_seen;
  const NumberedLog joined = load(in_parts(request, 16'000), [&](const LogPart& part) {
    for (std::size_t i = part.first; i < part.end; ++i)
      if (part.log.beats.beats[i].flag == BeatFlag::good)
        cycles_seen.push_back(part.log.beats.beats[i].cycle);
  });
  ASSERT_EQ(cycles_seen.size(), 79'999u);
  EXPECT_TRUE(std::is_sorted(cycles_seen.begin(), cycles_seen.end()));
  EXPECT_EQ(cycles_seen.back(), 79'999);
  EXPECT_EQ(joined.beats.segments, 1u);
  EXPECT_EQ(joined.beats.missed, 1);
}

TEST_F(LoadPartsTest, AFolderIsReadWhole) {
  std::filesystem::create_directory(path("logs"));
  put("logs/a.csv", text_of({.name = "a"}));
  LoadRequest request;
  request.path = path("logs");
  EXPECT_EQ(load(in_parts(request, 16'000)).good.size(), static_cast<std::size_t>(cycles));
}

// A wheel closes a contact once in 30 swings, but now and then it does not.
TEST_F(LoadPartsTest, ContactsOfAWheelAreCountedInSwings) {
  std::string text = "# goingrate log 1\n# nominal_period_s: 2\ntime_s\n";
  for (int n = 0; n < 60'000; ++n)
    if (n % 1000 != 999) text += fmt::format("{:.6f}\n", 100.0 + 60.0 * n);
  LoadRequest request;
  request.path = path("contacts");
  put("contacts", text);
  const NumberedLog whole = load(request), joined = load(in_parts(request, 16'000));
  EXPECT_EQ(whole.beats.step, 30);
  EXPECT_EQ(joined.beats.step, 30);
  EXPECT_EQ(joined.beats.missed, whole.beats.missed);
  EXPECT_EQ(joined.good.back().cycle, whole.good.back().cycle);
}

TEST_F(LoadPartsTest, AFaultInALaterPartIsToldWithItsLine) {
  std::string text;
  for (int n = 0; n < 40'000; ++n)
    text += n == 35'000 ? "what\n" : fmt::format("{:.6f}\n", 100.0 + 1.5 * n);
  LoadRequest request;
  request.path = path("junk");
  put("junk", text);
  const NumberedLog joined = load(in_parts(request, 16'000));
  ASSERT_EQ(joined.log.issues.size(), 1u);
  EXPECT_EQ(joined.log.issues[0].line, 35'001u);
  EXPECT_EQ(joined.beats.missed, 1);
}

} // namespace
} // namespace goingrate
