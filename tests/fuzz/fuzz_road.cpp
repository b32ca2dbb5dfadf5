// Random logs of 3 to 500 beats through the whole analysis: load, fit, drive, diary, causes,
// stability, report. `fuzz_road SECONDS [SEED]` runs for that long and prints the number of logs; a
// finding ends it with the seed of the log, which `fuzz_road 0 SEED` repeats. A finding is anything
// other than an answer or an error that the headers promise, "nan" or "inf" in the output, or an
// answer that takes longer than a minute of processor time, ten with a sanitizer.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/report/json.hpp"
#include "goingrate/report/report.hpp"
#include "goingrate/report/tables.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>

namespace {

using namespace goingrate;
using Clock = std::chrono::steady_clock;

class RandomLog {
public:
  explicit RandomLog(std::uint64_t seed)
      : random_(seed, StreamPurpose::jitter), choice_(seed, StreamPurpose::missed) {}

  std::string text() {
    beats_ = static_cast<int>(log_uniform(3.0, 500.0));
    const double period = log_uniform(0.3, 4.0), jitter = log_uniform(1e-9, 1e-2) * period;
    const double rate = chance(0.3) ? 0.0 : 1e-3 * random_.normal();
    const double walk = chance(0.5) ? 0.0 : log_uniform(1e-8, 1e-3);
    const double missed = chance(0.5) ? 0.0 : 0.5 * choice_.uniform();
    const double decay = chance(0.5) ? 0.0 : log_uniform(1e-5, 0.3);
    const double amplitude = log_uniform(1e-3, 2.0);
    const bool amplitudes = chance(0.4), temperature = chance(0.2), pressure = chance(0.2),
               both = chance(0.2), exact = chance(0.1);
    const int jump = chance(0.4) ? static_cast<int>(beats_ * choice_.uniform()) : -1;
    const double size = 1e-3 * random_.normal();
    std::string text = "time_s";
    if (both) text += ",edge";
    if (amplitudes) text += ",amplitude_rad";
    if (temperature) text += ",temperature_c";
    if (pressure) text += ",pressure_mbar";
    text += '\n';
    double time = chance(0.5) ? 0.0 : 1.6e9, drift = 0.0;
    for (int n = 0; n < beats_; ++n) {
      const double swing = amplitude * std::exp(-decay * n);
      const int edges = both ? 2 : 1;
      for (int edge = 0; edge < edges; ++edge) {
        if (choice_.uniform() < missed) continue;
        const double at = time + 0.5 * edge * period + (exact ? 0.0 : jitter * random_.normal());
        text += fmt::format("{:.9f}", at);
        if (both) text += edge == 0 ? ",up" : ",down";
        if (amplitudes)
          text += choice_.uniform() < 0.05
                      ? std::string(",")
                      : fmt::format(",{:.9g}", swing + 1e-4 * amplitude * random_.normal());
        if (temperature) text += fmt::format(",{:.3f}", 20.0 + std::sin(0.01 * n));
        if (pressure) text += fmt::format(",{:.2f}", chance(0.01) ? 9999.99 : 1000.0 + 0.1 * n);
        text += '\n';
      }
      drift += walk * random_.normal();
      const double circular = amplitudes || decay > 0.0 ? swing * swing / 16.0 : 0.0;
      time += period * (1.0 + rate + drift + circular + (jump >= 0 && n >= jump ? size : 0.0));
      if (chance(0.002)) time += period * log_uniform(1.0, 1e4);
      if (chance(0.0005)) time = 0.0;
    }
    return text;
  }

  LoadRequest request() {
    LoadRequest request;
    request.path = "fuzz";
    if (chance(0.2)) request.reading.nominal_period_s = log_uniform(0.2, 5.0);
    if (chance(0.1)) request.dead_time_s = log_uniform(1e-6, 1.0);
    request.find_sensor_offset = chance(0.1);
    if (chance(0.1)) request.sensor_offset_rad = 0.02 * random_.normal();
    if (chance(0.1)) request.flag_width_rad = 0.05 * choice_.uniform();
    request.both_edges = chance(0.05);
    return request;
  }

