// `goingrate rate` as a script sees it.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <signal.h>
#include <sstream>
#include <thread>

namespace goingrate::test {
namespace {

using RateCommandTest = CommandTest;

std::string evenly(int count, double period, double start = 100.0) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{:.9f}\n", start + period * i);
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  return lines;
}

TEST_F(RateCommandTest, SeveralFilesAreOneLog) {
  std::filesystem::create_directories(folder_ / "clock/days");
  const std::string first = evenly(300, 2.0003, 1.5e9), second = evenly(400, 2.0003, 1.5e9 + 640.0);
  put("clock/days/b.txt", first); // the dates tell the order, not the names
  put("clock/days/a.txt", second);
  put("whole.txt", first + second);
  ASSERT_EQ(run("rate whole.txt -o whole.csv").code, 0);
  for (const char* logs : {"clock/days", "clock/days/a.txt clock/days/b.txt"}) {
    const Outcome outcome = run(std::string("rate -o parts.csv --json parts.json ") + logs);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(content(folder_ / "parts.csv"), content(folder_ / "whole.csv")) << logs;
    EXPECT_EQ(json("parts.json")["files"],
              nlohmann::json({"clock/days/b.txt", "clock/days/a.txt"}));
  }
  EXPECT_EQ(run("report clock/days/").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "days.html"));
  EXPECT_EQ(run("rate --follow clock/days/a.txt whole.txt").code, 2);
  put("clock/days/a.txt", first);
  const Outcome copies = run("rate clock/days -o copies.csv");
  EXPECT_EQ(copies.code, 3);
  EXPECT_NE(copies.err.find("found the same times as in clock/days/"), std::string::npos)
      << copies.err;
}

TEST_F(RateCommandTest, SaysWhatItAssumedAndTakesOverrides) {
  std::string text;
  for (int i = 0; i < 20; ++i)
    text += fmt::format("{};{},5\n", 46 + i % 2, 1000 + 2 * i);
  put("b.log", text);
  const Outcome outcome =
      run("rate b.log --column time=2 --column amplitude=1:mrad --json r.json -o t.csv");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("a comma is the decimal point"), std::string::npos) << outcome.err;
  EXPECT_NEAR(json("r.json")["mean_period_s"].get<double>(), 2.0, 1e-12);
  EXPECT_NE(content(folder_ / "t.csv").find(",0.047,"), std::string::npos);
}

TEST_F(RateCommandTest, DegreesTakenForRadiansAreNotPassedOver) {
  std::string text = "time (s),amplitude\n";
  for (int i = 0; i < 20; ++i)
    text += fmt::format("{},3.02\n", 1000 + 2 * i);
  put("a.csv", text);
  EXPECT_NE(run("rate a.csv").err.find("--column amplitude=NAME:deg"), std::string::npos);
  EXPECT_EQ(run("rate a.csv --column amplitude=amplitude:deg").err.find("warning"),
            std::string::npos);
}

TEST_F(RateCommandTest, TimesWhoseDirectionNothingTellsAreSaidToBeOfOne) {
  const char* note =
      "assumed: each event is one period, and not a passage in either direction (see --both-edges)";
  const std::string rows = evenly(100, 1.0002);
  std::string labelled = "time (s),edge\n";
  for (const std::string& line : lines_of(rows))
    labelled += line + ",up\n";
  for (const auto& [text, open] : std::initializer_list<std::pair<std::string, bool>>{
           {rows, true},
           {"time (s)\n" + rows, true},
           {"time_s\n" + rows, true},
           {"# goingrate log: 1\ntime_s\n" + rows, false},
           {labelled, false},
           {"period (s)\n2.0001\n2.0002\n2.0001\n2.0002\n", false}}) {
    put("a.csv", text);
    EXPECT_EQ(run("rate a.csv").err.find(note) != std::string::npos, open) << text.substr(0, 60);
  }
}

TEST_F(RateCommandTest, TheLogIsNotReplacedByItsTable) {
  put("a.log", evenly(100, 2.0001));
  const Outcome outcome = run("rate a.log -o a.log");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("another file than the one that is read"), std::string::npos);
  EXPECT_EQ(content(folder_ / "a.log"), evenly(100, 2.0001));
}

