# SPDX-License-Identifier: Apache-2.0
"""The one place where arguments become arrays of float64.

What pandas makes is known by its columns, index, dtypes and iloc, without importing it; all else by what NumPy makes of
it. What is masked or missing becomes NaN. Errors name the argument, what it is, and what is wanted.
"""
from __future__ import annotations

import re
import sys
import textwrap
import warnings
from collections.abc import Iterable, Sequence
from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
masked: Any = np.ma  # which has no types


def run(t: Any, q: Any, qd: Any, tau: Any, tau_ext: Any, contact: Any,
        joint_names: Sequence[str]) -> tuple[Floats, Floats, Floats, Floats, Floats | None, NDArray[np.bool_] | None]:
    """The arguments of Run."""
    times = _times(t)
    n = len(times)
    for what, x in {"q": q, "qd": qd, "tau": tau, "tau_ext": tau_ext, "contact": contact}.items():
        _require_same_order(x, t, what)
    at = table(q, "q", n, None, joint_names)
    joints = at.shape[1]
    rate, torque = table(qd, "qd", n, joints, joint_names), table(tau, "tau", n, joints, joint_names)
    truth = None
    if tau_ext is not None:
        truth = table(tau_ext, "tau_ext", n, joints, joint_names)
        _require_finite(truth, "tau_ext", "nothing can be scored by that: leave such samples out, or tau_ext")
    return times, at, rate, torque, truth, None if contact is None else _flags(contact, "contact", n)


def table(x: Any, what: str, samples: int | None, joints: int | None, joint_names: Sequence[str]) -> Floats:
    """A row for each sample and a column for each joint, of any number of them where that is None. A table whose columns
    have names is brought into the order of joint_names."""
    if isinstance(joint_names, str):
        raise TypeError(f"joint_names is '{joint_names}', and a list of names is wanted")
    joint_names = list(joint_names)
    joints = joints or len(joint_names) or None
    labels = _labels(x, "columns")
    if labels and len(x) == (samples or len(x)):
        columns = _find(joint_names, labels, what)
        x = x.iloc[:, columns] if hasattr(x, "iloc") else np.asarray(x)[:, columns]
    a = _numbers(x, what)
    if a.ndim == 1 and joints in (None, 1) and len(a) == samples:
        a = a[:, np.newaxis]
    if a.ndim == 2 and a.shape[1] > 0 and a.shape[0] == (samples or len(a)) and a.shape[1] == (joints or a.shape[1]):
        return np.ascontiguousarray(a)
    is_turned = a.ndim == 2 and a.shape[1] == samples and len(a) == (joints or len(a))
    raise ValueError(f"{what} is {_described(x, a)}, and ({samples or 'samples'}, {joints or 'joints'}) is wanted: a row "
                     f"for each of {samples or 'the'} samples and a column for each of {joints or 'the'} joints"
                     + (f", as {what}.T has it" if is_turned else ""))


def vector(x: Any, what: str, joints: int, joint_names: Sequence[str]) -> Floats:
    """A number for each joint; those of a pandas.Series with names in the order of joint_names."""
    if hasattr(x, "iloc") and x.ndim == 2 and 1 in x.shape:
        x = x.iloc[0] if len(x) == 1 else x.iloc[:, 0]
    if hasattr(x, "iloc") and x.ndim == 1:
        x = x.iloc[_find(joint_names, _labels(x, "index"), what)]
    return np.ascontiguousarray(_line(_numbers(x, what), x, what, joints, f"{joints} numbers, one for each joint"))


def _flags(x: Any, what: str, samples: int) -> NDArray[np.bool_]:
    a = _numbers(x, what, "True or False is wanted", "biuf")
    a = _line(a, x, what, samples, "True or False for each sample")
    _require_finite(a, what, "True or False is wanted")
    return np.asarray(a != 0)


def _require_finite(a: Floats, what: str, why: str) -> None:
    is_bad = ~np.isfinite(a).reshape(len(a), -1).all(axis=1)
    if is_bad.any():
        k = int(np.argmax(is_bad))
        raise ValueError(f"{what}[{k}] is {a[k]}, and {why}")


