#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

struct RateStep {
  double at_s, s_per_day;
};

// Beats of 2 s with jitter, whose rate changes.
ClockLog regulated(int beats, std::initializer_list<RateStep> steps, std::uint64_t seed) {
  RandomStream jitter(seed, StreamPurpose::jitter);
  ClockLog log;
  log.source = "clock";
  log.nominal_period_s = 2.0;
  double early = 0.0;
  for (int i = 0; i < beats; ++i) {
    const double t = 2.0 * i;
    for (const RateStep& step : steps)
      early += t > step.at_s ? 2.0 * step.s_per_day / 86400.0 : 0.0;
    log.events.push_back(event_at(Instant::from_seconds(t - early + 1e-4 * jitter.normal()),
                                  Edge::up, static_cast<std::uint32_t>(i + 1)));
  }
  return log;
}

Analysis analysed(ClockLog log, std::string_view diary) {
  AnalysisRequest request;
  request.traces_profiles = false;
  request.logbook = parse_logbook(diary, "diary");
  return analyse(load_events(std::move(log), {}), request);
}

TEST(LogbookCheckTest, PlannedAgainstFound) {
  const Analysis data = analysed(regulated(8000, {{5000.0, 1.0}, {11000.0, -2.0}}, 4),
                                 "time,what,value,sigma,note\n"
                                 "-9000,clean,,,before the log\n"
                                 "2500,rate,0.8,0.1,did nothing\n"
                                 "5300,rate,1.0,0.2,up a bit\n"
                                 "8000,wind,,,\n");
  ASSERT_TRUE(data.logbook);
  const auto& entries = data.logbook->entries;
  ASSERT_EQ(entries.size(), 4u);
  EXPECT_EQ(entries[0].verdict, EntryVerdict::outside);
  EXPECT_EQ(entries[1].verdict, EntryVerdict::not_seen);
  EXPECT_LT(std::abs(entries[1].found), 4.0 * entries[1].found_sigma);
  EXPECT_EQ(entries[2].verdict, EntryVerdict::as_planned);
  EXPECT_LT(std::abs(entries[2].found - 1.0), 4.0 * entries[2].found_sigma);
  EXPECT_LT(entries[2].found_sigma, 0.02); // jitter of 0.1 ms over 2500 s, s/day
  EXPECT_NEAR(entries[2].found_at_s, 5000.0, 120.0); // sixty beats: of the window of the search
  EXPECT_EQ(entries[3].verdict, EntryVerdict::not_seen);
  ASSERT_EQ(data.logbook->unwritten.size(), 1u);
  EXPECT_NEAR(data.logbook->unwritten[0].at_s, 11000.0, 120.0);
  EXPECT_EQ(data.logbook->unwritten[0].entry.what, LogbookWord::rate);
  EXPECT_NEAR(data.logbook->unwritten[0].entry.value, -2.0,
              4.0 * data.logbook->unwritten[0].entry.sigma);
}

TEST(LogbookCheckTest, AnotherSizeDiffers) {
  const Analysis data = analysed(regulated(4000, {{4000.0, 2.0}}, 5),
                                 "time,what,value,sigma\n3900,rate,1.0,0.2\n");
  EXPECT_EQ(data.logbook->entries[0].verdict, EntryVerdict::differs);
}

TEST(LogbookCheckTest, WhatIsFoundIsADiaryInWhichNothingIsUnwritten) {
  ClockLog log = regulated(4000, {{4000.0, 2.0}}, 6);
  const Analysis once = analysed(log, "time,what\n100,note\n");
  ASSERT_EQ(once.logbook->unwritten.size(), 1u);
  const Analysis again = analysed(log, logbook_text(findings_of(once)));
  EXPECT_TRUE(again.logbook->unwritten.empty());
  EXPECT_EQ(again.logbook->entries.at(0).verdict, EntryVerdict::as_planned);
}

