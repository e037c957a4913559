# SPDX-License-Identifier: Apache-2.0
"""External joint torque of robot arms: truth, estimators, detectors and metrics.

    import tauext
    arm = tauext.Robot("wallmobot3")
    run = arm.record("contact")                 # 30 s of simulation, with its truth
    estimates = arm.estimate("mo2", run)
    marks = arm.detect("pan_tompkins", run, estimates)
    print(arm.score(run, estimates, marks, scenario="contact"))

Arrays have a row for each sample and a column for each joint: what NumPy makes an array of will do,
and what is of another shape, or no number, is an error that names the argument. Columns of a pandas
DataFrame are found by the joints' names, rows are taken in their order. Masked and missing values
of q, qd and tau become NaN, and Estimates.status says which samples could not be used. Everything is
in SI units and radians. tau_ext has the sign of B qdd + C qd + F + g + tau_ext = tau: a force f that acts on the
arm gives tau_ext = -J^T f. Wherever an estimator or a detector is named, a specification with its
parameters is understood: "mo2:bandwidth=50".
"""
from __future__ import annotations

import importlib.util
import inspect
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

if importlib.util.find_spec(f"{__name__}._core") is None:
    raise ImportError("tauext._core is not built for this Python: in a clone, ci/install_deps and then "
                      "ci/build release tauext_python build it for /usr/bin/python3")
from . import _arrays, _core
from ._core import Detections, Estimates, Run

__all__ = ["Arm", "CONTACTS", "Detections", "Estimates", "Estimator", "Robot", "Run", "Terms", "estimator",
           "metrics", "read_log", "read_results", "robots"]

__version__ = _core.build().split(",")[0].removeprefix("tauext ")

#: What the numbers of Detections.contact mean.
CONTACTS = ("none", "intentional", "collision", "clamping")

Degrade = Mapping[str, Any] | str | None


class Estimator(Protocol):
    """An estimator in Python."""

    def update(self, t: float, q: NDArray[np.float64], qd: NDArray[np.float64],
               tau: NDArray[np.float64]) -> ArrayLike:
        """tau_ext [N m] at time t [s], from q [rad], qd [rad/s] and tau [N m], a value a joint."""


class Terms(NamedTuple):
    """The terms of equation (3) at one state."""

    B: NDArray[np.float64]  #: [kg m^2] inertia
    bias: NDArray[np.float64]  #: [N m] C qd + g
    momentum_bias: NDArray[np.float64]  #: [N m] C^T qd - g
    friction: NDArray[np.float64]  #: [N m] F


class Arm:
    """An arm as estimators know it."""

    def __init__(self, arm: _core.Arm, joint_names: Sequence[str] = ()):
        self._arm, self._names = arm, joint_names

    def terms(self, q: ArrayLike, qd: ArrayLike) -> Terms:
        """At q [rad] and qd [rad/s], a number for each joint."""
        return Terms(*self._arm.terms(q, qd, self._names))


