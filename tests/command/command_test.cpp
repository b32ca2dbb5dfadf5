// The command as a script sees it: what its subcommands write and say.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <regex>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

TEST_F(CommandTest, RateCountsAndItsJsonHasTheKeysScriptsRelyOn) {
  run("simulate " + scenario("jump") +
      " -o log.csv --set sensor.missed=0.05 --set sensor.spurious=0.05");
  const Outcome outcome = run("rate log.csv --json rate.json");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.substr(0, outcome.out.find('\n')),
            "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags");
  const auto result = json("rate.json");
  for (const char* key : {"schema", "crossings", "periods", "missed", "spurious", "rivals", "gaps",
                          "longest_countable_gap", "mean_period_s", "rate_excess", "rate_s_per_day",
                          "rate_sigma_s_per_day", "last_period_s", "duration_s"})
    EXPECT_TRUE(result.contains(key)) << key;
  // The ends of the log may be among the missed.
  EXPECT_NEAR(result["periods"].get<int>(), 2000, 6);
  EXPECT_EQ(result["crossings"].get<int>() + result["missed"].get<int>(),
            result["periods"].get<int>() + 1);
  EXPECT_NEAR(result["spurious"].get<int>(), 100, 40);
  EXPECT_EQ(result["gaps"][0]["kind"], "missed");
  EXPECT_NE(run("rate log.csv --gap-probability 0.3").code, 0) << "less likely than not";
  EXPECT_EQ(run("rate log.csv --gap-probability 0.9").code, 0);
}

TEST_F(CommandTest, TheRateIsHeldAgainstTheAmplitude) {
  const std::string log = (source / "data/logs/interruption.csv").string();
  const std::string known = " --fix T0=3 --fix epsilon=7.5e-5 --fix mu=1.2e-5 --fix phi0=0.025";
  ASSERT_EQ(run("spectrum " + log + known + " --against amplitude --coherence c.csv").code, 0);
  EXPECT_EQ(content(folder_ / "c.csv").substr(0, 30), "frequency_hz,coherence,gain,ph");
  EXPECT_EQ(run("spectrum " + log + known + " --against pressure --coherence c.csv").code, 2);
}

