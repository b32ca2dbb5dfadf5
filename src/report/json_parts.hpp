// What every JSON result is made with.
#pragma once

#include "goingrate/fit/decay.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace goingrate {

using Json = nlohmann::ordered_json;

/// null for a number that is not known: JSON has no NaN.
inline Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json decay_object(const Decay& decay);

inline Json json_with_schema(const char* name) { return {{"schema", name}, {"version", 1}}; }

} // namespace goingrate
