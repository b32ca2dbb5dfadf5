"""The module gives what the command gives, to the last bit: JSON has all digits of a number."""

import csv
import io

import numpy as np
import pytest

import goingrate as gr
from conftest import LOGS, SOURCE, numbers_of

# What makes each log's fit quick and decided.
FITS = {
    "interruption": (
        {"noise": "drive", "events": [], "model": "averaged1"},
        ["--noise", "drive", "--event", "none", "--model", "averaged1"],
    ),
    "jump": ({"fix": {"T0": 2}, "events": ["150:mu"]}, ["--fix", "T0=2", "--event", "150:mu"]),
    "noisy-drive": (
        {"fix": ["T0=2", "epsilon=1.167245e-4"], "noise": "both", "events": "none"},
        ["--fix", "T0=2", "--fix", "epsilon=1.167245e-4", "--noise", "both", "--event", "none"],
    ),
}
each_log = pytest.mark.parametrize("path", LOGS, ids=lambda p: p.stem)


def assert_same(ours, theirs):
    ours, theirs = dict(numbers_of(ours)), dict(numbers_of(theirs))
    assert ours.keys() == theirs.keys()
    different = {k: (ours[k], theirs[k]) for k in ours if ours[k] != theirs[k]}
    assert not different


def test_every_log_is_tried():
    assert {path.stem for path in LOGS} == set(FITS)


@each_log
def test_rate(path, command_json):
    result = gr.rate(gr.read(path))
    theirs = command_json("rate", path)
    assert_same(result.to_dict(), theirs)
    for name in ("crossings", "periods", "missed", "spurious", "segments", "duration_s",
                 "mean_period_s", "mean_period_sigma_s", "last_period_s", "rate_excess",
                 "nominal_period_s", "rate_s_per_day", "rate_sigma_s_per_day"):
        assert getattr(result, name) == theirs[name], name


@each_log
def test_table_of_rates(path, command):
    assert gr.rate(gr.read(path)).to_csv() == command("rate", path, "-o", "-")


@each_log
def test_blocks(path, command):
    blocks = gr.rate(gr.read(path)).blocks(200.0)
    rows = list(csv.DictReader(io.StringIO(command("rate", path, "--block", 200, "-o", "-"))))
    assert [int(row["to_cycle"]) for row in rows] == blocks["to_cycle"].tolist()


@each_log
def test_fit(path, command_json):
    keywords, words = FITS[path.stem]
    assert_same(gr.fit(gr.read(path), **keywords).to_dict(), command_json("fit", path, *words))


@each_log
def test_fit_as_text_and_tables(path, command, tmp_path):
    keywords, words = FITS[path.stem]
    fit = gr.fit(gr.read(path), **keywords)
    par, table, latex = (tmp_path / name for name in ("fit.par", "fit.csv", "fit.tex"))
    text = command("fit", path, *words, "--par", par, "--csv", table, "--latex", latex, "-o", "-")
    assert fit.to_par() == par.read_text()
    assert fit.to_csv() == table.read_text()
    assert fit.to_latex() == latex.read_text()
    if not any("prior=" in note for note in fit.notes):
        assert str(fit) == text


def test_fit_that_finds_out_everything(jump, command_json):
    assert_same(gr.fit(jump).to_dict(), command_json("fit", SOURCE / "data" / "logs" / "jump.csv"))


def test_fit_from_a_file_of_parameters(jump, jump_fit, command_json, tmp_path):
    file = tmp_path / "jump.par"
    file.write_text(jump_fit.to_par())
    ours = gr.fit(jump, par=file, prior={"lambda0": (0.039, 0.001)}).to_dict()
    path = SOURCE / "data" / "logs" / "jump.csv"
    theirs = command_json("fit", path, "--from", file, "--prior", "lambda0=0.039+-0.001")
    assert_same(ours, theirs)


