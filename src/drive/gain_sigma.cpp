// The uncertainty of a clock's gains, from the fit that gave its parameters.
#include "goingrate/drive/drive_split.hpp"

#include "base/special_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {

// A parameter of the clock: its name in the fit, and its member.
struct ClockNumber {
  std::string_view name;
  double ClockParameters::*place;
};
constexpr std::array clock_numbers{ClockNumber{"T0", &ClockParameters::nominal_period_s},
                                   ClockNumber{"epsilon", &ClockParameters::epsilon},
                                   ClockNumber{"mu", &ClockParameters::mu},
                                   ClockNumber{"phi0", &ClockParameters::phi0}};

// The correlation of two parameters of the fit; 0 if the fit does not give it.
double correlation_of(const FitSummary& fit, const std::string& a, const std::string& b) {
  const auto at = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(fit.correlated.begin(), fit.correlated.end(), name) -
                                    fit.correlated.begin());
  };
  if (a == b) return 1.0;
  const std::size_t i = at(a), k = at(b);
  return std::max(i, k) < fit.correlation.size() ? fit.correlation[i][k] : 0.0;
}

} // namespace

double relative_gain_sigma(const FitSummary& fit, const ClockParameters& clock,
                           double frequency_hz) {
  std::vector<std::string> names;
  std::vector<double> moves; // changes of log |H| for one sigma
  const auto log_gain = [&](const ClockParameters& at) {
    const auto response = drive_response(at);
    return response ? std::log(std::abs(response->at(frequency_hz))) : not_known;
  };
  for (const ClockNumber& number : clock_numbers) {
    const FittedParameter* last = nullptr; // its value after the last event
    for (const FittedParameter& p : fit.parameters)
      if (std::string_view(p.name).substr(0, p.name.find('@')) == number.name) last = &p;
    if (last == nullptr || !(last->sigma > 0.0)) continue;
    ClockParameters up = clock, down = clock;
    up.*number.place += 0.5 * last->sigma;
    down.*number.place -= 0.5 * last->sigma;
    const double move = log_gain(up) - log_gain(down);
    if (!std::isfinite(move)) return std::numeric_limits<double>::infinity(); // at a stall
    names.push_back(last->name);
    moves.push_back(move);
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < moves.size(); ++i)
    for (std::size_t k = 0; k < moves.size(); ++k)
      variance += moves[i] * moves[k] * correlation_of(fit, names[i], names[k]);
  return std::sqrt(std::max(0.0, variance));
}

} // namespace goingrate
