"""Logs as arrays: views without a copy, times without a loss, and back."""

import pickle

import numpy as np
import pytest

import goingrate as gr
from conftest import LOGS, SOURCE


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("name", ["seconds", "fraction", "cycle", "amplitude_rad", "flags", "edge"])
def test_columns_are_read_only_views_of_one_memory(name, jump):
    column = getattr(jump, name)
    events = jump.events
    assert address(events) <= address(column) < address(events) + events.itemsize
    assert address(getattr(jump, name)) == address(column)
    assert column.shape == (len(jump),)
    assert not column.flags.writeable
    with pytest.raises(ValueError):
        column[0] = 1


def test_several_files_are_one_log(tmp_path):
    lines = [b"%.6f\n" % (1.5e9 + 2.0003 * n) for n in range(300)]
    (tmp_path / "b.txt").write_bytes(b"".join(lines[:100]))
    (tmp_path / "a.txt").write_bytes(b"".join(lines[100:]))
    whole = gr.read(b"".join(lines))
    for source in (tmp_path, [tmp_path / "a.txt", str(tmp_path / "b.txt")]):
        np.testing.assert_array_equal(gr.read(source).time_s, whole.time_s)


@pytest.mark.parametrize("name", ["time_s", "elapsed_s"])
def test_times_are_computed_once(name, jump):
    times = getattr(jump, name)
    assert getattr(jump, name) is times
    assert not times.flags.writeable
    with pytest.raises(ValueError):
        times.flags.writeable = True


def test_views_outlive_the_log(beats):
    log = gr.Log(time_s=beats)
    views = log.flags, log.time_s, log.good, log.cycle
    kept = [view.copy() for view in views]
    del log
    bytearray(10**7)  # might take the memory, if that had been let go
    for view, copy in zip(views, kept):
        assert view.tobytes() == copy.tobytes()


def test_flags_tell_what_events_are(beats):
    times = np.sort(np.append(np.delete(beats, 100), beats[200] + 0.7))
    log = gr.Log(time_s=times)
    assert log.flags.dtype == np.uint8
    assert np.flatnonzero(log.flags == gr.Flag.SPURIOUS).tolist() == [200]
    assert (log.missed, log.spurious) == (1, 1)
    assert [(gap.after_cycle, gap.length, gap.kind) for gap in log.gaps] == [(99, 1, "missed")]
    assert log.cycle[[99, 100]].tolist() == [99, 101]


def test_an_array_is_the_log_of_its_times(beats, tmp_path):
    beats = np.round(beats * 2**13) / 2**13  # decimal text holds these exactly
    file = tmp_path / "beats.txt"
    file.write_text("".join(f"{t!r}\n" for t in beats.tolist()))
    read, made = gr.read(file), gr.Log(time_s=beats)
    assert made.events.tobytes() == read.events.tobytes()
    assert made.nominal_period_s == read.nominal_period_s
    assert gr.rate(made).rate_excess == gr.rate(read).rate_excess


def test_times_and_amplitudes_come_back(beats):
    amplitude = 0.05 + 1e-4 * np.sin(np.arange(500.0))
    amplitude[7] = np.nan
    log = gr.Log(time_s=beats, amplitude_rad=amplitude, nominal_period_s=2, name="mine")
    np.testing.assert_array_equal(log.time_s, beats)
    np.testing.assert_array_equal(log.amplitude_rad, amplitude)
    assert (log.nominal_period_s, log.source, log.has_amplitude) == (2.0, "mine", True)


def test_two_parts_keep_what_one_loses():
    start, n = 1_700_000_000, np.arange(1000)
    seconds, fraction = start + 2 * n, 0.25 + 1e-11 * n  # 10 ps per beat
    log = gr.Log(seconds=seconds, fraction=fraction)
    np.testing.assert_array_equal(log.seconds, seconds)
    np.testing.assert_array_equal(log.fraction, fraction)
    rate = gr.rate(log)
    # T0/mean period - 1; the fractions are rounded to 2^-54 s.
    assert rate.rate_excess == pytest.approx(-5e-12, abs=1e-17)
    assert gr.rate(gr.Log(time_s=seconds + fraction)).rate_excess != rate.rate_excess


