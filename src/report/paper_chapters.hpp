// The sections of the paper's companion. Private to the report room.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace goingrate::paper {

/// An equation of the paper with its number there; `math` is MathML without its outermost element.
struct Equation {
  std::string_view number{}, math{};
};

/// A section of the paper with the sources of its numbers and figures; empty members are left out.
struct Chapter {
  std::string_view id, title, words;
  std::array<Equation, 6> equations;
  std::array<std::string_view, 2> wheres;  ///< PaperNumber::where
  std::array<std::string_view, 4> figures; ///< PaperFigure::name
};

std::span<const Chapter> chapters();

} // namespace goingrate::paper
