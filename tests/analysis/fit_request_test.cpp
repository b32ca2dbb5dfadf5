// Requests for a fit, as users write them.
#include "goingrate/analysis/fit_request.hpp"

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/pulse.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

namespace goingrate {
namespace {

const NumberedLog& jump() {
  static const NumberedLog loaded = [] {
    LoadRequest request;
    request.path = GOINGRATE_SOURCE_DIR "/data/logs/jump.csv";
    return load(request);
  }();
  return loaded;
}

FitRequest with_events(std::vector<std::string> events) {
  FitRequest request;
  request.events = std::move(events);
  return request;
}

TEST(FitRequestTest, EventsAreOfCyclesTimesOrWords) {
  const FitOptions by_cycle = fit_options(with_events({"150:mu,epsilon"}), jump());
  ASSERT_EQ(by_cycle.events.size(), 1u);
  EXPECT_EQ(by_cycle.events[0].cycle, 150);
  EXPECT_EQ(by_cycle.events[0].names, (std::vector<std::string>{"mu", "epsilon"}));
  EXPECT_FALSE(by_cycle.events[0].movable);
  const FitOptions by_time = fit_options(with_events({"299.5s:mu"}), jump());
  EXPECT_EQ(by_time.events.at(0).cycle, 150);
  EXPECT_TRUE(by_time.events[0].movable);
  EXPECT_TRUE(fit_options(with_events({"none"}), jump()).events.empty());
  EXPECT_EQ(fit_options(with_events({"auto"}), jump()).events.size(), 1u);
}

TEST(FitRequestTest, ChangesAreSearchedForWhereNoneAreNamed) {
  EXPECT_TRUE(finds_events({}));
  EXPECT_TRUE(finds_events(with_events({"auto"})));
  EXPECT_FALSE(finds_events(with_events({"none"})));
  FitRequest from_file;
  from_file.from = "clock.par";
  EXPECT_FALSE(finds_events(from_file));
  EXPECT_EQ(searching({}).events, std::vector<std::string>{"auto"});
  EXPECT_EQ(searching(with_events({"3:mu"})).events, std::vector<std::string>{"3:mu"});
}

TEST(FitRequestTest, WhatIsFixedFreedAndKnown) {
  FitRequest request;
  request.fixed = {{"T0", 2.0}, {"phi0", 0.03}};
  request.freed = {"drift"};
  request.priors = {{"lambda0", 0.04, 0.001}};
  request.noise = "both";
  request.model = "map";
  request.escapement = "constant-torque";
  const FitOptions options = fit_options(request, jump());
  EXPECT_EQ(options.fixed, (std::map<std::string, double>{{"T0", 2.0}, {"phi0", 0.03}}));
  EXPECT_EQ(options.freed, std::vector<std::string>{"drift"});
  ASSERT_EQ(options.priors.size(), 1u);
  EXPECT_EQ(options.noise, FitNoise::both);
  EXPECT_EQ(options.dynamics, FitDynamics::map);
  EXPECT_EQ(options.escapement, Escapement::constant_torque);
}

TEST(FitRequestTest, WordsThatMakeNoSenseAreRefused) {
  FitRequest both;
  both.fixed = {{"mu", 1e-5}};
  both.freed = {"mu"};
  EXPECT_THROW((void)fit_options(both, jump()), ArgumentError);
  for (std::string FitRequest::*word :
       {&FitRequest::model, &FitRequest::noise, &FitRequest::escapement}) {
    FitRequest request;
    request.*word = "guess";
    EXPECT_THROW((void)fit_options(request, jump()), ArgumentError);
  }
  for (const char* event : {"150", ":mu", "s:mu", "soon:mu", "xs:mu"})
    EXPECT_THROW((void)fit_options(with_events({event}), jump()), ArgumentError) << event;
}

TEST(FitRequestTest, TextsOfNamesAndNumbers) {
  EXPECT_EQ(parse_fixed("T0=2.5"), (std::pair<std::string, double>{"T0", 2.5}));
  const Prior prior = parse_prior("lambda0=4e-2+-1e-3");
  EXPECT_EQ(prior.name, "lambda0");
  EXPECT_EQ(prior.value, 0.04);
  EXPECT_EQ(prior.sigma, 0.001);
  for (const char* text : {"", "T0", "=2", "T0=", "T0=two", "T0=2 "})
    EXPECT_THROW((void)parse_fixed(text), ArgumentError) << text;
  for (const char* text : {"lambda0=1", "lambda0=1+-", "lambda0", "lambda0=+-1"})
    EXPECT_THROW((void)parse_prior(text), ArgumentError) << text;
}

// What the scope throws comes out of the fit, and nothing is written by Ceres.
TEST(PulseTest, EndsAFit) {
  int beats = 0;
  const PulseScope scope([&] {
    if (++beats == 5) throw std::runtime_error("enough");
  });
  FitRequest request = with_events({"150:mu"});
  request.fixed = {{"T0", 2.0}};
  const FitOptions options = fit_options(request, jump());
  testing::internal::CaptureStderr();
  EXPECT_THROW((void)fit_clock(fit_data(jump()), 2.0, options), std::runtime_error);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(beats, 5);
}

} // namespace
} // namespace goingrate
