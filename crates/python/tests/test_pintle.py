"""Tests of the installed package."""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import pintle
import pytest

HOST_SIM = Path(sys.executable).with_name("host-sim")
MODEL_QUANT = Path(sys.executable).with_name("model-quant")


@pytest.fixture(scope="module")
def bench():
    return pintle.Bench("bench-b")


@pytest.fixture(scope="module")
def log(bench):
    return bench.record(seed=3)


def without_times(figures):
    gone = ("wall_s", "wall_s_per_simulated_s", "provenance", "estimator")
    return {name: value for name, value in figures.items() if name not in gone}


def test_the_programs_run_and_state_their_exit_code():
    laws = subprocess.run([HOST_SIM, "laws", "--json"], capture_output=True, check=True)
    names = [law["name"] for law in json.loads(laws.stdout)["laws"]]
    assert names == list(pintle.laws()["name"])
    assert subprocess.run([HOST_SIM, "run", "--seed", "x"], capture_output=True).returncode == 2
    assert subprocess.run([MODEL_QUANT, "--version"], capture_output=True).returncode == 0
    assert subprocess.run([MODEL_QUANT, "nothing"], capture_output=True).returncode == 2


def test_a_run_has_the_figures_and_files_of_the_program(bench, tmp_path):
    run = bench.run(force="law", seed=2)
    words = [HOST_SIM, "run", "--force", "law", "--seed", "2", "--out", tmp_path]
    subprocess.run(words, capture_output=True, check=True)
    program = json.loads((tmp_path / "run.json").read_text())
    assert without_times(run.figures) == without_times(program)
    for name in ("log.csv", "impacts.csv", "estimates.csv", "estimated_impacts.csv"):
        assert run.text(name) == (tmp_path / name).read_text(), name
    largest_n = run.figures["peak_contact_force_n"]
    assert run.estimates["normal_force_n"].max() == pytest.approx(largest_n, rel=0.03)
    assert run.figures["provenance"]["command"].startswith("host-sim run ")
    other = pintle.Bench("friction-rig").check(pintle.Bench("friction-rig").record())
    assert other.figures["provenance"]["command"].startswith("host-sim check")
    assert run.report.startswith("<!doctype html>") or "<html" in run.report
    run.save(tmp_path / "saved")
    assert sorted(path.name for path in (tmp_path / "saved").iterdir()) == run.files


@pytest.mark.parametrize("preset, table", [("four-bar", "impacts"), ("slider-crank", "impacts")])
def test_mechanisms_run_too(preset, table):
    bench = pintle.Bench(preset)
    run = bench.run()
    assert len(getattr(run, table)) > 0
    assert len(run.log) > 100
    assert run.figures["contacts"]


def test_the_laws_keep_the_shape_of_their_arguments(bench):
    depth = np.linspace(-1e-5, 4e-5, 6).reshape(2, 3)
    normal_n, friction_n = bench.contact_forces(depth, sliding_m_s=-0.1)
    assert normal_n.shape == friction_n.shape == (2, 3)
    assert (normal_n[depth <= 0] == 0).all() and (np.diff(normal_n.reshape(-1)[1:]) > 0).all()
    mirrored_n, other_n = bench.contact_forces(depth, sliding_m_s=0.1)
    assert (mirrored_n == normal_n).all() and (other_n == -friction_n).all()
    scalar, _ = bench.contact_forces(2e-5)
    assert scalar.shape == ()
    with pytest.raises(ValueError):
        bench.contact_forces([1e-5, 2e-5], sliding_m_s=[0.0, 0.1, 0.2])
    missing = np.ma.masked_array([2e-5, 2e-5, np.nan, np.inf], mask=[False, True, False, False])
    normal_n, _ = bench.contact_forces(missing)
    assert normal_n[0] > 0 and np.isnan(normal_n[1:]).all()
    with pytest.raises(pintle.InputError, match="transmission-bench"):
        pintle.Bench("friction-rig").contact_forces(2e-5)


