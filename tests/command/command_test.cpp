// The command as a script sees it: exit codes, messages, files.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

TEST_F(CommandTest, SimulateWritesALogAndTheTruth) {
  ASSERT_EQ(run("simulate " + scenario("jump") + " -o log.csv --truth truth.csv --seed 3").code, 0);
  const std::string truth = content(folder_ / "truth.csv");
  EXPECT_EQ(truth.substr(0, truth.find('\n')), "cycle,time_s,period_s,velocity,amplitude_rad,mu");
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 2001);
  const std::string log = content(folder_ / "log.csv");
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 2001 + 3);
  EXPECT_EQ(run("simulate " + scenario("jump") + " --seed 3").out, log)
      << "standard output is the default";
  EXPECT_NE(run("simulate " + scenario("jump") + " --seed 4").out, log);
}

TEST_F(CommandTest, SimulateReachesTheExactStationaryRates) {
  struct Point {
    const char *epsilon, *mu;
    double rate;
  };
  for (const Point& p : {Point{"2.5e-4", "2e-5", 1.133264436573979e-04},
                         Point{"2.5e-4", "4e-5", 1.960046634308295e-04},
                         Point{"1.167245e-4", "1.5e-5", 1.844068077230375e-08}}) {
    put("s.toml",
        fmt::format("[clock]\nnominal_period=6.283185307179586\nepsilon={}\nmu={}\nphi0=0.03\n"
                    "[run]\nperiods=100\n",
                    p.epsilon, p.mu));
    ASSERT_EQ(run("simulate s.toml -o log.csv --truth truth.csv").code, 0);
    const std::string truth = content(folder_ / "truth.csv");
    const std::size_t row = truth.rfind('\n', truth.size() - 2) + 1;
    const std::size_t comma = truth.find(',', truth.find(',', row) + 1);
    const double period = std::stod(truth.substr(comma + 1));
    EXPECT_NEAR(6.283185307179586477 / period - 1, p.rate, 1e-12);
  }
}

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
  EXPECT_EQ(content(folder_ / "f/rate.csv").substr(0, 19), "series,x,y,low,high");
}

TEST_F(CommandTest, HelpExplainsItsTopics) {
  const Outcome list = run("help");
  ASSERT_EQ(list.code, 0);
  for (const char* topic : {"formats", "scenario", "noise", "identifiability"}) {
    EXPECT_NE(list.out.find(topic), std::string::npos);
    EXPECT_GT(run(std::string("help ") + topic).out.size(), 500u) << topic;
  }
  EXPECT_EQ(run("help clocks").code, 2);
}

// What the reader of scenarios expects in a section, from its complaint about a key it does not
// know.
std::vector<std::string> keys_it_names(const std::string& complaint) {
  std::vector<std::string> keys;
  const std::string begin = "expected one of ";
  const std::size_t at = complaint.find(begin);
  if (at == std::string::npos) return keys;
  std::istringstream list(complaint.substr(at + begin.size()));
  for (std::string key; std::getline(list, key, ',');) {
    key.erase(0, key.find_first_not_of(' '));
    keys.push_back(key.substr(0, key.find_first_of(" \n")));
  }
  return keys;
}

TEST_F(CommandTest, HelpNamesEveryKeyOfAScenario) {
  const std::string help = run("help scenario").out;
  put("s.toml", "[zzzzz]\n");
  const std::vector<std::string> sections = keys_it_names(run("simulate s.toml").err);
  EXPECT_GE(sections.size(), 8u);
  for (const std::string& section : sections) {
    const std::size_t at = help.find("[" + section + "]");
    ASSERT_NE(at, std::string::npos) << section;
    const std::size_t end = std::min(help.find("\n[", at), help.find("\n--set", at));
    const std::string part = help.substr(at, end - at);
    put("s.toml", (section == "event" ? "[[event]]" : "[" + section + "]") + "\nzzzzz = 1\n");
    const std::vector<std::string> keys = keys_it_names(run("simulate s.toml").err);
    EXPECT_FALSE(keys.empty()) << section;
    for (const std::string& key : keys)
      EXPECT_NE(part.find(key), std::string::npos) << section << ": " << key << '\n' << part;
  }
}

