#include "goingrate/fit/par_file.hpp"

#include "fit_setup.hpp"

#include "log/fields.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <utility>

namespace goingrate {

using timing_model::as_torque;

namespace {

constexpr std::string_view first_line = "# goingrate par 1";

constexpr std::array<std::pair<std::string_view, FitDynamics>, 4> dynamics_words{
    {{"averaged1", FitDynamics::averaged1},
     {"averaged2", FitDynamics::averaged2},
     {"map", FitDynamics::map},
     {"auto", FitDynamics::automatic}}};

constexpr std::array<std::pair<std::string_view, FitNoise>, 5> noise_words{
    {{"jitter", FitNoise::jitter},
     {"drive", FitNoise::drive},
     {"both", FitNoise::both},
     {"slow", FitNoise::slow},
     {"auto", FitNoise::automatic}}};

constexpr std::array<Escapement, 3> escapements{Escapement::constant_torque,
                                                Escapement::single_impulse, Escapement::none};

template <class Words, class Value>
bool set_by_word(const Words& words, std::string_view word, Value& value) {
  const auto at = std::find_if(words.begin(), words.end(),
                               [word](const auto& entry) { return entry.first == word; });
  if (at != words.end()) value = at->second;
  return at != words.end();
}

template <class Words, class Value>
std::string_view word_of(const Words& words, const Value& value) {
  const auto at = std::find_if(words.begin(), words.end(),
                               [&](const auto& entry) { return entry.second == value; });
  return at == words.end() ? "auto" : at->first;
}

// The range of a parameter's values, and its other properties.
struct Known {
  std::string_view name;
  enum Range { any, not_negative, positive } range;
  bool changes = false;       // at events
  bool only_if_named = false; // not fitted unless asked for
};

constexpr std::array<Known, 23> known_parameters{{
    {"T0", Known::positive, true},
    {"epsilon", Known::positive, true},
    {"mu", Known::not_negative, true},
    {"phi0", Known::positive, true},
    {"impulse", Known::not_negative, true},
    {"impulse_angle", Known::any, true},
    {"lambda0", Known::positive},
    {"quadratic_drag", Known::not_negative, false, true},
    {"dry_friction", Known::not_negative, false, true},
    {"gravity_share", Known::any, false, true},
    {"offset", Known::any, false, true},
    {"temperature", Known::any, false, true},
    {"pressure", Known::any, false, true},
    {"humidity", Known::any, false, true},
    {"density", Known::any, false, true},
    {"drift", Known::any, false, true},
    {"tide", Known::any, false, true},
    {"jitter_rms", Known::positive},
    {"walk_rms", Known::positive},
    {"drive_rms", Known::positive},
    {"slow_rms", Known::positive},
    {"slow_time", Known::positive},
    {"amplitude_rms", Known::positive},
}};

std::string_view base_of(std::string_view name) { return name.substr(0, name.find('@')); }

const Known* find_known(std::string_view name) {
  const auto at = std::find_if(known_parameters.begin(), known_parameters.end(),
                               [&](const Known& known) { return known.name == base_of(name); });
  const bool fits = at != known_parameters.end() && (base_of(name) == name || at->changes);
  return fits ? &*at : nullptr;
}

std::string known_names(bool changing_only) {
  std::string list;
  for (const Known& known : known_parameters)
    if (known.changes || !changing_only)
      list += fmt::format("{}{}", list.empty() ? "" : ", ", known.name);
  return list;
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stop != text.data() + text.size()) return {};
  return number;
}

class ParReader {
public:
  explicit ParReader(const std::string& file) : file_(file) {}

  ParFile read(std::string_view text) {
    while (!text.empty() || line_ == 0) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      ++line_;
      if (line_ == 1 && line != first_line)
        throw InputError({file_, 1, 1}, shown(line), fmt::format("'{}'", first_line));
      read_line(line);
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    for (const auto& [name, where] : changes_)
      check_change(name, where);
    for (const Prior& prior : result_.options.priors)
      if (result_.options.fixed.contains(prior.name))
        throw InputError(result_.parameter_places[prior.name], shown(prior.name) + " held",
                         "flag 1, since it has a PRIOR");
    return std::move(result_);
  }

private:
  void read_line(std::string_view line) {
    line = line.substr(0, line.find('#'));
    split_fields(line, ' ', fields_);
    end_column_ = line.size() + 1;
    if (fields_.empty()) return;
    const std::string_view item = fields_[0].text;
    if (item == "EVENT") return read_event();
    if (item == "PRIOR") return read_prior();
    if (item == "DYNAMICS") return read_word(set_dynamics, "averaged1, averaged2, map or auto");
    if (item == "NOISE") return read_word(set_noise, "jitter, drive, both, slow or auto");
    if (item == "ESCAPEMENT")
      return read_word(set_escapement, "constant-torque, single-impulse, none or auto");
    read_parameter();
  }

