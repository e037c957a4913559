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
    for name in ("run.csv", "run.npz", "run.mcap"):
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
    with pytest.raises(ValueError, match="benchmarks"):
        (tmp_path / "x.json").write_text(json.dumps([1]))
        tauext.read_results(tmp_path / "x.json")
    with pytest.raises(ValueError, match="estimates of 2 samples"):
        arm.score(run, tauext.Estimates(np.zeros((2, 3))))
    with pytest.raises(ValueError, match=r"estimates is .* shape \(2, 3\), and \(30000, 3\) is wanted"):
        arm.score(run, np.zeros((2, 3)))
    with pytest.raises(TypeError):
        tauext.estimator(3)


class Foreign:
    """Of another library: NumPy's protocol, and nothing else."""

    def __init__(self, a):
        self.a = a

    def __array__(self, dtype=None, copy=None):
        return np.array(self.a, dtype=dtype)


@pytest.fixture
def pd():
    return pytest.importorskip("pandas", reason="Debian's python3-pandas is not here")


N = 8
TIME = np.arange(N) / 64  # a float32 has them all
Q, QD, TAU, TRUTH = (np.round(np.random.default_rng(seed).normal(size=(N, 3)) * 64) / 64 for seed in range(4))


def made(t=TIME, q=Q, qd=QD, tau=TAU, *more, **named):
    return tauext.Run(t, q, qd, tau, *more, **named)


@pytest.mark.parametrize("form", [
    np.ndarray.tolist,
    lambda a: tuple(map(tuple, a)) if a.ndim > 1 else tuple(a),
    np.float32,
    lambda a: a.astype(">f8"),
    np.asfortranarray,
    lambda a: np.repeat(a, 2, axis=0)[::2],
    lambda a: a[::-1].copy()[::-1],
    lambda a: a.T.copy().T,
    lambda a: np.ma.array(a, mask=False),
    Foreign,
])
def test_every_form_of_an_array_is_the_same_run(arm, form):
    run = tauext.Run(*map(form, (TIME, Q, QD, TAU, TRUTH)), form(np.arange(N) % 2 * 1.0))
    wanted = {"t": TIME, "q": Q, "qd": QD, "tau": TAU, "tau_ext": TRUTH, "contact": np.arange(N) % 2}
    for what, numbers in wanted.items():
        np.testing.assert_array_equal(getattr(run, what), numbers)
    np.testing.assert_array_equal(tauext.Estimates(form(TRUTH)).tau_ext, TRUTH)
    for got, wanted in zip(arm.terms(form(Q[1]), form(QD[1])), arm.terms(Q[1], QD[1])):
        np.testing.assert_array_equal(got, wanted)
    assert arm.score(run, form(TAU)) == arm.score(run, tauext.Estimates(TAU))
    np.testing.assert_array_equal(arm.detect("pan_tompkins", run, form(TAU)).score,
                                  arm.detect("pan_tompkins", run, tauext.Estimates(TAU)).score)
    constant = tauext.estimator(lambda: type("Constant", (), {"update": lambda *of: form(Q[2])})())
    np.testing.assert_array_equal(arm.estimate(constant, run).tau_ext, np.tile(Q[2], (N, 1)))


def test_integers_and_one_joint_need_no_care():
    run = made(TIME[:, np.newaxis], np.arange(N), np.int8(QD[:, :1]), TAU[:, 0], contact=[True] * N)
    assert run.joints == 1 and run.contact.all()
    np.testing.assert_array_equal(run.q[:, 0], np.arange(N))
    np.testing.assert_array_equal(run.tau, TAU[:, :1])
    np.testing.assert_array_equal(made(TIME[np.newaxis]).t, TIME)


