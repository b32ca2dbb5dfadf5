#include "goingrate/report/figure.hpp"

#include "figure_axes.hpp"

#include <fmt/format.h>

namespace goingrate {

// Each custom property has its light value as fallback, so that the style also works without a
// page.
std::string figure_style() {
  std::string style = R"(
.figure{display:block;width:100%;height:auto;font:13px system-ui,sans-serif}
.figure text{fill:var(--text,#1b1b1b)}
.figure path,.figure rect{fill:none;stroke-linejoin:round}
.figure .frame{stroke:var(--text,#1b1b1b)}
.figure .grid{stroke:var(--grid,#d9d9d9)}
.figure .minor{stroke:var(--grid,#d9d9d9);stroke-opacity:.45}
.figure .marker{stroke:var(--text,#1b1b1b);stroke-dasharray:2 4}
.figure text.note{font-weight:600;stroke:var(--paper,#fff);stroke-width:4px;paint-order:stroke}
.figure .line{stroke:var(--ink);stroke-width:1.8;stroke-linecap:round}
.figure .line.k1{stroke-dasharray:9 5}
.figure .line.k2{stroke-dasharray:2 5}
.figure .line.k3{stroke-dasharray:10 4 2 4}
.figure .dots{stroke:var(--ink);stroke-width:2.2;stroke-linecap:round;stroke-opacity:.6}
.figure .dots.k1{stroke-linecap:square}
.figure .dots.k2{stroke-width:3.4}
.figure .body{stroke:var(--ink);stroke-width:1.1;stroke-opacity:.45}
.figure .bar{stroke:var(--ink);stroke-width:1.4}
.figure path.mark{fill:var(--ink)}
.figure rect.cell{fill:var(--ink)}
.figure path.band{fill:var(--ink);fill-opacity:.25}
)";
  for (int i = 0; i < 8; ++i)
    style += fmt::format(".figure .c{0}{{--ink:var(--c{0},{1})}}\n", i, palette(i));
  // On a telephone the drawing is half as large, so thin lines and small text are made larger.
  style += "@media screen and (max-width:600px){.figure{font-size:20px}"
           ".figure .frame,.figure .grid{stroke-width:1.5}.figure .line{stroke-width:3}"
           ".figure .dots{stroke-width:3}.figure .bar{stroke-width:2}}\n";
  return style;
}

} // namespace goingrate
