// Faulty lines: what is done about them, and what is reported.
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {
namespace {

TEST(FormatsTest, LabelJitterIsMendedAndTold) {
  std::string text;
  for (int i = 0; i < 40; ++i) {
    const int label = 3 * (i == 20 ? 19 : i == 30 ? 31 : i); // one early, one late
    text += fmt::format("{} {:.6f} 46.4\n", 1364774403 + label, -1.27 + 1e-5 * i);
  }
  const ClockLog log = read_log(text, "x");
  EXPECT_EQ(log.nominal_period_s, 3.0);
  ASSERT_EQ(log.issues.size(), 2u);
  EXPECT_EQ(log.issues[0].kind, IssueKind::label_jitter);
  EXPECT_EQ(log.issues[0].line, 21u);
  EXPECT_EQ(log.issues[1].line, 31u);
  for (std::size_t i = 1; i < log.events.size(); ++i)
    // A few roundings of 3 s.
    EXPECT_NEAR(log.events[i].time - log.events[i - 1].time, 3.0 - 1e-5, 2e-15);
}

TEST(FormatsTest, SentinelsEmptyFieldsAndNanAreNoTimes) {
  const ClockLog log = read_log("time_s,amplitude_rad\n0.0,0.05\n2.0,\n9999.999,0.05\n,0.05\n"
                                "4.0,NaN\nnan,0.05\n6.0,99999\n8.0,0.05\n",
                                "x");
  ASSERT_EQ(log.events.size(), 5u);
  EXPECT_TRUE(std::isnan(log.events[1].amplitude_rad));
  EXPECT_TRUE(std::isnan(log.events[3].amplitude_rad));
  std::vector<IssueKind> kinds;
  for (const LineIssue& issue : log.issues)
    kinds.push_back(issue.kind);
  EXPECT_EQ(kinds, (std::vector<IssueKind>{IssueKind::no_value, IssueKind::missing,
                                           IssueKind::no_value, IssueKind::no_value}))
      << "amplitudes that are empty or NaN are unknown by the file's own word";
}

TEST(FormatsTest, ATruncatedLastLineIsLeftOut) {
  for (const char* last : {"8.1", "8.", "8,0.05", "1"}) {
    const std::string rows = std::string_view(last).find(',') == std::string_view::npos
                                 ? "0.125\n2.125\n4.125\n6.125\n"
                                 : "0.125,0.05,3\n2.125,0.05,3\n4.125,0.05,3\n6.125,0.05,3\n";
    const ClockLog log = read_log(rows + last, "x");
    EXPECT_EQ(log.events.size(), 4u) << last;
    ASSERT_EQ(log.issues.size(), 1u) << last;
    EXPECT_EQ(log.issues[0].kind, IssueKind::truncated) << last;
  }
  EXPECT_TRUE(read_log("0.125\n2.125\n4.125", "x").issues.empty()); // whole, without a line end
}

TEST(FormatsTest, RunsOfBadLinesAreOneIssue) {
  const ClockLog log = read_log("0\n2\n4\nx\ny\nz\n6\n8\n10\n", "x");
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].line, 4u);
  EXPECT_EQ(log.issues[0].last_line, 6u);
}

TEST(FormatsTest, StrictMakesTheFirstIssueAnError) {
  ReadingOptions options;
  options.strict = true;
  EXPECT_THROW((void)read_log("0\n2\n4\nx\n6\n8\n", "log", options), InputError);
  try {
    (void)read_log("0\n2\n4\nx\n6\n8\n", "log", options);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string_view(error.what()).substr(0, 8), "log:4:1:");
  }
}

TEST(FormatsTest, AHalfHeaderNamesWhatItCan) {
  const ClockLog log = read_log("time_s,ampl\n0,0.05,20\n2,0.05,20\n4,0.05,20\n", "x");
  EXPECT_EQ(log.events.size(), 3u);
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].kind, IssueKind::header);
}

} // namespace
} // namespace goingrate