TEST_F(CommandTest, AReportsFiguresAndTablesAreWritten) {
  run("simulate " + scenario("jump") + " -o log.csv");
  ASSERT_EQ(run("report log.csv -o r.html --figures f --tables t").code, 0);
  for (const char* name : {"f/rate.svg", "f/rate.csv", "f/spectrum.svg", "t/rates.csv",
                           "t/parameters.csv", "t/parameters.tex", "t/spectrum.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
  const std::string rates = content(folder_ / "f/rate.csv");
  const std::string head = "series,\"time since the first beat (s)\",\"rate (s/day)\","
                           "\"low (s/day)\",\"high (s/day)\"";
  EXPECT_EQ(rates.substr(0, rates.find('\n')), head);
}

TEST_F(CommandTest, LinesAreNamedByTheTrain) {
  put("wheel.toml", "[clock]\nepsilon = 2.5e-4\nmu = 4e-5\nphi0 = 0.03\n[run]\nperiods = 20000\n"
                    "[drive]\nfast_rms = 0.1\nsine = [{amplitude = 0.05, period = 480.0}]\n"
                    "[sensor]\njitter_rms = 1e-6\n");
  ASSERT_EQ(run("simulate wheel.toml -o wheel.csv").code, 0);
  const Outcome found = run("spectrum wheel.csv --fix T0=2 --fix epsilon=2.5e-4 --fix mu=4e-5 "
                            "--fix phi0=0.03 --train 60,8,64,8,30 --fold 480 --fold-output f.csv "
                            "--tapers 8 -o s.csv --gapped g.csv --json s.json");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_NE(found.out.find("arbor 2"), std::string::npos) << found.out;
  EXPECT_NEAR(json("s.json")["lines"][0]["period_s"].get<double>(), 480.0, 2.0); // 5.8 s resolution
  EXPECT_EQ(content(folder_ / "f.csv").substr(0, 16), "phase,rate,sigma");
  EXPECT_EQ(content(folder_ / "s.csv").substr(0, 34), "frequency_hz,density_per_hz,low,hi");
  EXPECT_EQ(content(folder_ / "g.csv").substr(0, 25), "frequency_hz,power,window");
  EXPECT_EQ(run("spectrum wheel.csv --fix T0=2 --train 60,8").code, 2);
}

TEST_F(CommandTest, ThePapersFiguresAreWritten) {
  const Outcome outcome = run("paper --periods 10000 -o p --figure jump --json p.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("| gain at C without variability |"), std::string::npos);
  for (const char* name : {"jump_zoom.svg", "jump_rate.svg", "jump_amplitude.csv", "paper.md"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "p" / name)) << name;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "p" / "rate.svg"));
  EXPECT_EQ(json("p.json")["budget"].size(), 11u);
  EXPECT_EQ(run("paper --periods 10000 -o q --figure nothing").code, 2);
}

TEST_F(CommandTest, AReaderThatLeavesIsNotComplainedOf) {
  ASSERT_EQ(run("simulate " + scenario("jump") + " --set run.periods=20000 -o log.csv").code, 0);
  const Outcome left = run("rate log.csv --quiet | head -1");
  EXPECT_EQ(left.code, 0); // of head
  EXPECT_EQ(left.err, "");
}

TEST_F(CommandTest, StandardInputAndOutputArePipes) {
  run("simulate " + scenario("jump") + " -o log.csv");
  const Outcome outcome = run("rate - --quiet --json - < log.csv");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["crossings"], 2001) << "and nothing else is there";
  EXPECT_EQ(outcome.err, "");
}

TEST_F(CommandTest, SpectrumSplitsTheDriveOfAKnownClock) {
  run("simulate " + scenario("noisy-drive") + " -o log.csv --set run.periods=20000");
  const Outcome outcome =
      run("spectrum log.csv --fix T0=2 --fix epsilon=1.167245e-4 --fix mu=1.5e-5 "
          "--fix phi0=0.03 --json s.json -o s.csv");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto result = json("s.json");
  EXPECT_NEAR(result["corner_hz"].get<double>(), 1.167245e-4, 1e-12); // 2 epsilon / T0
  EXPECT_NEAR(result["fast"]["rms"].get<double>(), 0.3, 0.01);
  EXPECT_TRUE(fs::exists(folder_ / "s.csv"));
}

