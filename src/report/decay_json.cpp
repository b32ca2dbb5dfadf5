#include "json_parts.hpp"

#include "goingrate/fit/decay.hpp"

#include <fmt/format.h>
#include <utility>

namespace goingrate {

namespace {

// An open end of an interval, or an undetermined value, is null. Keys begin with `prefix`.
void put_estimate(const std::string& prefix, const DecayEstimate& estimate, Json& json) {
  json[prefix + "sigma"] = json_number(estimate.sigma);
  json[prefix + "low68"] = json_number(estimate.low68);
  json[prefix + "high68"] = json_number(estimate.high68);
  json[prefix + "low95"] = json_number(estimate.low95);
  json[prefix + "high95"] = json_number(estimate.high95);
}

} // namespace

Json decay_object(const Decay& decay) {
  Json json;
  json["amplitude_rad"] = json_number(decay.amplitude_rad);
  json["time_s"] = json_number(decay.time_s.value);
  put_estimate("time_s_", decay.time_s, json);
  json["q"] = json_number(decay.q.value);
  put_estimate("q_", decay.q, json);
  for (const auto& [when, angle] :
       {std::pair{"first", decay.first}, std::pair{"last", decay.last}}) {
    json[fmt::format("{}_amplitude_rad", when)] = json_number(angle.rad);
    json[fmt::format("{}_amplitude_rad_sigma", when)] = json_number(angle.sigma_rad);
  }
  json["q_at_amplitude"] = Json::array();
  for (const QAtAmplitude& at : decay.q_at_amplitude) {
    Json row{{"amplitude_rad", json_number(at.amplitude_rad)}, {"q", json_number(at.q.value)}};
    put_estimate("", at.q, row);
    json["q_at_amplitude"].push_back(std::move(row));
  }
  json["friction"] = decay.laws.empty() ? Json(nullptr) : Json(decay.laws.front().friction);
  json["friction_is_open"] = decay.law_is_open();
  json["friction_laws"] = Json::array();
  for (const FrictionLaw& law : decay.laws)
    json["friction_laws"].push_back(
        {{"friction", law.friction},
         {"bic", json_number(law.bic)},
         {"behind", json_number(law.behind)},
         {"T0_s", json_number(law.T0_s)},
         {"T0_s_sigma", json_number(law.T0_sigma_s)},
         {"lambda0", json_number(law.lambda0)},
         {"lambda0_sigma", json_number(law.lambda0_sigma)},
         {"epsilon", json_number(law.epsilon)},
         {"epsilon_sigma", json_number(law.epsilon_sigma)},
         {"quadratic_drag", json_number(law.quadratic_drag)},
         {"quadratic_drag_sigma", json_number(law.quadratic_drag_sigma)},
         {"dry_friction", json_number(law.dry_friction)},
         {"dry_friction_sigma", json_number(law.dry_friction_sigma)}});
  return json;
}

} // namespace goingrate