def test_what_is_masked_is_not_there():
    mask = Q > 0
    np.testing.assert_array_equal(made(q=np.ma.array(Q, mask=mask)).q, np.where(mask, np.nan, Q))
    whole = np.ma.array(Q.astype(int), mask=mask)  # integers have no NaN of their own
    np.testing.assert_array_equal(made(q=whole).q, np.where(mask, np.nan, Q.astype(int)))
    np.testing.assert_array_equal(made(q=list(whole)).q, made(q=whole).q)


@pytest.mark.parametrize("given, error, said", [
    ({"q": Q.T}, ValueError, r"^q is float64 of shape \(3, 8\), and \(8, joints\) is wanted: a row for .*, as q.T has"),
    ({"qd": QD[:4]}, ValueError, r"^qd is float64 of shape \(4, 3\), and \(8, 3\) is wanted"),
    ({"tau": TAU[:, :2]}, ValueError, r"^tau is float64 of shape \(8, 2\), and \(8, 3\) is wanted"),
    ({"tau": TAU[:, 0]}, ValueError, r"^tau is float64 of shape \(8,\), and \(8, 3\) is wanted"),
    ({"tau_ext": TRUTH[np.newaxis]}, ValueError, r"^tau_ext is float64 of shape \(1, 8, 3\)"),
    ({"tau_ext": np.ma.array(TRUTH, mask=TRUTH == TRUTH[2, 1])}, ValueError, r"^tau_ext\[2\] is \[.* nan .*\], and nothing"),
    ({"q": Q[:, :0]}, ValueError, r"^q is float64 of shape \(8, 0\)"),
    ({"q": Q + 1j}, TypeError, r"^q is complex128 of shape \(8, 3\), and numbers are wanted"),
    ({"qd": QD > 0}, TypeError, "^qd is bool of shape"),
    ({"qd": np.ma.array(QD > 0)}, TypeError, "^qd is bool of shape"),
    ({"tau": TAU.astype(str)}, TypeError, "^tau is <U.* of shape"),
    ({"tau": TAU.astype(object)}, TypeError, "^tau is object of shape"),
    ({"tau": None}, TypeError, "^tau is a NoneType"),
    ({"tau": [[1, 2, 3], [4]] * 4}, ValueError, "^tau, a list, is no array"),
    ({"q": np.zeros(N, [("a", float)])}, TypeError, "^q is .* of shape"),
    ({"q": TIME.astype("M8[s]")[:, np.newaxis]}, TypeError, r"^q is datetime64\[s\]"),
    ({"t": np.zeros((4, 2))}, ValueError, r"^t is float64 of shape \(4, 2\)"),
    ({"t": []}, ValueError, "^t is a list, float64 of shape"),
    ({"t": 3.0}, ValueError, "^t is a float, float64 of shape"),
    ({"t": TIME[:5]}, ValueError, r"^q is .* \(8, 3\), and \(5, joints\)"),
    ({"t": TIME * 0}, ValueError, r"^t must increase, and does not from t\[0\]"),
    ({"t": TIME[::-1]}, ValueError, r"^t must increase, and does not from t\[0\]"),
    ({"t": np.where(TIME == TIME[3], np.nan, TIME)}, ValueError, r"^t\[3\] is nan"),
    ({"t": np.where(TIME == TIME[7], np.inf, TIME)}, ValueError, r"^t\[7\] is inf"),
    ({"t": np.ma.array(TIME, mask=TIME == TIME[5])}, ValueError, r"^t\[5\] is nan"),
    ({"t": np.array(["2026-01-01", "NaT"] * 4, "M8[s]")}, ValueError, r"^t\[1\] is nan"),
    ({"t": TIME + 0j}, TypeError, "^t is complex128"),
    ({"t": TIME > 0}, TypeError, "^t is bool"),
    ({"t": TIME.astype(str)}, TypeError, "^t is <U"),
    ({"t": TIME.astype(object)}, TypeError, "^t is object"),
    ({"t": np.arange(N, dtype="m8[Y]")}, TypeError, r"^t is timedelta64\[Y\]"),
    ({"contact": np.zeros(3)}, ValueError, r"^contact is float64 of shape \(3,\), and \(8,\) is wanted"),
    ({"contact": [0, np.nan] * 4}, ValueError, r"^contact\[1\] is nan"),
    ({"contact": ["no"] * N}, TypeError, "^contact is a list, <U2"),
    ({"joint_names": "abc"}, TypeError, "^joint_names is 'abc'"),
    ({"joint_names": ["a", "b"]}, ValueError, r"^q is .* \(8, 3\), and \(8, 2\) is wanted"),
])
def test_what_is_no_run_is_named_with_what_is_wanted(given, error, said):
    with pytest.raises(error, match=said):
        made(**given)