TEST_F(CommandTest, StabilityReproducesTheNistSet) {
  std::string frequency;
  std::int64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    frequency += fmt::format("{:.17g}\n", static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  put("nist.txt", frequency);
  const Outcome outcome = run(
      "stability nist.txt --data frequency --tau0 1 --taus 1,10,100 --kind oadev --json s.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto rows = json("s.json")["rows"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(fmt::format("{:.6e}", rows[0]["value"].get<double>()), "2.922319e-01");
  EXPECT_EQ(fmt::format("{:.6e}", rows[1]["value"].get<double>()), "9.159953e-02");
  EXPECT_EQ(fmt::format("{:.6e}", rows[2]["value"].get<double>()), "3.241343e-02");
}

TEST_F(CommandTest, StabilityHasEveryKindAndSaysWhatItMeans) {
  std::string phases;
  double walk = 0.0;
  std::int64_t n = 1234567890;
  for (int i = 0; i < 300; ++i) {
    phases += fmt::format("{:.17g}\n", walk + 1.0);
    n = 16807 * n % 2147483647;
    walk += static_cast<double>(n) / 2147483647.0 - 0.5;
  }
  put("phase.txt", phases);
  for (const char* kind : {"adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev", "mtotdev",
                           "ttotdev", "htotdev", "theo1", "theoh", "mtie", "tierms", "pdev"}) {
    const Outcome outcome = run(fmt::format(
        "stability phase.txt --data phase --tau0 10 --kind {} --json s.json -o table.txt", kind));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(json("s.json")["kind"], kind);
    EXPECT_GE(json("s.json")["rows"].size(), 4u) << kind;
  }
  const Outcome words = run("stability phase.txt --data phase --tau0 10 --alpha 0");
  EXPECT_NE(words.out.find("of the relative rate"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("averaging helps as 1/√τ"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("Expected time error a day"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("extrapolated from"), std::string::npos) << words.out;
  const auto value = [&](const char* options) {
    run(std::string("stability phase.txt --data phase --tau0 10 --kind mtotdev --taus 40 --json "
                    "s.json --alpha 0 ") +
        options);
    return json("s.json")["rows"][0]["value"].get<double>();
  };
  EXPECT_NEAR(value("--no-bias") / value(""), std::sqrt(0.73), 1e-12); // SP 1065's ratio; roundings
  const Outcome jump = run("stability " + (source / "data/logs/jump.csv").string());
  EXPECT_EQ(jump.out.find("the rate is random"), std::string::npos) << jump.out;
  EXPECT_NE(jump.out.find("A step or a trend"), std::string::npos) << jump.out;
  EXPECT_EQ(run("stability phase.txt --data phase --kind nonsense").code, 2);
  EXPECT_EQ(run("stability phase.txt --data phase --alpha 3").code, 2);
}

TEST_F(CommandTest, ReportWritesAPageAndSpeaksInWords) {
  run("simulate " + scenario("interruption") + " -o log.csv");
  const Outcome outcome = run("report log.csv -o page.html --json report.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("the drive was interrupted"), std::string::npos) << outcome.out;
  EXPECT_LE(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 40);
  const std::string page = content(folder_ / "page.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(json("report.json")["diary"]["interruptions"].size(), 1u);
}

// A native log with all times after `from_s` later by `late_s`, as after a knock at the sensor.
std::string knocked(const std::string& log, double from_s, double late_s) {
  std::istringstream lines(log);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.find(',');
    const bool is_row = line.front() >= '0' && line.front() <= '9';
    const double time = is_row ? std::stod(line) : 0.0;
    text +=
        time > from_s ? fmt::format("{:.8f}{}\n", time + late_s, line.substr(comma)) : line + "\n";
  }
  return text;
}

TEST_F(CommandTest, AKnockWhileTheDriveWasOffIsNotSuspectedAgain) {
  // The drive is off from 1800 s to 2160 s; residuals are levelled until as long again after it.
  ASSERT_EQ(run("simulate " + scenario("interruption") +
                " -o log.csv --set drive.fast_rms=0.003 --set sensor.missed=0 --set "
                "sensor.spurious=0 --set run.periods=2600")
                .code,
            0);
  const std::string log = content(folder_ / "log.csv");
  const auto suspicions = [&](double knock_s) {
    put("knocked.csv", knocked(log, knock_s, 4e-4));
    const Outcome outcome = run("report knocked.csv -o page.html --noise jitter --fix T0=3 "
                                "--fix phi0=0.025 --fix epsilon=7.5e-5");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("the drive was interrupted"), std::string::npos) << outcome.out;
    return outcome.out;
  };
  const std::string within = suspicions(1980.0), later = suspicions(6000.0);
  EXPECT_EQ(within.find("most likely the sensor was moved"), std::string::npos) << within;
  EXPECT_NE(later.find("most likely the sensor was moved"), std::string::npos) << later;
}

// What a command writes to a terminal that is its standard error.
class Terminal {
public:
  Terminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) return;
    name_ = ::ptsname(master_);
    slave_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY); // what is written stays while it is open
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    ::close(slave_);
    ::close(master_);
  }
  [[nodiscard]] bool is_there() const { return slave_ >= 0; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string text() const {
    std::string all(65536, '\0');
    const ssize_t size = ::read(master_, all.data(), all.size());
    all.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return all;
  }

private:
  int master_, slave_ = -1;
  std::string name_;
};

TEST_F(CommandTest, OnATerminalItSaysWhatItIsDoingAndWipesThat) {
  const Terminal terminal;
  if (!terminal.is_there()) GTEST_SKIP() << "no terminal is available here";
  const std::string fit = (source / "data/logs/interruption.csv").string() +
                          " --noise both --fix T0=3 --fix phi0=0.025";
  const auto line = [&](const std::string& options) {
    return fmt::format("cd '{}' && exec '{}' fit {} {} > out.txt 2> {}", folder_.string(),
                       GOINGRATE_COMMAND, fit, options, terminal.name());
  };
  // Stopped while it fits, for longer than a terminal waits in silence: however fast the machine
  // is, this fit takes its time.
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", line("").c_str(), nullptr);
    ::_exit(127);
  }
  std::string loud;
  while (loud.find("nominal period") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    loud += terminal.text();
    ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "over before it fitted: " << loud;
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100)); // from the last note to the fit
  ::kill(child, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  ::kill(child, SIGCONT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  loud += terminal.text();
  const std::regex line_of_fit("fitting [a-z ]+(, step [1-5] of 5: [a-z ]+)? \\.\\.\\. 1 s");
  EXPECT_TRUE(std::regex_search(loud, line_of_fit)) << loud;
  const std::size_t wiped = loud.rfind("\r\x1b[K"); // before what was found is told
  ASSERT_NE(wiped, std::string::npos) << loud;
  EXPECT_GT(wiped, loud.rfind("fitting "));
  EXPECT_NE(loud.find("change found", wiped), std::string::npos) << loud;
  std::istringstream notes(loud);
  for (std::string note; std::getline(notes, note, '\n');) {
    if (note.find("\x1b") != std::string::npos) continue;
    EXPECT_LE(note.size(), 81u) << note; // with its \r
  }
  EXPECT_EQ(std::system(line("--quiet").c_str()), 0);
  EXPECT_EQ(terminal.text(), "");
  EXPECT_EQ(run("fit " + fit).err.find("fitting the model"), std::string::npos) << "in a file";
}

TEST_F(CommandTest, TheReportSaysHowToTurnTheRatingNut) {
  std::string log; // 10 s a day slow: 2 x 0.99396 m x 10/86400 is 0.3068 turns of 0.75 mm
  for (int i = 0; i < 500; ++i)
    log += fmt::format("{:.9f}\n", 2.0 * i / (1.0 - 10.0 / 86400.0) + 1e-6 * (i * 7 % 5));
  put("slow.log", log);
  const Outcome slow =
      run("report slow.log --nominal-period 2 --nut-pitch 0.75 -o r.html --json r.json");
  ASSERT_EQ(slow.code, 0) << slow.err;
  EXPECT_NE(slow.out.find("Raise the bob by 0.306"), std::string::npos) << slow.out;
  EXPECT_NE(content(folder_ / "r.html").find("Raise the bob by 0.306"), std::string::npos);
  EXPECT_NEAR(json("r.json")["rating_nut"]["turns_up"].get<double>(), 0.3068, 2e-4);
  const Outcome fast = run("report slow.log --nominal-period 2.001 --nut-pitch 0.75 -o r.html");
  EXPECT_NE(fast.out.find("Lower the bob"), std::string::npos) << fast.out;
  const Outcome shorter = run(
      "report slow.log --nominal-period 2 --nut-pitch 0.75 --pendulum-length 0.49698 -o r.html");
  EXPECT_NE(shorter.out.find("Raise the bob by 0.153"), std::string::npos) << shorter.out;
  EXPECT_EQ(run("report slow.log --nut-pitch 0 -o r.html").code, 2);
  EXPECT_EQ(run("report slow.log --pendulum-length 1 -o r.html").code, 2) << "without a pitch";
}

TEST_F(CommandTest, LatinOneInABadLineSpoilsNoJson) {
  put("l.csv", "0.0\n2.0\nbeat \xe9t\xe9\n4.0\n6.0\n");
  EXPECT_EQ(run("rate l.csv --json l.json").code, 0);
  EXPECT_EQ(json("l.json")["issues"].size(), 1u);
}

TEST_F(CommandTest, TheShortestLogsGetAReport) {
  for (int n = 3; n <= 12; ++n) {
    std::string log;
    for (int i = 0; i < n; ++i)
      log += fmt::format("{:.6f}\n", 2.0 * i + (i % 3) * 1e-5);
    put("short.log", log);
    const Outcome outcome = run("report short.log -o page.html --json r.json");
    EXPECT_EQ(outcome.code, 0) << n << outcome.err;
  }
}

TEST_F(CommandTest, DemoHandsItsArgumentsToReportAndNotToTheInstaller) {
  // The set-up with stand-ins for Debian's tools that say what they are asked.
  put("dpkg-query", "#!/bin/sh\nfor p; do :; done\necho \"$p\" >> asked.txt\necho installed\n");
  put("apt-get", "#!/bin/sh\necho called >> apt.txt\n");
  put("try.sh",
      fmt::format("set -- my.log --nominal-period 2\n. '{}/apps/setup.sh'\ngoingrate_setup extra\n",
                  source.string()));
  const std::string line =
      fmt::format("cd '{0}' && chmod +x dpkg-query apt-get && PATH={0}:$PATH bash try.sh "
                  "> said.txt 2>&1",
                  folder_.string());
  EXPECT_EQ(std::system(line.c_str()), 0);
  EXPECT_EQ(content(folder_ / "asked.txt").find("my.log"), std::string::npos);
  EXPECT_NE(content(folder_ / "asked.txt").find("extra"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "apt.txt"));
  EXPECT_EQ(content(folder_ / "said.txt"), "") << "silent if all is there";
}

TEST_F(CommandTest, ChartHasTheKeysScriptsRelyOn) {
  ASSERT_EQ(run("chart --periods 200 --repetitions 1 --json chart.json --plot chart.svg").code, 0);
  const auto chart = json("chart.json");
  EXPECT_EQ(chart["schema"], "goingrate.chart");
  bool rk4 = false;
  for (const auto& row : chart["rows"]) {
    for (const char* key : {"method", "setting", "ns_per_period", "max_error", "scenario"})
      EXPECT_TRUE(row.contains(key)) << key;
    rk4 = rk4 || (row["method"] == "rk4" && row["setting"] == "dt=0.03");
  }
  EXPECT_TRUE(rk4);
  EXPECT_EQ(content(folder_ / "chart.svg").substr(0, 4), "<svg");
}

TEST_F(CommandTest, MapSolvesForAnOperatingPoint) {
  ASSERT_EQ(run("map --solve epsilon=2.5e-4 mu=2e-5 --json point.json").code, 0);
  const auto points = json("point.json")["points"];
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0]["rate_excess"].get<double>(), 1.133264436573979e-04, 1e-15); // point A
  EXPECT_EQ(run("map --solve epsilon=2.5e-4 nonsense=1").code, 2);
  EXPECT_EQ(run("map --solve epsilon=2.5e-4 mu=1e-6").code, 4); // it would stall
  ASSERT_EQ(run("map --points 3 --first-order").code, 0);
  ASSERT_EQ(run("map --solve epsilon=1e-3 mu=1e-3 --plot p.svg").code, 0);
  EXPECT_NE(content(folder_ / "p.svg").find("operating point"), std::string::npos);
}

TEST_F(CommandTest, MapWritesNumbersAsPeopleDo) {
  const std::string nominal = run("map --solve amplitude=0.05 rate=0").out;
  EXPECT_NE(nominal.find(" 0              0\n"), std::string::npos) << nominal;
  const std::string table = run("map --points 2").out;
  EXPECT_NE(table.find("\n1e-05,1e-06,"), std::string::npos) << table;
}

} // namespace