@each_log
def test_spectrum(path, command, command_json):
    keywords, words = FITS[path.stem]
    ours = gr.spectrum(gr.read(path), **keywords)
    theirs = command_json("spectrum", path, *words)
    assert_same(ours.to_dict(), theirs)
    assert ours.frequency_hz.tolist() == theirs["frequency_hz"]
    assert ours.density.tolist() == theirs["density"]
    assert ours.to_csv() == command("spectrum", path, *words, "-o", "-")


@each_log
@pytest.mark.parametrize("kind", gr.DEVIATION_KINDS)
def test_deviation(path, kind, command_json):
    log = gr.read(path, only_phases=True)
    ours = gr.deviation(log, kind=kind, taus="decade")
    theirs = command_json("stability", path, "--kind", kind, "--taus", "decade")
    assert_same(ours.to_dict(), theirs)
    values = [np.nan if row["value"] is None else row["value"] for row in theirs["rows"]]
    np.testing.assert_array_equal(ours.value, values)


def test_deviation_of_an_array_is_that_of_the_file(command_json, tmp_path):
    phase = np.cumsum(np.random.default_rng(7).normal(size=2000)) * 1e-5
    file = tmp_path / "phase.txt"
    file.write_text("".join(f"{x!r}\n" for x in phase.tolist()))
    theirs = command_json("stability", file, "--data", "phase", "--tau0", "0.5", "--taus", "all",
                          "--kind", "mdev")
    assert_same(gr.deviation(phase=phase, rate=2.0, taus="all", kind="mdev").to_dict(), theirs)


@each_log
def test_analysis(path, command, command_json, tmp_path):
    keywords, words = FITS[path.stem]
    analysis = gr.analyse(gr.read(path), **keywords)
    page = tmp_path / "page.html"
    assert_same(analysis.to_dict(), command_json("report", path, *words, "-o", page))
    assert str(analysis) == command("report", path, *words, "-o", page)
    ours = analysis.to_html(tmp_path / "ours.html")
    assert ours == (tmp_path / "ours.html").read_text(encoding="utf-8")
    if not any("prior=" in note for note in analysis.fit.notes) and not analysis.log.assumptions:
        assert ours == page.read_text(encoding="utf-8")
    assert [p.name for p in tmp_path.iterdir() if p.name.endswith(".part")] == []


@pytest.mark.parametrize("first_order", [False, True])
def test_map(first_order, command_json):
    ours = gr.map(points=9, first_order=first_order)
    theirs = command_json("map", "--points", 9, *(["--first-order"] if first_order else []))
    assert ours.epsilon.tolist() == theirs["epsilon"]
    assert ours.mu.tolist() == theirs["mu"]
    rates = np.array(theirs["rate_excess"], float)
    np.testing.assert_array_equal(ours.rate_excess, rates)


def test_operating_point(command_json):
    ours = gr.operating_point(amplitude=0.05, rate=0)
    theirs = command_json("map", "--solve", "amplitude=0.05", "rate=0")["points"]
    assert [point.epsilon for point in ours] == [point["epsilon"] for point in theirs]
    assert [point.mu for point in ours] == [point["mu"] for point in theirs]


@pytest.mark.parametrize("name", ["interruption", "jump", "noisy-drive", "ring-down"])
def test_simulation(name, command, tmp_path):
    scenario = SOURCE / "data" / "scenarios" / f"{name}.toml"
    simulation = gr.simulate(scenario, seed=7, set={"run.periods": 900})
    log, truth = tmp_path / "log.csv", tmp_path / "truth.csv"
    command("simulate", scenario, "--seed", 7, "--set", "run.periods=900", "-o", log,
            "--truth", truth)
    theirs = gr.read(log)
    assert simulation.log.events.tobytes() == theirs.events.tobytes()
    rows = np.genfromtxt(truth, delimiter=",", names=True)
    for column in ("cycle", "period_s", "velocity", "amplitude_rad", "mu"):
        np.testing.assert_array_equal(getattr(simulation.truth, column), rows[column])
    # The file has both parts of a time, to 17 decimals; the nearest float64 may be the next one.
    np.testing.assert_allclose(simulation.truth.time_s, rows["time_s"], rtol=2.3e-16)
