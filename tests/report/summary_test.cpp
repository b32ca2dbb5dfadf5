// The summary: sentences that are true by themselves, and one table.
#include "goingrate/base/random.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"

#include "markup_checks.hpp"
#include "report/figure_axes.hpp"
#include "report/wording.hpp"
#include "some_report.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace goingrate {
namespace {

using test::some_report;

std::string all_of(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences)
    text += sentence + "\n";
  return text;
}

std::string value_of(const Analysis& data, const std::string& quantity) {
  for (const SummaryNumber& number : summary_numbers(data))
    if (number.quantity == quantity) return number.value;
  return {};
}

// A clock on which nothing happened.
Analysis quiet_report(std::size_t beats = 1000) {
  Analysis data = some_report(beats);
  data.diary = {};
  data.stretches = rates_between(data.beats, {}, 3.0);
  data.now = data.stretches.back();
  return data;
}

Analysis with_one_change(ChangeKind kind) {
  Analysis data = quiet_report();
  Change change{100, 300.0};
  change.kind = kind;
  change.rate_before = 1e-5;
  change.rate_before_sigma = 2e-7;
  change.rate_after = 3e-5;
  change.rate_after_sigma = 1e-7;
  data.diary.changes = {change};
  const Instant cut = data.beats.front().time + 300.0;
  data.stretches = rates_between(data.beats, {&cut, 1}, 3.0);
  data.now = data.stretches.back();
  return data;
}

TEST(SummaryTest, HasThreeToSixSentences) {
  for (const Analysis& data :
       {some_report(), quiet_report(), quiet_report(50), with_one_change(ChangeKind::drive)}) {
    const auto sentences = report_sentences(data);
    EXPECT_GE(sentences.size(), 3U) << all_of(sentences);
    EXPECT_LE(sentences.size(), 6U) << all_of(sentences);
    for (const std::string& sentence : sentences) {
      EXPECT_TRUE(sentence.ends_with('.') || sentence.ends_with('?')) << sentence;
      EXPECT_FALSE(test::has_word(sentence, "nan")) << sentence;
      EXPECT_EQ(sentence.find("+-"), std::string::npos) << sentence;
    }
  }
}

TEST(SummaryTest, WhereMoreCouldBeSaidTheLeastOfItIsLeftOut) {
  Analysis data = with_one_change(ChangeKind::drive);
  data.numbered.segments = 3;
  data.diary.interruptions = some_report().diary.interruptions;
  Suspicion first{Cause::slow_drive, 50.0, "evidence", {}, "Was it cleaned?"};
  Suspicion second{Cause::unlogged_weather, 40.0, "evidence"};
  data.suspicions = {first, second};
  const auto sentences = report_sentences(data);
  EXPECT_LE(sentences.size(), 6U) << all_of(sentences);
  const std::string text = all_of(sentences);
  EXPECT_NE(text.find("This log is in 3 parts"), std::string::npos) << text;
  EXPECT_NE(text.find("Was it cleaned?"), std::string::npos) << text;
  EXPECT_EQ(text.find("weather"), std::string::npos) << text;
  std::size_t count = 0;
  for (const std::string& sentence : sentences)
    count += sentences_in(sentence);
  EXPECT_LE(count, 6U) << text;
}

TEST(SummaryTest, SentencesAreCountedByTheirEnds) {
  EXPECT_EQ(sentences_in("It gains 1.5 s/day. Was it wound? Yes."), 3U);
  EXPECT_EQ(sentences_in("2.5 to 3.5"), 0U);
}

TEST(SummaryTest, TheCauseOfADatedChangeIsNotLeftOut) {
  Analysis data = with_one_change(ChangeKind::drive);
  data.fit.quality.whiteness_p = 0.5;
  Suspicion first{Cause::drive_step, 50.0, "evidence", {}, "Was it wound?"};
  Suspicion second{Cause::length_step, 40.0, "evidence"};
  first.numbers.at_s = 303.0;
  second.numbers.at_s = 900.0;
  second.numbers.size = -2e-5;
  data.suspicions = {first, second};
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("the regulation changed"), std::string::npos) << text;
  EXPECT_NE(text.find("changed at once by -1728 ms/day"), std::string::npos) << text;
  EXPECT_EQ(text.find("The model of the pendulum"), std::string::npos) << text;
}