TEST_F(CommandTest, HelpOnFormatsNamesEveryOptionThatReads) {
  const std::string help = run("help formats").out, options = run("rate --help").out;
  const std::size_t group = options.find("How the log is read");
  ASSERT_NE(group, std::string::npos);
  std::istringstream lines(options.substr(group, options.find("\n\n", group) - group));
  std::vector<std::string> names{"--flag-width", "--sensor-offset", "--both-edges",
                                 "--nominal-period"};
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  --")) names.push_back(line.substr(2, line.find(' ', 2) - 2));
  EXPECT_GE(names.size(), 12u);
  for (const std::string& name : names)
    EXPECT_NE(help.find(name), std::string::npos) << name;
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
  EXPECT_EQ(json("p.json")["budget"].size(), 8u);
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

TEST_F(CommandTest, FitPrintsAndItsJsonHasTheKeysScriptsRelyOn) {
  run("simulate " + scenario("jump") + " -o log.csv");
  const Outcome outcome = run("fit log.csv --fix T0=2 --event 150:mu --json fit.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("[parameters]"), std::string::npos);
  const auto fit = json("fit.json");
  for (const char* key : {"model", "parameters", "combinations", "correlation", "derived",
                          "quality", "alternatives", "termination"})
    EXPECT_TRUE(fit.contains(key)) << key;
  for (const char* key : {"dynamics", "escapement", "friction", "noise", "chosen_by"})
    EXPECT_TRUE(fit["model"].contains(key)) << key;
  for (const char* key : {"chi2", "dof", "p_value", "whiteness_p", "rms_s", "aic", "bic"})
    EXPECT_TRUE(fit["quality"][key].is_number()) << key;
  for (const char* key : {"Q", "stationary_amplitude", "rate_s_per_day", "decay_time_s"})
    EXPECT_TRUE(fit["derived"][key]["sigma"].is_number()) << key;
  EXPECT_EQ(fit["parameters"][0]["status"], "fixed");
  EXPECT_EQ(fit["parameters"][5]["name"], "mu@1");
  EXPECT_NEAR(fit["parameters"][5]["value"].get<double>(), 4e-5, 1e-7);
}

TEST_F(CommandTest, FitFindsTheEventByItselfOrByTime) {
  run("simulate " + scenario("jump") + " -o log.csv");
  for (const char* event : {"auto", "300s:mu"}) {
    const Outcome outcome =
        run(fmt::format("fit log.csv --fix T0=2 --event {} --json fit.json", event));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NEAR(json("fit.json")["parameters"][5]["value"].get<double>(), 4e-5, 1e-6) << event;
  }
}

double value_of(const nlohmann::json& fit, const std::string& name) {
  for (const auto& parameter : fit["parameters"])
    if (parameter["name"] == name)
      return parameter["value"].is_null() ? NAN : parameter["value"].get<double>();
  ADD_FAILURE() << "no parameter " << name;
  return NAN;
}

TEST_F(CommandTest, FitTakesTheModelItIsTold) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=600");
  const std::string fit = "fit log.csv --fix T0=2 --event 150:mu --json fit.json ";
  for (const auto& [noise, found] : std::initializer_list<std::pair<const char*, const char*>>{
           {"jitter", "jitter"},
           {"drive", "drive"},
           {"both", "jitter + drive"},
           {"slow", "jitter + drive + slow drive"}}) {
    ASSERT_EQ(run(fit + "--noise " + noise).code, 0) << noise;
    EXPECT_EQ(json("fit.json")["model"]["noise"], found);
  }
  ASSERT_EQ(run(fit + "--free quadratic_drag,drift --free dry_friction").code, 0);
  for (const char* name : {"quadratic_drag", "drift", "dry_friction"})
    value_of(json("fit.json"), name);
  ASSERT_EQ(run("fit log.csv --json fit.json --escapement single-impulse --event none").code, 0);
  EXPECT_EQ(json("fit.json")["model"]["escapement"], "single-impulse");
  for (const char* wrong : {"--noise pink", "--escapement profile", "--free lambda", "--free mu@2",
                            "--free temperature", "--free T0", "--from log.csv --from log.csv"})
    EXPECT_EQ(run(fit + wrong).code, 2) << wrong;
}

TEST_F(CommandTest, TheRateFollowsTemperatureOrPressureWhereTheLogHasThem) {
  // The length grows by 1.2e-5 per K, so the rate falls by half of it. Spurious and missed beats
  // show whether each beat has the temperature of its own row.
  const std::string warm = "--set run.periods=1000 --set length.temperature_coefficient=1.2e-5 "
                           "--set \"temperature.sine=[{amplitude=0.2,period=1000.0}]\" "
                           "--set sensor.temperature_rms=0.001 ";
  ASSERT_EQ(run("simulate " + scenario("jump") + " -o t.csv " + warm +
                "--set sensor.missed=0.05 --set sensor.spurious=0.05")
                .code,
            0);
  std::string log = content(folder_ / "t.csv");
  log.replace(log.find("temperature_c"), 13, "pressure_mbar");
  put("p.csv", log);
  for (const auto& [file, name] : std::initializer_list<std::pair<const char*, const char*>>{
           {"t.csv", "temperature"}, {"p.csv", "pressure"}})
    for (const char* command : {"fit", "report -o page.html"}) {
      const Outcome outcome = run(fmt::format("{} {} --fix T0=2 --event 150:mu --free {} "
                                              "--json fit.json",
                                              command, file, name));
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const auto result = json("fit.json");
      const auto& fit = result.contains("fit") ? result["fit"] : result;
      EXPECT_NEAR(value_of(fit, name), -6e-6, 1.2e-7) << command; // four sigma
    }
}

TEST_F(CommandTest, AFitComesBackFromItsFileAndOptionsWin) {
  run("simulate " + scenario("jump") + " -o log.csv");
  ASSERT_EQ(run("fit log.csv --fix T0=2 --event 150:mu --par a.par --json a.json").code, 0);
  const Outcome again = run("fit log.csv --from a.par --json b.json --par b.par");
  ASSERT_EQ(again.code, 0) << again.err;
  for (const char* name : {"T0", "epsilon", "mu", "phi0", "lambda0", "mu@1", "jitter_rms"})
    EXPECT_NEAR(value_of(json("b.json"), name) / value_of(json("a.json"), name), 1.0, 1e-9) << name;
  EXPECT_EQ(json("b.json")["model"]["dynamics"], json("a.json")["model"]["dynamics"]);
  ASSERT_EQ(run("fit log.csv --from a.par --prior T0=2+-1e-9 --model averaged1 --json b.json").code,
            0);
  EXPECT_EQ(json("b.json")["parameters"][0]["status"], "prior") << "was held by the file";
  EXPECT_EQ(json("b.json")["model"]["dynamics"], "averaged1");
  ASSERT_EQ(run("fit log.csv --from a.par --fix epsilon=2.5e-4 --free T0 --event 150:mu,T0 "
                "--json b.json")
                .code,
            0);
  EXPECT_EQ(value_of(json("b.json"), "epsilon"), 2.5e-4);
  EXPECT_EQ(json("b.json")["parameters"][0]["status"], "free");
  EXPECT_NEAR(value_of(json("b.json"), "T0@1"), 2.0, 1e-5);
  EXPECT_EQ(run("spectrum log.csv --from a.par").code, 0);
  EXPECT_EQ(run("report log.csv --from a.par -o page.html").code, 0);
  EXPECT_EQ(run("fit log.csv --from a.par --free epsilon --fix epsilon=1e-4").code, 2);
  EXPECT_EQ(run("fit - --from - < log.csv").code, 2);
}

TEST_F(CommandTest, TheEventsOfAFileAreAtTheCyclesOfTheRateTable) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=1500");
  std::string log;
  for (int i = 0; i < 40; ++i) // of another clock, before this one was set going
    log += fmt::format("{:.6f}\n", 2.0 * i);
  const std::string table = run("rate log.csv").out;
  for (std::size_t row = table.find('\n') + 1; row < table.size(); row = table.find('\n', row) + 1)
    log += fmt::format("{:.7f}\n", 5000.9 + std::stod(table.substr(table.find(',', row) + 1)));
  put("late.log", log);
  const std::string rates = run("rate late.log").out;
  const std::size_t split = rates.find(",split");
  ASSERT_NE(split, std::string::npos) << "the log must begin with a part that is not used";
  const int cycle = 150 + std::stoi(rates.substr(rates.rfind('\n', split) + 1));
  ASSERT_GT(cycle, 1000);
  ASSERT_EQ(run(fmt::format("fit late.log --fix T0=2 --event {}:mu --par a.par", cycle)).code, 0);
  EXPECT_NE(content(folder_ / "a.par").find(fmt::format("EVENT {} mu\n", cycle)),
            std::string::npos);
  ASSERT_EQ(run("fit late.log --from a.par --json fit.json").code, 0);
  EXPECT_NEAR(value_of(json("fit.json"), "mu@1"), 4e-5, 1e-7);
}

