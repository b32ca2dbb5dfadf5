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
          R"(The layout of a log is recognised from its first lines and reported on standard
error. Several files, a folder or a ZIP are read as one log of one clock.
  timestamps      one time per line: seconds, ms, us, ns, days, or
                  2013-02-22 23:38:00.2279906
  periods         one period per line
  clock-error     label, error of the clock, amplitude
  phase           Stable32: the clock's error every --tau0 s; a 0 between
                  other values marks a gap; or, with dates, columns named
                  mjd and phase_s
  frequency       relative rate every --tau0 s
  ticc            TAPR TICC; --channel chB
  ticc-interval   the clock's error every --tau0 s
  table           columns by their names: CSV, semicolon, tab, blanks; Vernier,
                  phyphox
  angle           samples of an angle; crossings by local fits
  ticktock        tick,tick_block,tock,tock_block: how long a flag leaves a
                  light gate open and covers it, in cycles; --counter-hz
  xy              time and place of the bob (Tracker): angles about the centre
                  of the circle through the places
  labx            a measurement of CASSY Lab 2: a table
  zip             one log or several, packed
  wav             a recording of the ticking: WAV, FLAC, OGG; --channel beat=1,
                  --channel pps=2 for a reference that clicks once a second
  native          what simulate writes: '#' lines 'key: value', then named
                  columns
These override what was recognised: --format, --unit, --column time=2,
--decimal-comma, --date-order (day or month, of 03/04/2013), --wrap, --channel,
--both-edges, --nominal-period (s), --tau0 (s, between values of phase,
frequency and intervals), --rest-angle (rad, at which a pendulum recorded as
angle samples hangs). A compressed log may unpack to 4 GiB at most;
--unpacked-limit changes that. A recording's sampling rate is taken to be right
to 50 parts in a million; --clock-ppm sets another value. --weather FILE adds
temperature, pressure and humidity from a table with a header; its readings
are interpolated to the beats.
--dead-time (s): events within this time after an edge are bounces of a contact;
without the option the dead time is estimated from the log. Where times go back,
a new segment begins.
With --strict the first faulty line is an error; otherwise faulty lines are
mended or left out, and rate --json lists each with its line and column.
An amplitude is in rad unless the header or --column amplitude=NAME:mrad (rad,
mrad, deg) says otherwise; the third column of a clock-error log is in mrad.
About the sensor: with --flag-width (rad: the width of the flag divided by its
distance from the pivot) the passage times of the flag give amplitudes, or the
times of its leading edge are moved to the vertical. --sensor-offset (rad, or
auto) is the angle of the sensor from the vertical: times are moved to the
vertical, and the lengths of the two half swings give amplitudes.
)"},
    Topic{"scenario", "keys of a scenario for simulate",
          R"([clock]   nominal_period (s), epsilon, mu, phi0 (rad),
          escapement = "constant-torque", "single-impulse" (impulse, angle),
          "profile" (rising, falling) or "none", quadratic_drag, dry_friction;
          every = 15 (the escapement acts in one period of 15) or below = 0.04
          (when the amplitude, rad, has fallen below it); gravity_share (1:
          gravity, 0: torsion)
[start]   amplitude = "stationary" or phi' at the first upward crossing (rad)
[run]     periods or duration (s); method = "auto", "direct", "map",
          "averaged1", "averaged2", "rk4" (dt, rk4_torque = "step", "stage" or
          "switches"); tolerance (s, of crossing times, for auto)
[[event]] at_period or at (s), and the new values: nominal_period, epsilon,
          mu, phi0, quadratic_drag, dry_friction, impulse, angle, every, below
[drive]   fast_rms (white, renewed at every upward crossing), slow_rms and
          slow_time (s), sine = [{amplitude = 0.02, period = 900.0}],
          series = "mu.csv"
[length]  relative changes: drift_per_day,
          sine = [{amplitude = 1e-6, period = 86400.0}],
          temperature_coefficient (per K, of the temperature below);
          compensation (per K, subtracted), compensation_lag (s)
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
    Topic{"noise", "what disturbs a clock, and how the causes are told apart",
          R"(jitter      timing noise of the sensor, independent from one crossing to the
            next: a late crossing makes one period longer and the next one
            shorter; the deviation falls as 1/τ
fast drive  drive that varies independently from one period to the next: the
            rate responds at once with one gain, and with another once the
            amplitude has settled; the clock's error is a random walk, and the
            deviation falls as 1/√τ
slow drive  drive that stays high or low for minutes to hours: its effects add
            up, and the clock gains or loses all that time
fit --noise jitter|drive|both|slow|auto selects which of them the fit includes;
auto adds one only where it makes the log much more likely (by the BIC, which
penalises every further parameter). spectrum finds the sizes of all three from
the spectrum of the rate, and the time error that each part of the drive causes
in a day, a week and a year.
stability names the noise at every averaging time.
)"},
    Topic{"diary", "what the keeper of a clock wrote down, checked by report",
          R"(report LOG --diary FILE reads a table with a header, for instance

  time,what,value,sigma,note
  2013-03-30 10:15,rate,-0.25,0.05,took a penny off the tray
  2013-03-30 18:00,wind,,,
  2013-03-31,clean,,,oiled the pivots

time   date with the time of day or alone, or seconds where the log has no dates
what   rate    regulated: value is the change of the rate, s/day, + faster
       weight  another driving weight: the relative change of the drive
       clean   cleaned or oiled: the relative change of the friction
       set     the hands set: by how many s, + forward
       wind, stop, start, note: no value
value, sigma   the planned value and its standard deviation; both may be empty
The report compares planned and found values, and lists entries that the log
does not show and changes that nobody wrote down. The time of an entry may be a
quarter of an hour off. Entries of rate, weight and clean are events of the fit;
a value with a sigma is prior knowledge in the fit. --diary-out FILE writes the
changes that the log shows, in the same format.
)"},
    Topic{"identifiability", "what a log can and cannot tell",
          R"(A log of a steady clock tells the mean rate and nothing about ε, μ and φ0: they
are 'undetermined'. A change tells more: a change of the driving weight, a start
from rest, a ring-down, or logged amplitudes. With T0 known (--fix T0=2) the
mean rate gives the ratio of drive to friction. A log of a steady clock with a
noisy drive shows how the rate responds to slow and fast changes of the drive.
Two clocks fit such a log, whose responses to slow changes have opposite signs;
one reading of the amplitude (--prior lambda0=0.05+-0.005) tells which of them
it is. fit names the combinations of parameters that are determined, and the
experiment that would tell more, with the σ it would reach.
)"},
    Topic{"exit-codes", "exit codes, and where results and messages go",
          R"(0  done; also if the reader of standard output closes it early, as head does
1  a fault of the program
2  wrong usage, including values given by options such as --set
3  the input cannot be used (the message gives file, line, column, what was
   found and what was expected), or needs more memory than there is
4  no numerical result: a fit or a simulation that does not succeed
5  the output could not be written
If only the fit has no result, report says so and exits 0; fit exits 4.
Results go to standard output or the named file, notes and errors to standard
error. Every error begins with 'goingrate:'. On a terminal notes and errors are
coloured; NO_COLOR=1 in the environment stops that, and --quiet stops the notes.
A file is written whole or not at all; of several, all or none.
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
    constexpr std::size_t description_column = 30;
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
  std::fputs(("goingrate help TOPIC, of\n" + list + "goingrate --help lists the commands.\n").c_str(),
             stdout);
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
