"""`flexmb check` of DAFMS decks: what is found at the start, and what is refused."""

import json

import pytest

from flexmb_cli.results.texts.check_text import check_text
from flexmb_cli.run.check.check import check_deck
from flexmb_cli.run.outcome import RunOptions
from tests.dialects.dafms.test_dafms_elements import deck
from tests.run.dafms_runs import DECKS, NAMES, altered


def check(name, **options):
    path = name if not isinstance(name, str) else DECKS / f"{name}.DAT"
    return check_deck(str(path), RunOptions(**options))


@pytest.mark.parametrize("name", NAMES)
def test_every_supplied_deck_can_be_run(name):
    report = check(name)
    assert report.outcome.exit_code == 0
    assert check_text(report).startswith(f"{DECKS / name}.DAT: DAFMS deck")
    assert json.loads(json.dumps(report.as_dict()))["status"] == "complete"


def test_coordinates_are_counted_and_named_in_the_order_of_eq_2_22():
    report = check("spatial_flex")
    assert report.counts["coordinates"] == report.counts["degrees_of_freedom"] == 10
    names = [name for name, *_ in report.tree.coordinates]
    assert names[:5] == [
        "body 1 rotation 1", "body 1 rotation 2", "body 1 rotation 3", "body 2 rotation 1",
        "body 1 node 1 axis 1",
    ]  # fmt: skip


def test_a_planar_four_bar_has_one_degree_of_freedom_and_its_gap_is_closed():
    report = check("fourbar_rigid")
    assert (report.counts["coordinates"], report.counts["degrees_of_freedom"]) == (3, 1)
    ((name, given, assembled),) = report.tree.gaps
    assert name == "closure 1"
    assert 1e-10 < given < 1e-8
    assert assembled < 1e-14


TERMS = (1, 2.0), (2, -1.0)  # body, factor
LOOP = "    3    0    0    0    0    1    1\n       0.0        .5       0.0       0.0       0.0        .6\n"


def test_a_closure_given_twice_is_recognised_and_counts_once(tmp_path):
    path = altered(tmp_path, "fourbar_rigid", (f"LOOP\n    1\n{LOOP}", f"LOOP\n    2\n{LOOP}{LOOP}"))
    report = check(path)
    assert report.counts["closed_directions"] == 4
    assert len(report.tree.redundant) == 2
    assert report.counts["degrees_of_freedom"] == 1


def test_a_coupling_given_twice_is_told_and_counts_once(tmp_path):
    """Two links with one equation between them have one degree of freedom, which `check` gave as 0."""
    terms = [" ".join(f"{body}.r3={factor * k}" for body, factor in TERMS) for k in (1, 2)]
    lines = "\n".join(f"  COUPLING coup-{k} {sums}" for k, sums in enumerate(terms, 1))
    (tmp_path / "a.DAT").write_text(deck(f"ELEMENTS\n{lines}"))
    report = check(tmp_path / "a.DAT")
    assert report.counts["degrees_of_freedom"] == 1
    (fault,) = report.outcome.faults
    assert fault.severity == "warning" and fault.message.startswith(
        "1 of 2 closed directions and couplings repeats others: coup-2;"
    )


def test_a_loop_that_cannot_be_closed_exits_with_1_and_says_how_far_it_is_open(tmp_path):
    far = LOOP.replace(".6\n", "9.\n")
    report = check(altered(tmp_path, "fourbar_rigid", (LOOP, far)))
    assert report.outcome.exit_code == 1
    assert "the loop cannot be closed" in report.outcome.faults[-1].message
    assert report.outcome.norms["gap"] > 1.0


def test_the_lowest_frequency_of_the_beam_is_that_of_its_deck():
    """112.0883 rad/s for the shaft's beam with ten nodes, recomputed from its condensed stiffness."""
    ((body, nodes, count, lowest, _),) = check("shaft_beam_n10").tree.elastic
    assert (body, nodes, count) == ("body 1", 10, 10)
    assert lowest * 2 * 3.141592653589793 == pytest.approx(112.0883, abs=6e-5)


def test_energies_at_the_start_of_the_pendulum():
    """19.6 N/m stretched by 0.14 m; 0.2 kg at 0.44 m and 0.01 rad from the vertical under 9.8 m/s²."""
    energies = check("pendulum").tree.energies
    assert energies["strain"] == pytest.approx(0.5 * 19.6 * 0.14**2, rel=1e-12)
    assert energies["potential"] == pytest.approx(-0.2 * 9.8 * 0.44 * (1 - 0.01**2 / 2), rel=1e-9)
    assert energies["kinetic"] == 0.0


def test_a_jacobian_of_a_tree_is_refused():
    report = check_deck(str(DECKS / "pendulum.DAT"), RunOptions(), "estimate")
    assert report.outcome.exit_code == 2
    assert "a tree has relative coordinates" in report.outcome.faults[-1].message


def test_what_the_run_refuses_the_check_refuses_too(tmp_path):
    report = check(altered(tmp_path, "fourbar_flex", ("END ", "UNCO\nEND ")))
    assert report.outcome.exit_code == 2
    assert "closed loops need the coupled equations" in report.outcome.faults[-1].message


def test_strict_makes_a_warning_of_the_model_an_error(tmp_path):
    deck = altered(
        tmp_path, "spatial_rigid", ("END ", "DESN\n    1    2       .01       .05\n    2    0\nEND ")
    )
    assert check(deck).outcome.exit_code == 0
    assert check(deck, strict=True).outcome.exit_code == 2
