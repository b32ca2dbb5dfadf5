#include "scenario_text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace goingrate {

namespace {

// A very deep key would overflow toml++'s stack; no scenario has more than two levels. Dots in
// strings and comments are not levels.
void refuse_deep_keys(std::string_view text, const std::string& source) {
  constexpr int most_levels = 64;
  std::size_t line = 1, start = 0;
  int dots = 0;
  char quote = '\0';
  bool comment = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') {
      ++line;
      start = i + 1;
      dots = 0;
      comment = false;
      quote = '\0'; // a string of several lines begins anew on each: its quotes come in threes
    } else if (comment) {
      continue;
    } else if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      comment = true;
    } else if (c == ',' || c == '=') {
      dots = 0;
    } else if (c == '.' && ++dots > most_levels) {
      throw InputError({source, line, i - start + 1}, "a key of more than 64 levels",
                       "one of at most two, such as clock.epsilon");
    }
  }
}

// `has_lines`: the text comes from a file, so that messages may cite its lines.
toml::table parsed(std::string_view text, const std::string& source, bool has_lines) {
  refuse_deep_keys(text, source);
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(has_lines ? place_of(error.source(), source) : TextPlace{source},
                     fmt::format("text that is not TOML ({})", error.description()),
                     "a scenario in TOML");
  }
}

bool is_bare_word(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !text.empty() && (is_letter(text.front()) || text.front() == '/') &&
         std::all_of(text.begin(), text.end(), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.' ||
                  c == '/';
         });
}

// "run.method=map" with the quotes that TOML wants; true, false, inf and nan stay what they are.
std::string with_quotes(const std::string& change) {
  const std::size_t equals = change.find('=');
  std::string_view word = std::string_view(change).substr(equals + 1);
  while (!word.empty() && word.front() == ' ')
    word.remove_prefix(1);
  while (!word.empty() && word.back() == ' ')
    word.remove_suffix(1);
  const bool is_toml_literal = word == "true" || word == "false" || word == "inf" || word == "nan";
  if (is_toml_literal || !is_bare_word(word)) return change;
  return fmt::format("{}='{}'", change.substr(0, equals), word);
}

toml::table parsed_override(const std::string& change) {
  if (change.find('=') == std::string::npos)
    throw InputError({change}, "no '='", "KEY=VALUE, such as clock.epsilon=1e-3");
  return parsed(with_quotes(change), change, false);
}

// Moves nodes: a copy loses its source, which messages name.
void merge(toml::table& base, toml::table&& change) {
  for (auto&& [key, node] : change) {
    toml::node* old = base.get(key.str());
    if (old != nullptr && old->is_table() && node.is_table()) {
      merge(*old->as_table(), std::move(*node.as_table()));
      continue;
    }
    base.erase(key.str());
    node.visit([&, &name = key](auto& value) { base.insert(name, std::move(value)); });
  }
}

// The first node below `node` with this key, and with this value if it is a number.
const toml::node* find(const toml::node& node, std::string_view key, const std::string& value) {
  if (const toml::array* list = node.as_array())
    for (const toml::node& entry : *list)
      if (const toml::node* found = find(entry, key, value)) return found;
  if (const toml::table* table = node.as_table())
    for (const auto& [name, entry] : *table) {
      const auto number = entry.value<double>();
      if (name.str() == key && (!number || fmt::format("{}", *number) == value)) return &entry;
      if (const toml::node* found = find(entry, key, value)) return found;
    }
  return nullptr;
}

} // namespace

TextPlace place_of(const toml::source_region& source, const std::string& file) {
  if (source.path && *source.path != file) return {*source.path, 0, 0};
  return {file, source.begin.line, source.begin.column};
}

toml::table scenario_tree(std::string_view text, const std::string& file,
                          const std::vector<std::string>& overrides) {
  constexpr std::size_t most_bytes = 1 << 20; // the tree takes up to a hundred times the text
  if (text.size() > most_bytes)
    throw InputError({file}, fmt::format("{} bytes", text.size()),
                     fmt::format("a scenario of at most {}", most_bytes));
  toml::table root = parsed(text, file, true);
  for (const std::string& change : overrides)
    merge(root, parsed_override(change));
  return root;
}

InputError located(const ArgumentError& error, const toml::table& root, const std::string& file) {
  const toml::node* node = &root;
  std::string_view key = error.name();
  for (std::size_t dot; (dot = key.find('.')) != key.npos; key.remove_prefix(dot + 1)) {
    const toml::table* table = node->as_table();
    const toml::node* below = table == nullptr ? nullptr : table->get(key.substr(0, dot));
    if (below != nullptr) node = below;
  }
  node = find(*node, key, error.value());
  const std::string found =
      error.value().empty() ? error.name() : fmt::format("{} = {}", error.name(), error.value());
  return {node == nullptr ? TextPlace{file, 0, 0} : place_of(node->source(), file), found,
          error.legal()};
}

} // namespace goingrate
