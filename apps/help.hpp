// What `goingrate help TOPIC` explains, and the manual page.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <string_view>

namespace goingrate::apps {

/// A page of the built-in help, lines of 80 columns.
struct Topic {
  std::string_view name, about, text;
};

std::span<const Topic> help_topics();

/// The manual page of the program (roff, macros of man(7)): its commands and options as --help has
/// them, and the topics.
std::string manual_page(CLI::App& program);

} // namespace goingrate::apps
