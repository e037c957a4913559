# SPDX-License-Identifier: Apache-2.0
"""The module against what does not use it: the programs, NumPy, and a second implementation."""
import ast
import json
import os
import pathlib
import subprocess
import sys
import time

import numpy as np
import pytest

import tauext

BIN = os.environ["TAUEXT_BIN"]


@pytest.fixture(scope="module")
def arm():
    return tauext.Robot("wallmobot3")


class Mo2:
    """The momentum observer of second order, written anew: exact for torques that are held."""

    def __init__(self, robot, bandwidth):
        self.robot, self.w, self.last = robot, bandwidth, None

    def update(self, t, q, qd, tau):
        terms = self.robot.terms(q, qd)
        p, rest = terms.B @ qd, terms.momentum_bias - terms.friction
        if self.last is None:
            self.x = np.zeros((2, len(q)))
        else:
            t0, p0, rest0, tau0 = self.last
            h = t - t0
            u = tau0 + (rest + rest0) / 2 - (p - p0) / h
            a = self.w * h / np.sqrt(2)
            e, c, s = np.exp(-a), np.cos(a), np.sin(a)
            phi = e * np.array([[c + s, np.sqrt(2) * s], [-np.sqrt(2) * s, c - s]])
            self.x[0] -= u
            self.x = phi @ self.x
            self.x[0] += u
        self.last = t, p, rest, tau.copy()
        return self.x[0]


def test_a_run_is_what_tauext_record_writes(arm, tmp_path):
    out = tmp_path / "step.npz"
    subprocess.run([f"{BIN}/tauext-record", "--robot", "wallmobot3", "--scenario", "step", "--out", out],
                   check=True, stderr=subprocess.DEVNULL)
    theirs, run = np.load(out), arm.record("step")
    assert len(run) == 30000 and run.joints == 3
    for name in ("t", "q", "qd", "tau", "tau_ext"):
        np.testing.assert_array_equal(np.squeeze(theirs[name]), getattr(run, name))


def test_thirty_seconds_are_recorded_in_a_few(arm):
    arm.record("step")
    begin = time.process_time()
    run = arm.record("step")
    assert run.q.shape == (30000, 3)
    assert time.process_time() - begin < 3  # 0.9 s alone; CI's machines are shared


def test_the_truth_keeps_equation_3(arm):
    run = arm.record("free")
    compared = 0
    for k in range(1, len(run) - 1, 50):
        qdd = (run.qd[k + 1] - run.qd[k - 1]) / 2e-3
        terms = arm.terms(run.q[k], run.qd[k])
        tau = (run.tau[k] + run.tau[k - 1]) / 2  # each is held until the next sample
        left = terms.B @ qdd + terms.bias + terms.friction + run.tau_ext[k]
        np.testing.assert_allclose(left, tau, atol=1e-3 * np.abs(tau).max())
        compared += 1
    assert compared > 500 and np.abs(run.qd).max() > 0.1


def test_an_observer_in_python_scores_as_the_one_in_cpp(arm):
    mine = tauext.estimator(lambda: Mo2(arm, 30))
    run = arm.record("step", degrade={"velocity_noise": 1e-3})
    ours, theirs = (arm.estimate(e, run).tau_ext for e in (mine, "mo2:bandwidth=30"))
    np.testing.assert_allclose(ours, theirs, atol=1e-7)
    a, b = (arm.score(run, e, scenario="step") for e in (ours, theirs))
    assert a.keys() == b.keys() and "settling_s" in a
    for key, value in a.items():
        assert value == pytest.approx(b[key], rel=1e-9, abs=1e-9), key


def test_the_suite_scores_as_tauext_bench(arm, tmp_path):
    mine = tauext.estimator(lambda: Mo2(arm, 30))
    rows = arm.suite([mine, "mo2"], filter="/step/")
    assert [r["name"] for r in rows] == [f"wallmobot3/step/{mine}", "wallmobot3/step/mo2"]
    out = tmp_path / "results.json"
    subprocess.run([f"{BIN}/tauext-bench", "--benchmark_filter=wallmobot3/step/mo2$", f"--benchmark_out={out}",
                    "--benchmark_min_time=0.001"], check=True, capture_output=True)
    theirs = tauext.read_results(out)[0]
    for row in rows:
        assert row["error"] == ""
        for key, value in row["metrics"].items():
            if key in theirs:
                assert value == pytest.approx(theirs[key], rel=1e-9, abs=1e-9), key
        assert row["metrics"].keys() & theirs.keys() >= {"rmse_Nm", "noise_Nm", "settling_s"}


