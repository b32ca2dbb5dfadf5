// The page's glossary, for readers who do not use its words every day.
#include "page.hpp"

#include "markup.hpp"

#include <array>
#include <fmt/format.h>

namespace goingrate::page {

namespace {

struct Word {
  std::string_view word, meaning;
};

constexpr std::array<Word, 12> glossary{{
    {"beat, period", "a passage of the pendulum in one direction, and the time to the next one in "
                     "that direction: there and back, tick and tock. A seconds pendulum has a "
                     "period of 2 s."},
    {"rate", "the time a clock gains over the time that passes; positive: it is fast. 10⁻⁵ is "
             "0.864 s/day."},
    {"a ± b", "b is one standard deviation (1 σ): the truth is within it in about two cases of "
              "three, and within twice as much in 19 of 20."},
    {"amplitude", "how far the pendulum swings from the vertical to either side."},
    {"beat error", "the difference of tick and tock; others use the name for half of it. It comes "
                   "from a clock that is out of beat, or from a sensor that is not where the "
                   "pendulum hangs at rest."},
    {"drive μ",
     "the push that keeps the pendulum going, as its torque over the moment of inertia."},
    {"friction ε", "what slows the pendulum down: left alone it loses a part 2πε of its swing "
                   "each period, at any size of the swing."},
    {"quality factor Q", "2π times the energy of the swing over the energy lost in a period; for "
                         "friction ε it is 1/(2ε)."},
    {"ring-down", "the pendulum left to come to rest without a drive."},
    {"escapement's angle φ0", "how far from the vertical the escapement's push changes its sign."},
    {"jitter", "how far the sensor's times scatter about the true passages."},
    {"Allan deviation", "by how much the rate, averaged over a time τ, typically differs from one "
                        "such stretch to the next, over √2."},
}};

} // namespace

std::string words() {
  std::string list = "<dl class=\"words\">\n";
  for (const auto& [word, meaning] : glossary)
    list += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_markup(word), escape_markup(meaning));
  return section("words", "Words", list + "</dl>\n");
}

} // namespace goingrate::page