TEST_F(RateCommandTest, GzipStandardInputAndFileGiveTheSame) {
  put("a.log", evenly(100, 2.0001));
  ASSERT_EQ(run("rate a.log -o file.csv").code, 0);
  ASSERT_EQ(run("rate - -o pipe.csv < a.log").code, 0);
  ASSERT_EQ(std::system(fmt::format("cd '{}' && gzip -k a.log", folder_.string()).c_str()), 0);
  ASSERT_EQ(run("rate a.log.gz -o gz.csv").code, 0);
  ASSERT_EQ(run("rate - -o packedpipe.csv < a.log.gz").code, 0);
  const std::string table = content(folder_ / "file.csv");
  EXPECT_EQ(lines_of(table).size(), 101u);
  for (const char* other : {"pipe.csv", "gz.csv", "packedpipe.csv"})
    EXPECT_EQ(content(folder_ / other), table) << other;
}

TEST_F(RateCommandTest, StrictMakesTheFirstFaultAnError) {
  put("a.log", evenly(5, 2.0) + "x\n" + evenly(5, 2.0, 112.0));
  EXPECT_EQ(run("rate a.log -o t.csv").code, 0);
  const Outcome strict = run("rate a.log -o s.csv --strict");
  EXPECT_EQ(strict.code, 3);
  EXPECT_NE(strict.err.find("a.log:6:1"), std::string::npos) << strict.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.csv"));
}

TEST_F(RateCommandTest, WritesFilesForOtherProgramsThatReadBackTheSame) {
  ASSERT_EQ(run("simulate " + scenario("jump") + " -o log.csv --set sensor.missed=0.01").code, 0);
  ASSERT_EQ(run("rate log.csv -o t.csv --native n.csv --phase p.txt --ticc c.txt --par s.par").code,
            0);
  for (const char* again : {"n.csv", "p.txt --tau0 2", "c.txt"}) {
    ASSERT_EQ(run(fmt::format("rate {} -o u.csv --json u.json --nominal-period 2", again)).code, 0)
        << again;
    ASSERT_EQ(run("rate log.csv -o v.csv --json v.json").code, 0);
    EXPECT_EQ(json("u.json")["crossings"], json("v.json")["crossings"]) << again;
    EXPECT_NEAR(json("u.json")["rate_excess"].get<double>(),
                json("v.json")["rate_excess"].get<double>(), 1e-13)
        << again; // a TICC writes 11 decimals of 4000 s
  }
  EXPECT_NE(content(folder_ / "s.par").find("\nPERIOD 1.99"), std::string::npos);
  EXPECT_EQ(run("rate log.csv --native - --phase -").code, 2);
}

TEST_F(RateCommandTest, BlocksRunningRatesAndSegments) {
  put("a.log", evenly(1000, 2.001) + evenly(500, 2.001, 100000.7));
  const Outcome blocks = run("rate a.log --block 500");
  ASSERT_EQ(blocks.code, 0) << blocks.err;
  const auto rows = lines_of(blocks.out);
  EXPECT_EQ(rows.front(), "segment,from_cycle,to_cycle,time_s,duration_s,rate_excess,sigma,"
                          "rate_s_per_day,amplitude_rad");
  EXPECT_GE(rows.size(), 7u);
  EXPECT_NE(blocks.err.find("  segment 1:"), std::string::npos) << blocks.err;
  const auto running = lines_of(run("rate a.log --running 50").out);
  EXPECT_NE(running.front().find(",running_rate_excess"), std::string::npos);
  EXPECT_EQ(running[10].back(), ',') << "none before fifty cycles are over";
  EXPECT_NE(running[100].find("-0.000499750"), std::string::npos) << running[100];
}

