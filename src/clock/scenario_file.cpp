// Scenarios from TOML text.
#include "goingrate/clock/scenario.hpp"

#include "scenario_text.hpp"

#include "base/spelling.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

namespace goingrate {

namespace {

// The words for what was expected if `found` is none of `known`.
std::string one_of(std::string_view found, const std::vector<std::string>& known) {
  return fmt::format("one of {}{}", fmt::join(known, ", "), meant_instead(found, known));
}

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

  // A list of tables like [{amplitude = 0.02, period = 900.0}]: each pair in turn.
  template <class Pair>
  std::vector<Pair> pairs(std::string_view key, std::string_view first, std::string_view second) {
    std::vector<Pair> list;
    const toml::node* node = find(key);
    if (node == nullptr) return list;
    const std::string expected = fmt::format("[{{{} = 0.01, {} = 900.0}}, ...]", first, second);
    if (!node->is_array()) wrong(*node, key, expected);
    for (const toml::node& entry : *node->as_array()) {
      if (!entry.is_table()) wrong(entry, key, expected);
      Section one(*entry.as_table(), fmt::format("{}{}", prefix(), key), file_);
      list.push_back({one.needed(first), one.needed(second)});
      one.finish();
    }
    return list;
  }

  // A list of points like [[-0.03, 0.0], [0.03, 2e-5]].
  TorqueTable points(std::string_view key) {
    TorqueTable table;
    const toml::node* node = find(key);
    if (node == nullptr) return table;
    constexpr const char* expected = "a list of [angle, torque]";
    if (!node->is_array()) wrong(*node, key, expected);
    for (const toml::node& entry : *node->as_array()) {
      const toml::array* point = entry.as_array();
      if (point == nullptr || point->size() != 2 || !(*point)[0].is_number() ||
          !(*point)[1].is_number())
        wrong(entry, key, expected);
      const double angle = *(*point)[0].value<double>(), torque = *(*point)[1].value<double>();
      if (!std::isfinite(angle) || !std::isfinite(torque)) wrong(entry, key, expected);
      table.points.push_back({angle, torque});
    }
    return table;
  }

  std::optional<std::string> text(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    if (!node->is_string()) wrong(*node, key, "a text in quotes");
    return node->value<std::string>();
  }

  double needed(std::string_view key) {
    const auto value = number(key);
    if (!value)
      throw InputError(place(table_.source()), fmt::format("{} without {}", name_, key),
                       fmt::format("{} = NUMBER", key));
    return *value;
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
      if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
        throw InputError(place(key.source()),
                         fmt::format("unknown key '{}{}'", prefix(), key.str()),
                         one_of(key.str(), known_));
    }
  }

private:
  const toml::node* find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
  }
  [[nodiscard]] std::string prefix() const { return name_.empty() ? "" : name_ + "."; }
  [[nodiscard]] TextPlace place(const toml::source_region& source) const {
    return place_of(source, file_);
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
  std::vector<std::string> known_; // keys that mean something
};

void read_clock(Section section, ClockParameters& clock) {
  clock.nominal_period_s = section.number("nominal_period").value_or(clock.nominal_period_s);
  clock.epsilon = section.number("epsilon").value_or(0.0);
  clock.mu = section.number("mu").value_or(0.0);
  clock.phi0 = section.number("phi0").value_or(0.0);
  const auto escapement =
      section.word("escapement", {"constant-torque", "single-impulse", "profile", "none"});
  for (const Escapement e : {Escapement::single_impulse, Escapement::profile, Escapement::none})
    if (escapement == name_of(e)) clock.escapement = e;
  clock.quadratic_drag = section.number("quadratic_drag").value_or(0.0);
  clock.dry_friction = section.number("dry_friction").value_or(0.0);
  clock.impulse = section.number("impulse").value_or(0.0);
  clock.impulse_angle = section.number("angle").value_or(0.0);
  clock.rising = section.points("rising");
  clock.falling = section.points("falling");
  clock.gravity_share = section.number("gravity_share").value_or(clock.gravity_share);
  clock.every = section.count("every").value_or(clock.every);
  clock.below = section.number("below").value_or(clock.below);
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
  const auto method =
      section.word("method", {"auto", "direct", "map", "averaged1", "averaged2", "rk4"});
  for (const Method m :
       {Method::direct, Method::map, Method::averaged1, Method::averaged2, Method::rk4})
    if (method == name_of(m)) scenario.method.method = m;
  scenario.method.dt = section.number("dt").value_or(scenario.method.dt);
  scenario.method.tolerance_s = section.number("tolerance");
  const auto torque = section.word("rk4_torque", {"step", "stage", "switches"});
  if (torque == "step") scenario.method.rk4_torque = Rk4Torque::per_step;
  if (torque == "switches") scenario.method.rk4_torque = Rk4Torque::at_switches;
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
  event.quadratic_drag = section.number("quadratic_drag");
  event.dry_friction = section.number("dry_friction");
  event.impulse = section.number("impulse");
  event.impulse_angle = section.number("angle");
  event.every = section.count("every");
  event.below = section.number("below");
  section.finish();
  return event;
}