TEST_F(CommandTest, AFileOfParametersThatIsUnusableIsExitThree) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=200");
  for (const auto& [text, place] : std::initializer_list<std::pair<const char*, const char*>>{
           {"epsilom 1e-4 1", "bad.par:2:1: found 'epsilom'"},
           {"EVENT 99999 mu", "bad.par:2:7: found cycle 99999, expected one inside the log"},
           {"temperature 0 1", "bad.par:2:1: found 'temperature', expected a log with a column"},
           {"pressure 0 0", "bad.par:2:1: found 'pressure', expected a log with a column"}}) {
    put("bad.par", std::string("# goingrate par 1\n") + text + "\n");
    const Outcome outcome = run("fit log.csv --from bad.par --json out.json");
    EXPECT_EQ(outcome.code, 3) << text;
    EXPECT_NE(outcome.err.find(place), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.json"));
  }
  EXPECT_EQ(run("fit log.csv --from log.csv").code, 3);
  EXPECT_EQ(run("fit log.csv --from absent.par").code, 3);
}

TEST_F(CommandTest, TheTablesOfAFitAreWrittenAllOrNone) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=300");
  const std::string fit = "fit log.csv --fix T0=2 --event 150:mu ";
  const Outcome outcome = run(fit + "--latex a.tex --csv - --par a.par --json a.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.substr(0, outcome.out.find('\n')),
            "name,value,sigma,low68,high68,low95,high95,unit,status");
  EXPECT_EQ(outcome.out.find("[parameters]"), std::string::npos) << "one result on one stream";
  EXPECT_NE(content(folder_ / "a.tex").find("\\end{tabular}"), std::string::npos);
  put("a.par", "precious");
  EXPECT_EQ(run(fit + "--par a.par --csv no/such/a.csv").code, 5);
  EXPECT_EQ(content(folder_ / "a.par"), "precious");
  EXPECT_EQ(run(fit + "--par - --latex -").code, 2) << "two results on one stream";
}