TEST(SummaryTest, AStopBetweenTwoPartsIsToldOnce) {
  Analysis data = quiet_report();
  data.numbered.segments = 2;
  Gap stop;
  stop.bridged = false;
  stop.kind = GapKind::stop;
  data.numbered.gaps = {stop};
  data.suspicions = {{Cause::stop, 14.0, "evidence", {}, "Analyse the other side."}};
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("Over the 2997 s of the longest part of this log the clock gains"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("Analyse the other part as a log of its own."), std::string::npos) << text;
  EXPECT_EQ(text.find("started again"), std::string::npos) << text;
  EXPECT_EQ(text.find("anything is wrong"), std::string::npos) << text;
}

TEST(SummaryTest, TheRateOfTheOtherPartIsTold) {
  Analysis data = quiet_report();
  data.numbered.segments = 2;
  data.numbered.beats = data.beats;
  for (int i = 0; i < 100; ++i) {
    Beat beat;
    beat.time = data.beats.back().time + (7200.0 + 3.0003 * i);
    beat.cycle = data.beats.back().cycle + 2400 + i;
    beat.segment = 1;
    data.numbered.beats.push_back(beat);
  }
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("The rate of the other part, after it, is -8639 "), std::string::npos)
      << text;
}

TEST(SummaryTest, TwoChangesHaveTheirMoments) {
  Analysis data = with_one_change(ChangeKind::drive);
  for (Beat& beat : data.beats)
    beat.time.seconds -= data.beats.back().time.seconds; // no dates
  Change second = data.diary.changes.front();
  second.at_s = 900.0;
  data.diary.changes.push_back(second);
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("The rate changed twice, 300 s and 900 s after the first beat;"),
            std::string::npos)
      << text;
  const std::array cuts{data.beats.front().time + 300.0, data.beats.front().time + 900.0};
  data.stretches = rates_between(data.beats, cuts, 3.0);
  ASSERT_EQ(data.stretches.size(), 3U);
  const std::string with_rates = all_of(report_sentences(data));
  for (const char* words :
       {"300 s and 900 s after the first beat: from ", " before to ", " between and "})
    EXPECT_NE(with_rates.find(words), std::string::npos) << with_rates;
}

TEST(SummaryTest, ABalanceHasARegulator) {
  Analysis data = quiet_report();
  EXPECT_EQ(all_of(report_sentences(data)).find("balance"), std::string::npos);
  data.rate.nominal_period_s = 0.4; // 18,000 beats an hour
  EXPECT_NE(all_of(report_sentences(data)).find("move the regulator towards slow"),
            std::string::npos)
      << all_of(report_sentences(data));
}

TEST(SummaryTest, AClockThatIsOutOfBeatIsToldSo) {
  Analysis data = quiet_report();
  data.sensor.beat_error_s = SensorEstimate{-0.02, 1e-5}; // less than a hundredth of 3 s
  EXPECT_EQ(all_of(report_sentences(data)).find("out of beat"), std::string::npos);
  data.sensor.beat_error_s = SensorEstimate{-0.06, 1e-5};
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("Tick and tock differ by 60.000 ± 0.010 ms: the clock is out of beat, or the "
                      "sensor"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("anything is wrong"), std::string::npos) << text;
}

TEST(SummaryTest, ADriveThatVariesIsNamedInPercent) {
  Analysis data = quiet_report();
  data.drive.split.reset();
  data.fit.model.drive = true;
  FittedParameter fast;
  fast.name = "drive_rms";
  fast.status = ParameterStatus::free;
  fast.value = 0.2;
  fast.sigma = 0.01;
  fast.low95 = 0.18;
  fast.high95 = 0.22;
  data.fit.parameters.push_back(fast);
  data.fit.quality.whiteness_p = 0.5;
  EXPECT_NE(all_of(report_sentences(data)).find("from period to period, by 20.0 ± 1.0 % rms"),
            std::string::npos)
      << all_of(report_sentences(data));
  EXPECT_EQ(value_of(data, "variation of the drive from period to period, rms"), "20.0 ± 1.0 %");
}

TEST(SummaryTest, AReferenceHasItsRateInMicroseconds) {
  Analysis data = quiet_report();
  data.rate.rate_excess = 1e-9; // 86 us/day
  data.rate.rate_excess_sigma = 1e-10;
  data.stretches.clear();
  EXPECT_EQ(value_of(data, "rate over the whole log, end to end"), "+86.4 ± 8.6 µs/day");
}

TEST(SummaryTest, TheRateOfAPartIsNotThatOfTheLog) {
  Analysis data = quiet_report();
  data.numbered.segments = 2;
  EXPECT_NE(value_of(data, "rate over the whole part, end to end"), "");
}