def _times(t: Any) -> Floats:
    """[s]; of dates and durations since the first."""
    a = _array(t, "t")
    if a.dtype.kind in "mMO" and a.size > 0:
        a = _since_first(a)
    s = _line(_numbers(a, "t", "seconds or dates (datetime64) are wanted", given=t), t, "t", None, "a time for each sample")
    _require_finite(s, "t", "each sample needs a time")
    steps = np.diff(s)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        raise ValueError(f"t must increase, and does not from t[{k}] = {s[k]} to t[{k + 1}] = {s[k + 1]} s")
    if s.size > 2 and s[-1] - s[0] > 0.1 * s.size:
        _warn(f"the samples are {steps.mean():.3g} s apart on average: is t in s?")
    if a.dtype.kind == "f" and s.size > 1 and (least := np.spacing(np.abs(a).max())) > 0.1 * np.median(steps):
        _warn(f"t is {a.dtype}, which knows steps of {least:.1g} s here, and the samples are {np.median(steps):.1g} s "
              "apart: estimates have the noise of that")
    return s


def _since_first(a: NDArray[Any]) -> NDArray[Any]:
    """[s] of dates or durations; what is none, or has no certain unit, stays as it is."""
    try:
        if a.dtype.kind != "O":
            a = np.asarray(masked.filled(a, a.dtype.type("NaT")))
            s = a - a.flat[0]
            return a if np.datetime_data(s.dtype)[0] == "generic" else np.asarray(s / np.timedelta64(1, "s"))
        # without summer time
        utc = [x.astimezone(timezone.utc) if isinstance(x, datetime) and x.tzinfo else x for x in a.flat]
        return np.array([(x - utc[0]) / timedelta(seconds=1) for x in utc], float).reshape(a.shape)
    except TypeError:
        return a


def _array(x: Any, what: str, kinds: str = "iuf") -> NDArray[Any]:
    """What NumPy makes of it, masked or not."""
    try:
        if isinstance(x, (list, tuple)) and any(isinstance(part, masked.MaskedArray) for part in x):
            x = masked.array(x)
        a: NDArray[Any] = x if isinstance(x, masked.MaskedArray) else np.asarray(x)
    except (TypeError, ValueError) as e:
        raise ValueError(f"{what}, a {type(x).__name__}, is no array: {e}") from None
    if a.dtype == object and hasattr(x, "to_numpy"):  # pandas' missing values and time zones, which NumPy has not
        theirs = {getattr(d, "kind", "O") for d in _dtypes(x)}
        if theirs <= set(kinds):
            return np.asarray(x.to_numpy(dtype=float, na_value=np.nan))
        if theirs == {"M"}:
            return np.asarray(x, dtype="datetime64[ns]")
    return a


def _numbers(x: Any, what: str, wanted: str = "numbers are wanted", kinds: str = "iuf", given: Any = None) -> Floats:
    a = _array(x, what, kinds)
    if a.dtype.kind not in kinds:
        raise TypeError(f"{what} is {_described(x if given is None else given, a)}, and {wanted}")
    return np.asarray(masked.filled(a.astype(float), np.nan))


def _line(a: Floats, x: Any, what: str, n: int | None, wanted: str) -> Floats:
    """Of shape (n,), (n, 1) or (1, n); of None any but 0."""
    if a.ndim not in (1, 2) or a.size != max(a.shape) or a.size != (n or a.size) or a.size == 0:
        raise ValueError(f"{what} is {_described(x, a)}, and ({n or 'samples'},) is wanted: {wanted}")
    return a.reshape(-1)


def _dtypes(x: Any) -> list[Any]:
    of = getattr(x, "dtypes", getattr(x, "dtype", None))
    return list(of) if isinstance(of, Iterable) else [of]