TEST_F(CommandTest, AnUndeterminedParameterIsAWordAndNull) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=140");
  const Outcome outcome = run("fit log.csv --json fit.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("ε (epsilon)    undetermined"), std::string::npos);
  EXPECT_EQ(json("fit.json")["parameters"][1]["status"], "undetermined");
  EXPECT_TRUE(json("fit.json")["parameters"][1]["value"].is_null());
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
                "sensor.spurious=0 --set run.periods=4000")
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
  const std::string within = suspicions(1980.0), later = suspicions(7000.0);
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
  if (!terminal.is_there()) GTEST_SKIP() << "no terminal to be had here";
  const std::string fit = (source / "data/logs/interruption.csv").string() +
                          " --noise both --fix T0=3 --fix phi0=0.025"; // some seconds
  const auto shown = [&](const std::string& options) {
    const std::string line =
        fmt::format("cd '{}' && '{}' fit {} {} > out.txt 2> {}", folder_.string(),
                    GOINGRATE_COMMAND, fit, options, terminal.name());
    EXPECT_EQ(std::system(line.c_str()), 0);
    return terminal.text();
  };
  const std::string loud = shown("");
  EXPECT_NE(loud.find("fitting the model ... 1 s"), std::string::npos) << loud;
  const std::size_t wiped = loud.rfind("\r\x1b[K"); // before what was found is told
  ASSERT_NE(wiped, std::string::npos) << loud;
  EXPECT_GT(wiped, loud.rfind("fitting the model"));
  EXPECT_NE(loud.find("found a change", wiped), std::string::npos) << loud;
  std::istringstream notes(loud);
  for (std::string note; std::getline(notes, note, '\n');) {
    if (note.find("\x1b") != std::string::npos) continue;
    EXPECT_LE(note.size(), 81u) << note; // with its \r
  }
  EXPECT_EQ(shown("--quiet"), "");
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