Analysis analysed(const std::string& text, std::optional<double> tau0_s = {}) {
  LoadRequest request;
  request.path = "log.txt";
  request.reading.tau0_s = tau0_s;
  return analyse(load_text(text, request));
}

// Read by hand, a clock has readings, which nobody takes for the swings of a pendulum.
TEST(SummaryTest, ReadingsByHandAreNoBeats) {
  std::string text = "date,error\n";
  for (int i = 0; i < 25; ++i)
    text +=
        fmt::format("2023-02-{:02} 08:0{},{:+.1f}\n", i + 1, i * i * 7 % 10, 0.1 * (i * i % 3) - i);
  const Analysis data = analysed(text);
  const std::string told = all_of(report_sentences(data));
  EXPECT_NE(told.find("too short, with 25 readings, to tell"), told.npos) << told;
  EXPECT_NE(told.find("readings of a clock 86400 s apart tell how it goes"), told.npos) << told;
  EXPECT_EQ(told.find("swings of a pendulum"), told.npos) << told;
  EXPECT_NE(value_of(data, "readings in 24 days"), "");
}

TEST(SummaryTest, ARateOfPhasesNeedsNoPeriod) {
  std::string text;
  for (int i = 0; i < 400; ++i)
    text += fmt::format("{:.9f}\n", 1e-6 * (i + 1) + 1e-8 * (i * i % 7));
  const Analysis data = analysed(text, 10.0);
  const std::string told = all_of(report_sentences(data));
  EXPECT_EQ(told.find("if its period should be"), told.npos) << told;
  EXPECT_NE(value_of(data, "values in 3990 s"), "");
  EXPECT_EQ(value_of(data, "mean period, against 10 s"), "");
  const std::string rate = value_of(data, "rate over the whole log, end to end");
  EXPECT_EQ(rate.substr(0, 5), "+8.64") << rate; // 1e-6 s in 10 s: ms/day
}

TEST(SummaryTest, AFreeSwingHasNoBeatErrorAndNoStability) {
  Analysis data = quiet_report();
  data.sensor.beat_error_s = SensorEstimate{-0.06, 1e-5};
  ASSERT_NE(value_of(data, "beat error, tick − tock"), "");
  data.fit.model.escapement = Escapement::none;
  EXPECT_EQ(value_of(data, "beat error, tick − tock"), "");
  for (const SummaryNumber& number : summary_numbers(data))
    EXPECT_EQ(number.quantity.find("Allan"), std::string::npos);
}

// The course that was fitted may be of another size, or under another law of friction.
TEST(SummaryTest, AFreeSwingHasNoAmplitudeThatTheLogDoesNotTell) {
  Analysis data = quiet_report();
  data.fit.model.escapement = Escapement::none;
  data.fit.decay.emplace();
  data.fit.decay->q_at_amplitude = {{0.06, {766.0, 1.0}}, {0.3, {3895.0, 2.0}}};
  data.fit.model_amplitude_rad = {0.3472, 0.1782};
  const std::string untold = all_of(report_sentences(data));
  EXPECT_NE(untold.find("swings freely for 2997 s."), std::string::npos) << untold;
  data.fit.decay->first = {0.3, 1e-3};
  EXPECT_NE(report_sentences(data)[0].find("its swing is 300.0 ± 1.0 mrad at first."),
            std::string::npos)
      << report_sentences(data)[0];
  data.fit.decay->last = {0.06, 2e-3};
  EXPECT_NE(
      report_sentences(data)[0].find("its swing falls from 300.0 ± 1.0 mrad to 60.0 ± 2.0 mrad."),
      std::string::npos)
      << report_sentences(data)[0];
}

// A gate that logs both passages of each swing halves the period, and with it the amplitudes.
TEST(SummaryTest, HalfOfTheAmplitudesTellsOfBothPassages) {
  for (const double size : {0.499, 0.8}) {
    Analysis data = quiet_report();
    data.fit.model.escapement = Escapement::none;
    data.fit.parameters.push_back({"amplitude_scale", "", ParameterStatus::free, size, 5e-4});
    const std::string text = all_of(report_sentences(data));
    EXPECT_NE(text.find("of the true ones"), std::string::npos) << text;
    EXPECT_EQ(text.find("the period is twice") != std::string::npos, size < 0.6) << text;
  }
}

