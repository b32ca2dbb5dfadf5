// libFuzzer target: any bytes as a log, read under various options, numbered and summarised.
#include "memory.hpp"

#include "sound/recording.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/logbook.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace goingrate;

// The first byte of the input chooses the options, so that the fuzzer reaches every format, the
// weather and a keeper's diary.
constexpr std::uint8_t weather = 12, logbook = 13;
ReadingOptions options_of(std::uint8_t choice) {
  ReadingOptions options;
  constexpr std::uint8_t formats = 11;
  const std::uint8_t format = choice % 16;
  if (format < formats) options.format = static_cast<LogFormat>(format);
  options.weather = format == weather;
  options.decimal_comma = (choice & 0x10) != 0;
  if ((choice & 0x20) != 0) options.wrap_s = 65536e-6;
  if ((choice & 0x40) != 0) options.nominal_period_s = 2.0;
  if ((choice & 0x80) != 0) options.columns = {"time=1", "amplitude=2:mrad"};
  return options;
}

void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

void use(ClockLog&& log) {
  // In order, but where a block begins; and that is told.
  std::size_t back = 0, told = 0;
  for (std::size_t i = 1; i < log.events.size(); ++i)
    back += log.events[i].time < log.events[i - 1].time ? 1 : 0;
  for (const LineIssue& issue : log.issues)
    told += issue.action == "a new segment" ? issue.lines : 0;
  demand(log.grid || back <= told, "events in order of time");
  for (const Beat& event : log.events)
    demand(event.time.fraction >= 0.0 && event.time.fraction < 1.0, "a fraction of a second");
  const std::size_t events = log.events.size();
  if (log.grid) {
    demand(events <= log.grid->phase_s.size(), "an event for a value");
    (void)beats_on_grid(std::move(log.events), log.source);
    return;
  }
  (void)mark_bounces(log);
  (void)label_alternate_edges(log, false, log.nominal_period_s);
  const Beats beats = number_beats(std::move(log.events), log.source,
                                   {.nominal_period_s = log.nominal_period_s}); // as load() does
  demand(beats.beats.size() == events, "no event is dropped");
  const auto longest = beats.longest_segment();
  if (longest.size() < 3) return;
  const RateSummary summary = summarise_rates(longest, beats.typical_period_s);
  demand(std::isfinite(summary.rate_excess), "a rate that is a number");
  (void)beat_error(beats.beats);
  (void)sensor_offset(beats.beats, beats.typical_period_s);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (is_sound(text)) return 0; // has a target of its own: a codec takes what it takes
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) +
                     static_cast<std::size_t>(std::count(text.begin(), text.end(), '\r')) + 1;
  // Ten times the input, what a line takes however short it is, and what any run takes (a list of
  // 500 issues, a table of 256 columns).
  const auto limit = [&](std::size_t a_line) { return 10 * size + a_line * lines + (128U << 10); };
  fuzz::reset_peak();
  const std::size_t before = fuzz::peak_bytes();
  const auto taken = [&] { return fuzz::peak_bytes() - before; };
  try {
    if (data[0] % 16 == logbook) {
      demand(!logbook_text(parse_logbook(text, "fuzz")).empty(), "entries can be written");
      demand(taken() <= limit(400), "memory of the logbook in proportion"); // an entry and its line
      return 0;
    }
    ClockLog log = read_log(text, "fuzz", options_of(data[0]));
    demand(taken() <= limit(48), "memory of the reader in proportion"); // an event takes 40
    if (data[0] % 16 != weather) use(std::move(log));                   // weather is not a clock
  } catch (const InputError&) {    // what bad input is answered with
  } catch (const ArgumentError&) { // a column that is not there
  }
  // Events, the longest segment of them, and nine numbers each for their noise.
  demand(taken() <= limit(152), "memory of the numbering in proportion");
  return 0;
}