TEST_F(CommandTest, UnusableInputIsExitThreeWithFileLineAndColumn) {
  put("empty.log", "");
  put("one.log", "12.5\n");
  put("binary.log", std::string("\x00\x01\x02", 3));
  put("words.log", "once upon a time\n");
  for (const char* command : {"rate", "fit", "spectrum", "stability", "report"}) {
    for (const auto& [file, place] : std::initializer_list<std::pair<const char*, const char*>>{
             {"empty.log", "empty.log:1:1: "},
             {"one.log", "one.log:1:1: "},
             {"binary.log", "binary.log:1:1: "},
             {"words.log", "words.log:1:1: "},
             {"absent.log", "absent.log: "},
             {".", ".: "}}) {
      const Outcome outcome = run(fmt::format("{} {}", command, file));
      EXPECT_EQ(outcome.code, 3) << command << " " << file << outcome.err;
      EXPECT_NE(outcome.err.find(place), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find("expected"), std::string::npos) << outcome.err;
      EXPECT_EQ(outcome.out, "");
    }
  }
}

TEST_F(CommandTest, AFailureOverwritesNothing) {
  put("empty.log", "");
  for (const char* file : {"out.html", "out.json", "out.csv", "truth.csv"})
    put(file, "precious");
  EXPECT_EQ(run("report empty.log -o out.html --json out.json").code, 3);
  EXPECT_EQ(run("rate empty.log -o out.csv --json out.json").code, 3);
  EXPECT_EQ(run("simulate empty.log -o out.csv --truth truth.csv").code, 3);
  for (const char* file : {"out.html", "out.json", "out.csv", "truth.csv"})
    EXPECT_EQ(content(folder_ / file), "precious") << file;
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_EQ(entry.path().string().find(".part-"), std::string::npos) << entry.path();
}

TEST_F(CommandTest, OneOutputThatCannotBeWrittenLeavesTheOthersAsTheyWere) {
  put("truth.csv", "precious");
  put("out.json", "precious");
  EXPECT_EQ(run("simulate " + scenario("jump") + " --truth truth.csv -o no/such/log.csv").code, 5);
  run("simulate " + scenario("jump") + " -o log.csv");
  EXPECT_EQ(run("report log.csv --json out.json -o no/such/page.html").code, 5);
  EXPECT_EQ(content(folder_ / "truth.csv"), "precious");
  EXPECT_EQ(content(folder_ / "out.json"), "precious");
  EXPECT_EQ(run("report log.csv -o - --json -").code, 2) << "two results on one stream";
}

TEST_F(CommandTest, AnUnwritableStandardErrorIsNoCrash) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const std::string line = fmt::format("'{}' rate no-such-file 2> /dev/full", GOINGRATE_COMMAND);
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 3);
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

TEST_F(CommandTest, OutputThatCannotBeWrittenIsExitFive) {
  EXPECT_EQ(run("simulate " + scenario("jump") + " -o no/such/folder/log.csv").code, 5);
  if (!fs::exists("/dev/full")) return;
  EXPECT_EQ(run("simulate " + scenario("jump") + " -o /dev/full").code, 5);
}

TEST_F(CommandTest, WithoutArgumentsItSaysWhatItCanDo) {
  const Outcome outcome = run("");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("report"), std::string::npos) << outcome.err;
}

