#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A learned estimator: a small network says what torque a motion takes, and what is measured beyond that is tau_ext.

learned.py train FOLDER MODEL.npz      from runs of tauext-record --set training
learned.py estimate MODEL.npz RUN.npz ESTIMATES.npz

All signals go through one filter of the second order, so that they stay in step; the estimate is late by it.
"""
import glob
import sys

import numpy as np

BANDWIDTH = 60.0  # [rad/s] of the filter
HIDDEN = 48
STEPS = 4000
RIDGE = 1e-5


def low_pass(x, h):
    """Of x (samples, n), h [s] apart: the signal behind two poles at BANDWIDTH, and its derivative."""
    y, v = x[0].copy(), np.zeros_like(x[0])
    out, rate = np.empty_like(x), np.empty_like(x)
    for k, u in enumerate(x):
        v = v + h * (BANDWIDTH**2 * (u - y) - 2 * BANDWIDTH * v)
        y = y + h * v
        out[k], rate[k] = y, v
    return out, rate


def features(run):
    """Of a run: what the torque of a motion depends on (samples, features), and that torque (samples, n) [N m], filtered."""
    h = np.median(np.diff(run["t"]))
    torque = run["tau"] if "tau" in run else run["tau_instant"]
    q, _ = low_pass(run["q"], h)
    qd, qdd = low_pass(run["qd"], h)
    tau, _ = low_pass(torque, h)
    n = q.shape[1]
    squares = np.stack([qd[:, i] * qd[:, j] for i in range(n) for j in range(i, n)], axis=1)
    turned = np.concatenate([np.sin(q), np.cos(q)], axis=1)
    mixed = np.concatenate([qdd * np.cos(q[:, i : i + 1] - q[:, j : j + 1]) for i in range(n) for j in range(i)], axis=1)
    return np.concatenate([turned, qd, squares, qdd, mixed], axis=1), tau


def network(w, x):
    """Of x (samples, features): the hidden layer, and torques (samples, n), all scaled."""
    hidden = np.tanh(x @ w["a"] + w["b"])
    return hidden, hidden @ w["c"] + x @ w["d"] + w["e"]


def train(folder, path):
    x, y = [], []
    for name in sorted(glob.glob(folder + "/*.npz")):
        run = np.load(name)
        all_x, tau = features(run)
        h = np.median(np.diff(run["t"]))
        all_y = tau - low_pass(run["tau_ext"], h)[0]  # a training set knows who pushes
        settled = int(0.5 / h)
        x.append(all_x[settled::3]), y.append(all_y[settled::3])
    x, y = np.concatenate(x), np.concatenate(y)
    s = {"x0": x.mean(0), "x1": x.std(0) + 1e-9, "y0": y.mean(0), "y1": y.std(0) + 1e-9}
    x, y = (x - s["x0"]) / s["x1"], (y - s["y0"]) / s["y1"]
    random = np.random.default_rng(1)
    n, m = x.shape[1], y.shape[1]
    w = {"a": random.normal(size=(n, HIDDEN)) / n**0.5, "b": np.zeros(HIDDEN), "c": np.zeros((HIDDEN, m)), "e": np.zeros(m)}
    # the linear part at once, without large numbers that cancel; the network learns what is left
    w["d"] = np.linalg.solve(x.T @ x + RIDGE * len(x) * np.eye(n), x.T @ y)
    first, second = ({k: np.zeros_like(v) for k, v in w.items()} for _ in range(2))
    for step in range(1, STEPS + 1):  # Adam
        pick = random.integers(len(x), size=512)
        hidden, out = network(w, x[pick])
        off = (out - y[pick]) / len(pick)
        back = (off @ w["c"].T) * (1 - hidden**2)
        slope = {"a": x[pick].T @ back, "b": back.sum(0), "c": hidden.T @ off, "d": x[pick].T @ off, "e": off.sum(0)}
        for k, g in slope.items():
            first[k] = 0.9 * first[k] + 0.1 * g
            second[k] = 0.999 * second[k] + 0.001 * g**2
            rate = 3e-3 * (1 - step / STEPS)
            w[k] = w[k] - rate * (first[k] / (1 - 0.9**step)) / (np.sqrt(second[k] / (1 - 0.999**step)) + 1e-9)
    left = (network(w, x)[1] - y) * s["y1"]
    print("left over in training [N m rms]:", np.sqrt((left**2).mean(0)).round(2))
    np.savez(path, **w, **s)


def estimate(model, path, out):
    w, run = np.load(model), np.load(path)
    x, tau = features(run)
    expected = network(w, (x - w["x0"]) / w["x1"])[1] * w["y1"] + w["y0"]
    np.savez(out, t=run["t"], tau_ext=tau - expected)


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "train":
        train(*sys.argv[2:])
    elif len(sys.argv) == 5 and sys.argv[1] == "estimate":
        estimate(*sys.argv[2:])
    else:
        sys.exit(__doc__)
