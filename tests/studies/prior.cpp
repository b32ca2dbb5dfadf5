// Clocks drawn from a prior, with one jump of mu, phi0 or epsilon at a known cycle, or with a rough
// drive and amplitudes: whether the search finds the same as a fit started from the truth, whether
// its statements are right, and whether everything is stated that could be; and whether the signed
// root of the likelihood ratio at the truth, over all logs, is standard normal.
//   study_prior write FOLDER LOGS SEED (jump|rough)     logs, and what the fit of each is told
//   study_prior score FOLDER LOGS SEED (jump|rough) [each]
// prior.sh runs it. Between the two, `goingrate batch fit` writes FOLDER/found.jsonl (fits that know
// what a user would), FOLDER/told.jsonl (fits started at the truth) and FOLDER/held-I.jsonl (the
// I-th parameter, counted from 0, held at its true value); `each` prints a line per log.
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/writing.hpp"
#include "support/prior_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

namespace {

using namespace goingrate;
using Json = nlohmann::json;

struct Study {
  std::filesystem::path folder;
  std::size_t logs = 600;
  std::uint64_t seed = 1;
  bool rough = false;

  [[nodiscard]] test::DrawnClock clock(std::size_t i) const {
    test::ClockPrior prior(seed + i);
    return rough ? prior.draw_rough() : prior.draw();
  }
};

// What a fit is told, as a file of parameters.
std::string par_of(const FitOptions& options) {
  std::string text = "# goingrate par 1\n";
  for (const FitEvent& event : options.events)
    text += fmt::format("EVENT {} {}\n", event.cycle, fmt::join(event.names, ","));
  for (const auto& [name, value] : options.fixed)
    text += fmt::format("{} {:.17g} 0\n", name, value);
  for (const auto& [name, value] : options.start)
    text += fmt::format("{} {:.17g} 1\n", name, value);
  return text;
}

// The parameters that are scored: not the initial amplitude, whose truth is known to first order
// only. Where T0 is given, or nothing changes, the list is shorter.
std::vector<std::string> scored_names(const test::DrawnClock& drawn) {
  std::vector<std::string> names;
  for (const auto& [name, value] : drawn.truth)
    if (name != "lambda0" && !drawn.options.fixed.contains(name)) names.push_back(name);
  return names;
}

constexpr std::size_t largest_scored_count = 5; // T0, epsilon, mu, phi0 and the changed one

FitOptions with_one_held(const test::DrawnClock& drawn, std::size_t i) {
  FitOptions options = test::told_the_truth(drawn);
  const auto names = scored_names(drawn);
  if (i >= names.size()) return options; // batch wants a file for each log
  options.start.erase(names[i]);
  options.fixed[names[i]] = drawn.truth.at(names[i]);
  return options;
}

// Names are numbers, so that batch, which takes files by name, keeps the order of the logs.
void write(const Study& study) {
  std::filesystem::create_directories(study.folder / "logs");
  for (std::size_t i = 0; i < study.logs; ++i) {
    const test::DrawnClock drawn = study.clock(i);
    const std::string name = fmt::format("{:05}", i);
    const ClockLog log = test::simulated_log(drawn.scenario, study.seed + i);
    constexpr int decimals = 15; // of times of some hours: all that a double has
    std::ofstream(study.folder / "logs" / (name + ".csv")) << native_log_text(log, decimals);
    std::ofstream(study.folder / "logs" / (name + ".found")) << par_of(drawn.options);
    std::ofstream(study.folder / "logs" / (name + ".told")) << par_of(test::told_the_truth(drawn));
    for (std::size_t j = 0; j < largest_scored_count; ++j)
      std::ofstream(study.folder / "logs" / fmt::format("{}.held-{}", name, j))
          << par_of(with_one_held(drawn, j));
  }
}

struct Outcome {
  bool failed = false;
  double behind = 0.0; // in 2 log L, of the fit that was told the truth
  double worst = 0.0;  // |z| of what is stated
  std::string worst_name;
  bool has_twin = false;
  // Parameters that the informed fit states to 5 %, of these the search's, and of these the ones
  // with at most 1.3 times its sigma.
  int could = 0, stated = 0, sharp = 0;
  // Where several clocks are listed: of the one nearest the truth, how far its worst parameter is
  // off, and what it adds to what is stated and sharp.
  double nearest_clock = 0.0;
  int stated_of_it = 0, sharp_of_it = 0;
  std::string model;
  double p = 0.0;
};

const Json* parameter(const Json& fit, const std::string& name) {
  for (const Json& one : fit["parameters"])
    if (one["name"] == name) return &one;
  return nullptr;
}

double two_log_likelihood(const Json& fit) {
  return 2.0 * static_cast<double>(fit["correlation"]["names"].size()) -
         fit["quality"]["aic"].get<double>();
}

std::string model_of(const Json& fit) {
  const Json& model = fit["model"];
  return fmt::format("{} {}, {}, {}", model["dynamics"].get<std::string>(),
                     model["escapement"].get<std::string>(), model["friction"].get<std::string>(),
                     model["noise"].get<std::string>());
}

void judge(const test::DrawnClock& drawn, const Json& found, const Json& told, Outcome& outcome) {
  for (const auto& [name, value] : drawn.truth) {
    const Json *own = parameter(found, name), *best = parameter(told, name);
    // The initial amplitude is known to first order only: it is not scored.
    if (name == "lambda0" || own == nullptr || best == nullptr ||
        drawn.options.fixed.contains(name))
      continue;
    const auto is_known = [](const Json& p) {
      return p["value"].is_number() && p["sigma"].is_number();
    };
    const bool stated = is_known(*own) && own->at("sigma") > 0.0;
    if (is_known(*best) && best->at("sigma") < 0.05 * std::abs(value)) {
      ++outcome.could;
      outcome.stated += stated ? 1 : 0;
      outcome.sharp += stated && own->at("sigma") <= 1.3 * best->at("sigma").get<double>() ? 1 : 0;
    }
    if (!stated) continue;
    const double z =
        std::abs(own->at("value").get<double>() - value) / own->at("sigma").get<double>();
    if (z <= outcome.worst) continue;
    outcome.worst = z;
    outcome.worst_name = name;
  }
}

// What one of the listed clocks says: its worst |z|, and which parameters it states of those that
// the informed fit knows to 5 % and the search does not state.
struct ListedClock {
  double worst = 0.0;
  int stated = 0, sharp = 0;
};

ListedClock listed_clock(const test::DrawnClock& drawn, const Json& clock, const Json& found,
                         const Json& told) {
  ListedClock listed;
  for (const auto& [name, value] : drawn.truth) {
    const Json *own = parameter(found, name), *best = parameter(told, name);
    if (name == "lambda0" || own == nullptr || best == nullptr || !clock["sigma"].contains(name) ||
        !clock["sigma"][name].is_number())
      continue;
    const double sigma = clock["sigma"][name];
    listed.worst =
        std::max(listed.worst, std::abs(clock["parameters"][name].get<double>() - value) / sigma);
    if ((*own)["value"].is_number() || !(*best)["value"].is_number() ||
        !(best->at("sigma") < 0.05 * std::abs(value)))
      continue;
    ++listed.stated;
    listed.sharp += sigma <= 1.3 * best->at("sigma").get<double>() ? 1 : 0;
  }
  return listed;
}

void judge_listed(const test::DrawnClock& drawn, const Json& found, const Json& told,
                  Outcome& outcome) {
  ListedClock nearest = listed_clock(drawn, found["likeliest_twin"], found, told);
  for (const Json& twin : found["twins"]) {
    const ListedClock other = listed_clock(drawn, twin, found, told);
    if (other.worst < nearest.worst) nearest = other;
  }
  outcome.nearest_clock = nearest.worst;
  outcome.stated_of_it = nearest.stated;
  outcome.sharp_of_it = nearest.sharp;
}

Outcome outcome_of(const test::DrawnClock& drawn, const Json& found, const Json& told) {
  Outcome outcome;
  outcome.failed = !found.contains("parameters") || !told.contains("parameters");
  if (outcome.failed) return outcome;
  outcome.behind = two_log_likelihood(told) - two_log_likelihood(found);
  outcome.model = model_of(found) + " / " + model_of(told);
  outcome.p =
      found["quality"]["p_value"].is_number() ? found["quality"]["p_value"].get<double>() : 0.0;
  outcome.has_twin = !found["twins"].empty();
  judge(drawn, found, told, outcome);
  if (outcome.has_twin) judge_listed(drawn, found, told, outcome);
  return outcome;
}

std::vector<Json> results_in(const std::filesystem::path& batch) {
  std::ifstream file(batch);
  std::string line;
  std::getline(file, line); // of the batch itself
  std::vector<Json> results;
  while (std::getline(file, line))
    results.push_back(Json::parse(line)["result"]);
  return results;
}

void print_each(std::uint64_t seed, const Outcome& o) {
  fmt::print("{}: behind {:.2f}, worst {} {:.1f} sigma, stated {}/{}, p {:.2g}{}  {}\n", seed,
             o.behind, o.worst_name, o.worst, o.stated, o.could, o.p,
             o.failed     ? ", no fit"
             : o.has_twin ? ", twin"
                          : "",
             o.model);
}

using Roots = std::map<std::string, std::vector<double>>; // by parameter; a changed one as "after"

// (value - truth) / |value - truth| * sqrt(2 log L(best) - 2 log L(best with the truth held)).
Roots signed_roots(const Study& study, const std::vector<Json>& found,
                   const std::vector<Json>& told) {
  std::vector<std::vector<Json>> held;
  for (std::size_t j = 0; j < largest_scored_count; ++j)
    held.push_back(results_in(study.folder / fmt::format("held-{}.jsonl", j)));
  Roots roots;
  for (std::size_t i = 0; i < study.logs; ++i) {
    const test::DrawnClock drawn = study.clock(i);
    const auto names = scored_names(drawn);
    for (std::size_t j = 0; j < names.size(); ++j) {
      const Json& at_truth = held[j].at(i);
      if (!at_truth.contains("parameters") || !told[i].contains("parameters")) continue;
      const bool search_wins = found[i].contains("parameters") &&
                               two_log_likelihood(found[i]) > two_log_likelihood(told[i]);
      const Json& best = search_wins ? found[i] : told[i];
      const Json* own = parameter(best, names[j]);
      if (own == nullptr || !own->at("value").is_number()) continue;
      const double gain = two_log_likelihood(best) - two_log_likelihood(at_truth);
      roots[names[j].ends_with("@1") ? "after" : names[j]].push_back(
          std::copysign(std::sqrt(std::max(0.0, gain)),
                        own->at("value").get<double>() - drawn.truth.at(names[j])));
    }
  }
  return roots;
}

// Kolmogorov and Smirnov's chance of a larger distance from the standard normal distribution.
double chance_if_normal(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double below = 0.5 * std::erfc(-values[i] / std::numbers::sqrt2);
    distance = std::max(
        {distance, below - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - below});
  }
  constexpr int terms = 100; // of a series that ends far earlier for any distance of interest
  double chance = 0.0;
  for (int k = 1; k <= terms; ++k)
    chance += (k % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * n * distance * distance);
  return std::clamp(chance, 0.0, 1.0);
}