TEST_F(CommandTest, ABareWordInSetIsText) {
  const std::string jump = "simulate " + scenario("jump") + " --set run.periods=20 -o ";
  ASSERT_EQ(run(jump + "a.csv --set run.method=direct").code, 0);
  ASSERT_EQ(run(jump + "b.csv --set \"run.method='direct'\"").code, 0);
  ASSERT_EQ(run(jump + "c.csv --set run.method=averaged1").code, 0);
  EXPECT_EQ(content(folder_ / "a.csv"), content(folder_ / "b.csv"));
  EXPECT_NE(content(folder_ / "a.csv"), content(folder_ / "c.csv"));
}

TEST_F(CommandTest, WrongUsageIsExitTwo) {
  EXPECT_EQ(run("tick").code, 2);
  EXPECT_EQ(run("rate").code, 2);
  run("simulate " + scenario("jump") + " -o log.csv");
  EXPECT_EQ(run("rate log.csv --format sundial").code, 2);
  EXPECT_EQ(run("fit log.csv --fix eps=1").code, 2);
  EXPECT_EQ(run("fit log.csv --event 99999:mu").code, 2);
  EXPECT_EQ(run("stability log.csv --taus 3").code, 2) << "no multiple of 2 s";
}

TEST_F(CommandTest, ABadScenarioIsExitThreeAndABadOptionTwo) {
  put("bad.toml", "[clock]\nepsilom = 1\n");
  const Outcome outcome = run("simulate bad.toml");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("bad.toml:2:1"), std::string::npos) << outcome.err;
  EXPECT_EQ(run("simulate " + scenario("jump") + " --set clock.mu=lots").code, 2)
      << "that is an option";
}

TEST_F(CommandTest, AStalledClockIsExitFourAndOverwritesNothing) {
  put("log.csv", "precious");
  const Outcome outcome = run("simulate " + scenario("jump") +
                              " -o log.csv --set clock.epsilon=0.01 "
                              "--set start.amplitude=0.05");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("stalled"), std::string::npos);
  EXPECT_EQ(content(folder_ / "log.csv"), "precious");
}

TEST_F(CommandTest, EachHelpHasAnExampleThatRuns) {
  fs::create_symlink(source / "data", folder_ / "data");
  for (const char* command : {"simulate", "rate", "fit", "spectrum", "stability", "report", "map",
                              "chart", "paper", "help"}) {
    const Outcome help = run(fmt::format("{} --help", command));
    EXPECT_EQ(help.code, 0);
    const std::size_t at = help.out.find("Example:");
    ASSERT_NE(at, std::string::npos) << command;
    std::string example = help.out.substr(help.out.find("goingrate ", at) + 10);
    for (std::size_t k; (k = example.find("\\\n")) != std::string::npos;)
      example.erase(k, 2);
    while (!example.empty() && (example.back() == '\n' || example.back() == ' '))
      example.pop_back();
    EXPECT_EQ(run(example).code, 0) << example;
  }
}

// The longest line in characters, not bytes.
std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0, width = 0;
  for (const char c : text) {
    if (c == '\n')
      width = 0;
    else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U)
      widest = std::max(widest, ++width);
  }
  return widest;
}

TEST_F(CommandTest, HelpAndSummaryFitATerminalOfEightyColumns) {
  EXPECT_LE(widest_line(run("--help").out), 80u);
  for (const char* command : {"simulate", "rate", "fit", "spectrum", "stability", "report", "map",
                              "chart", "paper", "help"})
    EXPECT_LE(widest_line(run(std::string(command) + " --help").out), 80u) << command;
  for (const char* topic : {"", "formats", "scenario", "noise", "identifiability"})
    EXPECT_LE(widest_line(run(std::string("help ") + topic).out), 80u) << topic;
  for (const char* log : {"interruption", "jump"}) {
    const std::string path = (source / "data/logs" / (std::string(log) + ".csv")).string();
    const Outcome report = run("report " + path + " -o r.html");
    EXPECT_LE(widest_line(report.out), 80u) << report.out;
    EXPECT_LE(std::count(report.out.begin(), report.out.end(), '\n'), 40) << report.out;
  }
}

