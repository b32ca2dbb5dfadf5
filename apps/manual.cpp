// The manual page, from what --help and `help TOPIC` say.
#include "help.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate::apps {

namespace {

// Roff's names for the characters beyond ASCII in the help texts: not every roff reads UTF-8.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> roff_names{{
    {"ε", "\\(*e"},
    {"λ", "\\(*l"},
    {"μ", "\\(*m"},
    {"σ", "\\(*s"},
    {"τ", "\\(*t"},
    {"φ", "\\(*f"},
    {"ψ", "\\(*q"},
    {"√", "\\(sr"},
}};

// Text with what roff would take for an escape, a hyphen or a request written so that it does not.
std::string roff(std::string_view text) {
  std::string result;
  bool begins = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto named = std::find_if(roff_names.begin(), roff_names.end(), [&](const auto& name) {
      return text.substr(i).starts_with(name.first);
    });
    if (named != roff_names.end()) {
      result += named->second;
      i += named->first.size() - 1;
      begins = false;
      continue;
    }
    if (begins && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    begins = c == '\n';
  }
  return result;
}

std::string as_it_stands(std::string_view text) {
  return fmt::format(".nf\n{}{}.fi\n", roff(text), text.ends_with('\n') ? "" : "\n");
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

// An option as --help shows it, and which commands have it.
struct Entry {
  std::string name, text;
  std::vector<std::string> commands;

  [[nodiscard]] std::string roff_text() const {
    return fmt::format(".TP\n.B {}\n{}\n", roff(name), roff(text));
  }
};

std::vector<CLI::App*> visible_commands(CLI::App& app) {
  return app.get_subcommands([](CLI::App* command) { return !command->get_group().empty(); });
}

// The words of CLI11's formatter, without its layout.
class OptionWords : public CLI::Formatter {
public:
  static Entry of(const CLI::Option& option) {
    const OptionWords words;
    const bool place = option.get_positional();
    return {words.make_option_name(&option, place) + words.make_option_opts(&option),
            words.make_option_desc(&option),
            {}};
  }
};

bool is_help(const CLI::Option& option) { return option.check_lname("help"); }

// Options in the order of the commands; one that several commands share is one entry.
std::vector<Entry> entries_of(const std::vector<CLI::App*>& commands) {
  std::vector<Entry> entries;
  for (CLI::App* command : commands) {
    for (const CLI::Option* option : std::as_const(*command).get_options()) {
      if (option->get_group().empty() || is_help(*option)) continue;
      Entry entry = OptionWords::of(*option);
      const auto same = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) {
        return e.name == entry.name && e.text == entry.text;
      });
      auto& where = same == entries.end() ? entries.emplace_back(std::move(entry)) : *same;
      where.commands.push_back(command->get_name());
    }
  }
  return entries;
}

// An option that at least this many commands share is listed once, for all of them.
constexpr std::size_t commands_of_a_common_option = 3;

std::string own_options(const std::vector<Entry>& entries, const std::string& command) {
  std::string text;
  for (const Entry& entry : entries)
    if (entry.commands.size() < commands_of_a_common_option &&
        std::find(entry.commands.begin(), entry.commands.end(), command) != entry.commands.end())
      text += entry.roff_text();
  return text;
}

std::string common_options(const std::vector<Entry>& entries) {
  std::string text = ".SH OPTIONS OF SEVERAL COMMANDS\n";
  const std::vector<std::string>* before = nullptr;
  for (const Entry& entry : entries) {
    if (entry.commands.size() < commands_of_a_common_option) continue;
    if (before == nullptr || *before != entry.commands)
      text += fmt::format(".SS Of {}\n", fmt::join(entry.commands, ", "));
    text += entry.roff_text();
    before = &entry.commands;
  }
  return text;
}

} // namespace

std::string manual_page(CLI::App& program) {
  const std::vector<CLI::App*> commands = visible_commands(program);
  const std::vector<Entry> entries = entries_of(commands);
  std::string text = fmt::format(
      ".\\\" Made by goingrate --man.\n.TH GOINGRATE 1 \"\" \"{}\" \"User commands\"\n.SH NAME\n"
      "goingrate \\- {}\n.SH SYNOPSIS\n.B goingrate\n.I COMMAND\n.RI [ OPTIONS ]\n.br\n"
      ".B goingrate\n.I COMMAND\n.B \\-\\-help\n.SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      roff(program.version()), roff(program.get_description()), roff(program.get_footer()));
  for (const CLI::App* command : commands)
    text += fmt::format(".TP\n.B {}\n{}\n", roff(command->get_name()),
                        roff(command->get_description()));
  text += ".SH OPTIONS OF ALL COMMANDS\n";
  for (const CLI::Option* option : std::as_const(program).get_options())
    if (!option->get_group().empty()) text += OptionWords::of(*option).roff_text();
  text += common_options(entries);
  for (const CLI::App* command : commands) {
    text +=
        fmt::format(".SH GOINGRATE {}\n{}\n{}", upper(roff(command->get_name())),
                    roff(command->get_description()), own_options(entries, command->get_name()));
    text += ".PP\n" + as_it_stands(command->get_footer());
  }
  for (const Topic& topic : help_topics())
    text += fmt::format(".SH {}\n{}", upper(std::string(topic.name)), as_it_stands(topic.text));
  return text;
}

} // namespace goingrate::apps
