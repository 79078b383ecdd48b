"""`flexmb beam`: finite-element blocks, whole decks, and beams put into decks."""

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from tests.run.dafms_runs import DECKS, run


def beam(*arguments):
    return CliRunner().invoke(cli, ["beam", *map(str, arguments)])


SHAFT = ("--length", 0.5, "--ei", 5.5, "--rho", 0.0858, "--offset", 0.05)
LINK = ("--length", 1, "--ei", 1000, "--rho", 5)


@pytest.mark.parametrize(
    ("deck", "nodes", "arguments"),
    [
        ("two_link_n2", 2, LINK),
        ("two_link_n4", 4, LINK),
        ("shaft_beam_n2", 2, SHAFT),
        ("shaft_beam_n5", 5, SHAFT),
        ("shaft_beam_n10", 10, SHAFT),
    ],
)
def test_the_blocks_of_the_supplied_decks_are_written_to_the_character(deck, nodes, arguments):
    """Thesis (Zhao, 1992), sections 4.3, 4.4: 5.5 N m², 0.0858 kg/m, 0.5 m; 1000 N m², 5 kg/m, 1 m."""
    done = beam("--nodes", nodes, *arguments)
    assert done.exit_code == 0
    assert done.stdout in (DECKS / f"{deck}.DAT").read_text()
    assert len(done.stdout.splitlines()) > 2 * nodes


def test_its_share_of_mass_and_inertia_is_said_on_standard_error():
    """Links of 5 kg; sum m x² = 1.875 kg m² and rho h³/24 of the root's half element, h = 0.5 m."""
    done = beam("--nodes", 2, *LINK)
    assert f"MASS 5 kg, of INER {1.875 + 5 * 0.5**3 / 24:.9g} kg m^2" in done.stderr


def test_a_whole_deck_runs(tmp_path):
    deck = tmp_path / "arm.DAT"
    deck.write_text(beam("--nodes", 3, *LINK, "--deck", "--title", "ARM").stdout)
    assert run(deck, tmp_path).exit_code == 0
    assert (tmp_path / "arm.OUT").read_text().splitlines()[1].rstrip() == "DFMB ARM"


def test_a_beam_put_where_it_was_leaves_the_deck_as_it_is():
    done = beam("--nodes", 2, *LINK, "--into", DECKS / "two_link_n2.DAT", "--body", 1)
    assert done.stdout.splitlines()[10:19] == (DECKS / "two_link_n2.DAT").read_text().splitlines()[10:19]


def test_a_finer_beam_in_one_body_runs(tmp_path):
    deck = tmp_path / "finer.DAT"
    deck.write_text(beam("--nodes", 3, *LINK, "--into", DECKS / "two_link_n2.DAT", "--body", 2).stdout)
    assert run(deck, tmp_path, changes=("time.IT=5",)).exit_code == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--into", "x.DAT"), "--into DECK and --body K go together"),
        (("--deck", "--into", "x.DAT", "--body", 1), "--deck and --into exclude each other"),
        (("--into", "none.DAT", "--body", 1), "none.DAT: error: no such file"),
        (("--into", DECKS / "pendulum.DAT", "--body", 2), "body 2: the deck has bodies 1 to 1"),
    ],
)
def test_what_makes_no_sense_is_refused_with_exit_2(arguments, message):
    done = beam("--nodes", 2, *LINK, *arguments)
    assert done.exit_code == 2
    assert message in done.stderr
