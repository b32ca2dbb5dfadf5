#include "usage.hpp"

#include "base/spelling.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

void add_option_names(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
}

} // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known,
                         const std::string& list) {
  const auto meant = nearest_word(word, known);
  return meant ? fmt::format("did you mean {}?", *meant) : list + " lists them";
}

std::optional<std::string> unexpected_word(const CLI::App& command, const std::string& name) {
  const auto commands = command.get_subcommands();
  // A command that passes its words on to another accepts any.
  if (!commands.empty() && commands.front()->get_prefix_command()) return {};
  const std::vector<std::string> words = command.remaining(true);
  if (words.empty()) return {};
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  const auto option = std::find_if(words.begin(), words.end(), is_option);
  if (option == words.end())
    return fmt::format("found {}, expected no more words after {}", words.front(), name);
  std::vector<std::string> known;
  if (!commands.empty()) add_option_names(*commands.front(), known);
  add_option_names(command, known);
  const std::string found = option->substr(0, option->find('='));
  return fmt::format("found {}, expected an option of {} ({})", found, name,
                     did_you_mean(found, known, name + " --help"));
}

} // namespace goingrate::apps
