"""DAFMS (1992), chapter 4: Table 4.1, the rotating shaft with a beam, the two-link manipulator."""

import matplotlib.pyplot as plt
import numpy as np
from html_page import Section
from runs import run

SAMPLE_RATE_LIMIT = 2.0  # Hz: what counts as slow elastic motion


def pendulum(results, pictures) -> Section:
    """Section 4.2."""
    section = Section("DAFMS: elastic pendulum (4.2)")
    (result,) = run(results, "dafms/pendulum.DAT")
    # Hinge coordinates: the angle and the length; q1 of (4.1) is the length beyond 0.1, over L = 0.4 m.
    time, q = result["time"][:], result["coordinate/q"]
    q2, q1 = q[:, 0], (q[:, 1] - 0.1) / 0.4
    rows = [
        ("largest q1, t > 0", "0.0999", f"{q1[1:].max():.5f}"),
        ("largest |q2|", "0.1986 (Kane and Kahn 0.2002)", f"{np.abs(q2).max():.5f}"),
    ]
    section.table(("quantity", "Table 4.1", "flexmb, 60 s"), rows)
    section.text(
        """The table belongs to w1/w2 = 2, the constants of the program; the text has the ratio upside
        down, and with 0.5 the pendulum hardly swings. The printed 0.1986 depends on the sampling: the
        motion itself reaches 0.1999."""
    )
    figure, axes = plt.subplots(2, 1, figsize=(9, 4), sharex=True, layout="constrained")
    for axis, values, label in zip(axes, (q1, q2), ("q1 = x/L", "q2 = theta, rad"), strict=True):
        axis.plot(time, values, lw=0.6)
        axis.set_ylabel(label)
    axes[1].set_xlabel("time, s")
    section.picture(pictures, "pendulum.png", figure, "Energy wanders between stretch and swing.")
    return section


def shaft(results, pictures) -> Section:
    """Section 4.3."""
    section = Section("DAFMS: rotating shaft with a beam (4.3)")
    coupled, one_way = run(results, "dafms/shaft_beam_n10.DAT", "dafms/shaft_beam_n10_unco.DAT")
    runs = {"coupled": coupled, "one-way": one_way}
    recomputed = {
        "coupled": ("0.015084", "-0.014466", "7.23197"),
        "one-way": ("0.018776", "-0.014413", "7.01051"),
    }
    rows = []
    for name, result in runs.items():
        tip, speed = result["elastic/body 1/displacement"][:, 9, 2], result["coordinate/u"][:, 0]
        row = np.flatnonzero(np.isclose(result["time"][:], 0.05))[0]
        found = (f"{tip.max():.6f}", f"{tip.min():.6f}", f"{speed[row]:.5f}")
        names = ("tip maximum, m", "tip minimum, m", "shaft speed at 0.05 s, rad/s")
        rows += [(name, *line) for line in zip(names, recomputed[name], found, strict=True)]
    section.table(("equations", "quantity", "recomputed from the text", "flexmb"), rows)
    section.text(
        """The thesis prints curves only; the numbers beside flexmb's were computed from its data by
        another program. It says that the shaft stops after the pulse except for a small residue. With
        its one-way equations the shaft comes to exact rest: the residue is the error of integrating
        across the jumps of the torque. With all terms the shaft goes on oscillating by 2.46 rad/s."""
    )
    figure, axes = plt.subplots(2, 1, figsize=(9, 4.5), sharex=True, layout="constrained")
    for name, result in runs.items():
        axes[0].plot(result["time"][:], 1e3 * result["elastic/body 1/displacement"][:, 9, 2], label=name)
        axes[1].plot(result["time"][:], result["coordinate/u"][:, 0], label=name)
    axes[0].set_ylabel("tip deflection, mm")
    axes[1].set_ylabel("shaft speed, rad/s")
    axes[1].set_xlabel("time, s")
    axes[0].legend()
    section.picture(pictures, "shaft.png", figure, "Figures 4.5 and 4.7 anew, with both sets of equations.")
    return section


def manipulator(results, pictures) -> Section:
    """Section 4.4."""
    section = Section("DAFMS: flexible two-link manipulator (4.4)")
    figure, axes = plt.subplots(2, 1, figsize=(9, 4.5), sharex=True, layout="constrained")
    rows = []
    found = run(results, "dafms/two_link_n2.DAT", "dafms/two_link_n2_unco.DAT")
    told = (("coupled", "+0.93"), ("one-way", "-0.43"))
    for axis, result, (name, expected) in zip(axes, found, told, strict=True):
        tips = [result[f"elastic/body {k}/displacement"][:, -1] for k in (1, 2)]
        slow = [_slow(tip[:, np.ptp(tip, axis=0).argmax()], result["time"][:]) for tip in tips]
        rows.append((name, expected, f"{np.corrcoef(*slow)[0, 1]:+.2f}"))
        for k, tip in enumerate(slow, start=1):
            axis.plot(result["time"][:], 1e3 * tip, label=f"link {k}")
        axis.set_ylabel(f"{name}: slow tip motion, mm")
    axes[0].legend()
    axes[1].set_xlabel("time, s")
    section.table(("equations", "correlation of the slow tip motions, recomputed", "flexmb"), rows)
    section.text(
        """The thesis finds the slow elastic motions of the links out of phase, against Usoro, Nadira and
        Mahil (1986), and takes this for better modelling. The full equations give them in phase; out of
        phase they are only in the one-way equations, that is, where the thesis's mass matrix drops the
        coupling."""
    )
    section.picture(pictures, "manipulator.png", figure, "Tips of the links, below 2 Hz.")
    return section


def _slow(values, time):
    """The part of a series below 2 Hz."""
    spectrum = np.fft.rfft(values - values.mean())
    spectrum[np.fft.rfftfreq(len(values), time[1] - time[0]) > SAMPLE_RATE_LIMIT] = 0.0
    return np.fft.irfft(spectrum, len(values))
