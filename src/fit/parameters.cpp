#include "parameters.hpp"

#include <fmt/format.h>

namespace goingrate::timing_model {

namespace {

std::string_view base_name(Quantity quantity, Escapement escapement) {
  const bool impulse = escapement == Escapement::single_impulse;
  switch (quantity) {
  case Quantity::T0:
    return "T0";
  case Quantity::epsilon:
    return "epsilon";
  case Quantity::mu:
    return impulse ? "impulse" : "mu";
  case Quantity::phi0:
    return impulse ? "impulse_angle" : "phi0";
  case Quantity::quadratic_drag:
    return "quadratic_drag";
  case Quantity::dry_friction:
    return "dry_friction";
  case Quantity::gravity_share:
    return "gravity_share";
  case Quantity::lambda0:
    return "lambda0";
  case Quantity::offset:
    return "offset";
  case Quantity::amplitude_scale:
    return "amplitude_scale";
  case Quantity::jitter_rms:
    return "jitter_rms";
  case Quantity::walk_rms:
    return "walk_rms";
  case Quantity::drive_rms:
    return "drive_rms";
  case Quantity::slow_rms:
    return "slow_rms";
  case Quantity::slow_time:
    return "slow_time";
  case Quantity::amplitude_rms:
    return "amplitude_rms";
  case Quantity::moment:
    return "moment";
  case Quantity::late_leap:
    return "late_leap";
  case Quantity::amplitude_leap:
    return "amplitude_leap";
  case Quantity::term:
    break;
  }
  return "term";
}

} // namespace

std::string Parameters::name_of(const Slot& slot) const {
  if (slot.quantity == Quantity::term) return term_names[slot.term];
  const auto base = base_name(slot.quantity, escapement);
  return slot.event == 0 ? std::string(base) : fmt::format("{}@{}", base, slot.event);
}

void Parameters::add(Slot slot) {
  if (slot.free) slot.index = free_count++;
  slots.push_back(slot);
}

} // namespace goingrate::timing_model
