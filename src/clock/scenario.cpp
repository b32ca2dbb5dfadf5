#include "goingrate/clock/scenario.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <sstream>
#include <toml++/toml.h>

namespace goingrate {

ClockParameters ClockEvent::applied_to(ClockParameters clock) const {
  clock.nominal_period_s = nominal_period_s.value_or(clock.nominal_period_s);
  clock.epsilon = epsilon.value_or(clock.epsilon);
  clock.mu = mu.value_or(clock.mu);
  clock.phi0 = phi0.value_or(clock.phi0);
  return clock;
}

namespace {

void check_sensor(const SensorSettings& sensor) {
  const auto not_negative = [](std::string_view name, double value) {
    if (!(value >= 0.0 && value <= 1e6)) throw ArgumentError(name, value, "between 0 and 1e6");
  };
  const auto probability = [](std::string_view name, double value) {
    if (!(value >= 0.0 && value < 1.0)) throw ArgumentError(name, value, "at least 0 and below 1");
  };
  not_negative("jitter_rms", sensor.jitter_rms_s);
  not_negative("resolution", sensor.resolution_s);
  not_negative("amplitude_rms", sensor.amplitude_rms.value_or(0.0));
  probability("missed", sensor.missed);
  probability("spurious", sensor.spurious);
}

void check_event(const ClockEvent& event, ClockParameters& clock) {
  if (event.at_period.has_value() == event.at_s.has_value())
    throw ArgumentError("event", "", "dated by at_period or by at, and not by both");
  if (event.at_period && *event.at_period < 0)
    throw ArgumentError("at_period", static_cast<double>(*event.at_period), "not below 0");
  if (event.at_s && !(*event.at_s >= 0.0)) throw ArgumentError("at", *event.at_s, "not below 0");
  clock = event.applied_to(clock);
  check(clock);
}

} // namespace

void check(const Scenario& scenario) {
  check(scenario.clock);
  if (scenario.start_amplitude &&
      !(*scenario.start_amplitude > 0.0 && *scenario.start_amplitude < 2.0))
    throw ArgumentError("start.amplitude", *scenario.start_amplitude,
                        "above 0 and below 2 (at 2 the pendulum turns over)");
  if (scenario.periods.has_value() == scenario.duration_s.has_value())
    throw ArgumentError("run", "", "given by periods or by duration, and not by both");
  if (scenario.periods && *scenario.periods < 1)
    throw ArgumentError("periods", static_cast<double>(*scenario.periods), "at least 1");
  if (scenario.duration_s && !(*scenario.duration_s > 0.0 && std::isfinite(*scenario.duration_s)))
    throw ArgumentError("duration", *scenario.duration_s, "a positive number of seconds");
  ClockParameters clock = scenario.clock;
  for (const ClockEvent& event : scenario.events)
    check_event(event, clock);
  check(scenario.drive);
  check_sensor(scenario.sensor);
}

// ---- reading ------------------------------------------------------------------------------------

namespace {

// One [section] of the file: hands out values by key and complains about keys nobody asked for.
class Section {
public:
  Section(const toml::table& table, std::string name, const std::string& file)
      : table_(table), name_(std::move(name)), file_(file) {}

  std::optional<double> number(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    if (!node->is_number()) wrong(*node, key, "a number");
    const double value = *node->value<double>();
    if (!std::isfinite(value)) wrong(*node, key, "a finite number");
    return value;
  }

  // A key of the scenario language for something that is not modelled: its neutral value is
  // accepted.
  void only_zero(std::string_view key) {
    const auto value = number(key);
    known_.pop_back(); // not offered to whoever misspells another key
    accepted_.emplace_back(key);
    if (value.value_or(0.0) != 0.0) wrong(*table_.get(key), key, "0: this is not modelled");
  }

  std::optional<std::int64_t> count(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    if (!node->is_integer()) wrong(*node, key, "a whole number");
    return *node->value<std::int64_t>();
  }

  std::optional<std::string> word(std::string_view key, const std::vector<std::string>& legal) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    const auto value = node->value<std::string>();
    if (!value || std::find(legal.begin(), legal.end(), *value) == legal.end())
      wrong(*node, key, fmt::format("\"{}\"", fmt::join(legal, "\" or \"")));
    return value;
  }

  // start.amplitude is the one key that is a number or a word.
  [[nodiscard]] bool is_text(std::string_view key) const {
    const toml::node* node = table_.get(key);
    return node != nullptr && node->is_string();
  }

  void finish() const {
    for (const auto& [key, node] : table_) {
      const auto among = [&](const std::vector<std::string>& keys) {
        return std::find(keys.begin(), keys.end(), key.str()) != keys.end();
      };
      if (!among(known_) && !among(accepted_))
        throw InputError(place(key.source()),
                         fmt::format("unknown key '{}{}'", prefix(), key.str()),
                         fmt::format("one of {}", fmt::join(known_, ", ")));
    }
  }

private:
  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
  }
  [[nodiscard]] std::string prefix() const { return name_.empty() ? "" : name_ + "."; }
  [[nodiscard]] TextPlace place(const toml::source_region& source) const {
    return {file_, source.begin.line, source.begin.column};
  }
  [[noreturn]] void wrong(const toml::node& node, std::string_view key,
                          const std::string& expected) const {
    std::ostringstream found;
    found << toml::node_view<const toml::node>(node);
    throw InputError(place(node.source()), fmt::format("{}{} = {}", prefix(), key, found.str()),
                     expected);
  }

