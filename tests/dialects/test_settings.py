"""`--set NAME=VALUE` on a YOUNG deck."""

import pytest

from flexmb_cli.dialects.settings import apply_settings
from flexmb_cli.errors import DeckError
from tests.dialects.young.young_decks import PENDULUM, read


def refused(*settings):
    with pytest.raises(DeckError) as error:
        apply_settings(read(PENDULUM), list(settings))
    return [fault.message for fault in error.value.faults]


def test_a_number_set_has_its_value_and_spelling_and_no_place_and_the_others_stay():
    before = read(PENDULUM)
    after = apply_settings(before, ["driver.1.B = 1D0", "driver.1.body=1"])
    (driver,) = after.section("driver")
    assert (driver["B"], driver.at("B").text, driver.at("B").place) == (1.0, "1D0", None)
    assert (driver["body"], driver["C"]) == (1, 0.0)
    assert before.section("driver")[0]["B"] == 1.047
    assert after.section("revolute") == before.section("revolute")


def test_the_last_of_two_settings_wins():
    assert apply_settings(read(PENDULUM), ["time.end=2", "time.end=3"]).one("time")["end"] == 3.0


def test_setting_a_direction_changes_the_units_behind_it():
    (driver,) = apply_settings(read(PENDULUM), ["driver.1.direction=1"]).section("driver")
    assert [number.unit for number in driver.numbers] == ["", "", "m", "m/s", "m/s^2"]


def test_an_unknown_name_is_refused_with_the_nearest():
    (message,) = refused("driver.1.b=2")
    assert message == (
        "--set driver.1.b=2: the deck has no number 'driver.1.b'; "
        "near it is driver.1.B; flexmb check --echo shows all"
    )


def test_a_number_called_by_a_word_of_its_meaning_comes_first():
    """B is the "angular velocity at t = 0" of a driver; the nearest by letters was driver.1.direction."""
    (message,) = refused("driver.1.velocity=2")
    assert "; near it is driver.1.B; driver.1 holds " in message


def test_a_count_cannot_be_set():
    assert refused("counts.NBODY=3") == [
        "--set counts.NBODY=3: a count cannot be set: the deck's layout depends on it"
    ]


def test_an_integer_must_be_set_to_an_integer():
    assert refused("driver.1.direction=4.5") == [
        "--set driver.1.direction=4.5: driver.1.direction must be an integer; read '4.5'"
    ]


def test_all_faulty_settings_are_named_at_once():
    assert refused("time.end=1,5", "time.end") == [
        "--set time.end=1,5: time.end must be a number; read '1,5': decimal comma? write a point",
        "--set time.end: write NAME=VALUE, such as time.end=2.5",
    ]


def test_a_setting_of_a_megabyte_is_shown_cut(tmp_path):
    """The message held all of it."""
    from click.testing import CliRunner

    from flexmb_cli.cli.check import check
    from tests.dialects.vsdf.vsdf_decks import RIGID

    (tmp_path / "pendulum.vsdf").write_text(RIGID)
    done = CliRunner().invoke(check, [str(tmp_path / "pendulum.vsdf"), "--set", f"gravity.x={'1' * 10**6}"])
    said = done.output + str(done.exception)
    assert "--set" in said and len(said) < 1000
