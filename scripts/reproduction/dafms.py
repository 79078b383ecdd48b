"""DAFMS (1992), chapter 4: Table 4.1, the rotating shaft with a beam, the two-link manipulator."""

import matplotlib.pyplot as plt
import numpy as np
from html_page import WIDTH, Section
from runs import run

SAMPLE_RATE_LIMIT = 2.0  # Hz: what counts as slow elastic motion
INERTIA = 0.00713213  # kg m²: shaft and undeformed beam, rho ((a + L)³ - a³) / 2


# Section 4.4, 0 to 5 s, two nodes a link: recomputed by another program, coupled and one-way.
RANGES = (
    ("-0.04766 … 0.04817", "-0.08721 … 0.08727", "-1.32e-4 … 1.34e-4", "-1.67e-4 … 1.83e-4"),
    ("-0.04940 … 0.04821", "-0.08652 … 0.08727", "-2.38e-4 … 2.36e-4", "-5.39e-4 … 5.31e-4"),
)


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
    figure, axes = plt.subplots(2, 1, figsize=(WIDTH, 4), sharex=True, layout="constrained")
    for axis, values, label in zip(axes, (q1, q2), ("q1 = x/L", "q2 = theta, rad"), strict=True):
        axis.plot(time, values, lw=0.6)
        axis.set_ylabel(label)
    axes[1].set_xlabel("time, s")
    section.picture(
        pictures, "pendulum.png", figure, "Figure 4.2 anew: energy wanders between stretch and swing."
    )
    return section


def shaft(results, pictures) -> Section:
    """Section 4.3."""
    section = Section("DAFMS: rotating shaft with a beam (4.3)")
    coupled, one_way = run(results, "dafms/shaft_beam_n10.DAT", "dafms/shaft_beam_n10_unco.DAT")
    runs = {"coupled": coupled, "one-way": one_way}
    recomputed = {
        "coupled": ("0.015084", "-0.014466", "7.23197", "0.706994"),
        "one-way": ("0.018776", "-0.014413", "7.01051", "0.700987"),
    }
    rows = []
    for name, result in runs.items():
        tip, speed = result["elastic/body 1/displacement"][:, 9, 2], result["coordinate/u"][:, 0]
        row = np.flatnonzero(np.isclose(result["time"][:], 0.05))[0]
        angle = result["coordinate/q"][-1, 0]
        found = (f"{tip.max():.6f}", f"{tip.min():.6f}", f"{speed[row]:.5f}", f"{angle:.6f}")
        names = ("tip maximum, m", "tip minimum, m", "shaft speed at 0.05 s, rad/s", "angle at 0.5 s, rad")
        rows += [(name, *line) for line in zip(names, recomputed[name], found, strict=True)]
    section.table(("equations", "quantity", "recomputed from the text", "flexmb"), rows)
    section.text(
        """The thesis prints curves only; the numbers beside flexmb's were computed from its data by
        another program. It says that the shaft stops after the pulse except for a small residue. With
        its one-way equations the shaft comes to exact rest: the residue is the error of integrating
        across the jumps of the torque. With all terms the shaft goes on oscillating by 2.46 rad/s."""
    )
    section.picture(
        pictures, "shaft.png", _shaft_curves(runs), "Figures 4.4 to 4.7 anew, with both equations."
    )
    return section


def _shaft_curves(runs):
    figure, axes = plt.subplots(2, 2, figsize=(WIDTH, 4.8), sharex=True, layout="constrained")
    rate = runs["one-way"]["coordinate/u_rate"][:, 0]
    axes[0, 0].plot(runs["one-way"]["time"][:], INERTIA * rate, color="tab:orange")
    axes[0, 0].set_title("4.4: torque, N m (one-way:\ninertia times acceleration)", fontsize=9)
    panels = (
        (axes[0, 1], "4.5: tip deflection, mm", "elastic/body 1/displacement", (9, 2), 1e3),
        (axes[1, 0], "4.6: shaft angle, rad", "coordinate/q", (0,), 1.0),
        (axes[1, 1], "4.7: shaft speed, rad/s", "coordinate/u", (0,), 1.0),
    )
    for axis, title, path, place, unit in panels:
        for name, result in runs.items():
            axis.plot(result["time"][:], unit * result[path][(slice(None), *place)], label=name, lw=1)
        axis.set_title(title, fontsize=9)
    axes[0, 1].legend()
    for axis in axes[1]:
        axis.set_xlabel("time, s")
    return figure


def manipulator(results, pictures) -> Section:
    """Section 4.4."""
    section = Section("DAFMS: flexible two-link manipulator (4.4)")
    figure, axes = plt.subplots(2, 1, figsize=(WIDTH, 4.5), sharex=True, layout="constrained")
    rows = []
    found = run(results, "dafms/two_link_n2.DAT", "dafms/two_link_n2_unco.DAT")
    reported = (("coupled", "+0.93"), ("one-way", "-0.43"))
    for axis, result, (name, expected) in zip(axes, found, reported, strict=True):
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
        coupling. Its figure 4.9 prints no numbers: flexmb is compared with a recomputation of its data."""
    )
    section.picture(pictures, "manipulator.png", figure, "Tips of the links, below 2 Hz.")
    section.table(
        ("quantity", "recomputed, coupled", "flexmb", "recomputed, one-way", "flexmb"), _ranges(found)
    )
    section.picture(
        pictures,
        "figure_4_9.png",
        _figure_4_9(*found),
        "Figure 4.9 anew: angles, mid-span and tip deflections.",
    )
    return section


def _curves(result):
    """Angles (rad), then mid-span and tip deflections of both links (m), across the links."""
    elastic = [result[f"elastic/body {k}/displacement"][:, node, 2] for k in (1, 2) for node in (0, 1)]
    return [*result["coordinate/q"][:, :2].T, *elastic]


def _ranges(found):
    """Largest and smallest values over 5 s beside those recomputed from the thesis's text."""
    names = ("angle 1, rad", "angle 2, rad", "tip 1, m", "tip 2, m")
    rows = []
    for name, k, *expected in zip(names, (0, 1, 3, 5), *RANGES, strict=True):
        row = [name]
        for result, words in zip(found, expected, strict=True):
            curve, digits = _curves(result)[k], ".5f" if k < 2 else ".2e"
            row += [words, f"{curve.min():{digits}} … {curve.max():{digits}}"]
        rows.append(row)
    return rows


def _figure_4_9(coupled, one_way):
    figure, axes = plt.subplots(3, 2, figsize=(WIDTH, 6.6), sharex=True, layout="constrained")
    titles = ("angle", "mid-span deflection", "tip deflection")
    for result, name in ((coupled, "coupled"), (one_way, "one-way, as in the thesis")):
        curves = _curves(result)
        for link in (0, 1):
            panels = (curves[link], 1e3 * curves[2 + 2 * link], 1e3 * curves[3 + 2 * link])
            for row, (values, title) in enumerate(zip(panels, titles, strict=True)):
                axis = axes[row, link]
                axis.plot(result["time"][:], values, lw=0.8, label=name)
                axis.set_title(f"link {link + 1}: {title}, {'mm' if row else 'rad'}", fontsize=9)
    axes[0, 1].legend(fontsize=8)
    for axis in axes[-1]:
        axis.set_xlabel("time, s")
    return figure


def _slow(values, time):
    """The part of a series below 2 Hz."""
    spectrum = np.fft.rfft(values - values.mean())
    spectrum[np.fft.rfftfreq(len(values), time[1] - time[0]) > SAMPLE_RATE_LIMIT] = 0.0
    return np.fft.irfft(spectrum, len(values))