def test_a_study_of_an_observer_in_python_counts_as_that_of_the_one_in_cpp():
    mine = tauext.estimator(lambda arm: Mo2(arm, 30))  # the arm of `light`, which carries no panel
    shares = []
    study = tauext.Robot("wallmobot3").study([mine, "mo2"], ["pan_tompkins"], conditions=["light"], collisions=3, pushes=0,
                                             clampings=0, hours=0, training_runs=1, jobs=1, progress=shares.append)
    a, b = study["cells"]
    assert (a["estimator"], b["estimator"]) == (mine, "mo2")
    for key in a.keys() - {"estimator"}:
        assert a[key] == pytest.approx(b[key]), key
    assert a["collisions"] >= 3 and shares[-1] == 1


def test_makers_that_cannot_be_are_refused():
    with pytest.raises(TypeError, match="takes an arm or nothing, not robot, bandwidth"):
        tauext.estimator(Mo2)
    arm = tauext.Robot("wallmobot3")
    with pytest.raises(TypeError, match="what tauext.estimator"):
        arm.estimate(lambda: Mo2(arm, 30), arm.record("step"))


def test_an_arm_from_a_file_has_the_terms_of_its_estimators():
    arm = tauext.Robot(os.environ["TAUEXT_EXAMPLES"] + "/arm7.xml", lock="finger.*")
    run = arm.record("contact")
    assert run.q.shape[1] == arm.joints == 7
    mine = tauext.estimator(lambda: Mo2(arm, 30))
    short = tauext.Run(run.t[:2000], run.q[:2000], run.qd[:2000], run.tau[:2000], run.tau_ext[:2000])
    np.testing.assert_allclose(arm.estimate(mine, short).tau_ext, arm.estimate("mo2", short).tau_ext, atol=1e-7)


def test_detections_mark_what_the_suite_finds(arm):
    run = arm.record("contact")
    estimates = arm.estimate("mo2", run)
    detections = arm.detect("pan_tompkins", run, estimates)
    scores = arm.score(run, estimates, detections, scenario="contact")
    assert detections.mark.dtype == bool and detections.mark.sum() >= 1
    assert scores["recall"] == 1
    first = run.t[np.argmax(detections.mark)] - run.t[np.argmax(run.contact)]
    assert 0 <= first < 0.05
    assert tauext.CONTACTS[detections.contact.max()] in ("collision", "clamping")


def test_thresholds_of_a_file_are_those_of_their_condition(arm, tmp_path):
    run = arm.record("contact")
    estimates = arm.estimate("mo2", run)
    scores = []
    for condition in ("light", "hard"):  # whose sensors are worse, and so are its thresholds
        file = tmp_path / f"{condition}.json"
        subprocess.run([f"{BIN}/tauext-detect", "--robot", "wallmobot3", "--calibrate", file, "--train", condition,
                        "--estimator", "mo2", "--detector", "threshold", "--runs", "2"], check=True, capture_output=True)
        d = arm.detect("threshold", run, estimates, thresholds=file, estimator="mo2", condition=condition)
        scores.append(d.score.max())
        with pytest.raises(ValueError):
            arm.detect("threshold", run, estimates, thresholds=file, estimator="ekf", condition=condition)
    assert scores[0] > 1.5 * scores[1] > 0


def test_runs_go_through_files(arm, tmp_path):
    run = arm.record("step")
    for name in ("run.csv", "run.npz"):
        run.save(str(tmp_path / name))
        again = tauext.read_log(tmp_path / name)
        np.testing.assert_array_equal(again.tau_ext, run.tau_ext)
        np.testing.assert_array_equal(again.q, run.q)


def test_arrays_are_copies(arm):
    run = arm.record("step")
    before = run.q[100, 0]
    run.q[:] = 0
    assert run.q[100, 0] == before


class Breaks:
    def update(self, t, q, qd, tau):
        if t > 0.5:
            raise RuntimeError("at half a second")
        return np.zeros(len(q))


