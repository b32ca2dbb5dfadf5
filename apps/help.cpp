// The subcommand `goingrate help TOPIC`, and the layout of every --help.
#include "help.hpp"

#include "common.hpp"
#include "words.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace goingrate::apps {

namespace {

constexpr std::array topics{
    Topic{"formats", "logs that are read",
          R"(The layout of a log is found from its first lines and said on standard error.
  timestamps      one time a line: seconds, ms, us, ns, days, or
                  2013-02-22 23:38:00.2279906
  periods         one period a line
  clock-error     label, error of the clock, amplitude
  phase           Stable32: the clock's error every --tau0 s; 0 within is a gap
  frequency       relative rate every --tau0 s
  ticc            TAPR TICC; --channel chB
  ticc-interval   the clock's error every --tau0 s
  table           columns by their names: CSV, semicolon, tab, blanks; Vernier,
                  phyphox
  angle           samples of an angle; crossings by local fits
  native          what simulate writes: '#' lines 'key: value', then named
                  columns
Against what is found: --format, --unit, --column time=2, --decimal-comma,
--wrap, --channel, --both-edges, --nominal-period (s), --tau0 (s, between values
of phase, frequency and intervals), --rest-angle (rad, at which the pendulum of
angle samples hangs). A packed log may have 4 GiB unpacked: --unpacked-limit.
--dead-time (s): events so soon after an edge are bounces of a contact; found by
itself if not given. Times that go back begin a new segment.
--strict makes the first faulty line an error; else faults
are mended or left out, and rate --json lists each with its line and column.
An amplitude is in rad unless the header or --column amplitude=NAME:mrad (rad,
mrad, deg) says otherwise; the third column of a clock-error log is in mrad.
Of the sensor: --flag-width (rad, width of the flag over its distance from the
pivot) makes amplitudes of widths, or moves the times of its leading edge to the
vertical; --sensor-offset (rad, or auto) says where it stands, moves the times
to the vertical and makes amplitudes of half-periods.
)"},
    Topic{"scenario", "keys of a scenario for simulate",
          R"([clock]   nominal_period (s), epsilon, mu, phi0 (rad),
          escapement = "constant-torque", "single-impulse" (impulse, angle),
          "profile" (rising, falling) or "none", quadratic_drag, dry_friction
[start]   amplitude = "stationary" or phi' at the first upward crossing (rad)
[run]     periods or duration (s); method = "auto", "direct", "map",
          "averaged1", "averaged2", "rk4" (dt, rk4_torque = "step", "stage" or
          "switches"); tolerance (s, of crossing times, for auto)
[[event]] at_period or at (s), and what changes then: nominal_period, epsilon,
          mu, phi0, quadratic_drag, dry_friction, impulse, angle
[drive]   fast_rms (white, renewed at every upward crossing), slow_rms and
          slow_time (s), sine = [{amplitude = 0.02, period = 900.0}],
          series = "mu.csv"
[length]  relative changes: drift_per_day,
          sine = [{amplitude = 1e-6, period = 86400.0}],
          temperature_coefficient (per K, of the temperature below)
[temperature]
          mean (degrees C), drift_per_day (K),
          sine = [{amplitude = 2.0, period = 86400.0}] (K, s)
[sensor]  edges = "up", "both", "gate", "four"; jitter_rms (s), resolution (s),
          offset (rad), flag_width (rad), missed, spurious (probability a
          crossing); amplitude_rms (rad), temperature_rms (K): each adds a
          column to the log
--set clock.epsilon=1e-3 overrides a key. Unknown keys are errors with line and
column.
)"},
    Topic{"noise", "what disturbs a clock, and how it is told apart",
          R"(jitter      of the sensor: white in time, so that neighbouring period
            differences go against each other; the deviation falls as 1/tau
fast drive  white from period to period: the rate answers at once with one gain,
            and once the amplitude has settled with another; the times walk; the
            deviation falls as 1/sqrt(tau)
slow drive  with a memory: little cancels, and the clock goes off for hours
fit --noise jitter|drive|both|slow|auto chooses; auto adds what BIC asks for.
spectrum sizes all three by the likelihood of the rate's spectrum and says what
each costs in a day, a week, a year. stability names the noise at every
averaging time.
)"},
    Topic{"identifiability", "what a log can and cannot tell",
          R"(A steady log tells the mean rate and nothing of epsilon, mu and phi0: they are
'undetermined'. A change tells: a jump of the driving weight, a start from rest,
a ring-down, or amplitudes. With T0 known (--fix T0=2) the mean rate says how
drive and friction stand to each other. A steady log with a noisy drive shows
the gain of the rate at low and high frequencies; two clocks fit it, with the
slow gain of either sign, and one look at the amplitude (--prior
lambda0=0.05+-0.005) tells which. fit names the combinations that are
determined, and says what experiment would tell more and with what sigma.
)"},
    Topic{"exit-codes", "what the command says to a script, and where it says it",
          R"(0  done; also where the reader of standard output goes away, as head does
1  a fault of the program
2  wrong usage; what an option says, --set too, is usage
3  the input cannot be used (the message gives file, line, column, what was
   found and what was expected), or needs more memory than there is
4  the numbers did not work out
5  the output could not be written
report exits 0 where the fit alone has no result and says so in its place; fit
exits 4. Results go to standard output or the named file, notes and errors to
standard error. Every error begins with 'goingrate:'. On a terminal notes and
errors are coloured; NO_COLOR=1 in the environment stops that, and --quiet stops
the notes. A file is written whole or not at all; of several, all or none.
)"},
};

// Wraps descriptions at 80 columns; the lines of CLI11's formatter are as long as the descriptions.
class NarrowFormatter : public CLI::Formatter {
public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return entry(make_option_name(option, is_positional) + make_option_opts(option),
                 make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return entry(command->get_display_name(true), command->get_description());
  }

private:
  static std::string entry(const std::string& name, const std::string& description) {
    constexpr std::size_t line_columns = 80, description_column = 30;
    std::string text = wrapped("  " + name, line_columns, 4);
    if (description.empty()) return text + '\n';
    const std::string indent(description_column, ' ');
    const std::string lines = wrapped(indent + description, line_columns);
    // The description starts on the line of the name, unless the name reaches into its column.
    if (text.size() < description_column) return text + lines.substr(text.size()) + '\n';
    return text + '\n' + lines + '\n';
  }
};

void run(const std::string& name) {
  const auto topic =
      std::find_if(topics.begin(), topics.end(), [&](const Topic& t) { return t.name == name; });
  if (topic != topics.end()) {
    std::fputs(std::string(topic->text).c_str(), stdout);
    return;
  }
  std::string list;
  for (const Topic& t : topics)
    list += fmt::format("  {:<16} {}\n", t.name, t.about);
  std::fputs(("goingrate help TOPIC, of\n" + list).c_str(), stdout);
}

} // namespace

std::span<const Topic> help_topics() { return topics; }

void narrow_help(CLI::App& program) { program.formatter(std::make_shared<NarrowFormatter>()); }

void add_help(CLI::App& program) {
  std::vector<std::string> names;
  for (const Topic& t : topics)
    names.emplace_back(t.name);
  auto* command =
      program.add_subcommand("help", fmt::format("explains a topic: {}", fmt::join(names, ", ")));
  auto topic = std::make_shared<std::string>();
  command->add_option("topic", *topic, "what to explain")->check(one_of(names));
  command->footer("Example:\n  goingrate help formats");
  command->callback([topic] { run(*topic); });
}

} // namespace goingrate::apps