def test_what_is_no_number_for_each_joint_is_named(arm):
    for wrong in (Q[0, :2], Q[:2], Q[0].astype(str), None):
        with pytest.raises((TypeError, ValueError), match="^qd is .* wanted"):
            arm.terms(Q[0], wrong)
    for wrong, error in ((TRUTH.T, ValueError), (TRUTH > 0, TypeError), (TRUTH[:, 0], ValueError)):
        with pytest.raises(error, match="^estimates is .* wanted"):
            arm.score(made(), wrong)
        with pytest.raises(error, match="^tau_ext is .* wanted|^estimates is .* wanted"):
            arm.detect("pan_tompkins", made(), wrong)
    with pytest.raises(ValueError, match=r"^tau_ext is float64 of shape \(8,\), and \(samples, joints\) is wanted"):
        tauext.Estimates(TRUTH[:, 0])
    nothing = tauext.estimator(lambda: type("Nothing", (), {"update": lambda *of: None})())
    with pytest.raises(TypeError, match=r"^what update\(\) returns is a NoneType"):
        arm.estimate(nothing, made())


def test_dates_are_seconds_since_the_first(pd):
    begin = pd.Timestamp("2026-03-29 01:59:59.970")  # Berlin's summer time begins 30 ms later
    dates = begin + pd.to_timedelta(np.arange(N) * 15625, unit="us")
    berlin = dates.tz_localize("UTC").tz_convert("Europe/Berlin")
    for t in (dates, dates.to_numpy(), dates.to_numpy().astype("M8[us]"), pd.Series(dates), pd.DataFrame({"t": dates}),
              dates - begin + pd.Timedelta("1h"), (dates - begin).to_numpy(), berlin, pd.Series(berlin),
              list(dates), list(berlin), [d.to_pydatetime() for d in berlin], [(d - begin).to_pytimedelta() for d in dates]):
        np.testing.assert_allclose(made(t).t, TIME, rtol=1e-15, err_msg=repr(t))


def test_times_that_can_hardly_be_seconds_are_doubted():
    with pytest.warns(UserWarning, match="15.6 s apart .* is t in s"):
        made(TIME * 1000)  # ms
    with pytest.warns(UserWarning, match="t is float32, which knows steps of 0.0001 s here") as told:
        made(np.float32(1024 + np.arange(N) / 1024))
    assert told[0].filename == __file__


@pytest.fixture(scope="module")
def arm6():
    return tauext.Robot(os.environ["TAUEXT_EXAMPLES"] + "/arm6.xml")


def test_columns_with_names_are_found_by_them(pd, arm6):
    names = arm6.joint_names
    assert names == ["shoulder_pan", "shoulder_lift", "elbow", "wrist1", "wrist2", "wrist3"]
    whole = arm6.record("in_motion")
    parts = {what: getattr(whole, what)[:2000] for what in ("q", "qd", "tau", "tau_ext")}
    plain = tauext.Run(whole.t[:2000], **parts)
    wanted = arm6.estimate("mo2", plain).tau_ext

    def framed(what, label):
        return pd.DataFrame({label.format(n): parts[what][:, i] for i, n in enumerate(names)}).sort_index(axis=1)

    for label in ("{}", "position.{}", "{}_pos"):
        frames = {what: framed(what, label) for what in parts}
        run = tauext.Run(plain.t, **frames, joint_names=names)
        np.testing.assert_array_equal(arm6.estimate("mo2", run).tau_ext, wanted)
    estimates = pd.DataFrame(wanted, columns=names).sort_index(axis=1)
    assert arm6.score(plain, estimates) == arm6.score(plain, wanted)
    q, qd = (framed(what, "{}").iloc[7] for what in ("q", "qd"))
    for got, of in zip(arm6.terms(q, qd), arm6.terms(parts["q"][7], parts["qd"][7])):
        np.testing.assert_array_equal(got, of)
    with pytest.raises(ValueError, match="^q has names, elbow, .* none are known: joint_names=robot.joint_names"):
        tauext.Run(plain.t, **frames | {"q": framed("q", "{}")})