// One factor per line; '#' comments and one row of names are skipped.
std::vector<double> read_series(const std::string& path) {
  std::error_code unknown;                              // a path that cannot be read is not a file
  if (!std::filesystem::is_regular_file(path, unknown)) // a device or a pipe might never end
    throw InputError({path}, "no regular file", "a file with a series of factors");
  std::ifstream in(path);
  note_input(path);
  if (!in) throw InputError({path}, "a file that cannot be opened", "a series of factors");
  std::vector<double> factors;
  bool named = false;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream text(line);
    double factor = 0.0;
    if (text >> factor && std::isfinite(factor))
      factors.push_back(factor);
    else if (!named && factors.empty())
      named = true; // one row of names
    else
      throw InputError({path, number, 1}, fmt::format("'{}'", line), "one finite number per line");
  }
  if (factors.empty()) throw InputError({path}, "no numbers", "a series of factors");
  return factors;
}

void read_drive(Section section, const std::string& file, DriveVariability& drive) {
  drive.fast_rms = section.number("fast_rms").value_or(0.0);
  drive.slow_rms = section.number("slow_rms").value_or(0.0);
  drive.slow_time_s = section.number("slow_time").value_or(0.0);
  drive.sines = section.pairs<DriveVariability::Sine>("sine", "amplitude", "period");
  if (const auto series = section.text("series")) {
    const auto path = std::filesystem::path(file).parent_path() / *series;
    drive.series = std::make_shared<const std::vector<double>>(read_series(path.string()));
  }
  section.finish();
}

void read_length(Section section, LengthChanges& length) {
  length.drift_per_day = section.number("drift_per_day").value_or(0.0);
  length.sines = section.pairs<LengthChanges::Sine>("sine", "amplitude", "period");
  length.temperature_coefficient = section.number("temperature_coefficient").value_or(0.0);
  length.compensation = section.number("compensation").value_or(0.0);
  length.compensation_lag_s = section.number("compensation_lag").value_or(0.0);
  section.finish();
}

void read_temperature(Section section, Temperature& temperature) {
  temperature.mean_c = section.number("mean").value_or(20.0);
  temperature.drift_per_day = section.number("drift_per_day").value_or(0.0);
  temperature.sines = section.pairs<Temperature::Sine>("sine", "amplitude", "period");
  section.finish();
}

void read_sensor(Section section, SensorSettings& sensor) {
  const std::map<std::string, SensorEdges> edges{{"up", SensorEdges::up},
                                                 {"both", SensorEdges::both},
                                                 {"gate", SensorEdges::gate},
                                                 {"four", SensorEdges::four}};
  if (const auto word = section.word("edges", {"up", "both", "gate", "four"}))
    sensor.edges = edges.at(*word);
  sensor.jitter_rms_s = section.number("jitter_rms").value_or(0.0);
  sensor.resolution_s = section.number("resolution").value_or(0.0);
  sensor.missed = section.number("missed").value_or(0.0);
  sensor.spurious = section.number("spurious").value_or(0.0);
  sensor.amplitude_rms = section.number("amplitude_rms");
  sensor.temperature_rms = section.number("temperature_rms");
  sensor.offset_rad = section.number("offset").value_or(0.0);
  sensor.flag_width_rad = section.number("flag_width").value_or(0.0);
  section.finish();
}

using Reader = std::function<void(const toml::table&, const std::string&)>;

void read_events(const toml::node& node, const std::string& file, Scenario& scenario) {
  const toml::array* list = node.as_array();
  const TextPlace place = place_of(node.source(), file);
  if (list == nullptr) throw InputError(place, "an event that is not a list", "[[event]] tables");
  for (const toml::node& entry : *list) {
    if (!entry.is_table()) throw InputError(place, "an event that is not a table", "[[event]] tables");
    scenario.events.push_back(read_event(Section(*entry.as_table(), "event", file)));
  }
}

const std::vector<std::string> section_names{"clock", "start",  "run",         "event",
                                             "drive", "length", "temperature", "sensor"};

void read_root(const toml::table& root, const std::string& file, Scenario& scenario) {
  const std::map<std::string, std::function<void(Section)>, std::less<>> sections{
      {"clock", [&](Section s) { read_clock(std::move(s), scenario.clock); }},
      {"start", [&](Section s) { read_start(std::move(s), scenario); }},
      {"run", [&](Section s) { read_run(std::move(s), scenario); }},
      {"drive", [&](Section s) { read_drive(std::move(s), file, scenario.drive); }},
      {"length", [&](Section s) { read_length(std::move(s), scenario.length); }},
      {"temperature", [&](Section s) { read_temperature(std::move(s), scenario.temperature); }},
      {"sensor", [&](Section s) { read_sensor(std::move(s), scenario.sensor); }},
  };
  for (const auto& [key, node] : root) {
    const TextPlace place = place_of(key.source(), file);
    if (key.str() == "event") {
      read_events(node, file, scenario);
      continue;
    }
    const auto reader = sections.find(key.str());
    if (reader == sections.end())
      throw InputError(place, fmt::format("unknown section '{}'", key.str()),
                       one_of(key.str(), section_names));
    if (!node.is_table())
      throw InputError(place, fmt::format("'{}', which is not a section", key.str()),
                       fmt::format("a section [{}]", key.str()));
    reader->second(Section(*node.as_table(), std::string(key.str()), file));
  }
}

} // namespace

Scenario parse_scenario(std::string_view text, const std::string& file,
                        const std::vector<std::string>& overrides) {
  const toml::table root = scenario_tree(text, file, overrides);
  Scenario scenario;
  read_root(root, file, scenario);
  try {
    check(scenario);
  } catch (const ArgumentError& error) {
    throw located(error, root, file);
  }
  return scenario;
}

} // namespace goingrate