TEST_F(RateCommandTest, AGateGivesAmplitudesAndTheSensorsPlaceIsFound) {
  const std::string gate = " --set sensor.edges=gate --set sensor.flag_width=0.02"
                           " --set sensor.jitter_rms=1e-6";
  ASSERT_EQ(run("simulate " + scenario("jump") + gate + " -o gate.csv").code, 0);
  const Outcome outcome = run("rate gate.csv -o t.csv");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("amplitudes from the widths"), std::string::npos) << outcome.err;
  const auto rows = lines_of(content(folder_ / "t.csv"));
  EXPECT_NE(rows.front().find("rate_excess_at_zero_amplitude"), std::string::npos);
  EXPECT_NE(rows[100].find(",0.0390"), std::string::npos) << rows[100];
  EXPECT_NE(outcome.err.find("amplitude 51.7"), std::string::npos) << outcome.err;
  const std::string beside = " --set sensor.edges=both --set sensor.offset=0.004"
                             " --set sensor.amplitude_rms=1e-5 --set sensor.jitter_rms=1e-5";
  ASSERT_EQ(run("simulate " + scenario("jump") + beside + " -o off.csv").code, 0);
  ASSERT_EQ(run("rate off.csv -o t.csv --json r.json --sensor-offset auto").code, 0);
  EXPECT_NEAR(json("r.json")["sensor_offset_rad"]["value"].get<double>(), 0.004, 1e-5);
  EXPECT_GT(json("r.json")["beat_error_s"]["value"].get<double>(), 0.01);
  ASSERT_EQ(run("rate off.csv -o t.csv --json r.json --sensor-offset 0.004").code, 0);
  const Outcome none = run("rate gate.csv -o t.csv --flag-width 0.02 --sensor-offset auto");
  EXPECT_EQ(none.code, 0) << none.err; // a centred gate: an offset of nothing
}

TEST_F(RateCommandTest, WithoutANominalPeriodNoGainIsClaimed) {
  put("a.log", evenly(100, 1.6234));
  const Outcome outcome = run("rate a.log -o t.csv --json r.json");
  EXPECT_NE(outcome.err.find("what it gains or loses is not known"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(json("r.json")["nominal_period_known"], false);
}

TEST_F(RateCommandTest, FollowPrintsBeatsAsTheyComeAndRaisesTheAlarm) {
  // A clock of four beats per second that stops for two seconds, seen through a pipe.
  put("feed.sh", "t=0\nwhile [ $t -lt 40 ]; do\n  echo \"$((100 + t / 4)).$((t % 4 * 25))\" | "
                 "sed 's/\\.0$/.00/'\n  t=$((t + 1))\n  [ $t -eq 20 ] && sleep 1.5 && t=28\n"
                 "  sleep 0.02\ndone\n");
  const Outcome outcome = run("rate - --follow --alarm 1", "bash feed.sh |");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("alarm: no beat for "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("the clock goes again"), std::string::npos) << outcome.err;
  const auto rows = lines_of(outcome.out);
  EXPECT_EQ(rows.front(), "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags");
  EXPECT_EQ(rows[1].substr(0, 14), "0,100.00000000");
  EXPECT_EQ(rows.back().substr(0, 3), "39,") << rows.back();
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(),
                          [](const std::string& row) { return row.ends_with(",missed"); }),
            8);
}

TEST_F(RateCommandTest, FollowWaitsForAFileToGrow) {
  put("a.log", evenly(20, 2.0));
  const std::string command =
      fmt::format("cd '{}' && exec '{}' rate a.log --follow > rows.csv 2> notes.txt",
                  folder_.string(), GOINGRATE_COMMAND);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/bash", "bash", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  const auto rows_within = [&](std::size_t count) { // of ten seconds
    for (int tenths = 0; tenths < 100; ++tenths) {
      if (lines_of(content(folder_ / "rows.csv")).size() >= count) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  };
  EXPECT_TRUE(rows_within(21));
  std::ofstream(folder_ / "a.log", std::ios::app) << "140.0";
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  std::ofstream(folder_ / "a.log", std::ios::app) << "01\n142.001\n"; // a line written in two parts
  EXPECT_TRUE(rows_within(23));
  ::kill(child, SIGTERM);
  ::waitpid(child, nullptr, 0);
  const auto rows = lines_of(content(folder_ / "rows.csv"));
  ASSERT_EQ(rows.size(), 23u);
  EXPECT_EQ(rows[21].substr(0, 17), "20,140.001000000,");
}

} // namespace
} // namespace goingrate::test