def test_a_changed_description_is_checked_and_leaves_the_old_one(bench):
    hard = bench.replace({"contact.stiffness": "johnson", "bearing.radial_clearance_m": np.float64(1e-3)})
    assert 'stiffness = "johnson"' in hard.text and 'stiffness = "johnson"' not in bench.text
    assert hard.contact_forces(2e-5)[0] != bench.contact_forces(2e-5)[0]
    with pytest.raises(pintle.InputError, match="bearing.radial_clearance_m is -1"):
        bench.replace({"bearing.radial_clearance_m": -1})
    with pytest.raises(pintle.InputError, match="expected one of"):
        bench.replace({"bearing.nothing": 1})
    with pytest.raises(pintle.InputError, match="found a value at `radial_clearance_m`"):
        bench.replace({"bearing.radial_clearance_m.x": 1})
    four_bar = pintle.Bench("four-bar")
    name = four_bar.text.split("[[body]]")[2].split('name = "')[1].split('"')[0]
    lighter = four_bar.replace({f"body[{name}].mass_kg": 0.5})
    assert lighter.text == four_bar.replace({"body[2].mass_kg": 0.5}).text != four_bar.text
    with pytest.raises(pintle.InputError, match="no entry `absent`"):
        four_bar.replace({"body[absent].mass_kg": 1})
    biased = bench.with_effect("sensor-gain", channel="shaft_angle_rad", relative_change=np.float32(0.5))
    assert biased != bench and biased.replace({"effects": None}) == bench
    assert pickle.loads(pickle.dumps(biased)) == biased
    with pytest.raises(pintle.InputError, match="not a known effect"):
        bench.with_effect("gremlins")


def test_a_wrong_description_names_every_flaw():
    with pytest.raises(pintle.InputError) as refused:
        pintle.Bench.from_text('plant = "transmission-bench"\n[shaft]\nmass_kg = -1\n')
    assert "shaft.mass_kg" in str(refused.value) and "bearing" in str(refused.value)
    with pytest.raises(pintle.InputError, match="neither a preset"):
        pintle.Bench("nothing.toml")


def test_a_log_survives_every_format(log, tmp_path):
    assert log.attrs["units"]["journal_y_m"] == "m"
    for name in ("log.csv", "log.parquet", "log.mat"):
        pintle.write_log(log, tmp_path / name)
        again = pintle.read_log(tmp_path / name)
        pd.testing.assert_frame_equal(again, log, check_exact=True)
    def refused(frame, match, name="x.csv"):
        with pytest.raises(pintle.InputError, match=match):
            pintle.write_log(frame, tmp_path / name)
        assert not (tmp_path / name).exists()

    refused(pd.DataFrame({"t_s": [0.0, 1.0], "name": ["1", "2"]}), "name: found")
    refused(pd.DataFrame({"t_s": pd.to_datetime([0, 1])}), "t_s: found datetime64.*seconds")
    refused(pd.DataFrame({"z": [1j, 2.0]}), "z: found complex")
    refused(log.set_index(["t_s", "journal_y_m"]), "several levels")
    refused(pd.concat([log, log["t_s"]], axis=1), "two columns")
    refused(log, "ends in .csv", "x.xlsx")
    refused(log["t_s"], "found Series")
    with pytest.raises(pintle.InputError, match="no group"):
        pintle.read_log(tmp_path / "log.csv", group="other")


def test_an_estimate_is_that_of_the_program(bench, log, tmp_path):
    estimates = bench.estimate(log)
    pintle.write_log(log, tmp_path / "log.parquet")
    words = [HOST_SIM, "replay", tmp_path / "log.parquet", "--out", tmp_path / "replay"]
    subprocess.run(words, capture_output=True, check=True)
    program = pd.read_csv(tmp_path / "replay" / "estimates.csv")
    for name in program.columns.drop(["sequence", "t_s", "flags", "saturated"]):
        assert (estimates.samples[name].to_numpy() == program[name].to_numpy(np.float32)).all(), name
    impacts = pd.read_csv(tmp_path / "replay" / "estimated_impacts.csv")
    assert list(estimates.impacts["onset_s"]) == list(impacts["onset_s"])
    assert estimates.counters["samples"] == len(log)
    again = bench.estimate(tmp_path / "log.parquet")
    pd.testing.assert_frame_equal(again.samples, estimates.samples)