def test_names_are_matched_or_refused(pd):
    def said(labels, *joints):
        return tauext.Estimates(pd.DataFrame([range(len(labels))], columns=labels), joint_names=joints).tau_ext[0].tolist()

    assert said(["c", "a", "b"], "a", "b", "c") == [1, 2, 0]
    assert said(["joint2", "joint1"], "panda_joint1", "panda_joint2") == [1, 0]
    assert said(pd.MultiIndex.from_tuples([("position", "b"), ("position", "a")]), "a", "b") == [1, 0]
    assert said(["tau1", "tau2"], "shoulder", "elbow") == [0, 1]  # names of no joint, but numbered
    assert said([0, 1, 2], "a", "b", "c") == [0, 1, 2] == said(["q4", "q5", "q10"])
    with pytest.warns(UserWarning, match="^tau_ext: names of no joint are left out, 2 of 4: finger, t$"):
        assert said(["finger", "b", "t", "a"], "a", "b") == [3, 1]
    with pytest.raises(ValueError, match="^tau_ext never names c; the joints are a, b, c, and tau_ext has a, b, d"):
        said(["a", "b", "d"], "a", "b", "c")
    with pytest.raises(ValueError, match="^tau_ext never names shoulder, elbow"):
        said(["upper", "lower"], "shoulder", "elbow")
    with pytest.raises(ValueError, match="more than once: q.a, q.b, or tau.a, tau.b"):
        said(["q.a", "q.b", "tau.a", "tau.b"], "a", "b")
    with pytest.raises(ValueError, match="has more than one a"):
        said(["a", "a", "b"], "a", "b")
    with pytest.raises(ValueError, match="none are known"):
        said(["tau2", "tau1"])


def test_missing_values_of_pandas_are_nan_and_texts_are_named(pd):
    frame = pd.DataFrame(Q, columns=["q1", "q2", "q3"])
    missing = frame.astype("Float64").mask(frame > 0)
    np.testing.assert_array_equal(made(q=missing).q, np.where(Q > 0, np.nan, Q))
    np.testing.assert_array_equal(made(q=frame.astype({"q1": "float32", "q2": "Float64"})).q, Q)
    assert made(contact=pd.Series([True, False] * 4, dtype="boolean")).contact.sum() == 4
    with pytest.raises(ValueError, match=r"^contact\[1\] is nan"):
        made(contact=pd.Series([True, None] * 4, dtype="boolean"))
    with pytest.raises(TypeError, match="^q is a DataFrame, object of shape .* because of q2, and numbers are wanted"):
        made(q=frame.assign(q2="1.5"))
    with pytest.warns(UserWarning, match="left out, 1 of 4: remark"):
        made(q=frame.assign(remark="text"), joint_names=["q1", "q2", "q3"])


def test_rows_that_an_index_puts_elsewhere_are_refused(pd):
    t = pd.Series(TIME)
    frame = pd.DataFrame(QD, columns=["1", "2", "3"])
    made(t, qd=frame.set_axis(pd.date_range("2026", periods=N)))  # another kind of index says nothing
    with pytest.raises(ValueError, match="^qd has the rows of t in another order"):
        made(t, qd=frame[::-1])


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
