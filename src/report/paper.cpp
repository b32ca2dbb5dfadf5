#include "goingrate/report/paper.hpp"

#include "paper_rates.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/tables.hpp"
#include "json_parts.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

using namespace paper;

void add_times(const PaperOptions& options, const NoisyRun& noisy,
               std::vector<PaperNumber>& numbers) {
  const bool whole = options.periods == PaperOptions{}.periods;
  const double times =
      static_cast<double>(PaperOptions{}.periods) / static_cast<double>(options.periods);
  const std::string said =
      whole ? "" : fmt::format("; carried over from {} periods", options.periods);
  numbers.push_back({"time of the simulation", "Fig. 6", "1e4 s (IDL)", times * noisy.rk4_s,
                     times * noisy.map_s, "s",
                     "RK4 compiled; the return map, which is exact to rounding" + said});
  numbers.push_back({"time of the averaged equations", "Sec. VII", "~50 s", times * noisy.model_s,
                     times * noisy.model_s, "s", "closed forms, one period a step" + said});
}

std::string number_text(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.7g}", value);
}

std::string ours_text(const PaperNumber& number) {
  return number.sigma > 0.0 ? with_sigma(number.ours, number.sigma) : number_text(number.ours);
}

} // namespace

PaperResults recompute_paper(const PaperOptions& options) {
  constexpr std::int64_t least = 10000;
  if (options.periods < least)
    throw ArgumentError("periods", static_cast<double>(options.periods), "10000 or more");
  PaperResults results;
  const auto tell = [&](std::string_view what) {
    if (options.now) options.now(what);
  };
  const NoisyRun noisy = noisy_run(options);
  tell("operating points and the jump");
  add_stationary(results.numbers);
  add_jump(results.numbers);
  add_long_run(noisy, results.numbers);
  add_numerics(results.numbers);
  tell("1000 runs of the driving noise");
  const NoiseStatistics noise = noise_statistics(options);
  add_noise_statistics(noise, results.numbers);
  tell("what the paper states in words");
  add_statements(results.numbers);
  add_times(options, noisy, results.numbers);
  results.budget = budget_at_c();
  results.figures = figures(noisy, noise);
  return results;
}

std::string paper_text(const PaperResults& results) {
  std::string text = "# Hoyng's paper, computed again\n\n"
                     "| what | where | printed | by the paper's method | ours | unit | why they "
                     "differ |\n|---|---|---|---|---|---|---|\n";
  for (const PaperNumber& n : results.numbers)
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", n.what, n.where, n.printed,
                        number_text(n.by_paper), ours_text(n), n.unit, n.why);
  text += "\n## What the lasting rate of 1e-8 at the operating point C is made of\n\n| part | rate "
          "|\n|---|---|\n";
  for (const BudgetPart& part : results.budget)
    text += fmt::format("| {} | {:+.4e} |\n", part.what, part.rate);
  return text;
}

std::string paper_json(const PaperResults& results) {
  Json json = json_with_schema("goingrate.paper");
  json["numbers"] = Json::array();
  for (const PaperNumber& n : results.numbers)
    json["numbers"].push_back({{"what", n.what},
                               {"where", n.where},
                               {"printed", n.printed},
                               {"by_paper", json_number(n.by_paper)},
                               {"ours", json_number(n.ours)},
                               {"ours_sigma", json_number(n.sigma)},
                               {"unit", n.unit},
                               {"why", n.why}});
  json["budget"] = Json::array();
  for (const BudgetPart& part : results.budget)
    json["budget"].push_back({{"what", part.what}, {"rate", json_number(part.rate)}});
  return json.dump(2) + "\n";
}

} // namespace goingrate
