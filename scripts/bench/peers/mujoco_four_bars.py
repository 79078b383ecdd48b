"""The chain of N four-bars of `four_bars` in MuJoCo: cranks and couplers on hinges, soft connections."""

import numpy as np


def four_bars(count):
    """MuJoCo's model and data of `count` four-bars at the start: cranks upright, 1 m/s at the first pin."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.gravity = [0.0, -9.81, 0.0]
    spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4

    def bar(parent, name, place, along):
        body = parent.add_body(name=name, pos=place, mass=1.0, ipos=0.5 * np.array(along))
        body.inertia = np.full(3, 1.0 / 12.0)
        body.explicitinertial = True
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        return body

    for k in range(count + 1):
        crank = bar(spec.worldbody, f"crank {k}", [k, 0, 0], [0, 1, 0])
        if k < count:
            bar(crank, f"coupler {k}", [0, 1, 0], [1, 0, 0])
    for k in range(count):
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=f"coupler {k}",
            name2=f"crank {k + 1}",
            data=[1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0],
        )
    model = spec.compile()
    data = mujoco.MjData(model)
    for k in range(count + 1):
        data.joint(f"crank {k}").qvel = -1.0
        if k < count:
            data.joint(f"coupler {k}").qvel = 1.0
    return model, data


def turn_of_first_crank(count, step, end):
    """Angle of the first crank at the end, rad from upright."""
    import mujoco

    model, data = four_bars(count)
    model.opt.timestep = step
    # The stiffest connection that steps of this length bear.
    model.eq_solref[:] = [2.0 * step, 1.0]
    mujoco.mj_step(model, data, round(end / step))
    return float(data.qpos[0])
