// Clocks drawn from a prior, with one jump of mu, phi0 or epsilon at a known cycle, or with a rough
// drive and amplitudes: whether the search finds what a fit that is started from the truth finds,
// whether what is stated is right, and whether what could be stated is.
//   study_prior write FOLDER LOGS SEED (jump|rough)     logs, and for each what a fit is told of it
//   study_prior score FOLDER LOGS SEED (jump|rough) [each]
// Between them `goingrate batch fit` writes FOLDER/found.jsonl and FOLDER/told.jsonl; `each` prints
// a line a log.
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/log/writing.hpp"
#include "support/prior_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
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

// In order of their names, as batch takes the files of a folder.
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
  }
}

struct Outcome {
  bool failed = false;
  double behind = 0.0; // in 2 log L, of the fit that was told the truth
  double worst = 0.0;  // |z| of what is stated
  std::string worst_name;
  bool has_twin = false;
  int could = 0, stated = 0; // parameters that the informed fit states, and of these the search's
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
    // The amplitude at rest is known to first order only: good for a start.
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
    }
    if (!stated) continue;
    const double z =
        std::abs(own->at("value").get<double>() - value) / own->at("sigma").get<double>();
    if (z <= outcome.worst) continue;
    outcome.worst = z;
    outcome.worst_name = name;
  }
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

void score(const Study& study, bool each) {
  const auto found = results_in(study.folder / "found.jsonl");
  const auto told = results_in(study.folder / "told.jsonl");
  std::size_t failed = 0, behind = 0, wrong = 0, unlisted = 0;
  int could = 0, stated = 0;
  for (std::size_t i = 0; i < study.logs; ++i) {
    const Outcome o = outcome_of(study.clock(i), found.at(i), told.at(i));
    if (each) print_each(study.seed + i, o);
    failed += o.failed ? 1 : 0;
    behind += o.behind > 1.0 ? 1 : 0;
    wrong += o.worst > 5.0 ? 1 : 0;
    unlisted += o.worst > 5.0 && !o.has_twin ? 1 : 0;
    could += o.could;
    stated += o.stated;
  }
  fmt::print("{} logs, {} without a result\n", study.logs, failed);
  fmt::print("2 log L more than 1 behind the fit from the truth: {}\n", behind);
  fmt::print("something stated more than 5 sigma off: {}, of these without a twin told: {}\n",
             wrong, unlisted);
  fmt::print("parameters that the fit from the truth knows to 5 %: {}, stated: {:.1f} %\n", could,
             100.0 * stated / std::max(1, could));
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