void print_roots(const Roots& roots) {
  fmt::print("signed root of the likelihood ratio at the truth, of all logs\n");
  for (const auto& [name, values] : roots) {
    const auto n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    const double square = std::inner_product(values.begin(), values.end(), values.begin(), 0.0) / n;
    const auto within =
        std::count_if(values.begin(), values.end(), [](double z) { return std::abs(z) < 1.0; });
    fmt::print("  {:8} {:4} logs, mean {:+.2f} +- {:.2f}, sd {:.2f}, 68 % hold {:.2f}, "
               "p of a normal law {:.2g}\n",
               name, values.size(), mean, 1.0 / std::sqrt(n), std::sqrt(square - mean * mean),
               static_cast<double>(within) / n, chance_if_normal(values));
  }
}

void score(const Study& study, bool each) {
  const auto found = results_in(study.folder / "found.jsonl");
  const auto told = results_in(study.folder / "told.jsonl");
  std::size_t failed = 0, behind = 0, wrong = 0, unlisted = 0, listed = 0, lost = 0;
  int stated_by_list = 0, sharp_by_list = 0;
  int could = 0, stated = 0, sharp = 0;
  for (std::size_t i = 0; i < study.logs; ++i) {
    const Outcome o = outcome_of(study.clock(i), found.at(i), told.at(i));
    if (each) print_each(study.seed + i, o);
    failed += o.failed ? 1 : 0;
    behind += o.behind > 1.0 ? 1 : 0;
    wrong += o.worst > 5.0 ? 1 : 0;
    unlisted += o.worst > 5.0 && !o.has_twin ? 1 : 0;
    listed += o.has_twin ? 1 : 0;
    lost += o.nearest_clock > 5.0 ? 1 : 0;
    stated_by_list += o.stated_of_it;
    sharp_by_list += o.sharp_of_it;
    could += o.could;
    stated += o.stated;
    sharp += o.sharp;
  }
  fmt::print("{} logs, {} without a result\n", study.logs, failed);
  fmt::print("2 log L more than 1 behind the fit from the truth: {}\n", behind);
  fmt::print("something stated more than 5 sigma off: {}, of these with no twin listed: {}\n",
             wrong, unlisted);
  fmt::print("logs of which several clocks are listed: {}, none of them within 5 sigma: {}\n", listed,
             lost);
  const auto percent = [&](int count) { return 100.0 * count / std::max(1, could); };
  fmt::print("parameters that the fit from the truth knows to 5 %: {}, stated: {:.1f} %, "
             "with at most 1.3 times its sigma: {:.1f} %\n",
             could, percent(stated), percent(sharp));
  fmt::print("  stated, or of the listed clock nearest the truth: {:.1f} %, "
             "with at most 1.3 times its sigma: {:.1f} %\n",
             percent(stated + stated_by_list), percent(sharp + sharp_by_list));
  print_roots(signed_roots(study, found, told));
}

} // namespace

int main(int count, char** words) {
  if (count < 6) return 2;
  const std::string what = words[1];
  const Study study{words[2], static_cast<std::size_t>(std::atoi(words[3])),
                    static_cast<std::uint64_t>(std::atoll(words[4])),
                    std::string(words[5]) == "rough"};
  if (what == "write")
    write(study);
  else
    score(study, count > 6 && std::string(words[6]) == "each");
}