def test_errors_say_what_is_wrong(arm, tmp_path):
    run = arm.record("step")
    with pytest.raises(RuntimeError, match="at half a second"):
        arm.estimate(tauext.estimator(Breaks), run)
    with pytest.raises(ValueError, match="3 numbers"):
        arm.estimate(tauext.estimator(lambda: type("Short", (), {"update": lambda *a: [1, 2]})()), run)
    arm.estimate("mo2", run)  # and the error is gone
    with pytest.raises(ValueError, match="mo2"):
        arm.estimate("mo22", run)
    with pytest.raises(ValueError, match="step"):
        arm.record("stepp")
    with pytest.raises(ValueError, match="wallmobot3"):
        tauext.Robot("wallmobot")
    with pytest.raises(ValueError, match="velocity_nois"):
        arm.record("step", degrade={"velocity_nois": 1})
    with pytest.raises(ValueError, match="row for each of 5 samples"):
        tauext.Run(np.arange(5.), np.zeros((5, 3)), np.zeros((4, 3)), np.zeros((5, 3)))
    with pytest.raises(ValueError, match="increase"):
        tauext.Run(np.zeros(5), *[np.zeros((5, 3))] * 3)
    with pytest.raises(ValueError, match="benchmarks"):
        (tmp_path / "x.json").write_text(json.dumps([1]))
        tauext.read_results(tmp_path / "x.json")
    with pytest.raises(ValueError, match="estimates of 2 samples"):
        arm.score(run, np.zeros((2, 3)))
    with pytest.raises(TypeError):
        tauext.estimator(3)


def test_lists_are_the_programs():
    arm = tauext.Robot("wallmobot3")
    listed = subprocess.run([f"{BIN}/tauext-bench", "--list"], check=True, capture_output=True, text=True).stdout
    for name in arm.estimators() + arm.detectors() + list(arm.scenarios()):
        assert name in listed
    assert "python" not in arm.estimators()
    assert {"wallmobot3", "testbed1", "wallmobot6"} <= set(tauext.robots())
    keys = {m["key"] for m in tauext.metrics()}
    assert {"rmse_Nm", "settling_s", "recall"} <= keys
    assert [p["key"] for p in arm.parameters("mo2")][0] == "bandwidth"


def test_the_extension_has_what_its_types_say():
    folder = pathlib.Path(tauext.__file__).parent
    stub = ast.parse((folder / "_core.pyi").read_text())

    def public(names):
        return {n for n in names if not n.startswith("_")}

    typed = [d for d in stub.body if isinstance(d, (ast.ClassDef, ast.FunctionDef))]
    assert public(dir(tauext._core)) == {d.name for d in typed}
    for of in (d for d in typed if isinstance(d, ast.ClassDef)):
        members = {d.name for d in of.body if isinstance(d, ast.FunctionDef)}
        theirs = vars(getattr(tauext._core, of.name))
        assert public(theirs) == public(members), of.name
        assert ("__len__" in theirs) == ("__len__" in members), of.name


def test_mypy_understands_the_types(tmp_path):
    user = tmp_path / "user.py"
    user.write_text("""import tauext
arm = tauext.Robot("wallmobot3")
run = arm.record("step")
print(arm.estimate("mo2", run).tau_ext.shape, run.joints + "1")
""")
    env = dict(os.environ, MYPYPATH=str(pathlib.Path(tauext.__file__).parents[1]))
    said = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, user], env=env,
                          capture_output=True, text=True).stdout
    assert 'Unsupported operand types for + ("int" and "str")' in said and "Found 1 error in 1 file" in said, said


def test_the_module_says_what_is_there(arm):
    def said(*robot):
        return subprocess.run([sys.executable, "-m", "tauext", *robot], capture_output=True, text=True)

    program = subprocess.run([f"{BIN}/tauext-bench", "--version"], capture_output=True, text=True, check=True).stdout
    assert program.split()[1].rstrip(",") == tauext.__version__
    lines = said().stdout.splitlines()
    assert lines[0].startswith(f"tauext {tauext.__version__}, ") and "MuJoCo" in lines[0]
    assert lines[2] == f"estimators: {', '.join(arm.estimators())}"
    assert {line.split()[0] for line in lines[5:]} == set(arm.scenarios())
    other = said("nothing_like_it")
    assert other.returncode == 2 and "nothing_like_it" in other.stderr and not other.stdout
