#include "goingrate/fit/par_file.hpp"

#include "support/fit_scenes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

const std::string head = "# goingrate par 1\n";

TEST(ParFileTest, EveryItemIsRead) {
  const ParFile file = parse_par(head + "DYNAMICS averaged2  # second order\r\n"
                                        "\n  ESCAPEMENT single-impulse\nNOISE slow\n"
                                        "EVENT 150 impulse,T0\nEVENT 300\tepsilon\n"
                                        "PRIOR lambda0 0.05 0.005\n"
                                        "T0 2 0\nepsilon 2.5e-4 1 1e-8 # ten figures\nimpulse - 1\n"
                                        "impulse@1 0 1\ntemperature -1e-6 1\noffset 1e-3 0\n"
                                        "jitter_rms +1e-5 1",
                                 "a.par");
  const FitOptions& options = file.options;
  EXPECT_EQ(options.dynamics, FitDynamics::averaged2);
  EXPECT_EQ(options.escapement, Escapement::single_impulse);
  EXPECT_EQ(options.noise, FitNoise::slow);
  ASSERT_EQ(options.events.size(), 2u);
  EXPECT_EQ(options.events[0].cycle, 150);
  EXPECT_EQ(options.events[0].names, (std::vector<std::string>{"impulse", "T0"}));
  EXPECT_EQ(file.event_places[1].line, 7u);
  ASSERT_EQ(options.priors.size(), 1u);
  EXPECT_EQ(options.priors[0].sigma, 0.005);
  EXPECT_EQ(options.fixed, (std::map<std::string, double>{{"T0", 2.0}, {"offset", 1e-3}}));
  EXPECT_EQ(
      options.start,
      (std::map<std::string, double>{
          {"epsilon", 2.5e-4}, {"impulse@1", 0.0}, {"temperature", -1e-6}, {"jitter_rms", 1e-5}}));
  EXPECT_EQ(options.freed, std::vector<std::string>{"temperature"});
  EXPECT_EQ(file.parameter_places.at("impulse").line, 11u);
}

TEST(ParFileTest, AFileThatSaysNothingLeavesAllOpen) {
  const FitOptions options = parse_par(head, "a.par").options;
  EXPECT_EQ(options.dynamics, FitDynamics::automatic);
  EXPECT_EQ(options.noise, FitNoise::automatic);
  EXPECT_FALSE(options.escapement);
  EXPECT_TRUE(options.start.empty() && options.fixed.empty() && options.events.empty());
}

struct Malformed {
  std::string text;    // behind the first line, unless it is one
  std::string message; // how what is said begins
};

