"""Every main job as a process of its own, beside its peer. speed.py COMMAND LARGEST

Prints for each job and size: seconds of processor (user and system, median of rounds in which a job and its
peers take turns), how often ours goes into the peer's, the exponent of our growth since the size before, and
the largest memory over the number of beats. What a process costs before it does anything is printed first.
"""

import math
import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

COMMAND, LARGEST = Path(sys.argv[1]).resolve(), int(float(sys.argv[2]))
HERE = Path(__file__).resolve().parent

# What peers do: each is a program that gets the log's path.
LOADTXT = "import sys, numpy; numpy.loadtxt(sys.argv[1])"
READ_CSV = "import sys, pandas; pandas.read_csv(sys.argv[1], header=None)"
TABLE = """
import sys, pandas
t = pandas.read_csv(sys.argv[1], header=None)[0]
period = t.diff()
table = pandas.DataFrame({"time": t, "period": period, "rate": 2 / period - 1, "per_day": 86400 * (2 / period - 1)})
table.to_csv(sys.argv[1] + ".table")
"""
DEVIATION = """
import sys, numpy
x = numpy.loadtxt(sys.argv[1])
m = 1
while 3 * m < len(x):
    z = x[2 * m:] - 2 * x[m:-m] + x[:-2 * m]
    numpy.sqrt(numpy.mean(z * z) / 2) / m
    m *= 2
"""
WELCH = """
import sys, numpy, scipy.signal
t = numpy.loadtxt(sys.argv[1])
scipy.signal.welch(2 / numpy.diff(t) - 1, fs=0.5, nperseg=min(len(t) - 1, 4096))
"""


def spent(command):
    """Seconds of processor and bytes of memory at most of a process that must succeed."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        process = subprocess.Popen(command, stdout=nowhere, stderr=nowhere)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(map(str, command))} failed")
    return usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def medians(commands, beats):
    rounds = 5 if beats <= 1_000_000 else 3
    runs = [[spent(command) for command in commands] for _ in range(rounds)]
    return [(statistics.median(run[i][0] for run in runs), max(run[i][1] for run in runs))
            for i in range(len(commands))]


def write_times(path, beats, decimals):
    """A clock of 2 s: 10 us of jitter, and a drive that makes its times walk."""
    import numpy as np
    random = np.random.default_rng(beats)
    times = 5.0 + 2.0 * np.arange(beats) + 1e-5 * random.standard_normal(beats)
    times += np.cumsum(2e-6 * random.standard_normal(beats))
    with path.open("w", encoding="ascii") as file:
        for begin in range(0, beats, 100_000):
            file.write("".join(f"{t:.{decimals}f}\n" for t in times[begin:begin + 100_000]))


def write_phases(path, beats):
    import numpy as np
    np.savetxt(path, 1e-9 * np.random.default_rng(beats).standard_normal(beats), fmt="%.12e")


def written(path, write, *what):
    """The log, written by a process of its own: the memory of this one counts in all that it starts."""
    if not path.exists():
        writer = multiprocessing.get_context("spawn").Process(target=write, args=(path, *what))
        writer.start()
        writer.join()
        if writer.exitcode != 0:
            raise SystemExit(f"{path} could not be written")
    return path


def python(program):
    return lambda path: ["/usr/bin/python3", "-c", program, path]


def ours(*words):
    return lambda path: [COMMAND, words[0], path, *words[1:]]


# Name, largest size, how a log is made, what we do, what peers do.
def jobs(folder):
    plain = lambda decimals: lambda beats: written(
        folder / f"times-{beats}-{decimals}", write_times, beats, decimals)
    phases = lambda beats: written(folder / f"phases-{beats}", write_phases, beats)
    readers = {"numpy.loadtxt": python(LOADTXT), "pandas.read_csv": python(READ_CSV)}
    read = ours("rate", "--json", "-", "--quiet")
    return [
        *((f"read and number, {d} decimals", 10**8, plain(d), read, readers) for d in (6, 8, 12)),
        ("the same, table written", 10**8, plain(8),
         lambda log: [COMMAND, "rate", log, "-o", f"{log}.table", "--quiet"],
         {"pandas to_csv": python(TABLE)}),
        ("stability, all octaves", 10**8, phases,
         ours("stability", "--format", "phase", "--tau0", "1", "--json", "-", "--quiet"),
         {"numpy, values only": python(DEVIATION)}),
        ("spectrum", 10**6, plain(8), ours("spectrum", "--fix", "T0=2", "--json", "-", "--quiet"),
         {"scipy welch only": python(WELCH)}),
        ("fit, steady", 10**6, plain(8), ours("fit", "--fix", "T0=2", "--json", "-", "--quiet"), {}),
        ("report", 10**6, plain(8), ours("report", "-o", "/dev/stdout", "--quiet"), {}),
    ]


def main():
    print("a process that does nothing: "
          + ", ".join(f"{name} {1e3 * medians([command], 1)[0][0]:.0f} ms" for name, command in (
              ("ours", [COMMAND, "--version"]),
              ("python with numpy", ["/usr/bin/python3", "-c", "import numpy"]),
              ("with pandas", ["/usr/bin/python3", "-c", "import pandas"]))))
    print(f"{'job':<32}{'beats':>9}{'s':>9}{'exponent':>9}{'bytes per beat':>16}  peers: s, times ours")
    with tempfile.TemporaryDirectory() as name:
        for job, most, make, our, peers in jobs(Path(name)):
            before = None
            beats = 1000
            while beats <= min(most, LARGEST):
                log = make(beats)
                (took, memory), *others = medians([our(log), *(p(log) for p in peers.values())], beats)
                exponent = f"{math.log10(took / before):.2f}" if before else ""
                print(f"{job:<32}{beats:>9}{took:>9.3f}{exponent:>9}{memory / beats:>16.0f}  "
                      + "; ".join(f"{peer} {s:.3f} {s / took:.2f}"
                                  for peer, (s, _) in zip(peers, others)), flush=True)
                before = took
                beats *= 10


if __name__ == "__main__":
    main()