TEST(SummaryTest, WithoutADecayTheFirstSwingIsTold) {
  Analysis data = quiet_report();
  data.fit.model.escapement = Escapement::none;
  FittedParameter lambda0{"lambda0", "rad"};
  lambda0.value = 0.2;
  lambda0.sigma = NAN;
  data.fit.parameters.push_back(lambda0); // undetermined
  data.fit.model_amplitude_rad.front() = 0.2;
  const std::string untold = report_sentences(data)[0];
  EXPECT_NE(untold.find("swings freely for 2997 s."), std::string::npos) << untold;
  data.fit.parameters.back().sigma = 1e-3;
  const std::string told = report_sentences(data)[0];
  EXPECT_NE(told.find("its swing is 200.0 ± 1.0 mrad at first."), std::string::npos) << told;
}

TEST(SummaryTest, SaysWhatTheClockDoes) {
  const Analysis data = quiet_report();
  EXPECT_NE(report_sentences(data)[0].find("the clock gains 864"), std::string::npos)
      << report_sentences(data)[0];
  EXPECT_NE(report_sentences(data)[0].find("ms/day"), std::string::npos);
  EXPECT_NE(all_of(report_sentences(data)).find("Nothing in this log shows"), std::string::npos)
      << all_of(report_sentences(data));
}

TEST(SummaryTest, ARateThatMayBeZeroIsNoGain) {
  Analysis data = quiet_report();
  data.now.rate.rate_excess_sigma = data.now.rate.rate_excess;
  EXPECT_NE(report_sentences(data)[0].find("neither gains nor loses"), std::string::npos);
  EXPECT_EQ(all_of(report_sentences(data)).find("nut"), std::string::npos) << "nothing to set";
}

TEST(SummaryTest, WithoutANominalPeriodThereIsNoRate) {
  Analysis data = quiet_report();
  data.rate.nominal_is_known = false;
  const std::string text = report_text(data);
  EXPECT_NE(text.find("is not known, because no nominal"), std::string::npos) << text;
  EXPECT_EQ(text.find("rate over"), std::string::npos) << text;
  EXPECT_EQ(text.find("gains 8"), std::string::npos) << text;
}

TEST(SummaryTest, AShortLogIsNotJudged) {
  const std::string text = all_of(report_sentences(quiet_report(50)));
  EXPECT_NE(text.find("too short, with 50 beats"), std::string::npos) << text;
  EXPECT_EQ(text.find("Nothing is wrong"), std::string::npos) << text;
}

// Four readings a day, by 0.2 s, and the nut turned on the sixteenth day at 9:36: a note of that
// moment belongs to the change, whose time is told to the hour.
TEST(SummaryTest, ReadingsSeveralTimesADayTellAChange) {
  RandomStream random(77, StreamPurpose::jitter);
  std::string text = "date,time,error\n";
  for (int day = 1; day <= 30; ++day)
    for (const int hour : {8, 12, 18, 21}) {
      const int minute = static_cast<int>(60.0 * random.uniform());
      const double at_days = day + (hour + minute / 60.0) / 24.0, turned_days = 16.4;
      text += fmt::format("2024-03-{:02},{:02}:{:02},{:+.1f}\n", day, hour, minute,
                          6.0 * at_days - 7.5 * std::max(0.0, at_days - turned_days) +
                              0.2 * random.normal());
    }
  LoadRequest log;
  log.path = "read.csv";
  AnalysisRequest asked;
  asked.logbook =
      parse_logbook("time,what,value,sigma,note\n2024-03-16 09:36,rate,-7.5,,nut\n", "diary");
  const Analysis data = analyse(load_text(text, log), asked);
  ASSERT_EQ(data.diary.changes.size(), 1u);
  EXPECT_TRUE(data.logbook->unwritten.empty());
  EXPECT_NE(data.logbook->entries.at(0).verdict, EntryVerdict::not_seen);
  EXPECT_NEAR(data.now.rate.rate_excess * 86400.0, -1.5,
              3.0 * data.now.rate.rate_excess_sigma * 86400.0);
  const std::string told = all_of(report_sentences(data));
  EXPECT_NE(told.find("The rate changed on 2024-03-16 at about "), told.npos) << told;
  EXPECT_EQ(value_of(data, "readings in 29.5 days").find(" 0 missed") == std::string::npos, false);
}

// A rate of nothing is told in a unit of what it may be.
TEST(SummaryTest, ThreeWholeSecondsTellNoMillionths) {
  const std::string told = all_of(report_sentences(analysed("1.0\n3.0\n5.0\n")));
  EXPECT_NE(told.find(" s/day"), told.npos) << told;
  EXPECT_EQ(told.find("µs/day"), told.npos) << told;
}

