// The statistics of Sec. VI from a thousand runs with the driving noise at C.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/ensemble.hpp"
#include "goingrate/dynamics/moments.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate::paper {

namespace {

constexpr std::size_t runs = 1000, compared_runs = 100;
constexpr std::int64_t longest_run = 24'000, noted_every = 1000; // periods
// By this period the start is forgotten to exp(-6): lambda^2 relaxes in 682 periods.
constexpr std::int64_t memory_end = 4000;
constexpr double paper_periods = 4.3e6; // with noise, in the paper's run

/// psi - t, rad, of each run at every noted period.
using Phases = std::vector<std::vector<double>>;

Phases phases(Method method, double rms, std::size_t realisations, std::uint64_t seed) {
  Scenario scenario = scenario_of(point_c(), longest_run, method);
  scenario.drive.fast_rms = rms;
  Phases all(realisations, std::vector<double>(longest_run / noted_every));
  const double T0 = scenario.clock.nominal_period_s;
  const auto note = [&](std::size_t run, const Period& period) {
    if (period.cycle % noted_every != 0) return;
    const double nominal = T0 * static_cast<double>(period.cycle);
    all[run][static_cast<std::size_t>(period.cycle / noted_every - 1)] =
        -two_pi / T0 * (TwoPart<double>(period.time_s) += TwoPart<double>{-nominal, 0.0}).value();
  };
  run_ensemble(scenario, {.seed = seed, .realisations = realisations}, note);
  return all;
}

/// Mean and variance over some values.
struct Moments {
  double mean = 0.0, variance = 0.0;
};

template <class Value> Moments moments_of(std::size_t count, Value value) {
  Moments m;
  for (std::size_t i = 0; i < count; ++i)
    m.mean += value(i) / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    m.variance += std::pow(value(i) - m.mean, 2) / static_cast<double>(count - 1);
  return m;
}

template <class Value> Estimate mean_of(std::size_t count, Value value) {
  const Moments m = moments_of(count, value);
  return {m.mean, std::sqrt(m.variance / static_cast<double>(count))};
}

// The variance of psi - t after n periods by the averaged equations for small noise: with the slow
// gain s, the fast gain f and the deviation x of lambda^2, which follows the drive at the rate k,
// the phase is 2 pi (s W - (s - f) x/k), W being the sum of the noise.
double linear_variance(double n) {
  const DriveResponse response = *drive_response(point_c());
  const double s = response.slow_gain, beyond = s - response.fast_gain;
  const double k = 2.0 * two_pi * point_c().epsilon, kept = std::exp(-k * n);
  return std::pow(two_pi * drive_rms, 2) * (s * s * n - 2.0 * s * beyond / k * (1.0 - kept) +
                                            beyond * beyond / (2.0 * k) * (1.0 - kept * kept));
}

// The secular psi_p - psi_m under noise of this size minus that without noise; the model has the
// circular error of first order, lambda^2/16.
Estimate added_by_noise(double rms, std::uint64_t seed) {
  const Phases exact = phases(Method::map, rms, compared_runs, seed);
  const Phases model = phases(Method::averaged1, rms, compared_runs, seed);
  const std::size_t from = memory_end / noted_every - 1;
  const double scaled_time = two_pi * static_cast<double>(longest_run - memory_end);
  const double lambda = *stationary_amplitude(point_c());
  const double steady = exact_rate(point_c()) - first_order_rate(point_c()) -
                        (circular_error(lambda) + lambda * lambda / 16.0);
  const auto secular = [&](std::size_t i) {
    return (exact[i].back() - model[i].back() - exact[i][from] + model[i][from]) / scaled_time -
           steady;
  };
  return mean_of(compared_runs, secular);
}

} // namespace

NoiseStatistics noise_statistics(const PaperOptions& options) {
  const Phases all = phases(Method::map, drive_rms, runs, options.seed);
  NoiseStatistics noise;
  noise.runs = runs;
  std::vector<double> mean;
  for (std::size_t k = 0; k < all.front().size(); ++k) {
    const Moments m = moments_of(runs, [&](std::size_t i) { return all[i][k]; });
    noise.periods.push_back(static_cast<double>(noted_every) * static_cast<double>(k + 1));
    noise.variance.push_back(m.variance);
    noise.linear.push_back(linear_variance(noise.periods.back()));
    mean.push_back(m.mean);
  }
  const std::size_t from = memory_end / noted_every - 1;
  noise.growth = mean_of(runs, [&](std::size_t i) {
    return (std::pow(all[i].back() - mean.back(), 2) - std::pow(all[i][from] - mean[from], 2)) /
           static_cast<double>(longest_run - memory_end);
  });
  const double exact = exact_rate(point_c()),
               scaled_time = two_pi * static_cast<double>(longest_run);
  noise.mean_gain =
      mean_of(runs, [&](std::size_t i) { return all[i].back() / scaled_time - exact; });
  noise.by_noise = added_by_noise(drive_rms, options.seed);
  noise.by_half_the_noise = added_by_noise(0.5 * drive_rms, options.seed);
  return noise;
}

