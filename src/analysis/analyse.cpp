#include "goingrate/analysis/analyse.hpp"

#include <algorithm>

namespace goingrate {

namespace {

// The values of a column at the good beats, which keep the order of the events.
std::vector<double> at_good_beats(const std::vector<double>& column, const NumberedLog& loaded) {
  std::vector<double> values;
  values.reserve(loaded.good.size());
  const std::vector<Beat>& events = loaded.beats.beats;
  for (std::size_t i = 0; i < events.size(); ++i)
    if (events[i].flag == BeatFlag::good && events[i].segment == loaded.good.front().segment)
      values.push_back(column[i]);
  return values;
}

// Through an interruption, and as long again after it, the lateness stands still: what shook the
// clock then is told by the diary.
void level_interruptions(const Diary& diary, TimingData& data) {
  constexpr double before_s = 30.0;
  for (const Interruption& event : diary.interruptions) {
    const double from = event.begin.at_s - before_s;
    const double to = 2.0 * event.end.at_s - event.begin.at_s;
    double held = 0.0, taken_off = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double late = data.lateness_s[i];
      if (data.elapsed_s[i] < from) {
        held = late;
      } else if (data.elapsed_s[i] <= to) {
        data.lateness_s[i] = held;
        taken_off = late - held;
      } else {
        data.lateness_s[i] -= taken_off;
      }
    }
  }
}

// What the diary tells and the fit follows need not be suspected again.
TimingData unexplained_times(const TimingData& times, const Analysis& data) {
  TimingData unexplained = times;
  const bool told = !data.diary.changes.empty() || !data.diary.interruptions.empty();
  if (told && data.fit.residual_s.size() == times.size())
    unexplained.lateness_s = data.fit.residual_s;
  level_interruptions(data.diary, unexplained);
  return unexplained;
}

} // namespace

TimingData fit_data(const NumberedLog& loaded) {
  TimingData data = timing_data(loaded.good);
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& column) {
    if (!column.empty())
      data.terms.push_back(rate_term(name, unit, data, at_good_beats(column, loaded)));
  };
  const EventColumns& columns = loaded.log.columns;
  add("temperature", "1/K", columns.temperature_c);
  add("pressure", "1/mbar", columns.pressure_mbar);
  if (!columns.temperature_c.empty() && !columns.pressure_mbar.empty())
    add("density", "m^3/kg", air_density(columns.temperature_c, columns.pressure_mbar));
  return data;
}

std::vector<FitEvent> events_of_diary(const NumberedLog& loaded) {
  constexpr std::size_t most = 4; // each costs a parameter
  std::vector<FitEvent> events;
  for (const Change& change :
       strongest_changes(keep_diary(loaded.good, loaded.nominal_period_s), most))
    events.push_back({change.cycle - loaded.good.front().cycle, {"mu"}, true});
  return events;
}

Analysis analyse(NumberedLog loaded, const FitOptions& fit,
                 const std::function<void(std::string_view)>& now) {
  const auto tell = [&](std::string_view what) {
    if (now) now(what);
  };
  Analysis data;
  data.rate = summarise_rates(loaded.good, loaded.nominal_period_s);
  data.rate.nominal_is_known = loaded.nominal_is_known;
  data.diary = keep_diary(loaded.good, loaded.nominal_period_s);
  const TimingData times = fit_data(loaded);
  FitOptions asked = fit;
  asked.profiles = true;
  tell("fitting the model");
  data.fit = fit_clock(times, loaded.nominal_period_s, asked);
  tell("looking at temperature and pressure");
  data.covariates = covariate_effects(times);
  tell("spectrum of the rate, fast and slow drive");
  data.drive = analyse_drive(loaded.good, loaded.nominal_period_s, data.fit);
  tell("the drive as it went");
  if (const auto model = drive_model(data.fit, times)) data.history = drive_history(times, *model);
  tell("likely causes");
  const TimingData unexplained = unexplained_times(times, data);
  const double missed = 1.0 - static_cast<double>(times.size()) / (times.cycle.back() + 1.0);
  data.suspicions = diagnose({&unexplained, loaded.nominal_period_s, missed, data.drive.lines});
  tell("stability");
  const PhaseSeries phase = phase_series(loaded);
  data.deviation = stability_table(DeviationKind::oadev, phase.phase_s, phase.tau0_s,
                                   octave_factors(phase.phase_s.size()));
  data.beats.assign(loaded.good.begin(), loaded.good.end());
  data.log = std::move(loaded.log);
  data.numbered = std::move(loaded.beats);
  return data;
}

} // namespace goingrate