const std::vector<Malformed> malformed{
    {"epsilon\n", "a.par:2:8: found the end of the line, expected 0 (held) or 1 (fitted)"},
    {"epsilon 1e-4\n", "a.par:2:13: found the end of the line, expected 0 (held) or 1 (fitted)"},
    {"epsilon 1e-4 2\n", "a.par:2:14: found '2', expected 0 (held) or 1 (fitted)"},
    {"epsilon 1e-4 1 x\n", "a.par:2:16: found 'x', expected a sigma or nothing"},
    {"epsilon 1e-4 1 -1\n", "a.par:2:16: found '-1', expected a sigma or nothing"},
    {"epsilon 1e-4 1 1 1\n", "a.par:2:18: found '1', expected the end of the line"},
    {"epsilon nan 1\n", "a.par:2:9: found 'nan', expected a number above 0, or - if none is known"},
    {"epsilon 1e999 0\n", "a.par:2:9: found '1e999', expected a number above 0"},
    {"epsilon - 0\n", "a.par:2:9: found '-', expected a number above 0"},
    {"epsilon -1e-4 1\n", "a.par:2:9: found '-1e-4', expected a number above 0"},
    {"mu 0 1\n", "a.par:2:4: found '0', expected a number above 0"},
    {"mu 1,5e-5 1\n", "a.par:2:4: found '1,5e-5', expected a number above 0"},
    {"dry_friction -1 0\n", "a.par:2:14: found '-1', expected a number not below 0"},
    {"\n  epsilom 1e-4 1\n", "a.par:3:3: found 'epsilom', expected EVENT, PRIOR, DYNAMICS"},
    {"lambda0@1 0.1 1\n", "a.par:2:1: found 'lambda0@1', expected EVENT, PRIOR, DYNAMICS"},
    {"mu 1e-5 1\nmu 2e-5 1\n", "a.par:3:1: found 'mu', expected one line of mu only"},
    {"mu@1 1e-5 1\n", "a.par:2:1: found 'mu@1', expected a name that the EVENT of this number"},
    {"mu@x 1e-5 1\nEVENT 9 mu\n", "a.par:2:1: found 'mu@x', expected a name that the EVENT"},
    {"mu@1 1e-5 1\nEVENT 9 T0\n", "a.par:2:1: found 'mu@1', expected a name that the EVENT"},
    {"EVENT\n", "a.par:2:6: found the end of the line, expected the number of a cycle"},
    {"EVENT 1.5 mu\n", "a.par:2:7: found '1.5', expected the number of a cycle"},
    {"EVENT 9\n", "a.par:2:8: found the end of the line, expected the names of what changes"},
    {"EVENT 9 mu,,T0\n", "a.par:2:9: found 'mu,,T0', expected a list, without blanks, of T0, "},
    {"EVENT 9 mu,mu\n", "a.par:2:9: found 'mu,mu', expected each name once"},
    {"EVENT 9 mu, T0\n", "a.par:2:9: found 'mu,', expected a list, without blanks, of"},
    {"EVENT 9 lambda0\n", "a.par:2:9: found 'lambda0', expected a list, without blanks, of"},
    {"EVENT 9 mu\nEVENT 9 T0\n", "a.par:3:7: found '9', expected the number of a cycle after"},
    {"EVENT 99999999999999999999 mu\n", "a.par:2:7: found '99999999999999999999', expected the"},
    {"PRIOR lambda0 0.05\n", "a.par:2:19: found the end of the line, expected a sigma above 0"},
    {"PRIOR lambda0 0.05 0\n", "a.par:2:20: found '0', expected a sigma above 0"},
    {"PRIOR lambda 0.05 0.1\n", "a.par:2:7: found 'lambda', expected one of T0, epsilon"},
    {"PRIOR T0 2 1\nPRIOR T0 2 1\n", "a.par:3:1: found 'PRIOR', expected one line of PRIOR T0"},
    {"PRIOR T0 2 1\nT0 2 0\n", "a.par:3:1: found 'T0' held, expected flag 1"},
    {"DYNAMICS\n", "a.par:2:9: found the end of the line, expected averaged1"},
    {"DYNAMICS newton\n", "a.par:2:10: found 'newton', expected averaged1, averaged2, map or auto"},
    {"NOISE pink\n", "a.par:2:7: found 'pink', expected jitter, drive, both, slow or auto"},
    {"ESCAPEMENT profile\n", "a.par:2:12: found 'profile', expected constant-torque"},
    {"NOISE slow\nNOISE slow\n", "a.par:3:1: found 'NOISE', expected one line of NOISE only"},
    {std::string("T0\0 2 0\n", 8), "a.par:2:1: found 'T0\\x00', expected EVENT"},
};

std::string complaint(const std::string& text) {
  try {
    parse_par(text, "a.par");
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(ParFileTest, MalformedLinesAreRefusedWithTheirPlace) {
  for (const Malformed& bad : malformed) {
    const std::string said = complaint(head + bad.text);
    EXPECT_EQ(said.substr(0, bad.message.size()), bad.message) << bad.text;
  }
}

TEST(ParFileTest, OtherFilesAreRefusedAtTheirFirstLine) {
  for (const std::string& text :
       {std::string(), std::string("T0 2 0\n"), "# goingrate par 2\n" + head, "\n" + head,
        std::string("\x1f\x8b\x00", 3)})
    EXPECT_EQ(complaint(text).substr(0, 10), "a.par:1:1:") << text;
}

// Whatever is cut off or spoilt, the answer is a reading or a complaint with the file's name.
TEST(ParFileTest, EverySpoiltByteIsReadOrRefused) {
  const std::string good = head + "DYNAMICS map\nEVENT 150 mu,T0\nPRIOR lambda0 0.05 0.005\n"
                                  "epsilon 2.5e-4 1 1e-8\nmu@1 - 1\n";
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char c : {'\0', '\n', ' ', '-', '9', '@', ',', '#', '"', '\xff'}) {
      std::string spoilt = good;
      spoilt[i] = c;
      const std::string said = complaint(spoilt);
      EXPECT_TRUE(said == "nothing" || said.starts_with("a.par:")) << said;
    }
    const std::string said = complaint(good.substr(0, i));
    EXPECT_TRUE(said == "nothing" || said.starts_with("a.par:")) << said;
  }
}