  const toml::table& table_;
  std::string name_;
  const std::string& file_;
  std::vector<std::string> known_;    // keys that mean something
  std::vector<std::string> accepted_; // keys that may be there if they say nothing
};

void read_clock(Section section, ClockParameters& clock) {
  clock.nominal_period_s = section.number("nominal_period").value_or(clock.nominal_period_s);
  clock.epsilon = section.number("epsilon").value_or(0.0);
  clock.mu = section.number("mu").value_or(0.0);
  clock.phi0 = section.number("phi0").value_or(0.0);
  const auto escapement = section.word("escapement", {"constant-torque", "none"});
  if (escapement == "none") clock.escapement = Escapement::none;
  section.only_zero("quadratic_drag");
  section.only_zero("dry_friction");
  section.finish();
}

void read_start(Section section, Scenario& scenario) {
  if (section.is_text("amplitude")) {
    section.word("amplitude", {"stationary"});
  } else {
    scenario.start_amplitude = section.number("amplitude");
  }
  section.finish();
}

void read_run(Section section, Scenario& scenario) {
  scenario.periods = section.count("periods");
  scenario.duration_s = section.number("duration");
  section.word("method", {"auto", "direct"});
  section.finish();
}

ClockEvent read_event(Section section) {
  ClockEvent event;
  event.at_period = section.count("at_period");
  event.at_s = section.number("at");
  event.nominal_period_s = section.number("nominal_period");
  event.epsilon = section.number("epsilon");
  event.mu = section.number("mu");
  event.phi0 = section.number("phi0");
  section.finish();
  return event;
}

void read_drive(Section section, DriveVariability& drive) {
  drive.fast_rms = section.number("fast_rms").value_or(0.0);
  drive.slow_rms = section.number("slow_rms").value_or(0.0);
  drive.slow_time_s = section.number("slow_time").value_or(0.0);
  section.finish();
}

void read_sensor(Section section, SensorSettings& sensor) {
  if (section.word("edges", {"up", "both"}) == "both") sensor.edges = SensorEdges::both;
  sensor.jitter_rms_s = section.number("jitter_rms").value_or(0.0);
  sensor.resolution_s = section.number("resolution").value_or(0.0);
  sensor.missed = section.number("missed").value_or(0.0);
  sensor.spurious = section.number("spurious").value_or(0.0);
  sensor.amplitude_rms = section.number("amplitude_rms");
  section.only_zero("offset");
  section.only_zero("flag_width");
  section.finish();
}

using Reader = std::function<void(const toml::table&, const std::string&)>;

void read_events(const toml::node& node, const std::string& file, Scenario& scenario) {
  const toml::array* list = node.as_array();
  const TextPlace place{file, node.source().begin.line, node.source().begin.column};
  if (list == nullptr) throw InputError(place, "event that is no list", "[[event]] tables");
  for (const toml::node& entry : *list) {
    if (!entry.is_table()) throw InputError(place, "an event that is no table", "[[event]] tables");
    scenario.events.push_back(read_event(Section(*entry.as_table(), "event", file)));
  }
}

void read_root(const toml::table& root, const std::string& file, Scenario& scenario) {
  const std::map<std::string, std::function<void(Section)>, std::less<>> sections{
      {"clock", [&](Section s) { read_clock(std::move(s), scenario.clock); }},
      {"start", [&](Section s) { read_start(std::move(s), scenario); }},
      {"run", [&](Section s) { read_run(std::move(s), scenario); }},
      {"drive", [&](Section s) { read_drive(std::move(s), scenario.drive); }},
      {"sensor", [&](Section s) { read_sensor(std::move(s), scenario.sensor); }},
  };
  for (const auto& [key, node] : root) {
    const TextPlace place{file, key.source().begin.line, key.source().begin.column};
    if (key.str() == "event") {
      read_events(node, file, scenario);
      continue;
    }
    const auto reader = sections.find(key.str());
    if (reader == sections.end())
      throw InputError(place, fmt::format("unknown section '{}'", key.str()),
                       "[clock], [start], [run], [[event]], [drive] or [sensor]");
    if (!node.is_table())
      throw InputError(place, fmt::format("{} that is no table", key.str()),
                       fmt::format("a section [{}]", key.str()));
    reader->second(Section(*node.as_table(), std::string(key.str()), file));
  }
}

toml::table parse_toml(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw InputError({file, error.source().begin.line, error.source().begin.column},
                     fmt::format("text that is no TOML ({})", error.description()),
                     "a scenario in TOML");
  }
}

void merge(toml::table& base, const toml::table& change) {
  for (const auto& [key, node] : change) {
    toml::node* old = base.get(key.str());
    if (old != nullptr && old->is_table() && node.is_table()) {
      merge(*old->as_table(), *node.as_table());
    } else {
      node.visit([&, name = std::string(key.str())](const auto& value) {
        base.insert_or_assign(name, value);
      });
    }
  }
}

} // namespace

Scenario parse_scenario(std::string_view text, const std::string& file,
                        const std::vector<std::string>& overrides) {
  toml::table root = parse_toml(text, file);
  for (const std::string& change : overrides)
    merge(root, parse_toml(change, fmt::format("--set {}", change)));
  Scenario scenario;
  read_root(root, file, scenario);
  try {
    check(scenario);
  } catch (const ArgumentError& error) {
    throw InputError({file, 0, 0}, error.what(), "a scenario that makes sense");
  }
  return scenario;
}

} // namespace goingrate
