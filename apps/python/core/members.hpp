// The members of every struct that a pickle holds, in order. A struct that has grown does not
// compile here until its new member is named; then increase archive_version by one.
#pragma once

#include "goingrate/analysis/analyse.hpp"

#include <tuple>
#include <type_traits>

// NOLINTBEGIN: a structured binding cannot be made without naming the members
#define GOINGRATE_MEMBERS(Type, ...)                                                               \
  template <class T>                                                                               \
  requires std::is_same_v<std::remove_const_t<T>, Type>                                            \
  auto members(T& whole) {                                                                         \
    auto& [__VA_ARGS__] = whole;                                                                   \
    return std::tie(__VA_ARGS__);                                                                  \
  }
// NOLINTEND

namespace goingrate {

GOINGRATE_MEMBERS(Instant, seconds, fraction)
GOINGRATE_MEMBERS(Beat, time, cycle, amplitude_rad, line, segment, flag, edge)
GOINGRATE_MEMBERS(LineIssue, line, column, kind, found, action, last_line, lines, scattered)
GOINGRATE_MEMBERS(EventColumns, width_s, sigma_s, temperature_c, pressure_mbar, humidity_percent)
GOINGRATE_MEMBERS(GridData, tau0_s, phase_s)
GOINGRATE_MEMBERS(Assumption, text, setting, value)
GOINGRATE_MEMBERS(LogFile, name, lines_before, events_before)
GOINGRATE_MEMBERS(JoinedWeather, quantity, source, readings, step_s, sigma, events_without)
GOINGRATE_MEMBERS(MeanBeat, begin_s, step_s, rise_s, power)
GOINGRATE_MEMBERS(SoundFindings, rate_hz, duration_s, drowned, has_tocks, has_pps, tick, tock)
GOINGRATE_MEMBERS(Site, latitude_deg, longitude_deg)
GOINGRATE_MEMBERS(Reading, time, error_s)
GOINGRATE_MEMBERS(ClockLog, source, files, format, events, grid, readings, columns, origin, site, zone_s, weather,
                  sound, time_base_sigma, has_amplitude, directions_are_open, nominal_period_s, flag_width_rad, gravity_share, assumptions, issues)
GOINGRATE_MEMBERS(Gap, after_cycle, length, probability, bridged, kind)
GOINGRATE_MEMBERS(Beats, beats, gaps, typical_period_s, scatter_s, step, missed, spurious, rivals,
                  bounces, has_downward, segments, longest_countable_gap)
GOINGRATE_MEMBERS(SensorEstimate, value, sigma)
GOINGRATE_MEMBERS(AmplitudeSummary, mean_rad, rms_rad, sigma_rad)
GOINGRATE_MEMBERS(SensorFindings, beat_error_s, sides_are_unknown, offset_rad, at_vertical, amplitude, gravity_share)
GOINGRATE_MEMBERS(RateSummary, crossings, periods, duration_s, nominal_period_s, nominal_is_known,
                  mean_period_s, mean_period_sigma_s, last_period_s, rate_excess, rate_excess_sigma,
                  slope_rate_excess, time_base_sigma)
GOINGRATE_MEMBERS(PartRate, segment, from_cycle, to_cycle, start, rate, amplitude_rad)

GOINGRATE_MEMBERS(RateTerm, name, unit, advance_s, is_known, sigma, step_s)
GOINGRATE_MEMBERS(ImpulseCycle::Estimate, value, sigma)
GOINGRATE_MEMBERS(ImpulseCycle, periods, is_regular, gain, first, cycles, amplitude_step, lateness,
                  kick, middle, amplitude_middle, epsilon)
GOINGRATE_MEMBERS(Displacement, beat, late_s, gain)
GOINGRATE_MEMBERS(Wheel, turn_s, late_s, amplitude_rad, gain)
GOINGRATE_MEMBERS(UnevenReadings, elapsed_s, late_s)
GOINGRATE_MEMBERS(TimingData, reference_period_s, cycle, elapsed_s, lateness_s, amplitude_rad,
                  terms, time_noise, amplitude_noise, as_read, no_swings, impulses, displaced,
                  wheels, wheel_late_s, wheel_amplitude_rad, time_base_sigma)
GOINGRATE_MEMBERS(PlannedRatio, ratio, sigma)
GOINGRATE_MEMBERS(FitEvent, cycle, names, movable, planned, at_crossing)
GOINGRATE_MEMBERS(Prior, name, value, sigma)
GOINGRATE_MEMBERS(FitOptions, dynamics, noise, escapement, events, possible_events, fixed, priors,
                  freed, start, profiles)
GOINGRATE_MEMBERS(ModelChoice, escapement, quadratic, dry, amplitude_scale, jitter, walk, drive,
                  slow, moments)
GOINGRATE_MEMBERS(ProfilePoint, value, fall)
GOINGRATE_MEMBERS(FittedParameter, name, unit, status, value, sigma, low68, high68, low95, high95,
                  sigma_by_law, at_bound, model_shift, profile)
GOINGRATE_MEMBERS(DerivedQuantity, name, expression, unit, value, sigma)
GOINGRATE_MEMBERS(FitQuality, chi2, dof, p_value, of_innovations, whiteness_p, rms_s,
                  amplitude_rms_rad, aic, bic)
GOINGRATE_MEMBERS(FitAlternative, model, bic, verdict)
GOINGRATE_MEMBERS(Experiment, what, relative_sigma)
GOINGRATE_MEMBERS(Thinning, beats, information_lost)
GOINGRATE_MEMBERS(FitNote, kind, text)
GOINGRATE_MEMBERS(ClockTwin, parameters, sigma, delta_2logL)
GOINGRATE_MEMBERS(DecayEstimate, value, sigma, low68, high68, low95, high95)
GOINGRATE_MEMBERS(QAtAmplitude, amplitude_rad, q)
GOINGRATE_MEMBERS(FrictionLaw, friction, bic, behind, T0_s, T0_sigma_s, lambda0, lambda0_sigma, epsilon, epsilon_sigma, quadratic_drag,
                  quadratic_drag_sigma, dry_friction, dry_friction_sigma)
GOINGRATE_MEMBERS(TurningAngle, rad, sigma_rad)
GOINGRATE_MEMBERS(Decay, amplitude_rad, q, time_s, q_at_amplitude, laws, first, last)
GOINGRATE_MEMBERS(FitSummary, status, termination, dynamics, model, chosen_by, parameters,
                  correlated, correlation, combinations, q_factor, stationary_amplitude,
                  rate_s_per_day, decay_time, decay, jitter_s, amplitude_noise_rad, time_widening,
                  amplitude_widening, quality, alternatives, twins, likeliest_twin, experiments, thinning, impulses,
                  events, notes, residual_s, model_amplitude_rad, amplitude_residual_rad)

GOINGRATE_MEMBERS(DeviationRow, tau_s, m, n, value, low, high, alpha, interval, bias)
GOINGRATE_MEMBERS(DeviationTable, kind, tau0_s, rows, bridged)
GOINGRATE_MEMBERS(Spectrum, frequency_hz, density, resolution_hz, degrees_of_freedom, segments,
                  segments_skipped, segment_length)
GOINGRATE_MEMBERS(SpectralLine, frequency_hz, amplitude, amplitude_sigma, phase_rad, ratio,
                  false_alarm, sideband_of)
GOINGRATE_MEMBERS(DriveResponse, fast_gain, slow_gain, corner_hz, amplitude2, switching_angle)
GOINGRATE_MEMBERS(RmsEstimate, rms, low68, high68)
GOINGRATE_MEMBERS(DriveCost, after_s, fast_s, slow_s)
GOINGRATE_MEMBERS(DriveSplit, split_hz, at_frequency, fast, slow, jitter_s, slow_time_s, slow_gain,
                  costs, jitter_density, fast_density, slow_density, note)
GOINGRATE_MEMBERS(DriveAnalysis, rates, interval_s, rate_spectrum, lines, response, split, swings_freely,
                  sees_amplitude)

GOINGRATE_MEMBERS(Change, cycle, at_s, rate_change, rate_change_sigma, amplitude_slope_change,
                  significance, stands_out, kind, next_kind, gain, kind_gain, rate_before,
                  rate_before_sigma, rate_after, rate_after_sigma, noted, planned)
GOINGRATE_MEMBERS(Relaxation, time_constant_s, sigma_s, window_s, limit_rad, rms_rad, exponential,
                  shorter_window_s, longer_window_s)
GOINGRATE_MEMBERS(Interruption, begin, end, amplitude_before_rad, amplitude_after_rad, rate_change,
                  decay, recovery)
GOINGRATE_MEMBERS(Diary, changes, interruptions)
GOINGRATE_MEMBERS(CauseNumbers, at_s, until_s, size, sigma, amplitude_rad, amplitude_sigma_rad,
                  period_s, places)
GOINGRATE_MEMBERS(Suspicion, cause, gain, evidence, alternatives, advice, numbers)
GOINGRATE_MEMBERS(EffectPart, way, coefficient, sigma)
GOINGRATE_MEMBERS(CovariateEffect, name, unit, coefficient, sigma, lag_s, without_s, with_s,
                  interpolation_sigma, step_s, known_share, parts, amplitude, amplitude_sigma)
GOINGRATE_MEMBERS(DrivePoint, at_s, relative, sigma)
GOINGRATE_MEMBERS(DriveHistory, points, step_rms, block_s, from_amplitude, from_rate)
GOINGRATE_MEMBERS(NutTurns, turns, sigma, raise_m)
GOINGRATE_MEMBERS(IsochronismCurve, amplitude_rad, circular, escapement, sum)
GOINGRATE_MEMBERS(Isochronism, amplitude_rad, slope, sigma, fitted_slope, curve)
GOINGRATE_MEMBERS(LogbookEntry, time, whole_day, has_zone, what, value, sigma, note, line)
GOINGRATE_MEMBERS(EntryFinding, entry, at_s, verdict, found_at_s, found, found_sigma)
GOINGRATE_MEMBERS(UnwrittenFinding, entry, at_s)
GOINGRATE_MEMBERS(LogbookCheck, source, entries, unwritten)
GOINGRATE_MEMBERS(Analysis, log, numbered, beats, rate, stretches, now, diary, fit, drive,
                  suspicions, covariates, isochronism, deviation, history, nut, logbook, sensor)

} // namespace goingrate
