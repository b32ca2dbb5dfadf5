"""Arrays and words that make no sense get a clear error, never a crash and never a number."""

import gzip
import io

import numpy as np
import pytest

import goingrate as gr

GOOD = np.arange(20.0)

BAD_ARRAYS = {
    "None": None,
    "text": "abc",
    "list of text": ["a", "b", "c"],
    "objects": np.array([object()] * 5),
    "complex": GOOD.astype(complex),
    "booleans": GOOD > 3,
    "two dimensions": GOOD.reshape(4, 5),
    "no dimension": np.float64(3.0),
    "ragged": [[1.0], [2.0, 3.0]],
    "structured": np.zeros(5, [("a", float)]),
    "empty": np.empty(0),
    "one element": np.array([1.0]),
    "infinite": np.array([1.0, 2.0, np.inf, 4.0]),
    "dict": {"a": 1},
}
bad_arrays = pytest.mark.parametrize("values", BAD_ARRAYS.values(), ids=BAD_ARRAYS.keys())


@bad_arrays
@pytest.mark.parametrize("kind", gr.DEVIATION_KINDS)
def test_phase(values, kind):
    with pytest.raises(ValueError) as error:
        gr.deviation(phase=values, kind=kind)
    assert str(error.value)


@bad_arrays
def test_frequency(values):
    if isinstance(values, np.ndarray) and values.size == 1 and values.ndim == 1:
        values = values[:0]  # one frequency makes two phases, which are too few
    with pytest.raises(ValueError):
        gr.deviation(frequency=values)


@bad_arrays
def test_times(values):
    with pytest.raises(ValueError) as error:
        gr.Log(time_s=values)
    assert str(error.value)


@pytest.mark.parametrize(
    "times, words",
    [
        ([0.0, 2.0, np.nan, 6.0], "nan at index 2"),
        ([0.0, 2.0, 4.0, 3.0, 8.0], "goes back at index 3"),
        ([0.0, 2.0, 4e18, 8e18], "index 2"),
        (np.array(["2020-01-01", "NaT", "2020-01-02"], "M8[ns]"), "NaT at index 1"),
    ],
)
def test_a_wrong_time_is_named(times, words):
    with pytest.raises(ValueError, match=words):
        gr.Log(time_s=times)


@pytest.mark.parametrize("values", [[1.0] * 3, [np.inf] * 500, [-0.1] * 500, [4.0] * 500, None])
def test_amplitudes(values, beats):
    if values is None:
        assert not gr.Log(time_s=beats).has_amplitude
        assert not gr.Log(time_s=beats, amplitude_rad=[np.nan] * 500).has_amplitude
        return
    with pytest.raises(ValueError, match="amplitude_rad"):
        gr.Log(time_s=beats, amplitude_rad=values)


def test_edges(beats):
    for wrong in (["sideways"] * 500, [2] * 500, [0] * 3, [0.5] * 500):
        with pytest.raises(ValueError, match="edge"):
            gr.Log(time_s=beats, edge=wrong)


def test_times_said_twice_or_not_at_all(beats):
    for given in ({}, {"time_s": beats, "seconds": beats}, {"seconds": [0, 2, 4]},
                  {"seconds": [0, 2, 4], "fraction": [0.0, np.nan, 0.0]}):
        with pytest.raises(ValueError):
            gr.Log(**given)


LAYOUTS = {
    "strided": lambda x: np.repeat(x, 3)[::3],
    "reversed twice": lambda x: x[::-1].copy()[::-1],
    "Fortran column": lambda x: np.asfortranarray(np.column_stack([x, x]))[:, 1],
    "list": lambda x: x.tolist(),
    "big-endian": lambda x: x.astype(">f8"),
    "long double": lambda x: x.astype(np.longdouble),
    "unaligned": lambda x: np.frombuffer(b"\0" + x.tobytes(), np.uint8)[1:].view(np.float64),
    "masked, none masked": lambda x: np.ma.masked_array(x),
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS.keys())
def test_any_layout_gives_the_same(layout, beats):
    plain = gr.deviation(phase=beats - 2 * np.arange(500)).value
    np.testing.assert_array_equal(gr.deviation(phase=layout(beats - 2 * np.arange(500))).value,
                                  plain)
    np.testing.assert_array_equal(gr.Log(time_s=layout(beats)).time_s, beats)


def test_read_only_arrays_are_taken_and_left_alone(beats):
    kept = beats.copy()
    beats.flags.writeable = False
    gr.deviation(phase=beats)
    gr.Log(time_s=beats, amplitude_rad=np.full(500, 0.05))
    np.testing.assert_array_equal(beats, kept)


def test_masked_values_are_gaps(beats):
    x = beats - 2 * np.arange(500)
    gaps = np.where(np.arange(500) % 50 == 7, np.nan, x)
    masked = np.ma.masked_invalid(gaps)
    np.testing.assert_array_equal(gr.deviation(phase=masked).value, gr.deviation(phase=gaps).value)