def estimator(make: Callable[[Arm], Estimator] | Callable[[], Estimator]) -> str:
    """The specification of an estimator in Python, which every call here understands.

    make(arm) is called anew for each run, and gives an object with update(); a make() without
    arguments is called so. What update() throws ends the call that runs it. There is no time in its
    scores: Python's would say nothing.
    """
    if not callable(make):
        raise TypeError("estimator(make): make is a class or a function that gives an estimator")
    wanted = [p for p in inspect.signature(make).parameters.values()
              if p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if len(wanted) > 1:
        raise TypeError(f"estimator(make): make takes an arm or nothing, not {', '.join(p.name for p in wanted)}")
    made: Callable[..., Estimator] = make
    return _core.estimator((lambda arm: made(Arm(arm))) if wanted else (lambda arm: made()))


def robots() -> list[str]:
    """The robots that are known by name; others are the path of an MJCF or URDF file."""
    return _core.robots()


def metrics() -> list[dict[str, str]]:
    """Every metric: its key, its unit, which values are better ("less", "more", "neither") and what it means."""
    return _core.metrics()


def read_log(path: str | os.PathLike[str], *, columns: str = "", channel: str = "",
             robot: str = "") -> Run:
    """A recording: CSV, NumPy, LCM, or a ROS 2 bag.

    columns: a preset (libfranka, ur_rtde, ...) or a TOML file that says which column is what
    channel: of an LCM log the channel, of a bag the topic
    robot: whose joints it must have, by whose names they are found in a bag, and whose gains make
    torques of currents; without it a bag's joints have the order of its first message
    """
    return _core.read_log(os.fspath(path), columns, channel, robot)


def read_results(path: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """The rows of a file that tauext-bench or tauext-score wrote, each with its name and metrics."""
    with open(path, encoding="utf-8") as file:
        all = json.load(file)
    if not isinstance(all, dict) or not isinstance(all.get("benchmarks"), list):
        raise ValueError(f"{os.fspath(path)}: has no list of results, \"benchmarks\"")
    rows: list[dict[str, Any]] = all["benchmarks"]
    return rows


def _list(specifications: str | Iterable[str] | None, otherwise: Callable[[], list[str]]) -> list[str]:
    if specifications is None:
        return otherwise()
    return [specifications] if isinstance(specifications, str) else list(specifications)


def _text(degrade: Degrade) -> str:
    if degrade is None:
        return ""
    return degrade if isinstance(degrade, str) else json.dumps(dict(degrade))


class Robot:
    """A robot, its scenarios, and the estimators and detectors that run on it."""

    def __init__(self, name: str | os.PathLike[str], *, lock: str = ""):
        """name: one of robots(), or the path of an MJCF or URDF file; lock: a regular expression of
        the joints of such a file that are fixed, like "finger.*"."""
        self._robot = _core.robot(os.fspath(name), lock)

    def __repr__(self) -> str:
        return f"<tauext.Robot: {self.name}, {self.joints} joints>"

    @property
    def name(self) -> str:
        """By which it was found."""
        return self._robot.name

    @property
    def joints(self) -> int:
        """How many it has."""
        return self._robot.joints

    @property
    def joint_names(self) -> list[str]:
        """What a robot's file calls them; none of a robot that is known by name."""
        return self._robot.joint_names

    def scenarios(self) -> dict[str, str]:
        """What can happen to it: names, and a line on each."""
        return dict(self._robot.scenarios())

    def estimators(self) -> list[str]:
        """By name; zero, truth and delayed_truth copy the truth, to compare with."""
        return self._robot.estimators()

    def detectors(self) -> list[str]:
        """By name."""
        return self._robot.detectors()

    def parameters(self, name: str) -> list[dict[str, str]]:
        """The keys of an estimator or a detector: unit, value unless it is set, and what larger does."""
        of = self._robot.estimator_fields if name in self.estimators() else self._robot.detector_fields
        return of(name)

    def terms(self, q: ArrayLike, qd: ArrayLike) -> Terms:
        """The arm as its estimators know it, at q [rad] and qd [rad/s]; wallmobot3 with 150 kg. In a
        study its estimators may know another panel, as the arm does that make(arm) of estimator() gets."""
        if not hasattr(self, "_arm"):
            self._arm = Arm(self._robot.arm(), self.joint_names)
        return self._arm.terms(q, qd)

    def record(self, scenario: str, *, degrade: Degrade = None, seed: int = 1) -> Run:
        """A scenario at 1 kHz, with its truth.

        degrade: what is wrong with sensors, model and drives: "light", "typical", "hard", the path of
        a JSON file, or its contents, like {"velocity_noise": 1e-3, "model_error": {"mass": 1.05}}.
        The seed is that of the sensors.
        """
        return self._robot.record(scenario, _text(degrade), seed)

    def estimate(self, estimator: str, run: Run) -> Estimates:
        """What an estimator makes of a run."""
        if not isinstance(estimator, str):
            raise TypeError("estimate(estimator, run): estimator is a specification, or what tauext.estimator(make) returns")
        return self._robot.estimate(estimator, run)

    def detect(self, detector: str, run: Run, estimates: Estimates | ArrayLike, *,
               thresholds: str | os.PathLike[str] = "", estimator: str = "",
               condition: str = "") -> Detections:
        """What a detector makes of estimates.

        thresholds: a file of tauext-detect --calibrate, which has those behind `estimator`
        condition: of the study, for which such a file may have others
        """
        return self._robot.detect(detector, run, self._estimates(estimates, run), os.fspath(thresholds), estimator,
                                  condition)

    def score(self, run: Run, estimates: Estimates | ArrayLike, detections: Detections | None = None, *,
              scenario: str = "", score_from: float | None = None) -> dict[str, float]:
        """Metrics of estimates, by their keys (see metrics()); NaN is "never".

        scenario: which the run is of; then it says what else is asked, and from when on
        score_from: [s] errors before do not count
        """
        marks = [] if detections is None else detections.mark.tolist()
        return _core.score(run, self._estimates(estimates, run), marks, self._robot, scenario,
                           float("nan") if score_from is None else score_from)

    def suite(self, estimators: str | Sequence[str] | None = None, *,
              detectors: str | Sequence[str] = (), filter: str = "", degrade: Degrade = None,
              seed: int = 1) -> list[dict[str, Any]]:
        """Estimators through the scenarios, as tauext-bench scores them, but for times.

        Each row has the name ROBOT/SCENARIO/ESTIMATOR[+DETECTOR], "metrics" by their keys or, where
        it failed, none and an "error". filter is a regular expression of names. Without detectors those of
        tauext-bench run where there is something to detect.
        """
        return _core.suite(self._robot, _list(estimators, self.estimators), _list(detectors, list),
                           filter, _text(degrade), seed)

    def study(self, estimators: str | Sequence[str], detectors: str | Sequence[str], *,
              conditions: Sequence[str] = (), collisions: int = 300, pushes: int = 100,
              clampings: int = 100, regions: int = 0, hours: float = 1, training_runs: int = 20,
              jobs: int = 0,
              progress: Callable[[float], None] | None = None) -> dict[str, Any]:
        """The detection study of these estimators with these detectors, whose thresholds are trained
        first: what tauext-detect writes to its file.

        conditions: by name; none are those of tauext-detect --quick
        training_runs: of 30 s for each condition of the training, free and with slow pushes
        jobs: threads, 0 for one a core; an estimator in Python gains nothing by several
        progress: is called with the share that is done
        """
        text = _core.study(self._robot, list(conditions), _list(estimators, list), _list(detectors, list),
                           collisions, pushes, clampings, regions, hours, training_runs, jobs, progress)
        written: dict[str, Any] = json.loads(text)
        return written

    def _estimates(self, estimates: Estimates | ArrayLike, run: Run) -> Estimates:
        if isinstance(estimates, Estimates):
            return estimates
        return Estimates(_arrays.table(estimates, "estimates", len(run), run.joints, self.joint_names))