// Daily readings, some of a steady clock and some of one whose rate falls from -1 to -13 s/day.
TEST(SummaryTest, FewReadingsTellARateThatMoves) {
  for (const double fall_s : {0.0, 0.1}) {
    std::vector<Beat> readings;
    double late_s = 0.0;
    for (int day = 0; day < 120; ++day) {
      late_s += 1.0 + fall_s * day;
      const double error_s = 0.1 * ((7 * day) % 5); // of reading the dial
      readings.push_back(event_at(Instant::from_seconds(86400.0 * day + late_s + error_s)));
      readings.back().cycle = day;
    }
    Analysis data = quiet_report();
    data.beats = readings;
    data.rate = summarise_rates(readings, 86400.0);
    data.stretches = rates_between(readings, {}, 86400.0);
    data.now = data.stretches.back();
    const std::string text = all_of(report_sentences(data));
    EXPECT_EQ(text.find("has moved in one direction") != std::string::npos, fall_s > 0.0) << text;
    EXPECT_EQ(text.find("too short") != std::string::npos, fall_s == 0.0) << text;
  }
}

TEST(SummaryTest, AChangeHasItsRatesBeforeAndAfter) {
  Analysis data = with_one_change(ChangeKind::drive);
  Suspicion drive{Cause::drive_step, 50.0, "evidence", {Cause::friction_step}, "Was it wound?"};
  drive.numbers.at_s = 303.0;
  drive.numbers.size = 2e-5;
  data.suspicions = {drive};
  data.log.source = "clock.csv";
  for (Beat& beat : data.beats)
    beat.time.seconds -= data.beats.back().time.seconds; // no dates
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("300 s after the first beat, from +86"), std::string::npos) << text;
  EXPECT_NE(text.find(" ms/day after; no other trend"), std::string::npos) << text;
  EXPECT_NE(text.find("drives the pendulum changed then"), std::string::npos) << text;
}

TEST(SummaryTest, AChangeThatDrownsInItsSigmaHasItsDateAlone) {
  Analysis data = with_one_change(ChangeKind::drive);
  data.rate.nominal_is_known = false;
  data.stretches[0].rate.rate_excess = 0.0;
  data.stretches[1].rate.rate_excess = 1e-6;
  for (const auto& [sigma, told] : {std::pair{1e-7, true}, {1e-6, false}}) {
    data.stretches[1].rate.rate_excess_sigma = sigma;
    const std::string text = all_of(report_sentences(data));
    EXPECT_NE(text.find("The rate changed"), std::string::npos) << text;
    EXPECT_EQ(text.find(", by ") != std::string::npos, told) << text;
  }
}

TEST(SummaryTest, ACauseWithAdviceLeavesTheNutToBeTurned) {
  Analysis data = quiet_report();
  data.suspicions = {{Cause::missed_beats, 50.0, "evidence", {}, "Clean the sensor."}};
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("Clean the sensor."), std::string::npos) << text;
  EXPECT_NE(text.find("Turn the rating nut so that the bob goes down, to bring"), std::string::npos)
      << text;
}

TEST(SummaryTest, AGuessedPeriodIsSaidWithTheRate) {
  Analysis data = quiet_report();
  data.log.nominal_period_s.reset();
  EXPECT_NE(report_sentences(data)[0].find("if its period should be 3 s"), std::string::npos)
      << report_sentences(data)[0];
  data.log.nominal_period_s = 3.0;
  EXPECT_EQ(report_sentences(data)[0].find("if its period"), std::string::npos)
      << report_sentences(data)[0];
}

TEST(SummaryTest, HalfThePeriodIsNoFaultOfTheSensor) {
  Analysis data = quiet_report();
  for (Beat& beat : data.beats)
    beat.cycle *= 2;
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("Every second beat is missing"), std::string::npos) << text;
  EXPECT_NE(text.find("takes 6 s here"), std::string::npos) << text;
  data.rate.crossings = 2 * static_cast<std::int64_t>(data.beats.size()); // and half were left out
  const std::string thinned = all_of(report_sentences(data));
  EXPECT_NE(thinned.find("one beat in 2 was taken"), std::string::npos) << thinned;
  EXPECT_EQ(thinned.find("is missing"), std::string::npos) << thinned;
}

TEST(SummaryTest, AVisitHasItsDirection) {
  Analysis data = quiet_report();
  data.suspicions = {{Cause::magnet, 50.0, "evidence"}};
  data.suspicions[0].numbers = {300.0, 600.0, -1e-5, 1e-6};
  EXPECT_NE(all_of(report_sentences(data)).find("the rate is lower by 864"), std::string::npos)
      << all_of(report_sentences(data));
}