def test_parts_may_carry():
    log = gr.Log(seconds=[0, 1, 3, 6], fraction=[0.5, 1.5, 1.5, -0.5])
    assert log.seconds.tolist() == [0, 2, 4, 5]  # the last is 5.5 s, in order
    assert log.fraction.tolist() == [0.5] * 4
    tiny = gr.Log(seconds=[0, 2, 4], fraction=[0.0, -1e-30, 0.0])
    assert ((0 <= tiny.fraction) & (tiny.fraction < 1)).all()


@pytest.mark.parametrize("unit, per_second", [("ns", 10**9), ("us", 10**6), ("ms", 10**3),
                                              ("s", 1), ("ps", 10**12)])
def test_dates_lose_nothing(unit, per_second):
    start = 1_000_000 if unit == "ps" else 1_700_000_000
    count = start * per_second + np.arange(300) * 2 * per_second + np.arange(300) % 2 * (per_second > 1)
    log = gr.Log(time_s=count.astype(f"M8[{unit}]"))
    whole, rest = np.divmod(count, per_second)
    np.testing.assert_array_equal(log.seconds, whole)
    np.testing.assert_array_equal(log.fraction, rest / per_second)
    if unit != "ps":
        np.testing.assert_array_equal(log.datetime, count.astype(f"M8[{unit}]"))


def test_dates_before_1970_and_of_odd_units():
    days = np.datetime64("1899-12-31", "D") + np.arange(10)
    assert gr.Log(time_s=days).seconds[0] == days[0].astype("M8[s]").astype(int)
    every = np.arange(0, 40, 1).astype("M8[500ms]")  # a count of half seconds
    np.testing.assert_array_equal(gr.Log(time_s=every).time_s, np.arange(40) * 0.5)
    early = np.array([-3_500_000_000, -1_500_000_000, 500_000_000], "M8[ns]")
    log = gr.Log(time_s=early)
    assert log.seconds.tolist() == [-4, -2, 0] and log.fraction.tolist() == [0.5] * 3
    np.testing.assert_array_equal(log.datetime, early)


def test_edges_in_words_and_numbers(beats):
    both = np.sort(np.concatenate([beats, beats + 0.98]))
    down = np.arange(1000) % 2
    logs = [gr.Log(time_s=both, edge=edge) for edge in (down, down == 1, np.where(down, "down", "up"))]
    for log in logs:
        np.testing.assert_array_equal(log.edge, down)
        assert log.beat_error_s == logs[0].beat_error_s
    assert logs[0].beat_error_s[0] == pytest.approx(
        2.0001 - 2 * 0.98, abs=2e-4)  # how much longer it is on the left


def test_other_columns_serve_the_fit():
    n = np.arange(3000)
    warm = 20 + np.sin(n / 200)
    noise = np.random.default_rng(3).normal(scale=1e-5, size=n.size)
    log = gr.Log(time_s=np.cumsum(2 * (1 + 1e-5 * (warm - 20))) + noise, temperature_c=warm)
    np.testing.assert_array_equal(log.temperature_c, warm)
    effect = gr.analyse(log, events="none", profiles=False).covariates[0]
    assert effect["name"] == "temperature"
    assert abs(effect["coefficient"] + 1e-5) < 5 * effect["sigma"]


@pytest.mark.parametrize("path", LOGS, ids=lambda p: p.stem)
def test_pickles_are_whole(path):
    log = gr.read(path)
    again = pickle.loads(pickle.dumps(log))
    assert again.events.tobytes() == log.events.tobytes()
    assert again.good.tobytes() == log.good.tobytes()
    for name in ("source", "format", "nominal_period_s", "assumptions", "issues", "gaps"):
        assert getattr(again, name) == getattr(log, name), name
    assert gr.rate(again).to_dict() == gr.rate(log).to_dict()
    assert gr.deviation(again).to_dict() == gr.deviation(log).to_dict()