TEST(ParFileTest, APartialStartIsDropped) {
  FitOptions options;
  options.fixed = {{"T0", 2.0}};
  options.start = {{"epsilon", 1e-4}, {"mu", 1e-5}, {"phi0", 0.03}, {"lambda0", 0.05}};
  FitOptions whole = options;
  drop_partial_start(whole);
  EXPECT_EQ(whole.start, options.start);
  FitOptions changed = options;
  changed.events = {{9, {"mu"}}};
  drop_partial_start(changed);
  EXPECT_TRUE(changed.start.empty());
  options.start.erase("phi0");
  options.escapement = Escapement::none;
  FitOptions undriven = options;
  drop_partial_start(undriven);
  EXPECT_FALSE(undriven.start.empty());
  options.escapement.reset();
  drop_partial_start(options);
  EXPECT_TRUE(options.start.empty());
}

TEST(ParFileTest, WhatWasChosenIsNamedAndWhatIsNotKnownIsADash) {
  FitSummary fit;
  fit.dynamics = FitDynamics::averaged2;
  fit.model.escapement = Escapement::none;
  fit.model.walk = true;
  fit.events = {{140, {"epsilon", "T0"}}, {190, {"mu"}, true}};
  fit.parameters = {{"T0", "s", ParameterStatus::fixed, 2.0, NAN},
                    {"epsilon", "", ParameterStatus::undetermined, NAN, NAN},
                    {"lambda0", "rad", ParameterStatus::prior, 0.1, 0.01},
                    {"jitter_rms", "s", ParameterStatus::fixed, 2e-12, NAN}};
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.priors = {{"lambda0", 0.1, 0.02}};
  const std::string text = par_text(fit, options, 10);
  for (const char* line :
       {"DYNAMICS averaged2\n", "ESCAPEMENT none\n", "NOISE auto\n", "EVENT 150 epsilon,T0\n",
        "EVENT ~200 mu\n", "PRIOR lambda0 0.10000000000000001 0.02", "T0             2 0   # s\n",
        "epsilon        - 1\n", "lambda0        0.10000000000000001 1 0.01"})
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  EXPECT_EQ(text.find("jitter_rms"), std::string::npos) << "held by the model, not by the user";
  options.noise = FitNoise::both;
  EXPECT_NE(par_text(fit, options, 0).find("NOISE both\n"), std::string::npos) << "as asked for";
  EXPECT_EQ(parse_par(text, "a.par").options.events[0].cycle, 150);
}

// The same log fitted again from the file of its fit.
void expect_same_again(const test::FitScene& scene) {
  SCOPED_TRACE(scene.name);
  const auto data = timing_data(test::simulated_beats(scene.scenario, 1));
  const double nominal = scene.scenario.clock.nominal_period_s;
  const FitSummary first = fit_clock(data, nominal, scene.options);
  FitOptions options = parse_par(par_text(first, scene.options, 0), "a.par").options;
  drop_partial_start(options);
  const FitSummary again = fit_clock(data, nominal, options);
  EXPECT_EQ(again.dynamics, first.dynamics);
  EXPECT_EQ(again.model.escapement, first.model.escapement);
  EXPECT_EQ(again.model.noise(), first.model.noise());
  ASSERT_EQ(again.parameters.size(), first.parameters.size());
  for (std::size_t k = 0; k < first.parameters.size(); ++k) {
    const FittedParameter &a = first.parameters[k], &b = again.parameters[k];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.status, a.status) << a.name;
    // A step that gains less than 1e-4 of L, 0.014 sigma, ends a search.
    constexpr double stopped = 0.014;
    if (std::isfinite(a.sigma)) {
      EXPECT_NEAR(b.value, a.value, stopped * a.sigma) << a.name;
      EXPECT_NEAR(b.sigma, a.sigma, stopped * a.sigma) << a.name;
    } else if (a.status == ParameterStatus::fixed) {
      EXPECT_EQ(b.value, a.value) << a.name;
    }
  }
}

TEST(ParFileTest, AFitComesBackFromItsFile) {
  expect_same_again(test::jump_scene("jump", 1000, 1e-5, true));
  expect_same_again(test::ring_down_scene(1000, 1e-5));
  expect_same_again(test::amplitude_scene(1000));
  expect_same_again(test::noisy_scene(5000, true));
}

} // namespace
} // namespace goingrate
