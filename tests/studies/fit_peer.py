"""fit_peer.py LOG [RESULT]: the log of a clock whose drive changes at cycle 150, fitted by
scipy.optimize.least_squares with the first-order averaged equations of dynamics/averaged.hpp.

RESULT is what `goingrate fit LOG --fix T0=2 --event 150:mu --model averaged1 --json RESULT` wrote;
if given, the parameters and their standard deviations are compared with it.
"""

import json
import statistics
import sys
import time

import numpy as np
import scipy
from scipy.optimize import least_squares

T0 = 2.0
EVENT_CYCLE = 150
TWO_PI = 2 * np.pi
NAMES = ["epsilon", "mu", "phi0", "lambda0", "mu@1"]
# From data/scenarios/jump.toml; lambda0 is the stationary amplitude, lambda^2 = 2 mu phi0/(pi eps).
TRUTH = np.array([2.5e-4, 2e-5, 0.03, np.sqrt(2 * 2e-5 * 0.03 / (np.pi * 2.5e-4)), 4e-5])
START = np.log(1.05 * TRUTH)
REPEATS = 5


class Log:
    """A native log with every beat present, reduced to what a fit needs."""

    def __init__(self, path):
        with open(path) as lines:
            numbers = [float(line) for line in lines if line[0].isdigit()]
        times = np.array(numbers)
        self.cycle = np.arange(times.size, dtype=float)
        self.elapsed = times - times[0]
        self.period = self.elapsed[-1] / self.cycle[-1]
        self.lateness = self.elapsed - self.cycle * self.period
        self.first_part = self.cycle <= EVENT_CYCLE
        self.second_part = ~self.first_part


class Motion:
    """Amplitude and phase in closed form while the parameters are constant."""

    def __init__(self, epsilon, mu, phi0, amplitude2_start):
        self.epsilon, self.start, self.phi0 = epsilon, amplitude2_start, phi0
        self.torque = 2 * mu / np.pi
        self.limit = self.torque * phi0 / epsilon
        self.root = np.sqrt(abs(self.limit - phi0**2))
        self.driven = self.limit > phi0**2
        self.primitive_start = self.primitive(np.sqrt(amplitude2_start - phi0**2))

    def primitive(self, y):
        """The integral of y/x dt, but for its part linear in time and a factor -epsilon."""
        arc = self.phi0 * np.arctan(y / self.phi0)
        if self.driven:
            return (arc - self.root * np.log(y + self.root)) / self.limit
        return (arc - self.root * np.arctan(y / self.root)) / self.limit

    def at(self, t):
        """lambda^2, psi - t and psi' - 1 at scaled time t (a number or an array)."""
        gone = -np.expm1(-2 * self.epsilon * t)
        amplitude2 = self.start + (self.limit - self.start) * gone
        area = self.limit * t + (self.start - self.limit) * gone / (2 * self.epsilon)
        y = np.sqrt(amplitude2 - self.phi0**2)
        pushed = (self.primitive_start - self.primitive(y)) / self.epsilon
        if self.driven:
            pushed += self.root / self.limit * t
        rate = self.torque * y / amplitude2 - amplitude2 / 16
        return amplitude2, self.torque * pushed - area / 16, rate


def residuals(logarithms, log):
    """Lateness of every beat against the model, s, mean removed."""
    epsilon, mu, phi0, lambda0, mu_after = np.exp(logarithms)
    before = Motion(epsilon, mu, phi0, lambda0**2)
    angle = TWO_PI * EVENT_CYCLE
    event_time = angle
    for _ in range(3):
        amplitude2, excess, rate = before.at(event_time)
        event_time -= (event_time + excess - angle) / (1 + rate)
    amplitude2, excess, _ = before.at(event_time)
    after = Motion(epsilon, mu_after, phi0, amplitude2)
    longer = T0 - log.period
    event_late = EVENT_CYCLE * longer - T0 / TWO_PI * excess
    event_elapsed = EVENT_CYCLE * log.period + event_late

    def late(motion, part, cycle, elapsed, late_then):
        _, excess, rate = motion.at((log.elapsed[part] - elapsed) * (TWO_PI / T0))
        due = late_then + (log.cycle[part] - cycle) * longer - T0 / TWO_PI * excess
        return (log.lateness[part] - due) / (1 + rate)

    late_s = np.concatenate([
        late(before, log.first_part, 0, 0.0, 0.0),
        late(after, log.second_part, EVENT_CYCLE, event_elapsed, event_late),
    ])
    return late_s - late_s.mean()


def timed_fit(method, log):
    """The result of a fit, the median of the seconds it took and the evaluations it made."""
    evaluations = 0

    def counted(logarithms):
        nonlocal evaluations
        evaluations += 1
        return residuals(logarithms, log)

    seconds = []
    for _ in range(REPEATS):
        evaluations = 0
        begin = time.process_time()
        result = least_squares(counted, START, method=method, x_scale="jac",
                               xtol=1e-12, ftol=1e-12, gtol=1e-12)
        seconds.append(time.process_time() - begin)
    return result, statistics.median(seconds), evaluations


def compare(result_path, values, sigmas):
    """Prints how far scipy's parameters are from those of goingrate, in goingrate's sigmas."""
    with open(result_path) as text:
        result = json.load(text)
    theirs = {parameter["name"]: parameter for parameter in result["parameters"]}
    off = [abs(v - theirs[n]["value"]) / theirs[n]["sigma"] for n, v in zip(NAMES, values)]
    wide = [theirs[n]["sigma"] / sigma for n, sigma in zip(NAMES, sigmas)]
    print(f"  largest difference from goingrate {max(off):.1e} sigma ({NAMES[np.argmax(off)]});")
    print(f"  its sigmas {min(wide):.4f} to {max(wide):.4f} of these, "
          f"its rms {result['quality']['rms_s']:.6e} s")


def main():
    log = Log(sys.argv[1])
    freedom = log.cycle.size - len(NAMES) - 1  # the mean is fitted as well
    print(f"scipy {scipy.__version__}, numpy {np.__version__}, {log.cycle.size} beats")
    for method in "lm", "trf":
        fit, seconds, evaluations = timed_fit(method, log)
        square, values = fit.fun @ fit.fun, np.exp(fit.x)
        sigmas = values * np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)) * square / freedom)
        print(f"{method} {seconds * 1e3:.2f} ms, {evaluations} evaluations, "
              f"rms {np.sqrt(square / log.cycle.size):.6e} s, {fit.message}")
        for name, value, sigma in zip(NAMES, values, sigmas):
            print(f"  {name:8} {value:.10e} +- {sigma:.2e}")
        if len(sys.argv) > 2:
            compare(sys.argv[2], values, sigmas)


if __name__ == "__main__":
    main()
