"""Force laws of elements against their definitions, and their slopes and energies against differences."""

import numpy as np
import pytest

from flexmb_cli.kernels._jit import interpreting
from flexmb_cli.kernels.laws import (
    ANSWER_COLUMNS,
    COORDINATE,
    DAMPING,
    EFFORT,
    ENERGY,
    POWER,
    SPEED,
    STIFFNESS,
    answer_law,
    friction_share,
)
from flexmb_cli.model.arrays.function_table import FunctionTable, fill_law
from flexmb_cli.model.arrays.records import LAW
from flexmb_cli.model.laws import (
    CABLE,
    FRICTION,
    FUNCTIONS,
    LAWS,
    OF_RATE,
    OF_TIME,
    SPRING,
    STOP,
    At,
    Element,
    Joint,
    Line,
)
from flexmb_cli.model.time_functions import POLYNOMIAL, MotionFunction
from tests.naive.element_efforts import cable_effort, friction_per_speed, spring_effort, stop_effort

H = 1e-5
CURVE, DAMPER = (MotionFunction(POLYNOMIAL, c) for c in ((0.5, 2.0, 3.0, 0.4), (0.1, 1.5, 0.0, 0.3)))
CASES = {
    "spring": (Element("", SPRING, At(0, ""), (20.0, 0.3, 1.5, 2.0, None, None)), spring_effort),
    "curves": (Element("", SPRING, At(0, ""), (20.0, 0.3, 1.5, 2.0, CURVE, DAMPER)), spring_effort),
    "cable": (Element("", CABLE, Line(0, 0, (), ()), (80.0, 0.2, 0.3)), cable_effort),
    "stop": (Element("", STOP, At(0, ""), (-0.1, 0.25, 90.0, 0.4)), stop_effort),
}
# One of each law in a coordinate or a line; a damper of odd powers takes energy at all rates.
ODD = MotionFunction(POLYNOMIAL, (0.0, 1.5, 0.0, 0.3))
IN_ONE_COORDINATE = [
    Element(
        law.word,
        law,
        law.measures[0](*(0,) * len(law.measures[0]._fields)),
        tuple(
            {OF_RATE: ODD}.get(p.kind, CURVE if p.kind in FUNCTIONS else 0.2 + 0.3 * k)
            for k, p in enumerate(law.parameters)
        ),
    )
    for law in LAWS
    if {At, Line} & set(law.measures)
]
STATES = [(x, v) for x in (-0.7, 0.1, 0.9) for v in (-3.0, 0.2, 2.0)]


def answered(item, x, v):
    """What a law answers at a coordinate and its rate, kernels interpreted."""
    table, record, answer = FunctionTable(), np.zeros(1, LAW)[0], np.zeros(ANSWER_COLUMNS)
    fill_law(record, item.law, item.values, table)
    answer[COORDINATE], answer[SPEED] = x, v
    with interpreting():
        answer_law(record, *table.function_arrays().values(), 0.0, True, answer)
    return answer


@pytest.mark.parametrize(("item", "defined"), CASES.values(), ids=CASES)
def test_a_law_answers_what_defines_it(item, defined):
    for x, v in STATES:
        answer, wanted = answered(item, x, v), defined(item, x, v)
        assert answer[EFFORT] == pytest.approx(wanted.effort, rel=1e-13)
        assert answer[POWER] == pytest.approx((wanted.effort - wanted.kept) * v, rel=1e-12, abs=1e-12)
        assert answer[ENERGY] == pytest.approx(wanted.energy, rel=1e-13)


@pytest.mark.parametrize(
    "item",
    [*(item for item, _ in CASES.values()), *IN_ONE_COORDINATE],
    ids=[*CASES, *(item.name for item in IN_ONE_COORDINATE)],
)
def test_slopes_of_a_law_are_those_of_its_effort_and_its_energy_has_the_part_without_power(item):
    for x, v in STATES:
        answer = answered(item, x, v)
        by_x, by_v = (
            (answered(item, x + H * a, v + H * b) - answered(item, x - H * a, v - H * b)) / (2 * H)
            for a, b in ((1, 0), (0, 1))
        )
        assert answer[STIFFNESS] == pytest.approx(-by_x[EFFORT], rel=1e-7, abs=1e-7)
        assert answer[DAMPING] == pytest.approx(-by_v[EFFORT], rel=1e-7, abs=1e-7)
        assert -by_x[ENERGY] * v == pytest.approx(answer[EFFORT] * v - answer[POWER], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("item", IN_ONE_COORDINATE, ids=lambda item: item.name)
def test_a_law_of_positive_numbers_takes_energy_unless_time_drives_it(item):
    powers = [answered(item, x, v)[POWER] for x, v in STATES]
    driven = any(p.kind == OF_TIME for p in item.law.parameters)
    assert max(powers) > 0.0 if driven else max(powers) <= 0.0


@pytest.mark.parametrize("code", [0, -1, 1 + max(law.code for law in LAWS)])
def test_a_code_without_a_law_answers_no_number(code):
    unknown = SPRING._replace(code=code)
    answer = answered(Element("", unknown, At(0, ""), SPRING.values(stiffness=2.0)), 0.3, 1.0)
    assert np.isnan(answer[[EFFORT, POWER]]).all()


def test_friction_slides_with_its_coefficient():
    item = Element("", FRICTION, Joint(0), (0.2, 0.35, 0.4, 0.05, 0.0, 0.0, 0.0, 0.0))
    record = np.zeros(1, LAW)[0]
    fill_law(record, item.law, item.values)
    with interpreting():
        for v in (0.0, 1e-9, 0.03, 0.5, 4.0):
            share, slope = friction_share(record, v)
            assert share == pytest.approx(friction_per_speed(item, v), rel=1e-12)
            ahead = (v + H) * friction_per_speed(item, v + H)
            behind = (v - H) * friction_per_speed(item, abs(v - H))
            assert slope == pytest.approx((ahead - behind) / (2 * H), rel=1e-5, abs=1e-8)
