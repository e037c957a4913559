# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# A first estimator: the momentum observer of first order in ten lines, beside the known ones.

# %%
import numpy as np

import tauext

arm = tauext.Robot("wallmobot3")
run = arm.record("step", degrade={"velocity_noise": 1e-3})
print(run)


# %%
class FirstOrder:
    """r follows n - dp/dt with 30 rad/s: p = B qd, n = tau + C^T qd - g - F."""

    def __init__(self, arm):
        self.arm, self.last = arm, None

    def update(self, t, q, qd, tau):
        terms = self.arm.terms(q, qd)
        p, n = terms.B @ qd, tau + terms.momentum_bias - terms.friction
        if self.last is None:
            self.r = np.zeros(len(q))
        else:
            t0, p0, n0 = self.last
            h = t - t0
            self.r += (1 - np.exp(-30 * h)) * (n0 - (p - p0) / h - self.r)
        self.last = t, p, n
        return self.r


mine = tauext.estimator(FirstOrder)
estimates = arm.estimate(mine, run)
scores = arm.score(run, estimates, scenario="step")
for metric in tauext.metrics():  # of this noisy run; nan: it never came to that
    if metric["key"] in ("rmse_Nm", "settling_s", "overshoot_percent"):
        print(f"{metric['key']:18} {scores[metric['key']]:8.3f}   {metric['meaning']}")

# %% [markdown]
# Beside the known ones, through all scenarios with a step, whose sensors are ideal.

# %%
for row in arm.suite([mine, "mo1", "mo2", "ekf"], filter="/step/"):
    estimator = row["name"].split("/")[2]
    print(f"{estimator:18} rmse {row['metrics']['rmse_Nm']:6.3f} N m   noise {row['metrics']['noise_Nm']:6.3f} N m")

# %% [markdown]
# And does it see a collision?

# %%
contact = arm.record("contact")
seen = arm.estimate(mine, contact)
marks = arm.detect("pan_tompkins", contact, seen)
first = contact.t[np.argmax(contact.contact)]
print(f"touched at {first:.3f} s, marked at", *(f"{t:.3f} s" for t in contact.t[marks.mark][:1]))

# %%
try:  # python3-matplotlib, if it is there
    import matplotlib.pyplot as plt
except ImportError:
    pass
else:
    plt.plot(run.t, run.tau_ext[:, 0], "k", label="truth")
    plt.plot(run.t, estimates.tau_ext[:, 0], label="mine")
    plt.xlabel("t [s]"), plt.ylabel("tau_ext of joint 1 [N m]"), plt.legend()
    plt.savefig("step.png")
