// Words that an option takes: what is checked, what is completed, what a misspelt one was meant to
// be.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace goingrate::apps {

/// The value must be one of the words; the complaint names the one that was probably meant.
CLI::Validator one_of(std::vector<std::string> words);

/// Words that the option takes among others: they are completed, and checked by whoever reads them.
/// A word that ends in '=' is followed by a value.
CLI::Option* offers(CLI::Option* option, const std::vector<std::string>& words);

/// All words that one_of() or offers() gave an option.
std::vector<std::string> words_of(CLI::Option& option);

/// What may stand for the last of `words` (those after `goingrate`), given the others: commands,
/// options, words of an option. Nothing where only the user can know: a file, a number.
std::vector<std::string> completions(CLI::App& program, std::vector<std::string> words);

} // namespace goingrate::apps
