#include "words.hpp"

#include "base/spelling.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

namespace goingrate::apps {

namespace {

// CLI11 stores a name with each check of an option. Checks made here list their words in it.
constexpr std::string_view offered = "offers\n";

std::vector<CLI::Validator> checks_of(CLI::Option& option) {
  std::vector<CLI::Validator> checks;
  try {
    for (int i = 0;; ++i) // CLI11 does not say how many there are
      checks.push_back(*option.get_validator(i));
  } catch (const CLI::OptionNotFound&) {
    return checks;
  }
}

bool is_visible(const CLI::App* app) { return !app->get_group().empty(); }

std::vector<std::string> commands_of(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    if (is_visible(command)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty())
      for (const std::string& name : option->get_lnames())
        names.push_back("--" + name);
  return names;
}

CLI::Option* option_named(CLI::App& program, CLI::App& command, const std::string& name) {
  CLI::Option* option = command.get_option_no_throw(name);
  return option != nullptr ? option : program.get_option_no_throw(name);
}

// The state after some words of a command line: the command they are in, and the option, if any,
// that still needs values.
struct Position {
  CLI::App* command;
  CLI::Option* waiting = nullptr;
  int values_missing = 0; // of them at least `values_needed`
  int values_needed = 0;
};

void pass(CLI::App& program, Position& at, const std::string& word) {
  if (at.values_missing > 0 && (at.values_needed > 0 || !word.starts_with('-'))) {
    --at.values_needed;
    if (--at.values_missing == 0) at.waiting = nullptr;
    return;
  }
  const auto named =
      at.command->get_subcommands([&](CLI::App* command) { return command->get_name() == word; });
  if (!named.empty()) {
    at.command = named.front();
    return;
  }
  if (!word.starts_with('-') || word.find('=') != std::string::npos) return;
  CLI::Option* option = option_named(program, *at.command, word);
  if (option == nullptr || option->get_items_expected_max() == 0) return;
  at.waiting = option;
  constexpr int longest_list = 10; // values: a list may have no end
  at.values_needed = option->get_items_expected_min();
  at.values_missing = option->get_items_expected_max() < longest_list
                          ? option->get_items_expected_max()
                          : at.values_needed;
}

// The words of `all` that begin with `begun`, each with `kept` put in front.
std::vector<std::string> beginning_with(std::string_view begun, const std::vector<std::string>& all,
                                        const std::string& kept = "") {
  std::vector<std::string> some;
  for (const std::string& word : all)
    if (word.starts_with(begun)) some.push_back(kept + word);
  return some;
}

// Completes the last word of a list separated by commas.
std::vector<std::string> values_of(CLI::Option& option, const std::string& typed,
                                   std::string kept) {
  const std::size_t comma = typed.rfind(',');
  const std::size_t from = comma == std::string::npos ? 0 : comma + 1;
  kept += typed.substr(0, from);
  return beginning_with(std::string_view(typed).substr(from), words_of(option), kept);
}

} // namespace

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string list = fmt::format("{}", fmt::join(words, ","));
  const std::string name = fmt::format("{}{}", offered, fmt::join(words, "\n"));
  return {[words = std::move(words)](std::string& text) {
            if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
            return fmt::format("found {}, expected one of {}{}", text, fmt::join(words, ", "),
                               meant_instead(text, words));
          },
          "{" + list + "}", name};
}

CLI::Option* offers(CLI::Option* option, const std::vector<std::string>& words) {
  return option->check({[](std::string&) { return std::string(); }, "",
                        fmt::format("{}{}", offered, fmt::join(words, "\n"))});
}

std::vector<std::string> words_of(CLI::Option& option) {
  std::vector<std::string> words;
  for (const CLI::Validator& check : checks_of(option)) {
    if (!check.get_name().starts_with(offered)) continue;
    std::istringstream list(check.get_name().substr(offered.size()));
    for (std::string word; std::getline(list, word);)
      words.push_back(word);
  }
  return words;
}

std::vector<std::string> completions(CLI::App& program, std::vector<std::string> words) {
  if (words.empty()) words.emplace_back();
  const std::string typed = std::move(words.back());
  words.pop_back();
  Position at{&program};
  for (const std::string& word : words)
    pass(program, at, word);
  if (at.waiting != nullptr) return values_of(*at.waiting, typed, "");
  const std::size_t equals = typed.find('=');
  if (typed.starts_with("--") && equals != std::string::npos) {
    CLI::Option* option = option_named(program, *at.command, typed.substr(0, equals));
    if (option == nullptr) return {};
    return values_of(*option, typed.substr(equals + 1), typed.substr(0, equals + 1));
  }
  if (typed.starts_with('-')) {
    std::vector<std::string> names = options_of(*at.command);
    if (at.command != &program)
      for (std::string& name : options_of(program))
        if (std::find(names.begin(), names.end(), name) == names.end())
          names.push_back(std::move(name));
    return beginning_with(typed, names);
  }
  std::vector<std::string> all = commands_of(*at.command);
  for (CLI::Option* option :
       at.command->get_options([](CLI::Option* o) { return o->get_positional(); }))
    for (std::string& word : words_of(*option))
      all.push_back(std::move(word));
  return beginning_with(typed, all);
}

} // namespace goingrate::apps