void add_noise_statistics(const NoiseStatistics& noise, std::vector<PaperNumber>& numbers) {
  const auto gain = [](double variance, double periods) {
    return std::sqrt(variance) / (two_pi * periods);
  };
  const double n = noise.periods.back(), ours = gain(noise.variance.back(), n);
  numbers.push_back(
      {fmt::format("rms gain by the driving noise in {:.0f} periods, {} runs", n, noise.runs),
       "Sec. VI", "", gain(noise.linear.back(), n), ours, "",
       "by the paper's equations for small noise, the start included: over the "
       "first 700 periods the rate responds with the fast gain",
       ours / std::sqrt(2.0 * static_cast<double>(noise.runs - 1))});
  const double slow = drive_rms * std::abs(drive_response(point_c())->slow_gain);
  const double carried = gain(noise.growth.value * paper_periods, paper_periods);
  numbers.push_back(
      {"the same in the paper's 4.3e6 periods, from the growth of the variance", "Sec. VI", "~1e-8",
       slow / std::sqrt(paper_periods), carried, "",
       fmt::format("carried over, not run: the variance of ψp grows from {} to {} periods as it "
                   "would go on. Theory: slow gain times 0.3/sqrt(N). The paper reads 0.04/4e6 off "
                   "one run, {:.1f} times our rms",
                   memory_end, longest_run, 0.04 / 4e6 / carried),
       0.5 * carried * noise.growth.sigma / noise.growth.value});
  numbers.push_back({"mean gain by that noise", "Sec. VI", "", not_known, noise.mean_gain.value, "",
                     "the rate is not linear in the drive; the paper does not separate this gain "
                     "from the rms",
                     noise.mean_gain.sigma});
  numbers.push_back(
      {fmt::format("what the noise adds to the secular ψp - ψm, {} runs", compared_runs), "Sec. VI",
       "", not_known, noise.by_noise.value, "",
       "second order in the torque: the model of second order has it", noise.by_noise.sigma});
  numbers.push_back(
      {"the same with half the noise", "Sec. VI", "", not_known, noise.by_half_the_noise.value, "",
       "a quarter: it goes as the square of the noise", noise.by_half_the_noise.sigma});
}

PaperFigure noise_figure(const NoiseStatistics& noise) {
  const DriveResponse response = *drive_response(point_c());
  Series measured{Series::Style::bars,
                  fmt::format("{} runs, 95 %", noise.runs),
                  noise.periods,
                  noise.variance,
                  {},
                  {},
                  blue};
  const double two_sigma = 1.96 * std::sqrt(2.0 / static_cast<double>(noise.runs - 1));
  for (const double v : noise.variance) {
    measured.low.push_back(v * (1.0 - two_sigma));
    measured.high.push_back(v * (1.0 + two_sigma));
  }
  Series slow{Series::Style::line, "slow gain alone", {}, {}, {}, {}, green};
  for (const double n : {0.0, noise.periods.back()}) {
    slow.x.push_back(n);
    slow.y.push_back(std::pow(two_pi * drive_rms * response.slow_gain, 2) * n);
  }
  Series linear{Series::Style::line, "averaged equations, small noise", {}, {}, {}, {}, vermilion};
  for (double n = 0.0; n <= noise.periods.back(); n += 100.0) {
    linear.x.push_back(n);
    linear.y.push_back(linear_variance(n));
  }
  return {"noise_growth",
          {"noise_growth",
           "Variance of pendulum time under the driving noise at C",
           "Runs start in stationary operation. Until the swing has answered, the rate follows the "
           "drive by the fast gain; then the variance grows by the slow gain alone.",
           {"length of the run", "nominal periods"},
           {"variance of ψp", "rad²"},
           {linear, slow, measured}}};
}

} // namespace goingrate::paper