def test_all_unknown_is_no_number():
    assert np.isnan(gr.deviation(phase=np.full(100, np.nan)).value).all()


@pytest.mark.parametrize("words", [
    {"kind": "nodev"}, {"taus": "sometimes"}, {"taus": [0.3]}, {"taus": [np.nan]}, {"taus": [-1.0]},
    {"taus": []}, {"rate": 0}, {"rate": np.nan}, {"rate": "fast"}, {"rate": 1.0, "tau0_s": 1.0},
    {"tau0_s": -1}, {"alpha": 7}, {"threads": -1},
])
def test_words_of_deviation(words):
    with pytest.raises((ValueError, TypeError)):
        result = gr.deviation(phase=GOOD, **words)
        assert len(result) > 0, "no row"
        raise AssertionError(result)


@pytest.mark.parametrize("words", [
    {"fix": {"T0": "two"}}, {"fix": {"T0": np.nan}}, {"fix": {"nonsense": 1.0}}, {"fix": ["T0"]},
    {"fix": 3}, {"prior": {"lambda0": 0.1}}, {"prior": ["lambda0=1"]}, {"events": ["150"]},
    {"events": ["-5:mu"]}, {"events": ["150:wind"]}, {"events": 150}, {"model": "guess"},
    {"noise": "loud"}, {"escapement": "gravity"}, {"free": ["T0x"]}, {"fix": {"mu": 1e-5},
    "free": ["mu"]},
])
def test_words_of_fit(words, jump):
    with pytest.raises(ValueError) as error:
        gr.fit(jump, **words)
    assert str(error.value)


@pytest.mark.parametrize("call", [gr.rate, gr.fit, gr.spectrum, gr.analyse])
@pytest.mark.parametrize("log", [None, "jump.csv", GOOD, {}, 3])
def test_what_is_no_log(call, log):
    with pytest.raises(ValueError, match="expected a Log"):
        call(log)


@pytest.mark.parametrize("options", [
    {"format": "prose"}, {"unit": "fortnight"}, {"nominal_period_s": -1.0},
    {"nominal_period_s": np.nan}, {"nominal_period_s": "two"}, {"gap_probability": 2},
    {"flag_width_rad": 5}, {"sensor_offset_rad": "left"}, {"dead_time_s": -1}, {"columns": "time=1"},
    {"columns": ["time"]}, {"tau0_s": 0}, {"unpacked_limit": -1},
])
def test_options_of_read(options):
    with pytest.raises((ValueError, TypeError)):
        gr.read(b"0\n2\n4\n6\n8\n", **options)


@pytest.mark.parametrize("text", [
    b"", b"\n\n", b"hello world\n" * 5, b"\0" * 1000, bytes(range(256)) * 40, b"1\n2\n",
    "été\n".encode("utf-16"), b"\x1f\x8b broken", b"time_s\n" + b"nan\n" * 50, b"1e999\n" * 10,
])
def test_content_that_is_no_log(text):
    with pytest.raises(gr.InputError) as error:
        gr.read(text, name="my.log")
    assert "my.log" in str(error.value)
    assert error.value.file == "my.log"


def test_an_input_error_says_where():
    with pytest.raises(gr.InputError) as error:
        gr.read(b"0\n2\n4\n6\nx\n10\n12\n", strict=True, name="a.log")
    assert (error.value.file, error.value.line, error.value.column) == ("a.log", 5, 1)
    assert isinstance(error.value, ValueError)


def test_a_file_that_is_not_there_is_both_errors():
    for kind in (gr.InputError, FileNotFoundError):
        with pytest.raises(kind):
            gr.read("/no/such/file.csv")


def test_a_folder_is_no_log(tmp_path):
    with pytest.raises(gr.InputError):
        gr.read(tmp_path)


@pytest.mark.parametrize("source", [None, 3, 1.5, [], [b"1.0\n3.0\n"], object()])
def test_what_is_no_source(source):
    with pytest.raises(ValueError, match="expected paths"):
        gr.read(source)


def test_other_readings_can_be_tried():
    text = b"".join(b"%.3f\n" % (2000.0 * n) for n in range(300))
    with pytest.raises(gr.ImpossibleReading) as error:
        gr.read(text, nominal_period_s=2, unit="s")
    words, options = error.value.others[0]
    assert "ms" in words
    log = gr.read(text, **{"nominal_period_s": 2, "unit": "s", **options})
    assert log.elapsed_s[-1] == 598.0


def test_a_packed_log_has_a_limit():
    packed = gzip.compress(b"0.000\n" * 100000)
    with pytest.raises(gr.InputError, match="unpack to more"):
        gr.read(packed, unpacked_limit=1000)