def test_a_missing_row_and_a_wrong_unit_are_noticed(bench, log):
    whole, holes = bench.estimate(log), bench.estimate(log.drop(index=range(100, 600)))
    assert (whole.counters["sequence_gaps"], len(holes.samples)) == (0, len(log) - 500)
    assert holes.counters["sequence_gaps"] > 0
    wrong = log.copy()
    wrong.attrs = {"units": {"journal_y_m": "mm"}}
    for work in (bench.estimate, bench.evaluate, bench.check):
        with pytest.raises(pintle.InputError, match="journal_y_m: found the unit mm; expected m"):
            work(wrong)
    dated = log.set_index(pd.DatetimeIndex(pd.to_datetime(log["t_s"], unit="s"), name="t_s"))
    with pytest.raises(pintle.InputError, match="t_s: found datetime64.*seconds since the start"):
        bench.evaluate(dated.drop(columns="t_s"))
    columns = '[columns]\njournal_y_m = { from = "y", scale = 1e-3 }\n'
    named = pintle.Bench.from_text(bench.text + columns)
    foreign = log.assign(y=1e3 * log["journal_y_m"], remark="text").drop(columns="journal_y_m")
    found = named.estimate(foreign).samples["normal_force_n"]
    assert np.abs(found - whole.samples["normal_force_n"]).max() < 10
    twice = pd.concat([log.iloc[:50], log.iloc[49:]], ignore_index=True)
    with pytest.raises(pintle.InputError, match="rows 50 and 51 in one period"):
        bench.estimate(twice)


def test_samples_may_come_in_parts_and_with_gaps(bench, log):
    whole = bench.estimate(log).samples
    controller = pintle.Controller.native()
    with pytest.raises(pintle.InputError, match="without a configuration"):
        controller.estimate(log)
    period_s = round(log["t_s"].diff().median(), 6)
    controller.configure(bench, period_s=period_s)
    parts = pd.concat([controller.estimate(log.iloc[:100]), controller.estimate(log.iloc[100:])])
    assert (parts["force_y_n"].to_numpy() == whole["force_y_n"].to_numpy()).all()
    assert controller.stop()["samples"] == len(log)
    gaps = log.copy()
    gaps.loc[500:520, "journal_y_m"] = np.nan
    held = bench.estimate(gaps).samples
    assert np.isfinite(held["normal_force_n"]).all()
    assert held["force_sd_n"].iloc[515] > whole["force_sd_n"].iloc[515]
    controller.configure(bench, period_s=period_s)
    parts = pd.concat([controller.estimate(gaps.iloc[:510]), controller.estimate(gaps.iloc[510:])])
    assert (parts["force_y_n"].to_numpy() == held["force_y_n"].to_numpy()).all()
    with pytest.raises(pintle.InputError, match="found no column load_force_n"):
        bench.estimate(log.drop(columns="load_force_n"))


def test_a_diagnosis_names_an_effect_and_improves_the_bench():
    rig = pintle.Bench("friction-rig")
    worn = rig.with_effect("viscous-asymmetry", asymmetry_effort=60.0)
    logs = [worn.record(seed=seed) for seed in (1, 2, 3)]
    diagnosis = rig.diagnose(logs[0], held_out=[logs[1]])
    assert diagnosis.verdict == "named" and list(diagnosis.causes["effect"]) == ["viscous-asymmetry"]
    (cause,) = diagnosis.causes.itertuples()
    assert cause.low < 60 < cause.high and cause.unit in repr(diagnosis)
    table = diagnosis.gain_on(rig, logs[2])
    assert (table["rms_after"] < table["rms_before"]).any()
    assert diagnosis.extended.plant == rig.plant
    assert rig.diagnose(rig.record(seed=4)).verdict == "none"
    inspection = rig.check(logs[0])
    assert set(inspection.findings["log"]) == {"log 1"}
    assert len(inspection.channels) > 0 and len(inspection.parameters) > 0


def test_networks_follow_the_law_and_mark_what_they_never_saw(bench):
    networks = pintle.Networks.shipped("babbitt")
    depth = np.linspace(1e-5, 4e-5, 30)
    normal_n, friction_n, outside = networks.forces(depth, sliding_m_s=0.1)
    law_n, law_friction_n = bench.contact_forces(depth, sliding_m_s=0.1)
    assert np.abs(normal_n - law_n).max() < 0.02 * law_n.max()
    assert np.abs(friction_n - law_friction_n).max() < 0.05 * np.abs(law_friction_n).max()
    assert not outside.any()
    assert networks.forces(1e-3)[2]
    normal_n, _, outside = networks.forces([np.nan, 1e300, 2e-5], sliding_m_s=[0, 0, np.inf])
    assert np.isnan(normal_n).all() and outside.all()
    assert pickle.loads(pickle.dumps(networks)).material == "babbitt"
    with pytest.raises(pintle.InputError, match="model image"):
        pintle.Networks(networks.image[:-1])
    with pytest.raises(pintle.InputError, match="expected one of `babbitt`, `plastic`"):
        pintle.Networks.shipped("wood")


