// Symbols and meanings of the parameters of a fit. Private to the report.
#pragma once

#include <string>
#include <string_view>

namespace goingrate {

/// "ε" for "epsilon", "μ@1" for "mu@1"; a name without a symbol is returned unchanged.
std::string symbol_of(std::string_view name);

/// Whether physicists write it as a letter: "epsilon" and "T0", not "impulse".
bool has_symbol(std::string_view name);

/// As symbol_of(), with a name without a symbol in words: "dry friction", "jitter rms".
std::string label_of(std::string_view name);

/// "ε (epsilon)": the symbol, and the name by which options and files know the parameter.
std::string symbol_and_name(std::string_view name);

/// An expression with symbols for the names in it: "T0/(2π ε)" for "T0/(2 pi epsilon)".
std::string in_symbols(std::string_view expression);

/// The meaning of the parameter for somebody who has not read the paper; "@1" and the like, of a
/// parameter that changes at an event, are not mentioned.
std::string_view meaning_of(std::string_view name);

} // namespace goingrate
