// The TOML of a scenario: the file, the options that override it, and the place of each value.
#pragma once

#include "goingrate/base/errors.hpp"

#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

namespace goingrate {

/// Parses `text` and applies the overrides ("key=value" with dotted keys). A value that is a
/// bare word (run.method=map) is text. Throws InputError if it is not TOML.
toml::table scenario_tree(std::string_view text, const std::string& file,
                          const std::vector<std::string>& overrides);

/// The place of a node of the tree: file, line and column, or the option "--set KEY=VALUE".
TextPlace place_of(const toml::source_region& source, const std::string& file);

/// The complaint of a check about a value, with the place of that value in the tree.
InputError located(const ArgumentError& error, const toml::table& root, const std::string& file);

} // namespace goingrate
