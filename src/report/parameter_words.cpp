#include "parameter_words.hpp"

#include "markup.hpp"

#include "base/readable.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace goingrate {

namespace {

struct ParameterWords {
  std::string_view name;
  std::string_view symbol; ///< empty: the name is itself the symbol, or there is no symbol
  std::string_view meaning;
};

constexpr std::array<ParameterWords, 25> words{{
    {"T0", "T0", "period of small free swings"},
    {"epsilon", "ε", "friction"},
    {"mu", "μ", "driving torque"},
    {"phi0", "φ0", "angle at which the torque changes its sign"},
    {"lambda0", "λ0", "amplitude at the first beat"},
    {"impulse", "", "impulse of the escapement"},
    {"impulse_angle", "", "angle at which the impulse is given"},
    {"gravity_share", "", "share of gravity in the restoring torque"},
    {"quadratic_drag", "", "friction that grows as the square of the speed"},
    {"dry_friction", "", "friction that does not depend on the speed"},
    {"offset", "", "angle of the sensor from the vertical"},
    {"amplitude_scale", "", "factor of the amplitude column"},
    {"jitter_rms", "", "scatter of the sensor's times, rms"},
    {"walk_rms", "", "random walk of the times per period, rms"},
    {"drive_rms", "", "variation of the drive from period to period, rms"},
    {"slow_rms", "", "slow variation of the drive, rms"},
    {"slow_time", "", "memory of the slow variation"},
    {"amplitude_rms", "", "scatter of the amplitudes, rms"},
    {"drift", "", "change of the rate per day"},
    {"temperature", "", "change of the rate per kelvin"},
    {"pressure", "", "change of the rate per millibar"},
    {"humidity", "", "change of the rate per percent of relative humidity"},
    {"density", "", "change of the rate with the density of the air"},
    {"tide", "", "response to Moon and Sun, as a share of the theoretical one"},
    {"pi", "π", ""},
}};

std::string_view base_of(std::string_view name) { return name.substr(0, name.find('@')); }

const ParameterWords* find(std::string_view base) {
  const auto* found = std::find_if(words.begin(), words.end(),
                                   [&](const ParameterWords& w) { return w.name == base; });
  return found == words.end() ? nullptr : found;
}

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Length of a number at the beginning of `text`, with what is written directly against it.
std::size_t length_of_number(std::string_view text) {
  std::size_t end = 1;
  for (; end < text.size(); ++end) {
    const bool signs_exponent = (text[end] == '-' || text[end] == '+') && text[end - 1] == 'e';
    const bool is_point = text[end] == '.' && end + 1 < text.size() &&
                          std::isdigit(static_cast<unsigned char>(text[end + 1])) != 0;
    if (!is_of_word(text[end]) && !is_point && !signs_exponent) break;
  }
  return end;
}

// "4.2e+02" becomes "420", and "1.5e-07" becomes "1.5×10⁻⁷"; anything else stays as it is.
std::string without_letter_e(std::string_view number) {
  const std::size_t e = number.find('e');
  double value = 0.0;
  const auto read = std::from_chars(number.data(), number.data() + number.size(), value);
  if (e == std::string_view::npos || read.ptr != number.data() + number.size())
    return std::string(number);
  const auto digits = std::count_if(number.begin(), number.begin() + static_cast<std::ptrdiff_t>(e),
                                    [](char c) { return c != '.'; });
  return value < 1.0 ? typeset(number) : typeset(readable(value, static_cast<int>(digits)));
}

std::string word_in_symbols(std::string_view word) {
  if (word == "lambda") return "λ"; // not a parameter by itself
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

bool has_symbol(std::string_view name) {
  const ParameterWords* found = find(base_of(name));
  return found != nullptr && !found->symbol.empty();
}

std::string label_of(std::string_view name) {
  std::string label = symbol_of(name);
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

std::string symbol_and_name(std::string_view name) {
  std::string symbol = symbol_of(name);
  return symbol == name ? symbol : symbol + " (" + std::string(name) + ")";
}

std::string in_symbols(std::string_view expression) {
  std::string text;
  while (!expression.empty()) {
    const bool is_number = std::isdigit(static_cast<unsigned char>(expression.front())) != 0;
    const std::size_t length =
        is_number ? length_of_number(expression)
                  : static_cast<std::size_t>(
                        std::find_if_not(expression.begin(), expression.end(), is_of_word) -
                        expression.begin());
    const std::string_view part = expression.substr(0, std::max<std::size_t>(1, length));
    expression.remove_prefix(part.size());
    const bool is_typed = expression.starts_with('='); // an argument of a command
    text += is_number                 ? without_letter_e(part)
            : length > 0 && !is_typed ? word_in_symbols(part)
                                      : std::string(part);
  }
  return text;
}

std::string_view meaning_of(std::string_view name) {
  const ParameterWords* found = find(base_of(name));
  return found == nullptr ? std::string_view{} : found->meaning;
}

} // namespace goingrate