  FitOptions fit() {
    FitOptions options;
    constexpr std::array noises{FitNoise::automatic, FitNoise::jitter, FitNoise::drive,
                                FitNoise::both, FitNoise::slow};
    options.noise = noises[pick(noises.size())];
    constexpr std::array dynamics{FitDynamics::automatic, FitDynamics::averaged1,
                                  FitDynamics::averaged2, FitDynamics::map};
    options.dynamics = dynamics[pick(dynamics.size())];
    if (chance(0.3)) {
      constexpr std::array escapements{Escapement::none, Escapement::constant_torque,
                                       Escapement::single_impulse};
      options.escapement = escapements[pick(escapements.size())];
    }
    if (chance(0.3)) options.fixed["T0"] = 2.0;
    for (const char* name : {"quadratic_drag", "dry_friction", "offset", "drift"})
      if (chance(0.15)) options.freed.emplace_back(name);
    if (chance(0.3))
      options.events.push_back(
          {1 + static_cast<std::int64_t>(pick(static_cast<std::size_t>(beats_))),
           {chance(0.7)   ? "mu"
            : chance(0.5) ? "epsilon"
                          : "T0"},
           chance(0.5)});
    if (chance(0.2)) options.priors.push_back({"lambda0", 0.05, 0.005});
    return options;
  }

  DeviationKind kind() { return deviation_kinds[pick(deviation_kinds.size())]; }

private:
  bool chance(double part) { return choice_.uniform() < part; }
  std::size_t pick(std::size_t count) {
    return std::min(count - 1,
                    static_cast<std::size_t>(choice_.uniform() * static_cast<double>(count)));
  }
  double log_uniform(double low, double high) {
    return low * std::exp(std::log(high / low) * choice_.uniform());
  }

  RandomStream random_, choice_;
  int beats_ = 0;
};

[[noreturn]] void finding(std::uint64_t seed, const std::string& what) {
  std::fprintf(stderr, "finding at seed %llu: %s\n", static_cast<unsigned long long>(seed),
               what.c_str());
  std::abort();
}

// "nan" or "inf" as a word of its own, in any case.
std::size_t find_no_number(const std::string& text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  for (std::size_t i = 0; i + 3 <= text.size(); ++i) {
    const char first = lower(text[i]);
    if (first != 'n' && first != 'i') continue;
    const bool is_one = first == 'n' ? lower(text[i + 1]) == 'a' && lower(text[i + 2]) == 'n'
                                     : lower(text[i + 1]) == 'n' && lower(text[i + 2]) == 'f';
    const bool alone =
        (i == 0 || !is_letter(text[i - 1])) && (i + 3 == text.size() || !is_letter(text[i + 3]));
    if (is_one && alone) return i;
  }
  return std::string::npos;
}

void demand_numbers(std::uint64_t seed, const char* where, const std::string& text) {
  const std::size_t at = find_no_number(text);
  if (at == std::string::npos) return;
  finding(seed, fmt::format("'{}' in {}", text.substr(at > 60 ? at - 60 : 0, 120), where));
}

void try_log(std::uint64_t seed) {
  RandomLog random(seed);
  const std::string text = random.text();
  const LoadRequest request = random.request();
  AnalysisRequest road;
  road.fit = random.fit();
  road.finds_events = road.fit.events.empty() && seed % 2 == 0;
  const DeviationKind kind = random.kind();
  try {
    NumberedLog loaded = load_text(text, request);
    const PhaseSeries phase = phase_series(loaded);
    demand_numbers(seed, "the deviation",
                   deviation_text(stability_table(kind, phase.phase_s, phase.tau0_s,
                                                  octave_factors(phase.phase_s.size(), kind))));
    const Analysis data = analyse(std::move(loaded), road);
    demand_numbers(seed, "the rate's table", rate_table(data.numbered, data.rate.nominal_period_s));
    demand_numbers(seed, "the summary", report_text(data));
    demand_numbers(seed, "the fit's text", fit_text(data.fit));
    demand_numbers(seed, "the fit's table", fit_csv(data.fit));
    demand_numbers(seed, "the JSON", report_json(data));
    for (const Figure& figure : report_figures(data))
      demand_numbers(seed, "a figure", standalone_svg(figure));
  } catch (const InputError&) {
  } catch (const ArgumentError&) {
  } catch (const NumericsError&) {
  } catch (const std::exception& error) {
    finding(seed, error.what());
  }
}

#ifdef __SANITIZE_ADDRESS__
constexpr double patience_s = 600.0; // with sanitizers all is some ten times slower
#else
constexpr double patience_s = 60.0;
#endif

} // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 20.0;
  std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const auto start = Clock::now();
  const auto since = [](Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
  };
  std::uint64_t logs = 0;
  double longest = 0.0;
  std::uint64_t longest_seed = seed;
  do {
    const std::clock_t begin = std::clock(); // its own time: the machine may be busy with others
    try_log(seed);
    const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (took > longest) {
      longest = took;
      longest_seed = seed;
      if (took > patience_s) finding(seed, "took too long");
    }
    ++logs;
    ++seed;
  } while (since(start) < seconds);
  std::printf("%llu logs in %.0f s without a finding; the longest took %.1f s (seed %llu)\n",
              static_cast<unsigned long long>(logs), since(start), longest,
              static_cast<unsigned long long>(longest_seed));
}
