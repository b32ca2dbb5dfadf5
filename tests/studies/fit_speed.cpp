// Time of a fit against its error, for the dynamics and for thinned logs. Error: the largest
// |value - truth| of a determined parameter of the clock, in the sigma of the whole log's fit.
// Arguments: "year" adds a log of 1.6e7 periods; "solver LOG" times the search alone instead, on a
// log of the jump with T0 = 2 s, from 5 % off.
#include "fit/fit_starts.hpp"
#include "fit/inference.hpp"
#include "fit/search.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/log/reading.hpp"
#include "support/fit_scenes.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>

namespace {

using namespace goingrate;
using namespace goingrate::test;

struct Timed {
  FitSummary fit;
  double ms = 0.0; // median
};

Timed timed(const TimingData& data, const FitOptions& options, int repeats) {
  Timed result;
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    times.push_back(1e3 * thread_seconds([&] { result.fit = fit_clock(data, 2.0, options); }));
  }
  std::sort(times.begin(), times.end());
  result.ms = times[times.size() / 2];
  return result;
}

double sigma_of(const FitSummary& fit, const std::string& name) {
  const FittedParameter* found = fit.find(name);
  return found ? found->sigma : 0.0;
}

void print(const char* what, const Timed& t, const FitScene& scene, const FitSummary& whole) {
  double worst = 0.0;
  for (const FittedParameter& p : t.fit.parameters) {
    const auto truth = scene.truth.find(p.name);
    if (truth == scene.truth.end() || p.name.find("_rms") != std::string::npos) continue;
    const double sigma = sigma_of(whole, p.name);
    if (std::isfinite(p.value) && std::isfinite(sigma))
      worst = std::max(worst, std::abs(p.value - truth->second) / sigma);
  }
  std::printf("  %-22s %10.1f ms   error %8.2f sigma   sigma of epsilon %.2g %%   (%s)\n", what,
              t.ms, worst, 100.0 * sigma_of(t.fit, "epsilon") / 2.5e-4,
              std::string(name_of(t.fit.dynamics)).c_str());
}

void dynamics_of(const FitScene& given, int repeats) {
  FitScene scene = given;
  scene.options.noise = FitNoise::jitter; // what a wrong model leaves is not to be called noise
  const TimingData data = timing_data(simulated_beats(scene.scenario, 1));
  std::printf("%s, %zu beats\n", scene.name.c_str(), data.size());
  const Timed whole = timed(data, scene.options, repeats);
  for (const auto& [name, dynamics] : {std::pair{"averaged1", FitDynamics::averaged1},
                                       {"averaged2", FitDynamics::averaged2},
                                       {"map", FitDynamics::map},
                                       {"auto", FitDynamics::automatic}}) {
    scene.options.dynamics = dynamics;
    print(name, timed(data, scene.options, repeats), scene, whole.fit);
  }
}

void thinnings_of(const FitScene& scene, const std::vector<std::size_t>& strides) {
  const TimingData data = timing_data(simulated_beats(scene.scenario, 1));
  std::printf("%s, %zu beats\n", scene.name.c_str(), data.size());
  const int repeats = data.size() > 1000000 ? 1 : 3;
  const Timed whole = timed(data, scene.options, repeats);
  std::printf("  (the fit itself takes %zu beats and loses %.2g %% of the information)\n",
              whole.fit.thinning.beats, 100.0 * whole.fit.thinning.information_lost);
  print("as it is", whole, scene, whole.fit);
  std::fflush(stdout);
  for (const std::size_t stride : strides) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < data.size(); i += stride)
      kept.push_back(i);
    char name[32];
    std::snprintf(name, sizeof name, "every %zu-th beat", stride);
    print(name, timed(subset(data, kept), scene.options, 3), scene, whole.fit);
  }
}

// What scipy's solver does: the clock's parameters by least squares from a start, and their sigmas;
// no other starts, no intervals, no tests. The condensed log is made again each time.
void solver_alone(const std::string& path) {
  using namespace timing_model;
  const FitScene scene = jump_scene("jump", 2000, 1e-6, true);
  const TimingData data =
      timing_data(number_beats(read_log(read_text(path), path)).longest_segment());
  std::vector<double> times;
  for (int i = 0; i < 25; ++i) {
    const auto begin = ThreadClock::now();
    FitProblem problem = make_problem(data, scene.options, ModelChoice{});
    std::vector<double> x(problem.parameters.free_count, 0.0);
    for (const Slot& slot : problem.parameters.slots)
      if (slot.free) {
        const double off = is_noise(slot.quantity) ? 1.0 : 1.05;
        x[slot.index] = slot.coordinate_of(off * scene.truth.at(problem.parameters.name_of(slot)));
      }
    problem.condensed = CondensedLog::of(data, problem.parameters.event_cycles, 300.0);
    problem = with_noise_held(problem, x);
    x.resize(problem.parameters.free_count);
    const Minimum minimum = minimise(problem, x, {100, 1e-4, 1e4});
    const auto at = evaluate(problem, minimum.x);
    const Certainty known = certainty(problem, minimum.x, *at, {});
    const std::chrono::duration<double, std::milli> time = ThreadClock::now() - begin;
    times.push_back(time.count());
    if (i == 0)
      std::printf("epsilon %.10e +- %.2e\n", std::exp(minimum.x[0]),
                  std::exp(minimum.x[0]) * known.sigma(0));
  }
  std::sort(times.begin(), times.end());
  std::printf("search alone %.3f ms\n", times[times.size() / 2]);
}

} // namespace

int main(int count, char** words) {
  if (count > 2 && std::strcmp(words[1], "solver") == 0) {
    solver_alone(words[2]);
    return 0;
  }
  dynamics_of(jump_scene("jump, jitter 1e-6 s", 2000, 1e-6, true), 11);
  dynamics_of(jump_scene("jump, jitter 1e-4 s", 2000, 1e-4, true), 11);
  dynamics_of(jump_scene("jump, jitter 1e-6 s", 20000, 1e-6, true), 3);
  thinnings_of(noisy_scene(100000, true), {4, 16});
  if (count > 1 && std::strcmp(words[1], "year") == 0)
    thinnings_of(noisy_scene(16000000, true), {});
}