// The driving weight is made heavier: with what was planned the fit knows the drive better.
TEST(LogbookCheckTest, WhatWasPlannedIsKnownToTheFit) {
  FitOptions options;
  const NumberedLog loaded = load({.path = GOINGRATE_SOURCE_DIR "/data/logs/jump.csv"});
  options.fixed = {{"T0", 2.0}};
  options.dynamics = FitDynamics::averaged1;
  options.noise = FitNoise::jitter;
  options.events = {{150 - loaded.good.front().cycle, {"mu"}}};
  const FitSummary free = fit_clock(fit_data(loaded), 2.0, options);
  options.events[0].planned = PlannedRatio{2.0, 1e-7};
  const FitSummary planned = fit_clock(fit_data(loaded), 2.0, options);
  const auto ratio = [](const FitSummary& fit) { return fit["mu@1"].value / fit["mu"].value; };
  EXPECT_NEAR(ratio(planned), 2.0, 4e-7);
  EXPECT_GT(std::abs(ratio(free) - 2.0), 4e-7) << "the log alone does not tell so well";
}

TEST(LogbookCheckTest, ThingsDoneAtOnceAreOneChange) {
  const Analysis data = analysed(regulated(4000, {{4000.0, 2.0}}, 7),
                                 "time,what,value,sigma\n4000,rate,2,0.2\n4000,clean,,\n"
                                 "4000,wind,,\n6000,clean,,\n6000,weight,0.05,0.001\n");
  const auto& entries = data.logbook->entries;
  EXPECT_EQ(entries[0].verdict, EntryVerdict::as_planned);
  EXPECT_EQ(entries[1].verdict, EntryVerdict::unclear) << "not by itself";
  EXPECT_EQ(entries[2].verdict, EntryVerdict::not_seen) << "the change is named already";
  EXPECT_TRUE(data.logbook->unwritten.empty());
}

TEST(LogbookCheckTest, ADayLeavesChangesToThoseWhoKnowTheTime) {
  ClockLog log = regulated(4000, {{4000.0, 2.0}}, 8);
  for (Beat& beat : log.events)
    beat.time.seconds += 1364637600; // 2013-03-30 10:00
  const Analysis data = analysed(log, "time,what,value,sigma\n2013-03-30,clean,,\n"
                                      "2013-03-30 11:05,rate,2,0.2\n2013-03-31,rate,1,\n");
  const auto& entries = data.logbook->entries;
  EXPECT_EQ(entries[0].verdict, EntryVerdict::unclear);
  EXPECT_EQ(entries[1].verdict, EntryVerdict::as_planned);
  EXPECT_EQ(entries[2].verdict, EntryVerdict::outside);
}

TEST(LogbookCheckTest, ASettingIsKnownButForWholePeriods) {
  ClockLog log = regulated(4000, {}, 9);
  for (std::size_t i = 2000; i < log.events.size(); ++i)
    log.events[i].time = log.events[i].time + -0.4;
  const Analysis data = analysed(log, "time,what,value,sigma\n4010,set,60.4,0.1\n");
  EXPECT_EQ(data.logbook->entries[0].verdict, EntryVerdict::as_planned);
  EXPECT_NEAR(data.logbook->entries[0].found, 60.4, 0.01);
}

TEST(LogbookCheckTest, APlanThatTheLogExcludesIsLeftOut) {
  AnalysisRequest request;
  request.traces_profiles = false;
  request.fit.fixed = {{"T0", 2.0}};
  request.logbook =
      parse_logbook("time,what,value,sigma\n300,weight,-0.4,0.002\n", "diary"); // it was doubled
  const Analysis data =
      analyse(load({.path = GOINGRATE_SOURCE_DIR "/data/logs/jump.csv"}), request);
  EXPECT_EQ(data.fit.status, FitStatus::converged);
  EXPECT_EQ(data.logbook->entries[0].verdict, EntryVerdict::differs);
  EXPECT_NEAR(data.logbook->entries[0].found, 1.0, 4.0 * data.logbook->entries[0].found_sigma);
  EXPECT_LT(data.logbook->entries[0].found_sigma, 1e-3) << "before and after go together";
}

} // namespace
} // namespace goingrate