TEST(SummaryTest, AWanderThatTheModelNeedsIsNamed) {
  Analysis data = with_one_change(ChangeKind::drive);
  data.fit.model.slow = true;
  FittedParameter slow;
  slow.name = "slow_rms";
  slow.value = 0.034;
  data.fit.parameters.push_back(slow);
  data.fit.quality.whiteness_p = 0.5;
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("wanders slowly, by 3.4 % rms, which absorbs the change"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("to within its noise"), std::string::npos) << text;
}

TEST(SummaryTest, AWanderOfUnknownSizeIsNamedToo) {
  Analysis data = quiet_report();
  data.fit.model.slow = true;
  FittedParameter slow;
  slow.name = "slow_rms";
  slow.value = std::numeric_limits<double>::quiet_NaN();
  slow.status = ParameterStatus::undetermined;
  data.fit.parameters.push_back(slow);
  data.fit.quality.whiteness_p = 0.5;
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("explains this log with a drive that may wander slowly"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("to within its noise"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(SummaryTest, OnlyOneCauseIsTheMostLikely) {
  Analysis data = quiet_report();
  Suspicion wander, step;
  wander.cause = Cause::slow_drive;
  step.cause = Cause::drive_step;
  step.numbers.at_s = 300.0;
  step.numbers.size = -1e-5;
  data.suspicions = {wander, step};
  const std::string text = all_of(report_sentences(data));
  const std::size_t first = text.find("ost likely");
  ASSERT_NE(first, std::string::npos) << text;
  EXPECT_EQ(text.find("ost likely", first + 1), std::string::npos) << text;
  EXPECT_NE(text.find("Probably the force that drives the pendulum changed"), std::string::npos)
      << text;
}

TEST(SummaryTest, ABeatErrorIsInTheTable) {
  Analysis data = quiet_report();
  EXPECT_EQ(value_of(data, "beat error, tick − tock"), "");
  data.sensor.beat_error_s = SensorEstimate{-2.1e-3, 1e-5};
  EXPECT_EQ(value_of(data, "beat error, tick − tock"), "2.100 ± 0.010 ms");
  data.sensor.beat_error_s = SensorEstimate{2e-8, 9.6e-7}; // the unit of the larger of the two
  EXPECT_EQ(value_of(data, "beat error, tick − tock"), "20 ± 960 ns");
}

TEST(SummaryTest, WithoutANominalPeriodAChangeHasItsSize) {
  Analysis data = with_one_change(ChangeKind::drive);
  data.rate.nominal_is_known = false;
  data.stretches[0].rate.rate_excess = -1e-5;
  data.stretches[1].rate.rate_excess = 1e-5;
  data.stretches[0].rate.rate_excess_sigma = 3e-7;
  data.stretches[1].rate.rate_excess_sigma = 4e-7;
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find(", by +1728 ± 43 ms/day;"), std::string::npos) << text; // 86400 times
}

TEST(SummaryTest, TimesThatAreDatesAreToldAsSuch) {
  const Analysis data = with_one_change(ChangeKind::drive); // from 2013-03-31 23:59 or so on
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("on 2013-04-01 at 00:05:03"), std::string::npos) << text;
}

TEST(SummaryTest, AnInterruptionIsToldOnce) {
  Analysis data = some_report();
  Suspicion again{Cause::drive_step, 50.0, "evidence", {}, "Was it wound?"};
  again.numbers.at_s = 301.0;
  again.numbers.size = 1e3;
  data.suspicions = {again};
  const std::string text = all_of(report_sentences(data));
  EXPECT_NE(text.find("the drive was interrupted"), std::string::npos) << text;
  EXPECT_EQ(text.find("drives the pendulum changed"), std::string::npos) << text;
}

TEST(SummaryTest, ASizeBelowItsSigmaHasNone) {
  Analysis data = quiet_report();
  Suspicion drift{Cause::growing_friction, 50.0, "evidence"};
  drift.numbers.size = 1e-6;
  drift.numbers.sigma = 1.0;
  data.suspicions = {drift};
  EXPECT_EQ(all_of(report_sentences(data)).find("86400000"), std::string::npos);
}

TEST(SummaryTest, ASwingThatGrowsIsNotBlamedOnFriction) {
  Analysis data = quiet_report();
  Suspicion drift{Cause::growing_friction, 50.0, "evidence"};
  drift.numbers.size = -5e-5;
  drift.numbers.amplitude_rad = 1e-2;
  data.suspicions = {drift};
  const std::string grows = all_of(report_sentences(data));
  EXPECT_NE(grows.find("the swing rises by 10"), std::string::npos) << grows;
  EXPECT_NE(grows.find("friction lessens"), std::string::npos) << grows;
  data.suspicions.front().numbers.amplitude_rad = -1e-2;
  const std::string falls = all_of(report_sentences(data));
  EXPECT_NE(falls.find("the swing falls by 10"), std::string::npos) << falls;
  EXPECT_NE(falls.find("friction grows"), std::string::npos) << falls;
}

TEST(SummaryTest, AChangeOfTheEscapementsAngleIsNoChangeOfForce) {
  Analysis data = with_one_change(ChangeKind::drive);
  Suspicion step{Cause::drive_step, 50.0, "evidence"};
  step.numbers.at_s = 300.0;
  step.numbers.size = 2e-5;
  data.suspicions = {step};
  data.fit.events = {{100, {"phi0"}}};
  const std::string angle = all_of(report_sentences(data));
  EXPECT_NE(angle.find("the angle at which the escapement acts changed then"), std::string::npos)
      << angle;
  data.fit.events = {{100, {"phi0", "mu"}}};
  const std::string force = all_of(report_sentences(data));
  EXPECT_NE(force.find("the force that drives the pendulum changed then"), std::string::npos)
      << force;
}

TEST(SummaryTest, EveryCauseHasASentenceWithoutNaN) {
  Analysis data = quiet_report();
  for (int i = 0; i <= static_cast<int>(Cause::unknown); ++i) {
    Suspicion suspicion{static_cast<Cause>(i), 50.0, "evidence", {Cause::knock, Cause::magnet}, ""};
    suspicion.numbers = {300.0, 600.0, 1e-5, 1e-6, 1e-3, 1e-4, 480.0, 3};
    data.suspicions = {suspicion};
    const std::string text = all_of(report_sentences(data));
    EXPECT_FALSE(test::has_word(text, "nan")) << text;
    EXPECT_NE(text.find(" a knock or a magnet"), std::string::npos) << text;
  }
}

TEST(SummaryTest, AThermometerInTheLogIsNoWeatherThatItLacks) {
  Analysis data = quiet_report();
  data.suspicions = {{Cause::unlogged_weather, 50.0, "evidence", {Cause::log_clock}, ""}};
  data.suspicions[0].numbers.size = 1e-5;
  EXPECT_NE(all_of(report_sentences(data)).find("which this log does not hold"), std::string::npos);
  data.covariates = {{"temperature", "1/K", -6e-6, 1e-7, 0.0, 2.0, 1.0}};
  name_weather(data.covariates, data.suspicions);
  const std::string text = all_of(report_sentences(data));
  EXPECT_EQ(text.find("which this log does not hold"), std::string::npos) << text;
  EXPECT_NE(text.find("falls by 518.4 ± 8.6 ms/day per kelvin"), std::string::npos) << text;
}

TEST(SummaryTest, TheTableHasOneUnitForAQuantity) {
  const Analysis data = some_report();
  const std::string text = report_text(data);
  EXPECT_EQ(text.find(" s/day"), std::string::npos) << text;
  EXPECT_GT(test::count_of(text, " ms/day"), 4U) << text;
  EXPECT_NE(value_of(data, "friction ε").find("(8.00 ± 0.10)×10⁻⁵"), std::string::npos) << text;
  EXPECT_EQ(value_of(data, "driving torque μ"), "") << "the log does not tell it";
  EXPECT_NE(value_of(data, "  time error of the two in a week, rms").find("0.3 s"),
            std::string::npos)
      << text;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(characters(line), 80U) << line;
}

// Those of neighbouring beats exceed the rate of a clock that goes well by far.
TEST(SummaryTest, AnAllanDeviationHasAUnitOfItsSize) {
  Analysis data = some_report();
  data.deviation.rows[0] = {3.0, 1, 498, 4.262e-4, 4.152e-4, 4.372e-4, 2, true}; // 36.8 s/day
  EXPECT_EQ(value_of(data, "Allan deviation over τ = 3 s"), "36.82 ± 0.95 s/day");
  EXPECT_EQ(value_of(data, "  least, over τ = 6 s"), "0.1728 s/day");
  EXPECT_NE(value_of(data, "rate over the whole log, end to end").find(" ms/day"),
            std::string::npos);
}

TEST(SummaryTest, AQAfterAChangeOfFrictionNamesIt) {
  Analysis data = some_report();
  EXPECT_NE(value_of(data, "quality factor of that friction, Q = 1/2ε"), "");
  FittedParameter later = *data.fit.find("epsilon");
  later.name = "epsilon@1";
  data.fit.parameters.push_back(later);
  data.fit.events = {{100, {"epsilon"}}};
  EXPECT_EQ(value_of(data, "quality factor of that friction, Q = 1/2ε"), "");
  EXPECT_EQ(value_of(data, "quality factor Q = 1/2ε of the friction ε from 2013-04-01 00:05:03 on"),
            "6250 ± 80")
      << report_text(data);
}

TEST(SummaryTest, TheQOfARingDownIsNotThatOfLinearFrictionAlone) {
  Analysis data = some_report();
  data.fit.decay.emplace();
  data.fit.decay->amplitude_rad = 0.12;
  data.fit.q_factor = {"Q", "at 0.12 rad, whichever law of friction", "", 53.7, 0.05};
  EXPECT_EQ(value_of(data, "quality factor Q at 120 mrad, whichever law of friction"),
            "53.700 ± 0.050");
  EXPECT_EQ(value_of(data, "quality factor of that friction, Q = 1/2ε"), "");
}

TEST(SummaryTest, TheClocksThatALogMayBeOfAreInTheTable) {
  Analysis data = quiet_report();
  EXPECT_EQ(value_of(data, "a clock that explains this log"), "");
  data.fit.likeliest_twin = ClockTwin{{{"epsilon", 2e-4}}, {{"epsilon", 1e-6}}};
  data.fit.twins = {ClockTwin{{{"epsilon", 3e-4}}, {{"epsilon", 2e-6}}, 2.0 * std::log(3.0)}};
  EXPECT_EQ(value_of(data, "a clock that explains this log"), "ε (2.000 ± 0.010)×10⁻⁴");
  EXPECT_EQ(value_of(data, "  another, 3 times less likely"), "ε (3.000 ± 0.020)×10⁻⁴");
}

TEST(SummaryTest, TheWeeksCostIsNamedWhereItIsKnown) {
  Analysis data = some_report();
  EXPECT_EQ(value_of(data, "  time error of the two in a week, rms"), "0.3 s and at most 1.2 s");
  data.drive.split->costs.resize(1); // of a day
  EXPECT_EQ(value_of(data, "  time error of the two in a week, rms"), "");
}

TEST(SummaryTest, AFewWideSwingsAreInRadians) {
  Analysis data = quiet_report();
  for (Beat& beat : data.beats)
    beat.amplitude_rad = 0.7 + 1e-3 * static_cast<double>(beat.cycle % 2);
  EXPECT_EQ(value_of(data, "amplitude, mean of the last 20 beats"), "0.70050 ± 0.00011 rad");
}

TEST(SummaryTest, TheJsonHoldsAllOfIt) {
  Analysis data = some_report();
  data.covariates = {{"temperature", "1/K", 6e-6, 1e-7, 0.0, 2.0, 1.0}};
  const auto json = nlohmann::json::parse(report_json(data));
  EXPECT_EQ(json["summary"].get<std::vector<std::string>>(), report_sentences(data));
  EXPECT_EQ(json["numbers"].size(), summary_numbers(data).size());
  for (const char* key : {"rate", "segment_rates", "rate_now", "diary", "causes", "covariates",
                          "fit", "spectrum", "stability"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["covariates"][0]["name"], "temperature");
  EXPECT_EQ(json["covariates"][0]["coefficient"], 6e-6);
  EXPECT_EQ(json["segment_rates"].size(), 3U);
}

TEST(SummaryTest, ALongSpectrumIsAveragedForThePage) {
  Analysis data = some_report();
  auto& spectrum = *data.drive.rate_spectrum;
  spectrum.frequency_hz.clear();
  spectrum.density.clear();
  for (int i = 1; i <= 100'000; ++i) {
    spectrum.frequency_hz.push_back(1e-6 * i);
    spectrum.density.push_back(2.0);
  }
  const auto json = nlohmann::json::parse(report_json(data))["spectrum"];
  EXPECT_TRUE(json["averaged_in_bands"].get<bool>());
  EXPECT_LT(json["density"].size(), 2000U);
  for (const auto& density : json["density"])
    EXPECT_NEAR(density.get<double>(), 2.0, 1e-12);
}

} // namespace
} // namespace goingrate
