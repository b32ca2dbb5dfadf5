// Writes the clock set by the sliders as a scenario, which `goingrate simulate` reads.

/** The sliders; those with `event` describe a change of μ. */
export const sliders = [
  { key: "epsilon", label: "friction ε", least: 2e-5, greatest: 2e-3, usual: 2.5e-4, logarithmic: true },
  { key: "mu", label: "driving torque μ", least: 2e-6, greatest: 2e-4, usual: 2e-5, logarithmic: true },
  { key: "phi0", label: "escapement angle φ0, rad", least: 0.005, greatest: 0.1, usual: 0.03, logarithmic: true },
  { key: "T0", label: "period of small free swings T0, s", least: 0.4, greatest: 3, usual: 2, step: 0.01 },
  { key: "periods", label: "periods", least: 200, greatest: 10000, usual: 2000, step: 100 },
  { key: "jitter", label: "scatter of the sensor's times, s", least: 1e-7, greatest: 1e-2, usual: 1e-5, logarithmic: true },
  { key: "fast", label: "fast noise of the drive, rms", least: 0, greatest: 0.5, usual: 0, step: 0.01 },
  { key: "slow", label: "slow noise of the drive, rms", least: 0, greatest: 0.3, usual: 0, step: 0.01 },
  { key: "missed", label: "share of beats missed", least: 0, greatest: 0.1, usual: 0, step: 0.005 },
  { key: "spurious", label: "share of spurious events", least: 0, greatest: 0.1, usual: 0, step: 0.005 },
  { key: "seed", label: "seed of the noise", least: 1, greatest: 1000, usual: 1, step: 1 },
  { key: "at", label: "after this many periods", least: 10, greatest: 5000, usual: 300, step: 10, event: true },
  { key: "factor", label: "μ is multiplied by", least: 0.25, greatest: 4, usual: 2, logarithmic: true, event: true },
];

const slowMemory = 900; // s

const driveText = ({ fast, slow }) => (fast > 0 || slow > 0
  ? `\n[drive]\nfast_rms = ${fast}\nslow_rms = ${slow}\n${slow > 0 ? `slow_time = ${slowMemory}\n` : ""}` : "");

/** `clock`: a value for each slider, and hasEvent. */
export function scenarioText(clock) {
  const event = clock.hasEvent ? `\n[[event]]\nat_period = ${clock.at}\nmu = ${clock.mu * clock.factor}\n` : "";
  return `[clock]\nnominal_period = ${clock.T0}\nepsilon = ${clock.epsilon}\nmu = ${clock.mu}\nphi0 = ${clock.phi0}\n
[start]\namplitude = "stationary"\n\n[run]\nperiods = ${clock.periods}\n${event}${driveText(clock)}
[sensor]\njitter_rms = ${clock.jitter}\nmissed = ${clock.missed}\nspurious = ${clock.spurious}\n`;
}
