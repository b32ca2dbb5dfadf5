"""While the library works: other threads, Ctrl-C, progress, memory."""

import concurrent.futures
import gc
import os
import resource
import signal
import subprocess
import sys
import threading
import time
import tracemalloc

import numpy as np
import pytest

import goingrate as gr
from conftest import SOURCE

SANITIZED = "libasan" in os.environ.get("LD_PRELOAD", "")
# Longer than any of these would take to the end on any machine of today.
LONG = {
    "fit": "gr.fit(gr.read(path))",
    "analyse": "gr.analyse(gr.read(path))",
    "deviation": "gr.deviation(phase=np.random.default_rng(1).normal(size=400000), kind='mtotdev')",
    "map": "gr.map(points=2000)",
    "simulate": "gr.simulate({'clock': {'epsilon': 1e-4, 'mu': 1e-5, 'phi0': 0.03},"
                "'run': {'periods': 10**9}, 'drive': {'fast_rms': 0.1}})",
    "integrate": "gr.integrate(lambda phi, v: 1e-3 * v, periods=10**9)",
}


@pytest.mark.parametrize("call", LONG.values(), ids=LONG.keys())
def test_ctrl_c_ends_the_work(call):
    script = f"""
import sys, numpy as np, goingrate as gr
path = {str(SOURCE / "data" / "logs" / "interruption.csv")!r}
print("begun", flush=True)
try:
    {call}
except KeyboardInterrupt:
    sys.exit(130)
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
    try:
        assert process.stdout.readline() == b"begun\n"
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
    finally:
        process.kill()
        process.stdout.close()
        process.wait()


def test_other_threads_run_meanwhile():
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    gr.deviation(phase=np.random.default_rng(1).normal(size=20000), kind="mtotdev", threads=1)
    end = time.perf_counter()
    done.set()
    thread.join()
    within = [t for t in ticks if begin < t < end]
    # Held throughout, the lock would let the other thread run at the ends only.
    assert len(within) > 5 and max(np.diff(within)) < 0.5 * (end - begin)


def test_progress_that_raises_ends_the_work(jump, tmp_path):
    class Enough(Exception):
        pass

    def stop(news):
        raise Enough(news)

    with pytest.raises(Enough, match="looking for changes"):
        gr.fit(jump, progress=stop)
    with pytest.raises(Enough):
        gr.analyse(jump, progress=stop)
    file = tmp_path / "long.txt"
    file.write_text("".join(f"{2 * n}\n" for n in range(100_000)))
    with pytest.raises(Enough):
        gr.read(file, progress=stop)
    assert gr.fit(jump, fix={"T0": 2}, events=["150:mu"]).success  # nothing is left behind


def test_signals_are_looked_for_within_a_fit(jump):
    """A handler that raises within the call, as a notebook's interrupt does."""

    class Alarm(Exception):
        pass

    def handler(number, frame):
        raise Alarm

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            gr.fit(gr.read(SOURCE / "data" / "logs" / "interruption.csv"))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_threads_give_what_one_gives(jump):
    def work(k):
        log = gr.Log(time_s=jump.time_s, nominal_period_s=2)
        return (gr.fit(log, fix={"T0": 2}, events=["150:mu"]).to_json(),
                gr.rate(log).rate_excess,
                gr.deviation(log, kind=gr.DEVIATION_KINDS[k % 3]).to_json(),
                gr.spectrum(log, fix={"T0": 2}, events=["150:mu"]).to_json())

    alone = [work(k) for k in range(3)]
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        together = list(pool.map(work, range(24)))
    for k, result in enumerate(together):
        assert result == alone[k % 3]


def test_one_log_and_one_fit_are_shared_by_threads(jump, jump_fit):
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        texts = set(pool.map(lambda _: (jump_fit.to_json(), str(jump_fit), jump.native(9),
                                        jump_fit.predict([3000])[0], len(jump.issues)), range(64)))
    assert len(texts) == 1


