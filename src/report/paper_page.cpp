// The paper's companion: what it says, section by section, and what comes of it when it is computed
// again.
#include "goingrate/report/paper.hpp"

#include "markup.hpp"
#include "page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace goingrate {

namespace {

/// An equation of the paper; `math` is MathML without its outermost element.
struct Equation {
  std::string_view label, math;
};

/// A section of the paper, and where its numbers and figures come from.
struct Chapter {
  std::string_view id, title, words;
  std::array<Equation, 2> equations;
  std::array<std::string_view, 2> wheres; ///< PaperNumber::where
  std::string_view figures;               ///< how their names begin; empty: none
};

// Parts that equations share.
#define FRAC(above, below) "<mfrac><mrow>" above "</mrow><mrow>" below "</mrow></mfrac>"
#define SUB(base, index) "<msub>" base index "</msub>"
#define SQUARED(base) "<msup>" base "<mn>2</mn></msup>"
#define LAMBDA "<mi>λ</mi>"
#define EPSILON "<mi>ε</mi>"
#define MU "<mi>μ</mi>"
#define PI "<mi>π</mi>"
#define PHI0 SUB("<mi>φ</mi>", "<mn>0</mn>")
#define PSI "<mi>ψ</mi>"
#define RATE "<mover>" PSI "<mo>˙</mo></mover><mo>−</mo><mn>1</mn>"
#define EQUALS "<mo>=</mo>"
#define PLUS "<mo>+</mo>"
#define MINUS "<mo>−</mo>"
#define TWO "<mn>2</mn>"

constexpr std::array chapters{
    Chapter{"motion",
            "Amplitude and phase",
            "The pendulum swings as φ = λ sin ψ. Averaged over a swing, friction lowers the "
            "amplitude λ and the component of the torque m along the motion raises it; the phase "
            "ψ runs ahead of time by the circular error and by the component of the torque along "
            "the excursion. Only these two moments of the torque count: escapements that share "
            "them keep the same time to first order.",
            {Equation{"dotl3", "<mover>" LAMBDA "<mo>˙</mo></mover>" EQUALS MINUS EPSILON LAMBDA PLUS
                               "<mo>∮</mo><mi>m</mi><mi>cos</mi>" PSI "<mi>d</mi>" PSI},
             Equation{"dotpsi3", RATE EQUALS MINUS FRAC(SQUARED(LAMBDA), "<mn>16</mn>") MINUS
                                 FRAC("<mn>1</mn>", LAMBDA) "<mo>∮</mo><mi>m</mi><mi>sin</mi>" PSI
                                 "<mi>d</mi>" PSI}},
            {"sec. rateq", ""},
            ""},
    Chapter{"escapement",
            "The model escapement",
            "A torque μ that pushes along the motion until the pendulum is φ0 beyond the vertical, "
            "and against it from there on.",
            {Equation{"dotl4", FRAC("<mi>d</mi>" SQUARED(LAMBDA), "<mi>d</mi><mi>t</mi>") EQUALS MINUS
                               TWO EPSILON SQUARED(LAMBDA) PLUS FRAC("<mn>4</mn>" MU PHI0, PI)},
             Equation{"dotpsi4", RATE EQUALS MINUS FRAC(SQUARED(LAMBDA), "<mn>16</mn>") PLUS
                                 FRAC(TWO MU, PI LAMBDA) "<msqrt><mn>1</mn>" MINUS
                                 FRAC(SQUARED(PHI0), SQUARED(LAMBDA)) "</msqrt>"}},
            {"", ""},
            ""},
    Chapter{"stationary",
            "Stationary operation",
            "Where friction and drive balance, the amplitude and the rate follow in closed form. "
            "The map shows which clocks gain and which lose; below the line the torque is too "
            "weak to carry the pendulum past φ0.",
            {Equation{"statam", LAMBDA EQUALS PHI0 "<msqrt>" FRAC(TWO MU, PI EPSILON PHI0) "</msqrt>"},
             Equation{"statrate", RATE EQUALS MINUS FRAC(MU PHI0, "<mn>8</mn>" PI EPSILON) PLUS EPSILON
                                  "<msqrt>" FRAC(TWO MU, PI EPSILON PHI0) MINUS "<mn>1</mn></msqrt>"}},
            {"sec. statop", "fig. rate"},
            "rate"},
    Chapter{"gain",
            "Losing or gaining?",
            "More torque makes a clock lose where the circular error rules and gain where the "
            "escapement error does; more friction may make it run faster.",
            {},
            {"sec. losgain", ""},
            ""},
    Chapter{"accuracy",
            "Accuracy, and the best place for the drive",
            "The relative rate is of the order of the friction, whatever the drive. A push whose "
            "middle is at the vertical has no escapement error of first order, however wide it is: "
            "its place counts, not its width.",
            {Equation{"ratest", RATE "<mo>∼</mo>" FRAC("<mi>m</mi>", LAMBDA) "<mo>∼</mo>" EPSILON}, {}},
            {"sec. oomest", "sec. optdriv"},
            ""},
    Chapter{"jump",
            "A jump of the torque",
            "The torque doubles at once. The rate answers at once as well, by the escapement error "
            "at the old amplitude; then the amplitude grows towards its new value, and the rate "
            "settles where the map says.",
            {Equation{"l2jump", SQUARED(LAMBDA) EQUALS FRAC(TWO PHI0, PI EPSILON) "<mo>{</mo>"
                                SUB(MU, "<mn>1</mn>") MINUS "<mo>(</mo>" SUB(MU, "<mn>1</mn>") MINUS
                                SUB(MU, "<mn>0</mn>") "<mo>)</mo><mi>exp</mi><mo>(</mo>" MINUS TWO EPSILON
                                "<mi>t</mi><mo>)</mo><mo>}</mo>"},
             {}},
            {"sec. such", ""},
            "jump"},
    Chapter{"long",
            "A noisy drive over months",
            "Clock C, which keeps nominal time to first order, for 1e9 steps of RK4, first with a "
            "steady torque and then with one that is drawn again at every swing. It gains 1e-8 all "
            "the same, and hardly feels the noise: the swing averages it over its long memory.",
            {},
            {"sec. perst", "fig. quasistat"},
            "quasistat"},
    Chapter{"circular",
            "The circular error, and what the 1e-8 is made of",
            "The circular error in full, of which −λ²/16 is the first term. The table below takes "
            "the gain of clock C apart: each line comes from runs of its own, and their sum misses "
            "the full equation of motion by terms of third order.",
            {Equation{"ce3", FRAC("<mn>1</mn>", LAMBDA) SUB("<mi>J</mi>", "<mn>1</mn>") "<mo>(</mo>" LAMBDA
                             "<mo>)</mo>" MINUS FRAC("<mn>1</mn>", TWO) "<mo>≃</mo>" MINUS
                             FRAC(SQUARED(LAMBDA), "<mn>16</mn>") PLUS
                             FRAC("<msup>" LAMBDA "<mn>4</mn></msup>", "<mn>384</mn>")},
             {}},
            {"", ""},
            ""},
    Chapter{"impulse",
            "A single impulse",
            "The other extreme of an escapement: once in a swing, at the angle φ1 = λ sin ψ1, the "
            "energy e is given in no time.",
            {Equation{"blow6", RATE EQUALS MINUS FRAC("<mi>e</mi>", "<mn>32</mn>" PI EPSILON) MINUS EPSILON
                               "<mi>tan</mi>" SUB(PSI, "<mn>1</mn>")},
             {}},
            {"app. appblow", ""},
            ""},
    Chapter{"end",
            "Method and machine",
            "What the choice of the torque within a step does, how long the runs take, and what a "
            "change of length does.",
            {},
            {"app. appnum", "sec. disc"},
            ""},
};

#undef FRAC
#undef SUB
#undef SQUARED
#undef LAMBDA
#undef EPSILON
#undef MU
#undef PI
#undef PHI0
#undef PSI
#undef RATE
#undef EQUALS
#undef PLUS
#undef MINUS
#undef TWO

std::string equations_html(std::span<const Equation> equations) {
  std::string html;
  for (const Equation& equation : equations)
    if (!equation.math.empty())
      html += fmt::format("<div class=\"equation\"><math display=\"block\"><mrow>{}</mrow></math>"
                          "<span>eq. {}</span></div>\n",
                          equation.math, equation.label);
  return html;
}

std::string number_cell(double value, double sigma, const std::string& unit) {
  if (std::isnan(value)) return "–";
  const std::string text = sigma > 0.0 ? measured(value, sigma) : plain_number(value, 7);
  return unit.empty() ? text : text + " " + unit;
}

std::string numbers_html(const Chapter& chapter, const PaperResults& results) {
  page::Table table("Numbers of this section",
                    {"", "the paper", "by its method", "here", "why they differ"});
  for (const PaperNumber& number : results.numbers) {
    const auto at = std::find(chapter.wheres.begin(), chapter.wheres.end(), number.where);
    if (at == chapter.wheres.end()) continue;
    table.row({number.what, number.printed.empty() ? "–" : number.printed,
               number_cell(number.by_paper, 0.0, number.unit),
               number_cell(number.ours, number.sigma, number.unit), number.why});
  }
  return table.empty() ? "" : table.html();
}

std::string budget_html(const PaperResults& results) {
  page::Table table("The gain of clock C, part by part", {"part", "rate"});
  for (const BudgetPart& part : results.budget)
    table.row({part.what, typeset(fmt::format("{:+.4e}", part.rate))});
  return table.html();
}

std::string figures_html(const Chapter& chapter, const PaperResults& results) {
  std::string html;
  for (const PaperFigure& figure : results.figures) {
    if (chapter.figures.empty() || !figure.name.starts_with(chapter.figures)) continue;
    html += fmt::format("<figure>\n<h3>{}</h3>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                        escape_markup(figure.figure.title), svg(figure.figure),
                        escape_markup(figure.figure.caption));
  }
  return html;
}

// Equations stand in the middle, their names at the right.
constexpr std::string_view equation_style =
    ".equation{display:flex;align-items:center;gap:1rem;margin:.6rem 0}.equation math{flex:1;"
    "font-size:1.15rem}.equation span{color:var(--soft);font-size:.85rem}"
    "@media print{.equation,section>p{break-inside:avoid}}";

} // namespace

std::string paper_page(const PaperResults& results) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Hoyng's paper, computed again</title>\n<style>{}{}{}</style>\n</head>\n<body>\n"
      "<header>\n<h1>Hoyng’s paper, computed again</h1>\n{}</header>\n<main>\n",
      page::style(), figure_style(), equation_style,
      page::paragraph("A companion to P. Hoyng, “Dynamics and performance of clock pendulums”. "
                      "Each section gives the paper’s equations by their names there, its figures "
                      "drawn from runs made now, and its numbers in three columns: as printed, by "
                      "the paper’s method, and by the full equation of motion."));
  for (const Chapter& chapter : chapters) {
    std::string body =
        page::paragraph(chapter.words) + equations_html(chapter.equations) +
        figures_html(chapter, results) + numbers_html(chapter, results);
    if (chapter.id == "circular") body += budget_html(results);
    html += page::section(chapter.id, chapter.title, body);
  }
  return html + "</main>\n</body>\n</html>\n";
}

} // namespace goingrate