  [[nodiscard]] TextPlace place(std::size_t field) const {
    return {file_, line_, field < fields_.size() ? fields_[field].column : end_column_};
  }
  [[noreturn]] void refuse(std::size_t field, const std::string& expected) const {
    throw InputError(place(field),
                     field < fields_.size() ? shown(fields_[field].text) : "the end of the line",
                     expected);
  }
  std::string_view required(std::size_t field, const std::string& expected) const {
    if (field >= fields_.size()) refuse(field, expected);
    return fields_[field].text;
  }
  void end_at(std::size_t field) const {
    if (field < fields_.size()) refuse(field, "the end of the line");
  }
  double number(std::size_t field, const std::string& expected) const {
    const auto value = parse_number(required(field, expected));
    if (!value) refuse(field, expected);
    return *value;
  }
  // Each item may be given only once, because one of two values would be ignored.
  void once(const std::string& item) {
    if (!seen_.insert(item).second) refuse(0, fmt::format("one line of {} only", item));
  }

  void read_word(bool (*set)(FitOptions&, std::string_view), const std::string& expected) {
    once(std::string(fields_[0].text));
    if (!set(result_.options, required(1, expected))) refuse(1, expected);
    end_at(2);
  }

  void read_event() {
    auto& events = result_.options.events;
    const std::string expected = events.empty()
                                     ? "the number of a cycle"
                                     : "the number of a cycle after that of the EVENT before";
    FitEvent event;
    std::string_view when = required(1, expected);
    event.at_crossing = !when.starts_with('~');
    if (!event.at_crossing) when.remove_prefix(1);
    const auto cycle = whole_number(when);
    if (!cycle || (!events.empty() && *cycle <= events.back().cycle)) refuse(1, expected);
    event.cycle = *cycle;
    std::vector<Field> names;
    split_fields(required(2, "the names of what changes"), ',', names);
    for (const Field& field : names) {
      const Known* known = find_known(field.text);
      if (known == nullptr || !known->changes || known->name != field.text)
        refuse(2, "a list, without blanks, of " + known_names(true));
      if (std::count(event.names.begin(), event.names.end(), field.text) > 0)
        refuse(2, "each name once");
      event.names.emplace_back(field.text);
    }
    end_at(3);
    events.push_back(std::move(event));
    result_.event_places.push_back(place(1));
  }

  void read_prior() {
    Prior prior;
    prior.name = name_at(1);
    once("PRIOR " + prior.name);
    prior.value = value_at(2, prior.name, false);
    prior.sigma = number(3, "a sigma above 0");
    if (!(prior.sigma > 0.0)) refuse(3, "a sigma above 0");
    end_at(4);
    result_.options.priors.push_back(std::move(prior));
  }

  void read_parameter() {
    const std::string name = name_at(0);
    once(name);
    const std::string_view flag = required(2, "0 (held) or 1 (fitted)");
    if (flag != "0" && flag != "1") refuse(2, "0 (held) or 1 (fitted)");
    const bool fitted = flag == "1";
    const bool known = !fitted || fields_[1].text != "-";
    if (known)
      (fitted ? result_.options.start : result_.options.fixed)[name] = value_at(1, name, fitted);
    if (fitted && find_known(name)->only_if_named) result_.options.freed.push_back(name);
    if (fields_.size() > 3 && !(number(3, "a sigma or nothing") >= 0.0))
      refuse(3, "a sigma or nothing");
    end_at(4);
    result_.parameter_places[name] = place(0);
  }

  std::string name_at(std::size_t field) {
    const std::string expected =
        (field == 0 ? "EVENT, PRIOR, DYNAMICS, ESCAPEMENT, NOISE or one of " : "one of ") +
        known_names(false);
    const std::string name(required(field, expected));
    if (find_known(name) == nullptr) refuse(field, expected);
    if (base_of(name) != name) changes_.emplace_back(name, place(field));
    return name;
  }

  double value_at(std::size_t field, const std::string& name, bool fitted) const {
    const Known& known = *find_known(name);
    // Torque is searched for by its logarithm, except where it changes and may be cut off.
    const bool by_logarithm = fitted && name == known.name && as_torque(name) == "mu";
    const auto range = by_logarithm ? Known::positive : known.range;
    const std::string expected = fmt::format("a number{}{}",
                                             range == Known::any            ? ""
                                             : range == Known::not_negative ? " not below 0"
                                                                            : " above 0",
                                             fitted ? ", or - if none is known" : "");
    const double value = number(field, expected);
    if (value < 0.0 ? range != Known::any : value == 0.0 && range == Known::positive)
      refuse(field, expected);
    return value;
  }

