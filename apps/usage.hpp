// What is wrong with the words of a command line.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate::apps {

/// "did you mean X?" for a word that is nearly one of the `known`; else that `list` lists them.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known,
                         const std::string& list);

/// An option that `command` and its subcommands do not know, or a word too many, as a message that
/// names the command `name`. It comes before what else may be wrong, which is often its
/// consequence.
std::optional<std::string> unexpected_word(const CLI::App& command, const std::string& name);

} // namespace goingrate::apps
