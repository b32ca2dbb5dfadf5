"""Times plain numpy versions of the deviations on the phases and factors that study_stability used.

stability.py PHASES TIMES: PHASES holds doubles, TIMES what `study_stability time` printed. Each numpy
version is what one writes down from the definition in whole-array operations, with prefix sums where
they save a factor of m, and computes the values alone: no noise type, no interval.
"""
import statistics
import sys
import time

import numpy as np


def second(x, m, step=1):
    z = x[2 * m::step] - 2 * x[m:-m:step] + x[:-2 * m:step]
    return np.sqrt(np.mean(z * z) / 2) / m


def third(x, m, step=1):
    z = x[3 * m::step] - 3 * x[2 * m:-m:step] + 3 * x[m:-2 * m:step] - x[:-3 * m:step]
    return np.sqrt(np.mean(z * z) / 6) / m


def modified(x, m):
    c = np.concatenate([[0.0], np.cumsum(x)])
    z = c[3 * m:] - 3 * c[2 * m:-m] + 3 * c[m:-2 * m] - c[:-3 * m]
    return np.sqrt(np.mean(z * z) / 2) / m**2


def total(x, m):
    n = len(x)
    inner = np.concatenate([2 * x[0] - x[m - 1:0:-1] if m > 1 else x[:0], x,
                            2 * x[-1] - x[-2:-m - 1:-1] if m > 1 else x[:0]])
    z = inner[2 * m:] - 2 * inner[m:-m] + inner[:-2 * m]
    assert len(z) == n - 2
    return np.sqrt(np.mean(z * z) / 2) / m


def total_runs(v, m):
    run, half, sum_of_means = 3 * m, 3 * m // 2, 0.0
    index = np.arange(run)
    for i in range(len(v) - run + 1):
        s = v[i:i + run]
        s = s - (s[run - half:].mean() - s[:half].mean()) / (run - half) * index
        c = np.concatenate([[0.0], np.cumsum(np.concatenate([s[::-1], s, s[::-1]]))])
        z = (c[3 * m:] - 3 * c[2 * m:-m] + 3 * c[m:-2 * m] - c[:-3 * m])[:2 * run] / m
        sum_of_means += np.mean(z * z)
    return sum_of_means / (len(v) - run + 1)


def modified_total(x, m):
    return np.sqrt(total_runs(x, m) / 2) / m


def hadamard_total(x, m):
    return third(x, 1) if m == 1 else np.sqrt(total_runs(np.diff(x), m) / 6)


def theo1(x, m):
    n, h, total_sum = len(x), m // 2, 0.0
    ends = x[:n - m] + x[m:]
    for d in range(h):
        z = ends - x[h - d:h - d + n - m] - x[h + d:h + d + n - m]
        total_sum += np.dot(z, z) / (h - d)
    return np.sqrt(total_sum / (0.75 * (n - m))) / m


def largest_range(x, m):
    high, low, width = x, x, 1
    while 2 * width <= m + 1:
        high, low = np.maximum(high[:-width], high[width:]), np.minimum(low[:-width], low[width:])
        width *= 2
    rest = m + 1 - width
    if rest:
        high, low = np.maximum(high[:-rest], high[rest:]), np.minimum(low[:-rest], low[rest:])
    return np.max(high - low)


def rms_change(x, m):
    z = x[m:] - x[:-m]
    return np.sqrt(np.mean(z * z))


def parabolic(x, m):
    if m == 1:
        return second(x, 1)
    p = np.concatenate([[0.0], np.cumsum(x)])
    q = np.concatenate([[0.0], np.cumsum(p)])
    n = len(x)
    b = 0.5 * (m - 1) * (p[m:n + 1] + p[:n + 1 - m]) - (q[m:n + 1] - q[1:n + 2 - m])
    z = (b[m:] - b[:-m])[:n - 2 * m]
    return np.sqrt(72 * np.mean(z * z)) / m**3


DEVIATIONS = {
    "adev": lambda x, m: second(x, m, m), "oadev": second, "mdev": modified,
    "hdev": lambda x, m: third(x, m, m), "ohdev": third, "totdev": total,
    "mtotdev": modified_total, "htotdev": hadamard_total, "theo1": theo1, "mtie": largest_range,
    "tierms": rms_change, "pdev": parabolic,
}


def main():
    phases = np.fromfile(sys.argv[1])
    print(f"{'kind':<8} {'phases':>9} {'factors':>8} {'whole, s':>9} {'values, s':>10} {'numpy, s':>9} "
          f"{'whole':>6} {'values':>7} {'worst difference':>17}")
    for line in open(sys.argv[2]):
        kind, points, seconds, given, *rows = line.split()
        x = phases[:int(points)]
        times = []
        while not times or (sum(times) < 0.3 and len(times) < 51):  # short runs scatter most
            begin = time.process_time()
            worst = 0.0
            for row in rows:
                m, value = row.split("=")
                worst = max(worst, abs(DEVIATIONS[kind](x, int(m)) / float(value) - 1))
            times.append(time.process_time() - begin)
        took = statistics.median(times)
        print(f"{kind:<8} {points:>9} {len(rows):>8} {float(seconds):>9.4f} {float(given):>10.4f} "
              f"{took:>9.3f} {took / float(seconds):>6.1f} {took / float(given):>7.1f} {worst:>17.1e}", flush=True)


main()