  void check_change(const std::string& name, const TextPlace& where) const {
    const auto& events = result_.options.events;
    const auto k = whole_number(std::string_view(name).substr(base_of(name).size() + 1));
    const auto names_it = [&](const std::string& n) {
      return as_torque(n) == as_torque(base_of(name));
    };
    if (k && *k >= 1 && *k <= static_cast<std::int64_t>(events.size())) {
      const auto& names = events[static_cast<std::size_t>(*k - 1)].names;
      if (std::any_of(names.begin(), names.end(), names_it)) return;
    }
    throw InputError(where, shown(name), "a name that the EVENT of this number has");
  }

  const std::string& file_;
  ParFile result_;
  std::vector<Field> fields_;
  std::size_t line_ = 0, end_column_ = 1;
  std::set<std::string> seen_;
  std::vector<std::pair<std::string, TextPlace>> changes_; // parameters of events
};

std::string_view noise_word(const FitSummary& fit, const FitOptions& options) {
  if (options.noise != FitNoise::automatic) return word_of(noise_words, options.noise);
  const ModelChoice& model = fit.model;
  if (model.walk) return word_of(noise_words, FitNoise::automatic); // it has no word of its own
  if (model.slow) return word_of(noise_words, FitNoise::slow);
  if (!model.drive) return word_of(noise_words, FitNoise::jitter);
  return word_of(noise_words, model.jitter ? FitNoise::both : FitNoise::drive);
}

// A parameter that the model itself holds (a jitter at rounding) is not the user's choice: the
// model holds it again.
bool belongs(const FittedParameter& p, const FitOptions& options) {
  return p.status != ParameterStatus::fixed || options.fixed.contains(p.name);
}

std::string parameter_line(const FittedParameter& p) {
  std::string line = p.status == ParameterStatus::undetermined
                         ? fmt::format("{:<14} - 1", p.name)
                         : fmt::format("{:<14} {:.17g} {}", p.name, p.value,
                                       p.status == ParameterStatus::fixed ? 0 : 1);
  if (std::isfinite(p.sigma)) line += fmt::format(" {:.17g}", p.sigma);
  if (!p.unit.empty()) line += "   # " + p.unit;
  return line + "\n";
}

} // namespace

bool set_dynamics(FitOptions& options, std::string_view word) {
  return set_by_word(dynamics_words, word, options.dynamics);
}

bool set_noise(FitOptions& options, std::string_view word) {
  return set_by_word(noise_words, word, options.noise);
}

bool set_escapement(FitOptions& options, std::string_view word) {
  if (word == "auto") {
    options.escapement.reset();
    return true;
  }
  const auto at = std::find_if(escapements.begin(), escapements.end(),
                               [word](Escapement e) { return name_of(e) == word; });
  if (at != escapements.end()) options.escapement = *at;
  return at != escapements.end();
}

std::string par_text(const FitSummary& fit, const FitOptions& options, std::int64_t first_cycle) {
  const std::string_view dynamics = options.dynamics == FitDynamics::automatic
                                        ? name_of(fit.dynamics)
                                        : word_of(dynamics_words, options.dynamics);
  std::string text =
      fmt::format("{}\n# NAME VALUE FLAG SIGMA; flag 1: fitted, the search starts at VALUE (-: not "
                  "known); 0: held\nDYNAMICS {}\nESCAPEMENT {}\nNOISE {}\n",
                  first_line, dynamics, name_of(fit.model.escapement), noise_word(fit, options));
  for (const FitEvent& event : fit.events)
    text += fmt::format("EVENT {}{} {}\n", event.has_known_moment() ? "" : "~",
                        event.cycle + first_cycle, fmt::join(event.names, ","));
  for (const Prior& prior : options.priors)
    text += fmt::format("PRIOR {} {:.17g} {:.17g}\n", prior.name, prior.value, prior.sigma);
  for (const FittedParameter& p : fit.parameters)
    if (belongs(p, options)) text += parameter_line(p);
  return text;
}

ParFile parse_par(std::string_view text, const std::string& file) {
  return ParReader(file).read(text);
}

void drop_partial_start(FitOptions& options) {
  if (!timing_model::names_without_start(options).empty()) options.start.clear();
}

std::vector<std::string> parameter_names() {
  std::vector<std::string> names;
  for (const Known& known : known_parameters)
    names.emplace_back(known.name);
  return names;
}

std::vector<std::string> optional_parameter_names() {
  std::vector<std::string> names;
  for (const Known& known : known_parameters)
    if (known.only_if_named) names.emplace_back(known.name);
  return names;
}

} // namespace goingrate
