"""What it costs to call goingrate from Python: overhead of a call, memory of large arrays, and the time of
long data beside that of the command. python.py COMMAND [PHASES]
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import tracemalloc
from pathlib import Path

import numpy as np

import goingrate as gr

SOURCE = Path(__file__).resolve().parents[2]


def processor_s():
    """Seconds of processors so far, children's too: what else the machine does hardly touches it."""
    return sum(os.times()[:4])


def microseconds(call, least_s=0.5):
    """The best mean of ten rounds: what is above it is the machine's."""
    call()
    count, took = 1, 0.0
    while took < least_s / 10:
        count *= 2
        begin = time.process_time()
        for _ in range(count):
            call()
        took = time.process_time() - begin
    rounds = []
    for _ in range(10):
        begin = time.process_time()
        for _ in range(count):
            call()
        rounds.append((time.process_time() - begin) / count)
    return 1e6 * min(rounds)


def seconds_of(call):
    begin = processor_s()
    call()
    return processor_s() - begin


def medians(*calls, rounds=5):
    """Medians over rounds in which the calls take turns, so that what slows the machine slows all."""
    return np.median([[seconds_of(call) for call in calls] for _ in range(rounds)], axis=0)


def overheads():
    log = gr.read(SOURCE / "data" / "logs" / "jump.csv")
    fit = gr.fit(log, fix={"T0": 2}, events=["150:mu"])
    few = gr.Log(time_s=2.0 * np.arange(10))
    phase = np.array([0.0, 1e-6, 0.0])
    print("overhead: us a call, the library's own work on the least data included")
    for words, call in {
        "gr.rate(log) of 10 beats": lambda: gr.rate(few),
        "gr.deviation(phase=x) of 3 phases": lambda: gr.deviation(phase=phase),
        "gr.operating_point, first order": lambda: gr.operating_point(
            epsilon=2.5e-4, mu=2e-5, first_order=True),
        "fit['epsilon'].value": lambda: fit["epsilon"].value,
        "fit['epsilon'].interval(0.95)": lambda: fit["epsilon"].interval(0.95),
        "fit.residual_s": lambda: fit.residual_s,
        "log.time_s": lambda: log.time_s,
        "log.flags": lambda: log.flags,
        "log.events": lambda: log.events,
        "fit.predict([10])": lambda: fit.predict([10]),
    }.items():
        print(f"  {words:36} {microseconds(call):7.2f}")


def copies(count):
    x = np.cumsum(np.random.default_rng(1).normal(size=count)) * 1e-6
    tracemalloc.start()
    gr.deviation(phase=x, taus=[1.0])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(f"gr.deviation(phase=x), x of {x.nbytes / 1e6:.0f} MB: NumPy's memory grows by {peak / 1e6:.3f} MB")
    log = gr.Log(time_s=2.0 * np.arange(count // 10))
    tracemalloc.start()
    for name in ("seconds", "fraction", "cycle", "amplitude_rad", "flags", "edge", "events", "good"):
        getattr(log, name)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(f"all columns of a log of {len(log)} events (40 MB): {peak / 1e6:.3f} MB")
    return x


def long_data(command, x):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "phase.txt"
        with open(file, "w") as out:
            out.writelines(f"{value!r}\n" for value in x.tolist())
        words = [command, "--quiet", "stability", file, "--data", "phase", "--taus", "octave"]
        theirs = json.loads(subprocess.run([*words, "--json", "-"], check=True, text=True,
                                           capture_output=True).stdout)
        log = gr.read(file, format="phase", only_phases=True)
        whole, reading, of_log, of_array = medians(
            lambda: subprocess.run([*words, "-o", "/dev/null"], check=True),
            lambda: gr.read(file, format="phase", only_phases=True),
            lambda: gr.deviation(log),
            lambda: gr.deviation(phase=x))
        same = gr.deviation(phase=x).value.tolist() == [row["value"] for row in theirs["rows"]]
    print(f"{x.size} phases, oadev at {len(theirs['rows'])} averaging times; processor time, median of 5")
    print(f"  the command, file to table            {whole:7.2f} s")
    print(f"  gr.read                               {reading:7.2f} s")
    print(f"  gr.deviation(log)                     {of_log:7.2f} s  read and this {(reading + of_log) / whole:.2f} of the command")
    print(f"  gr.deviation(phase=array)             {of_array:7.2f} s")
    print(f"  the same numbers to the last bit: {'yes' if same else 'NO'}")


def laws():
    def linear(phi, v):
        return 1e-3 * v

    calls = 0

    def counted(phi, v):
        nonlocal calls
        calls += 1
        return 1e-3 * v

    gr.integrate(counted, periods=20)
    took = medians(lambda: gr.integrate(linear, periods=200))[0] / 200
    print(f"gr.integrate with a friction law in Python: {calls // 20} calls and {1e3 * took:.2f} ms a period")


def main():
    print(f"Python {sys.version.split()[0]}, numpy {np.__version__}, goingrate {gr.__version__}")
    overheads()
    long_data(sys.argv[1], copies(int(float(sys.argv[2])) if len(sys.argv) > 2 else 10_000_000))
    laws()


if __name__ == "__main__":
    main()