TEST_F(CommandTest, HelpListsEveryCommand) {
  const Outcome help = run("--help");
  for (const char* name :
       {"report", "rate", "fit", "spectrum", "stability", "simulate", "map", "chart", "paper"})
    EXPECT_NE(help.out.find(fmt::format("\n  {} ", name)), std::string::npos) << name;
  EXPECT_EQ(run("--version").out.substr(0, 10), "goingrate ");
}

TEST_F(CommandTest, RealisationsAreTheRunsOfTheirSeeds) {
  const std::string noisy = scenario("noisy-drive") + " --set run.periods=300 --quiet";
  ASSERT_EQ(run("simulate " + noisy + " --realisations 11 --seed 4 -o log.csv").code, 0);
  for (const int k : {0, 7, 10}) {
    ASSERT_EQ(run(fmt::format("simulate {} --seed {} -o one.csv", noisy, 4 + k)).code, 0);
    EXPECT_EQ(content(folder_ / fmt::format("log-{:02}.csv", k)), content(folder_ / "one.csv"));
  }
  EXPECT_EQ(run("simulate " + noisy + " --realisations 3").code, 2); // all to standard output?
  fs::create_directory(folder_ / "logs");
  for (const char* target : {"-o /dev/null", "-o logs", "-o logs/", "-o l.csv --truth /dev/null"}) {
    const Outcome refused = run(fmt::format("simulate {} --realisations 3 {}", noisy, target));
    EXPECT_EQ(refused.code, 2) << target;
    EXPECT_NE(refused.err.find("log.csv becomes log-0.csv"), std::string::npos) << refused.err;
  }
}

TEST_F(CommandTest, AFailedRealisationLeavesNothingBehind) {
  const std::string stalling =
      scenario("noisy-drive") + " --set clock.epsilon=1e-2 --set start.amplitude=0.04";
  EXPECT_EQ(run("simulate " + stalling + " --realisations 9 -o log.csv").code, 4);
  for (const auto& file : fs::directory_iterator(folder_))
    EXPECT_EQ(file.path().filename().string().find("log"), std::string::npos) << file.path();
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

TEST_F(CommandTest, EveryClockLawAndMethodRunsFromAScenario) {
  put("laws.toml", "[clock]\nepsilon = 1e-4\nescapement = 'single-impulse'\nimpulse = 1.5e-6\n"
                   "angle = 0.01\nquadratic_drag = 1e-4\ndry_friction = 1e-8\n"
                   "[run]\nperiods = 50\n[length]\ndrift_per_day = 1e-5\n"
                   "[drive]\nseries = 'mu.csv'\nsine = [{amplitude = 0.1, period = 20.0}]\n");
  std::string series = "factor\n";
  for (int i = 0; i < 50; ++i)
    series += fmt::format("{}\n", 1.0 + 0.01 * i);
  put("mu.csv", series);
  EXPECT_EQ(run("simulate laws.toml -o a.csv").code, 0);
  EXPECT_EQ(run("simulate laws.toml -o b.csv --set \"run.method='direct'\"").code, 0);
  EXPECT_EQ(content(folder_ / "a.csv").substr(0, 200), content(folder_ / "b.csv").substr(0, 200));
  EXPECT_EQ(run("simulate laws.toml -o c.csv --set \"run.method='averaged2'\"").code, 2);
  put("profile.toml", "[clock]\nepsilon = 1e-4\nescapement = 'profile'\n"
                      "rising = [[-0.02, 0], [0, 4e-5], [0.02, 0]]\n"
                      "falling = [[-0.02, 0], [0, -4e-5], [0.02, 0]]\n[run]\nperiods = 20\n");
  EXPECT_EQ(run("simulate profile.toml -o d.csv").code, 0);
  put("mu.csv", "factor\n1.0\nx\n");
  const Outcome bad = run("simulate laws.toml");
  EXPECT_EQ(bad.code, 3);
  EXPECT_NE(bad.err.find("mu.csv:3:1"), std::string::npos) << bad.err;
}

} // namespace