def test_the_native_text_is_read_back(jump):
    again = gr.read(jump.native(12).encode())
    np.testing.assert_array_equal(again.time_s, jump.time_s)
    assert again.nominal_period_s == jump.nominal_period_s
    with pytest.raises(ValueError):
        jump.native(40)


def test_assumptions_name_the_keyword():
    text = "".join(f"{2.0001 * n:.4f}\n" for n in range(100)).encode()
    log = gr.read(text)
    assert any("(both_edges)" in line for line in log.assumptions)
    assert not any("--" in line for line in log.assumptions)


def test_data_that_are_no_clocks():
    text = "".join(f"{x}\n" for x in np.cumsum(np.random.default_rng(2).normal(size=300))).encode()
    log = gr.read(text, format="phase", only_phases=True)
    assert len(log.good) == 0 and log.phase_s.size == 300 and log.tau0_s == 1.0
    assert len(gr.deviation(log)) > 3
    for call in (gr.rate, gr.fit, gr.spectrum, gr.analyse):
        with pytest.raises(gr.NumericsError):
            call(log)


def test_what_a_log_says_of_itself(jump):
    assert "jump.csv" in repr(jump) and str(len(jump)) in repr(jump)
    table = pytest.importorskip("pandas") and jump.to_pandas()
    assert list(table.columns[:2]) == ["time_s", "elapsed_s"] and len(table) == len(jump)


def test_progress_is_told(tmp_path):
    file = tmp_path / "long.txt"
    file.write_text("".join(f"{2 * n}\n" for n in range(300_000)))
    shares = []
    gr.read(file, progress=shares.append)
    assert len(shares) >= 3 and shares == sorted(shares) and 0 < shares[0] < 1


def test_real_logs_are_read_as_the_command_reads_them(command_json):
    real = SOURCE.parent / "shared" / "real" / "trinity-clock"
    logs = sorted(p for p in real.glob("*") if p.suffix in (".csv", ".txt", ".gz")) if real.is_dir() else []
    if not logs:
        pytest.skip("../shared/real with public measurements is not here")
    ours = gr.rate(gr.read(logs[0])).to_dict()
    theirs = command_json("rate", logs[0])
    assert ours["rate_excess"] == theirs["rate_excess"]


def test_weather_of_its_own_and_clocks_compared(tmp_path):
    clocks = []
    for k in range(3):
        noise = np.random.default_rng(k).normal(0, 1e-4, 2000)
        path = tmp_path / f"{k}.csv"
        np.savetxt(path, 2.0 * np.arange(2000) + noise, fmt="%.6f")
        clocks.append(path)
    weather = tmp_path / "weather.csv"
    weather.write_text("time_s,temperature_c\n0,20\n2000,22\n4000,21\n")
    log = gr.read(clocks[0], weather=weather)
    assert log.temperature_c is not None
    assert log.temperature_c[500] == pytest.approx(21.0, abs=1e-3)
    comparison = gr.compare([gr.read(path) for path in clocks])
    result = comparison.to_dict()
    assert len(result["differences"]) == 3 and len(result["alone"]) > 3
    assert comparison.rates_csv().startswith("time_s,rate_1_s_per_day,")
    with pytest.raises(ValueError):
        gr.compare([log])


def test_a_diary_is_checked(tmp_path):
    diary = tmp_path / "diary.csv"
    diary.write_text("time,what,value,sigma,note\n310,weight,1.0,0.1,heavier\n")
    analysis = gr.analyse(gr.read(SOURCE / "data/logs/jump.csv"), diary=diary, profiles=False)
    assert analysis.kept_diary["entries"][0]["verdict"] == "as planned"
    assert analysis.diary_csv().startswith("time,what,value,sigma,note\n")
    again = pickle.loads(pickle.dumps(analysis))
    assert again.kept_diary == analysis.kept_diary
