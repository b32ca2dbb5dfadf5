#include "watch_json.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace goingrate::apps {

namespace {

using Json = nlohmann::ordered_json;

constexpr double seconds_a_day = 86400.0;

Json value_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json rate_json(const std::optional<Measured>& rate) {
  if (!rate) return nullptr;
  return {{"s_per_day", rate->value * seconds_a_day},
          {"sigma", rate->sigma * seconds_a_day},
          {"blocks", rate->blocks}};
}

// By days, since a year has many hours.
std::optional<Measured> rate_of_a_year(const Going& going, double nominal_period_s,
                                       double silence_s) {
  constexpr std::size_t year_days = 365;
  return going.days().rate_over(year_days, nominal_period_s, silence_s);
}

Json blocks_json(const GoingBlocks& blocks, double nominal_period_s) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < blocks.all().size(); ++i) {
    const GoingBlock& block = blocks.all()[i];
    auto rate = blocks.rate_of(i, nominal_period_s);
    if (rate) *rate *= seconds_a_day;
    rows.push_back({block.start_s, value_or_null(rate), value_or_null(block.amplitude_rad()),
                    value_or_null(block.beat_error_s()), block.beats, block.missed,
                    block.spurious});
  }
  return {
      {"schema", "goingrate.monitor.blocks"},
      {"version", 1},
      {"block_s", blocks.length_s()},
      {"columns",
       {"start", "rate_s_per_day", "amplitude_rad", "beat_error_s", "beats", "missed", "spurious"}},
      {"rows", std::move(rows)}};
}

Json alarm_json(const AlarmRecord& alarm) {
  return {
      {"at", alarm.at_s}, {"kind", alarm.kind}, {"raised", alarm.is_raised}, {"text", alarm.text}};
}

Json now_json(const ClockWatch& watch, const std::string& name, const Instant& now) {
  const Going& going = watch.going();
  const double nominal = watch.nominal_period_s(), silence = watch.silence_s();
  constexpr double present_s = 60.0; // older values do not count as present
  Json raised = Json::array();
  for (const AlarmChange& alarm : watch.alarms().raised())
    raised.push_back(
        {{"kind", name_of(alarm.kind)}, {"at", alarm.at.to_double()}, {"text", alarm.text}});
  Json assumed = Json::array();
  for (const Assumption& assumption : watch.assumptions())
    assumed.push_back(assumption.text);
  const bool knows = going.last().has_value();
  std::optional<double> amplitude, beat_error;
  if (const auto& minutes = going.minutes().all(); minutes.size() > 1 && silence < present_s) {
    amplitude = minutes[minutes.size() - 2].amplitude_rad();
    beat_error = minutes[minutes.size() - 2].beat_error_s();
  }
  return {{"schema", "goingrate.monitor.now"},
          {"version", 1},
          {"clock", name},
          {"now", now.to_double()},
          {"last_beat", knows ? Json(going.last()->time.to_double()) : Json(nullptr)},
          {"cycle", knows ? Json(going.last()->cycle) : Json(nullptr)},
          {"beats", going.beats()},
          {"nominal_period_s", nominal > 0.0 ? Json(nominal) : Json(nullptr)},
          {"deviation_s", value_or_null(going.deviation_s(nominal))},
          {"deviation_since",
           going.first_of_run() ? Json(going.first_of_run()->time.to_double()) : Json(nullptr)},
          {"amplitude_rad", value_or_null(amplitude)},
          {"beat_error_s", value_or_null(beat_error)},
          {"rate",
           {{"ten_minutes", rate_json(going.minutes().rate_over(10, nominal, silence))},
            {"hour", rate_json(going.minutes().rate_over(60, nominal, silence))},
            {"day", rate_json(going.hours().rate_over(24, nominal, silence))},
            {"year", rate_json(rate_of_a_year(going, nominal, silence))}}},
          {"alarms", std::move(raised)},
          {"assumed", std::move(assumed)},
          {"heard", watch.heard()},
          {"acknowledged", watch.acknowledged()},
          {"lost", watch.lost()}};
}