def test_a_training_repeats_and_becomes_a_package():
    epochs = []
    checkpoint = pintle.train(
        rows=2048, epochs=2, grid_epochs=1, report=lambda network, epoch: epochs.append((network, epoch))
    )
    assert epochs == [(n, e) for n in ("collision", "friction") for e in (1, 2, 3)]
    assert len(checkpoint.history) == 6
    assert pintle.train(rows=2048, epochs=2, grid_epochs=1).data == checkpoint.data
    networks = checkpoint.quantise()
    verdicts = checkpoint.verify(networks)
    assert list(verdicts["network"]) == ["collision", "friction"]
    package = pintle.package([networks], version=2)
    with pytest.raises(pintle.InputError, match="native"):
        pintle.Controller.native().update(package)
    controller = pintle.Controller.native()
    controller.configure(pintle.Bench())
    with pytest.raises(pintle.InputError, match="expected `stop`"):
        controller.update(package)
    with pytest.raises(pintle.InputError, match="rows: found 1"):
        pintle.train(rows=1)

    def impatient(network, epoch):
        raise KeyError(epoch)

    with pytest.raises(KeyError, match="1"):
        pintle.train(rows=2048, epochs=2, grid_epochs=1, report=impatient)
    with pytest.raises(pintle.InputError, match="board: found `toaster`"):
        pintle.package([networks], version=1, board="toaster")


def test_an_error_of_a_command_is_an_exception(bench, tmp_path):
    with pytest.raises(pintle.InputError, match="--force"):
        bench.run(force="magic")
    with pytest.raises(pintle.InputError, match="--dropout-share: found 2"):
        bench.run(dropout_share=2)
    with pytest.raises(pintle.InputError, match="^bench: found plant `friction-rig`"):
        pintle.Bench("friction-rig").run()
    with pytest.raises(pintle.InputError, match="out: found the option"):
        bench.run(out=tmp_path)
    with pytest.raises(pintle.InputError, match="logs: found none"):
        bench.evaluate()
    with pytest.raises(pintle.InputError, match="-1"):
        bench.run(seed=-1)
    with pytest.raises(KeyError, match="estimates.csv: this result has"):
        bench.run(force="law", controller="none").estimates
    (tmp_path / "file").write_text("")
    with pytest.raises(pintle.WorkError, match="expected a folder"):
        pintle.command("run", out=tmp_path / "file" / "below")


def test_a_command_returns_its_result_and_leaves_standard_output_alone(capfd):
    found = pintle.command("laws", json=True)
    assert [law["name"] for law in found["laws"]] == list(pintle.laws()["name"])
    assert pintle.command("laws") == pintle.command("laws", quiet=True) == ""
    assert pintle.command("laws", quiet=False).startswith("contact.dissipation")
    assert "Usage: host-sim" in pintle.command("--help")
    assert capfd.readouterr().out == ""
    with pytest.raises(pintle.InputError, match="expected a command"):
        pintle.command()


def test_control_c_ends_the_wait_for_a_command():
    script = (
        "import pintle, signal, tempfile\n"
        # A program that was started in the background ignores it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "print('ready', flush=True)\n"
        "pintle.command('claims', runs=100000, out=tempfile.mkdtemp())"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stdout.readline() == b"ready\n"
    time.sleep(1)
    child.send_signal(signal.SIGINT)
    try:
        _, errors = child.communicate(timeout=60)
    finally:
        child.kill()
    assert b"KeyboardInterrupt" in errors and child.returncode != 0


def test_threads_wait_for_each_other_and_a_forked_process_is_refused(bench):
    controller = pintle.Controller.native()
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(lambda _: pintle.command("laws"), range(4))) == [""] * 4
        pool.submit(controller.configure, bench).result()
    assert controller.stop()["samples"] == 0
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            pintle.command("laws")
        except pintle.InputError as error:
            os.write(write, str(error).encode())
        os._exit(0)
    os.waitpid(child, 0)
    assert b"spawn" in os.read(read, 1000)


def test_a_cause_shows_its_part_of_a_mechanism():
    estimate = {"name": "clearance_increase_m", "value": 3e-5, "unit": "m", "ci95": [2e-5, 4e-5]}
    cause = {"effect": "clearance-wear", "of": "rocker_coupler", "probability": 1.0, "parameters": [estimate]}
    figures = {"verdict": "named", "causes": [cause], "provenance": {}}
    diagnosis = pintle.Diagnosis({"diagnosis.json": json.dumps(figures).encode()}, {}, None)
    assert list(diagnosis.causes["of"]) == ["rocker_coupler"]
    assert "clearance-wear of rocker_coupler: clearance_increase_m = 3e-05 m" in repr(diagnosis)
