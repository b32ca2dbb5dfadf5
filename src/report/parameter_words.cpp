#include "parameter_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace goingrate {

namespace {

struct ParameterWords {
  std::string_view name;
  std::string_view symbol; ///< empty: the name is one, or there is none
  std::string_view meaning;
};

constexpr std::array<ParameterWords, 25> words{{
    {"T0", "", "period of small free swings"},
    {"epsilon", "ε", "friction"},
    {"mu", "μ", "driving torque"},
    {"phi0", "φ0", "angle at which the torque changes its sign"},
    {"lambda0", "λ0", "amplitude at the first beat"},
    {"impulse", "", "impulse of the escapement"},
    {"impulse_angle", "", "angle at which the impulse is given"},
    {"gravity_share", "", "share of gravity in the restoring torque"},
    {"quadratic_drag", "", "friction that grows as the square of the speed"},
    {"dry_friction", "", "friction that does not depend on the speed"},
    {"offset", "", "how far the sensor stands from the vertical"},
    {"amplitude_scale", "", "factor of the amplitude column"},
    {"jitter_rms", "", "scatter of the sensor's times, rms"},
    {"walk_rms", "", "random walk of the times per period, rms"},
    {"drive_rms", "", "variation of the drive from period to period, rms"},
    {"slow_rms", "", "slow variation of the drive, rms"},
    {"slow_time", "", "memory of the slow variation"},
    {"amplitude_rms", "", "scatter of the amplitudes, rms"},
    {"drift", "", "change of the rate a day"},
    {"temperature", "", "change of the rate per kelvin"},
    {"pressure", "", "change of the rate per millibar"},
    {"humidity", "", "change of the rate per percent of relative humidity"},
    {"density", "", "change of the rate with the density of the air"},
    {"tide", "", "answer to Moon and Sun, as a share of what theory says"},
    {"pi", "π", ""},
}};

std::string_view base_of(std::string_view name) { return name.substr(0, name.find('@')); }

const ParameterWords* find(std::string_view base) {
  const auto* found = std::find_if(words.begin(), words.end(),
                                   [&](const ParameterWords& w) { return w.name == base; });
  return found == words.end() ? nullptr : found;
}

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::string word_in_symbols(std::string_view word) {
  if (word == "lambda") return "λ"; // no parameter by itself
  if (word == "sqrt") return "√";
  if (word == "sigma") return "σ";
  const ParameterWords* found = find(word);
  return std::string(found != nullptr && !found->symbol.empty() ? found->symbol : word);
}

} // namespace

std::string symbol_of(std::string_view name) {
  const std::string_view base = base_of(name);
  return word_in_symbols(base) + std::string(name.substr(base.size()));
}

std::string symbol_and_name(std::string_view name) {
  std::string symbol = symbol_of(name);
  return symbol == name ? symbol : symbol + " (" + std::string(name) + ")";
}

std::string in_symbols(std::string_view expression) {
  std::string text;
  while (!expression.empty()) {
    const auto* const end = std::find_if_not(expression.begin(), expression.end(), is_of_word);
    const auto length = static_cast<std::size_t>(end - expression.begin());
    if (length == 0)
      text += expression.front();
    else
      text += word_in_symbols(expression.substr(0, length));
    expression.remove_prefix(std::max<std::size_t>(1, length));
  }
  return text;
}

std::string_view meaning_of(std::string_view name) {
  const ParameterWords* found = find(base_of(name));
  return found == nullptr ? std::string_view{} : found->meaning;
}

} // namespace goingrate