def test_text_that_is_open_in_any_mode(beats):
    text = "".join(f"{t:.6f}\n" for t in beats)
    same = [gr.read(source).time_s for source in (
        text.encode(), bytearray(text, "ascii"), io.StringIO(text), io.BytesIO(text.encode()),
        io.BytesIO(gzip.compress(text.encode())))]
    for times in same[1:]:
        np.testing.assert_array_equal(times, same[0])


@pytest.mark.parametrize("words", [
    {"points": 1}, {"points": 10**6}, {"epsilon": (1e-4, 1e-5)}, {"mu": (0.0, 1e-3)}, {"phi0": 0},
    {"epsilon": [np.nan]}, {"epsilon": [-1.0]}, {"phi0": np.nan}, {"mu": [2.0]},
])
def test_words_of_map(words):
    with pytest.raises(ValueError):
        gr.map(**{"points": 3, **words})


@pytest.mark.parametrize("words", [
    {}, {"epsilon": 1e-4}, {"epsilon": 1e-4, "mu": 1e-5, "rate": 0}, {"rate": 0, "rate_excess": 0},
    {"epsilon": -1.0, "mu": 1e-5}, {"epsilon": np.nan, "mu": 1e-5}, {"amplitude": 9, "rate": 0},
    {"amplitude": 0.05, "rate": 0, "phi0": -1},
])
def test_words_of_operating_point(words):
    with pytest.raises(ValueError):
        gr.operating_point(**words)


def test_a_clock_that_cannot_run():
    with pytest.raises(gr.NumericsError):
        gr.operating_point(amplitude=0.01, epsilon=1e-4, phi0=0.03)


SCENARIO = {"clock": {"epsilon": 2.5e-4, "mu": 2e-5, "phi0": 0.03}, "run": {"periods": 50}}


@pytest.mark.parametrize("scenario, kind", [
    (None, ValueError), (3, ValueError), ({}, gr.InputError), ("[clock]\nepsilon = x\n", gr.InputError),
    ({"clock": {"wind": 1}}, gr.InputError), ({"clock": {"epsilon": None}}, ValueError),
    ({"clock": {"epsilon": [1, 2]}}, gr.InputError), ("/no/such.toml", FileNotFoundError),
    ({**SCENARIO, "run": {"periods": -5}}, gr.InputError),
    ({**SCENARIO, "clock": {"epsilon": np.nan}}, gr.InputError),
])
def test_scenarios(scenario, kind):
    with pytest.raises(kind):
        gr.simulate(scenario)


@pytest.mark.parametrize("seed", [-1, 2**64, 1.5, "x", None, True])
def test_seeds(seed):
    with pytest.raises(ValueError, match="seed"):
        gr.simulate(SCENARIO, seed=seed)


@pytest.mark.parametrize("law", [
    lambda phi, v: "much", lambda phi, v: None, lambda phi: 0.0, lambda phi, v: 1j])
def test_laws_that_give_no_number(law):
    with pytest.raises((TypeError, RuntimeError, ValueError)):
        gr.integrate(law, periods=2)


def test_laws_that_raise():
    class Mine(Exception):
        pass

    def law(phi, v):
        raise Mine("here")

    with pytest.raises(Mine, match="here"):
        gr.integrate(law)


def test_laws_that_are_not_finite_end_the_motion():
    result = gr.integrate(lambda phi, v: np.nan, periods=5)
    assert len(result) == 0 and result.ended
    assert gr.integrate(lambda phi, v: -50.0 * v, periods=5).ended


@pytest.mark.parametrize("words", [
    {"amplitude_rad": 0}, {"amplitude_rad": 4}, {"periods": 0}, {"nominal_period_s": 0},
    {"mu": 2.0}, {"mu": 1e-5, "phi0": 0}, {"jumps": [[1]]}, {"torque": 3},
])
def test_words_of_integrate(words):
    with pytest.raises(ValueError):
        gr.integrate(lambda phi, v: 0.0, **words)


def test_the_library_beneath_refuses_what_the_package_would_not_send():
    from goingrate import _core

    for array in (np.zeros((3, 3)), np.arange(5), np.zeros(10)[::2], None):
        try:
            _core.deviation(array, 1.0, "oadev", "octave", None, True, 0)
        except (TypeError, ValueError):
            continue
        assert array is not None and array.ndim == 2  # taken as its memory stands


@pytest.mark.parametrize("part", ["log", "fit", "rate", "deviation"])
def test_damaged_pickles(part, jump, jump_fit):
    import pickle

    core = {"log": jump._core, "fit": jump_fit._core, "rate": gr.rate(jump)._core,
            "deviation": gr.deviation(jump)._core}[part]
    state = core.__getstate__()
    fresh = type(core).__new__(type(core))
    for wrong in (b"", state[:10], state[:-1], state[: len(state) // 2], state + b"x",
                  b"\xff" * 100, state.replace(b"goingrate", b"goinglate", 1)):
        with pytest.raises(ValueError):
            fresh.__setstate__(wrong)
    assert pickle.loads(pickle.dumps(core)) is not None