// Appends one metric in Prometheus' text format; nothing if its value is not known.
void put(std::string& text, const char* name, const char* kind, const char* help, const Json& value,
         const std::string& labels = "") {
  if (value.is_null()) return;
  text += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n{0}{3} {4}\n", name, help, kind, labels,
                      value.dump());
}

std::string metrics_of(const Json& now) {
  std::string text;
  put(text, "goingrate_beats_total", "counter", "Beats that were numbered.", now["beats"]);
  put(text, "goingrate_acknowledged_total", "counter", "Events of this run that are on disk.",
      now["acknowledged"]);
  put(text, "goingrate_lost_total", "counter",
      "Events of this run that could not be kept while the archive could not be written.",
      now["lost"]);
  put(text, "goingrate_last_beat_seconds", "gauge", "Time of the last beat since 1970.",
      now["last_beat"]);
  put(text, "goingrate_deviation_seconds", "gauge", "The clock's error; positive: fast.",
      now["deviation_s"]);
  put(text, "goingrate_amplitude_radians", "gauge", "Amplitude of the last minute.",
      now["amplitude_rad"]);
  put(text, "goingrate_beat_error_seconds", "gauge", "Tick less tock, last minute.",
      now["beat_error_s"]);
  std::string rates;
  for (const auto& [span, rate] : now["rate"].items())
    if (!rate.is_null())
      rates += fmt::format("goingrate_rate_seconds_per_day{{over=\"{}\"}} {}\n", span,
                           rate["s_per_day"].dump());
  if (!rates.empty())
    text += "# HELP goingrate_rate_seconds_per_day Rate; positive: gaining.\n"
            "# TYPE goingrate_rate_seconds_per_day gauge\n" +
            rates;
  text += "# HELP goingrate_alarm Whether an alarm is raised.\n# TYPE goingrate_alarm gauge\n";
  for (std::size_t kind = 0; kind < alarm_kinds; ++kind) {
    const auto name = name_of(static_cast<AlarmKind>(kind));
    const bool raised = std::any_of(now["alarms"].begin(), now["alarms"].end(),
                                    [&](const Json& a) { return a["kind"] == name; });
    text += fmt::format("goingrate_alarm{{kind=\"{}\"}} {}\n", name, raised ? 1 : 0);
  }
  return text;
}

template <class Records, class Make>
std::string list_json(const char* schema, const Records& records, Make make) {
  Json rows = Json::array();
  for (auto record = records.rbegin(); record != records.rend(); ++record) // the newest first
    rows.push_back(make(*record));
  return Json{{"schema", schema}, {"version", 1}, {"rows", std::move(rows)}}.dump();
}

} // namespace

bool WatchAnswering::blocks_are_old(const Instant& now, const Going& going) const {
  constexpr double oldest_s = 60.0; // also where no minute begins because the clock has stopped
  if (!blocks_made_ || std::abs(now - *blocks_made_) >= oldest_s) return true;
  const auto& minutes = going.minutes().all();
  return !minutes.empty() && minutes.back().start_s != last_minute_;
}

const WatchAnswers& WatchAnswering::at(const Instant& now, const ClockWatch& watch) {
  const Json state = now_json(watch, name_, now);
  const auto dumped = [](const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  answers_.now = dumped(state);
  answers_.metrics = metrics_of(state);
  const Going& going = watch.going();
  if (blocks_are_old(now, going)) {
    const double nominal = watch.nominal_period_s();
    answers_.minutes = dumped(blocks_json(going.minutes(), nominal));
    answers_.hours = dumped(blocks_json(going.hours(), nominal));
    answers_.days = dumped(blocks_json(going.days(), nominal));
    blocks_made_ = now;
    if (!going.minutes().all().empty()) last_minute_ = going.minutes().all().back().start_s;
  }
  answers_.alarms = list_json("goingrate.monitor.alarms", watch.alarm_records(), alarm_json);
  answers_.breaks =
      list_json("goingrate.monitor.breaks", watch.breaks(), [](const CountBreak& gap) {
        return Json{{"at", gap.at.to_double()},
                    {"after_cycle", gap.after_cycle},
                    {"missing", gap.missing},
                    {"probability", gap.probability}};
      });
  return answers_;
}

} // namespace goingrate::apps
