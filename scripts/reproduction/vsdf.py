"""VSDFlex (2008): the pendulum of bricks, its frequencies and its fall."""

import matplotlib.pyplot as plt
import numpy as np
from html_page import WIDTH, Section
from runs import run

# Frequencies and motion of node 51 as recomputed from the paper's description by other programs:
# eigenvalues of the supplied matrices, and a nonlinear (St. Venant-Kirchhoff) solution on the same mesh.
FREQUENCIES = (5.264, 7.412, 24.93, 34.54, 39.86, 47.64, 60.25, 97.73, 124.32)  # Hz
NONLINEAR = {0.05: (-0.01772, -0.6896), 0.1: (-0.06560, -1.0613), 0.2: (-0.06667, 1.2686),
             0.3: (0.02708, 0.2764), 0.4: (-0.01657, -1.1694), 0.5: (-0.09822, 0.3937)}  # fmt: skip


def pendulum(results, pictures) -> Section:
    """The paper's example."""
    section = Section("VSDFlex: flexible pendulum of 16 bricks")
    (result,) = run(results, "vsdf/pendulum.vsdf")
    found = result["modal/body 1/frequency"][:]
    section.text("The paper keeps nine modes and gives their range as 5 to 124 Hz.")
    rows = [(k, f, f"{g:.3f}") for k, (f, g) in enumerate(zip(FREQUENCIES, found, strict=True), start=1)]
    section.table(("mode", "recomputed, Hz", "flexmb, Hz"), rows)
    time, z, vz = (result[name][:] for name in ("time", "point/position", "point/velocity"))
    z, vz = z[:, 0, 2], vz[:, 0, 2]
    rows = []
    for moment, (z_ref, v_ref) in NONLINEAR.items():
        k = np.abs(time - moment).argmin()
        rows.append((moment, z_ref, f"{z[k]:.5f}", v_ref, f"{vz[k]:.4f}"))
    section.table(("t, s", "z nonlinear, m", "z flexmb", "vz nonlinear, m/s", "vz flexmb"), rows)
    section.text(
        """Nine linear modes against a nonlinear solution on the same mesh. In print, (57) and (76), (77)
        have wrong signs: with the printed ones energy and angular momentum are not conserved. The moment of
        inertia, 3.3e-3, is that of 1 kg (0.26 kg have 8.7e-4 kg m² about the end), the step of "5e-5 ms" is
        5e-5 s. The nonlinear motion is recomputed on the same mesh (St. Venant-Kirchhoff);
        the curves of the paper are not printed as numbers."""
    )
    gaps = [max(abs(row[1 + 2 * k] - float(row[2 + 2 * k])) for row in rows) for k in (0, 1)]
    section.table(
        ("divergence of nine modes from the nonlinear motion", "the paper (ANSYS)", "flexmb, six instants"),
        (("height, m", "4e-4", f"{gaps[0]:.1e}"), ("velocity, m/s", "4e-2", f"{gaps[1]:.1e}")),
    )
    section.picture(pictures, "pendulum_fe.png", _curves(time, z, vz), "Figures 3 and 4 anew.")
    return section


def _curves(time, z, vz):
    figure, axes = plt.subplots(2, 1, figsize=(WIDTH, 4.8), sharex=True, layout="constrained")
    labels = ("3: height of node 51, m", "4: its velocity along z, m/s")
    for k, (axis, values, label) in enumerate(zip(axes, (z, vz), labels, strict=True)):
        axis.plot(time, values, label="flexmb, nine modes")
        axis.plot(
            list(NONLINEAR), [pair[k] for pair in NONLINEAR.values()], "o", mfc="none", label="nonlinear"
        )
        axis.set_ylabel(label)
    axes[1].set_xlabel("time, s")
    axes[0].legend()
    return figure
