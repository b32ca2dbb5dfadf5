#include "goingrate/report/error_budget_report.hpp"

#include "json_parts.hpp"

#include "base/scaled_time.hpp"

#include <fmt/format.h>

namespace goingrate {

namespace {

// The meaning of a scenario's key, and the unit in which its value is shown.
std::string named(const std::string& key) {
  if (key == "clock.epsilon") return "friction ε (Q = 1/2ε), the swing kept by the drive";
  if (key == "amplitude") return "amplitude, rad, by the drive";
  return key;
}

std::string value(const std::string& key, double size) {
  if (key == "clock.epsilon") return fmt::format("{:.3g} (Q {:.0f})", size, 0.5 / size);
  return fmt::format("{:.3g}", size);
}

} // namespace

std::string error_budget_text(const ErrorBudget& budget, const std::vector<Requirement>& needed,
                              double most_s) {
  const double all = budget.all_s();
  std::string text =
      fmt::format("The error of this clock within {:.3g} days, once regulated, rms\n",
                  budget.after_s / seconds_per_day);
  for (const ErrorPart& part : budget.parts)
    text += fmt::format("  {:<34} {:.3g} s\n", part.cause, part.rms_s);
  text += fmt::format("  {:<34} {:.3g} s\n", "all together", all);
  text +=
      fmt::format("It {} {:.3g} s. {}:\n", all <= most_s ? "is below" : "is above", most_s,
                  all <= most_s ? "Any one of these may go as far as its limit, all else unchanged"
                                : "To get below that, change one of these to its limit, all else "
                                  "unchanged");
  text += fmt::format("  {:<52} {:<20} {}\n", "", "now", "limit");
  for (const Requirement& one : needed)
    text += fmt::format("  {:<52} {:<20} {}\n", named(one.key), value(one.key, one.present),
                        one.limit ? value(one.key, *one.limit) +
                                        (one.stops ? " (no steady swing beyond)" : "")
                        : all <= most_s ? "none in the range tried"
                                        : "not by this alone");
  if (all <= most_s) return text;
  const double share = budget.share_below(most_s);
  text += fmt::format("Or all the causes together, to {:.3g} of what they are:\n", share);
  const auto row = [&](const std::string& key, double size) {
    text +=
        fmt::format("  {:<52} {:<20} {}\n", named(key), value(key, size), value(key, share * size));
  };
  for (const ErrorPart& part : budget.parts) {
    row(part.key, part.size);
    if (part.key != "length.temperature_coefficient") continue;
    // The effect of temperature is proportional to the sum of the rod's and its compensation's.
    for (const Requirement& one : needed)
      if (one.key == "length.compensation") row(one.key, one.present);
  }
  return text;
}

std::string error_budget_json(const ErrorBudget& budget, const std::vector<Requirement>& needed,
                              double most_s) {
  Json json = json_with_schema("goingrate.error_budget");
  json["after_s"] = budget.after_s;
  json["most_s"] = most_s;
  json["error_s"] = json_number(budget.all_s());
  json["share_below"] = json_number(budget.share_below(most_s));
  json["parts"] = Json::array();
  for (const ErrorPart& part : budget.parts)
    json["parts"].push_back({{"cause", part.cause},
                             {"key", part.key},
                             {"size", json_number(part.size)},
                             {"rms_s", json_number(part.rms_s)}});
  json["requirements"] = Json::array();
  for (const Requirement& one : needed)
    json["requirements"].push_back({{"key", one.key},
                                    {"present", json_number(one.present)},
                                    {"limit", one.limit ? json_number(*one.limit) : Json(nullptr)},
                                    {"stops", one.stops}});
  return json.dump(1) + '\n';
}

} // namespace goingrate