def test_processes_take_pickled_logs(jump):
    # As dask and multiprocessing do; a fresh interpreter, since a fork would share the memory.
    import multiprocessing

    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(gr.rate, (jump,)).to_json() == gr.rate(jump).to_json()


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


LOOPS = {
    "read": lambda s: gr.read(s.path).time_s,
    "bytes": lambda s: gr.read(s.text).flags,
    "array": lambda s: gr.Log(time_s=s.times, amplitude_rad=s.amplitude).events,
    "rate": lambda s: (gr.rate(s.log).to_dict(), gr.rate(s.log).rate_excess_each),
    "deviation": lambda s: gr.deviation(phase=s.times).value,
    "fit": lambda s: gr.fit(s.log, fix={"T0": 2}, events=["150:mu"]).residual_s,
    "views": lambda s: (s.log.flags, s.fit.residual_s, s.fit.correlation, s.fit.to_json()),
    "pickle": lambda s: s.pickle.loads(s.pickle.dumps((s.log, s.fit))),
    "simulate": lambda s: gr.simulate(s.scenario, seed=2),
    "error": lambda s: s.fails(lambda: gr.read(b"no log\n" * 2000)),
    "law": lambda s: gr.integrate(lambda phi, v: 1e-3 * v, periods=2),
    "law that raises": lambda s: s.fails(lambda: gr.integrate(lambda phi, v: 1 / 0, periods=2)),
    "progress that raises": lambda s: s.fails(lambda: gr.fit(s.log, progress=lambda news: 1 / 0)),
}


class Loop:
    import pickle

    path = SOURCE / "data" / "logs" / "jump.csv"
    scenario = {"clock": {"epsilon": 2.5e-4, "mu": 2e-5, "phi0": 0.03}, "run": {"periods": 2000}}

    def __init__(self, log, fit):
        self.log, self.fit = log, fit
        self.times, self.text = log.time_s.copy(), self.path.read_bytes()
        self.amplitude = np.full(self.times.size, 0.05)

    @staticmethod
    def fails(call):
        with pytest.raises((ValueError, ZeroDivisionError)):
            call()


@pytest.mark.skipif(SANITIZED, reason="the sanitizer keeps what is freed for a while")
@pytest.mark.parametrize("work", LOOPS.values(), ids=LOOPS.keys())
def test_nothing_leaks(work, jump, jump_fit):
    """A loop of a hundred: one leaked log of 2000 beats each time would be 8 MB."""
    state = Loop(jump, jump_fit)
    for _ in range(15):  # caches and arenas fill
        work(state)
    gc.collect()
    tracemalloc.start()
    objects, resident = tracemalloc.get_traced_memory()[0], resident_bytes()
    for _ in range(100):
        work(state)
    gc.collect()
    more_objects = tracemalloc.get_traced_memory()[0] - objects
    more_resident = resident_bytes() - resident
    tracemalloc.stop()
    assert more_objects < 50_000, "bytes of Python objects"
    assert more_resident < 4_000_000, "bytes of memory"  # fragmentation is below 2 MB


@pytest.mark.skipif(SANITIZED, reason="the sanitizer's own memory counts too")
def test_a_large_phase_is_not_copied():
    """The binding hands over the memory: what is used beside is the library's own."""
    x = np.cumsum(np.random.default_rng(1).normal(size=2_000_000))
    tracemalloc.start()
    gr.deviation(phase=x, taus=[1.0])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000  # NumPy's memory is traced; 16 MB would be a copy


@pytest.mark.skipif(SANITIZED, reason="the sanitizer's own memory counts too")
def test_columns_of_a_long_log_are_not_copied():
    log = gr.Log(time_s=2.0 * np.arange(500_000))
    log.time_s
    tracemalloc.start()
    for _ in range(3):
        views = (log.time_s, log.seconds, log.fraction, log.cycle, log.flags, log.edge,
                 log.amplitude_rad, log.events, log.good)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(views) == 9 and peak < 100_000