def _described(x: Any, a: NDArray[Any]) -> str:
    dtype = _array(x, "").dtype
    of = "" if isinstance(x, np.ndarray) else f"a {type(x).__name__}, "
    columns = [name for name, d in zip(_labels(x, "columns"), _dtypes(x)) if getattr(d, "kind", "") == "O"]
    return f"{of}{dtype} of shape {a.shape}" + (f" because of {_listed(columns)}" if dtype == object and columns else "")


def _labels(x: Any, of: str) -> list[str]:
    """The names of columns, or of an index; none if there are none."""
    labels = getattr(x, of, None)
    if labels is None or callable(labels) or not isinstance(labels, Iterable):
        return []
    return [".".join(map(str, label)) if isinstance(label, tuple) else str(label) for label in labels]


def _find(joints: Sequence[str], labels: list[str], what: str) -> list[int]:
    """Where the joints are among labels, which may have a text before or behind all names, and may not have the robot's
    prefix. Labels like q1, q2, .. that name no joint are in their order."""
    ways = {tuple(joints)} if joints and set(joints) <= set(labels) else _affixed(joints, labels)
    if len(ways) > 1:
        raise ValueError(f"{what} has the joints more than once: {', or '.join(_listed(way) for way in sorted(ways))}")
    if not ways:
        if len(labels) == 1 or _are_numbered(labels) and not any(j in label for j in joints for label in labels):
            return list(range(len(labels)))
        is_argument = what.isidentifier()  # and not what an estimator in Python returns
        way_on = f"{what if is_argument else 'its'}{'.' if is_argument else ' '}to_numpy() is taken in its order"
        if not joints:
            names = "joint_names=robot.joint_names says them, if the robot is from a file; " if is_argument else ""
            raise ValueError(f"{what} has names, {_listed(labels)}, and of the joints none are known: {names}{way_on}")
        missing = [j for j in joints if not any(j in label for label in labels)]
        raise ValueError(f"{what} never names {_listed(missing or joints)}; the joints are {_listed(joints)}, "
                         f"and {what} has {_listed(labels)}; {way_on}")
    (called,) = ways
    if twice := [name for name in called if labels.count(name) > 1]:
        raise ValueError(f"{what} has more than one {_listed(twice)}")
    if others := [label for label in labels if label not in called]:
        _warn(f"{what}: names of no joint are left out, {len(others)} of {len(labels)}: {_listed(others)}")
    return [labels.index(name) for name in called]


def _affixed(joints: Sequence[str], labels: list[str]) -> set[tuple[str, ...]]:
    ways = set()
    for cut in [0, *(m.end() for m in re.finditer("[_/.]", joints[0]))] if joints else []:
        if any(j[:cut] != joints[0][:cut] or len(j) == cut for j in joints):
            break
        for label in labels:
            for found in re.finditer(re.escape(joints[0][cut:]), label):
                way = tuple(label[:found.start()] + j[cut:] + label[found.end():] for j in joints)
                if set(way) <= set(labels):
                    ways.add(way)
    return ways


def _are_numbered(labels: list[str]) -> bool:
    """Whether they differ by a number, which grows."""
    parts = [m.groups() for label in labels if (m := re.fullmatch(r"(.*?)(\d+)(\D*)", label))]
    numbers = [int(number) for _, number, _ in parts]
    return len(parts) == len(labels) and len({(a, b) for a, _, b in parts}) == 1 and numbers == sorted(set(numbers))


def _require_same_order(x: Any, t: Any, what: str) -> None:
    """Rows are taken by their places. An index that is sorted in another way says that these are others."""
    ours: Any = getattr(x, "index", None)
    theirs: Any = getattr(t, "index", t)
    if not (hasattr(ours, "sort_values") and hasattr(theirs, "sort_values")) or ours.dtype != theirs.dtype:
        return
    if not ours.equals(theirs) and ours.sort_values().equals(theirs.sort_values()):
        raise ValueError(f"{what} has the rows of t in another order, by its index: {what}.loc[t.index] has that of t")


def _listed(names: Iterable[str]) -> str:
    return textwrap.shorten(", ".join(names), 400, placeholder=" ..")


def _warn(text: str) -> None:
    """In the line of the user."""
    level, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, stacklevel=level)
