// goingrate fit as a script sees it: models, files of parameters, tables.
#include "support/command_fixture.hpp"

#include <cmath>
#include <initializer_list>
#include <sstream>
#include <string>
#include <utility>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

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

TEST_F(CommandTest, WeatherMayStandInAFileOfItsOwn) {
  // The same log with a temperature at each beat, and with readings every ten minutes elsewhere.
  put("warm.toml", "[clock]\nnominal_period = 2.0\nepsilon = 2.5e-4\nmu = 2e-5\nphi0 = 0.03\n"
                   "[start]\namplitude = \"stationary\"\n[run]\nperiods = 10000\n"
                   "[length]\ntemperature_coefficient = 1.2e-5\n"
                   "[temperature]\nsine = [{amplitude = 1.0, period = 7200.0},"
                   " {amplitude = 2.0, period = 16000.0}]\n"
                   "[sensor]\njitter_rms = 3e-4\ntemperature_rms = 0.002\n");
  ASSERT_EQ(run("simulate warm.toml -o whole.csv").code, 0);
  std::string log, weather = "time_s,temperature_c\n";
  std::istringstream lines(content(folder_ / "whole.csv"));
  double next_s = 0.0;
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    const std::size_t comma = line.rfind(',');
    last = line.substr(0, line.find(',')) + line.substr(comma) + "\n";
    log += line.substr(0, comma) + "\n";
    if (line.starts_with("time_s") || std::stod(line) < next_s) continue;
    weather += last;
    next_s = std::stod(line) + 600.0;
  }
  put("log.csv", log);
  put("weather.csv", weather + last); // a thermometer does not stop before the clock
  const auto effect = [&](const std::string& words) {
    const Outcome outcome = run("report " + words + " -o page.html --json r.json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json("r.json")["covariates"][0];
  };
  const auto own = effect("whole.csv"), split = effect("log.csv --weather weather.csv");
  EXPECT_EQ(split["name"], "temperature");
  EXPECT_NEAR(split["readings_step_s"].get<double>(), 600.0, 2.0); // a beat
  EXPECT_GT(split["interpolation_sigma"].get<double>(), 0.0);
  EXPECT_LT(std::abs(split["coefficient"].get<double>() - own["coefficient"].get<double>()),
            0.2 * split["sigma"].get<double>());
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
           {"temperature 0 1", "bad.par:2:1: found 'temperature', expected a log with a temperature column"},
           {"pressure 0 0", "bad.par:2:1: found 'pressure', expected a log with a pressure column"}}) {
    put("bad.par", std::string("# goingrate par 1\n") + text + "\n");
    const Outcome outcome = run("fit log.csv --from bad.par --json out.json");
    EXPECT_EQ(outcome.code, 3) << text;
    EXPECT_NE(outcome.err.find(place), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "out.json"));
  }
  EXPECT_EQ(run("fit log.csv --from log.csv").code, 3);
  EXPECT_EQ(run("fit log.csv --from absent.par").code, 3);
}

TEST_F(CommandTest, AnEventOutsideOfTheLogIsToldItsRange) {
  run("simulate " + scenario("jump") + " -o log.csv --set run.periods=200");
  const Outcome cycle = run("fit log.csv --fix T0=2 --event 5000:mu");
  EXPECT_EQ(cycle.code, 2);
  EXPECT_NE(cycle.err.find("'5000:mu': must be inside the log, between cycles 0 and 200"),
            std::string::npos)
      << cycle.err;
  const Outcome time = run("fit log.csv --fix T0=2 --event 9000s:mu");
  EXPECT_EQ(time.code, 2);
  EXPECT_NE(time.err.find("must be inside the log, between 0s and "), std::string::npos)
      << time.err;
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

} // namespace
