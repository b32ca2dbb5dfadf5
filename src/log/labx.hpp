// Measurements of CASSY Lab 2 (.labx): XML with a list of values for each quantity.
#pragma once

#include <string>
#include <string_view>

namespace goingrate {

/// Whether a text with this beginning is such a measurement.
bool is_labx(std::string_view beginning);

/// The measurement as a table: a header "quantity (unit)" for each channel that has values, fields
/// separated by tabs, one line for each value, an empty field where there is none. Channels with
/// less than half as many values as the longest are left out. Throws InputError if there is no
/// channel with values, or more than 256.
std::string table_of_labx(std::string_view text, const std::string& name);

} // namespace goingrate
