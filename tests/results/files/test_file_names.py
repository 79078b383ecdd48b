"""Names of result files."""

import os

import pytest

from flexmb_cli.errors import OutputError
from flexmb_cli.results.files.file_names import (
    ResultPaths,
    h5_name,
    out_name,
    refuse_shared,
    result_paths,
    series_names,
)


@pytest.mark.parametrize(
    ("deck", "dialect", "out", "h5"),
    [
        ("IN4-BAR.PAS", "young", "OUT4-BAR.PAS", "OUT4-BAR.h5"),
        ("IN4-BAR.dat", "young", "OUT4-BAR.dat", "OUT4-BAR.h5"),
        ("IN1", "young", "OUT1", "OUT1.h5"),
        ("IN.dat", "young", "OUT.dat", "OUT.h5"),
        ("in4-bar.dat", "young", "in4-bar.OUT", "in4-bar.h5"),
        ("crank.v2.dat", "young", "crank.v2.OUT", "crank.v2.h5"),
        ("crank", "young", "crank.OUT", "crank.h5"),
        ("INERTIA.DAT", "dafms", "INERTIA.OUT", "INERTIA.h5"),
        ("pendulum.vsdf", "vsdf", "pendulum.OUT", "pendulum.h5"),
        ("-", "young", "flexmb.OUT", "flexmb.h5"),
        (".dat", "young", ".dat.OUT", ".dat.h5"),
    ],
)
def test_results_are_named_after_their_deck(deck, dialect, out, h5):
    assert (out_name(deck, dialect), h5_name(deck, dialect)) == (out, h5)


def test_series_of_dafms_are_named_after_their_units():
    assert series_names("PENDULUM.DAT", "dafms") == ("PENDULUM.T2", "PENDULUM.T3")
    assert series_names("-", "dafms") == ("flexmb.T2", "flexmb.T3")


def test_options_overrule_names():
    assert result_paths("IN1.dat", "young", "out", h5="x.h5") == ResultPaths(
        os.path.join("out", "OUT1.dat"), "x.h5", named=("x.h5",)
    )
    assert result_paths("IN1.dat", "young", no_out=True, no_h5=True).files == ()
    assert result_paths("IN1.dat", "young", out="-").files == ("OUT1.h5",)


def test_only_dafms_decks_have_series():
    assert result_paths("P.DAT", "dafms").files == ("P.OUT", "P.h5", "P.T2", "P.T3")
    assert result_paths("P.DAT", "dafms", no_out=True).series == ()


def pairs(*decks, **options):
    return [(deck, result_paths(os.path.basename(deck), "young", **options)) for deck in decks]


def test_decks_of_different_results_are_accepted():
    assert refuse_shared(pairs("a/IN1.dat", "a/IN2.dat")) is None


@pytest.mark.parametrize("second", ["b/IN1.dat", "a/IN1.dat", "./a/IN1.PAS"])
def test_two_decks_that_would_write_the_same_file_are_refused(second):
    with pytest.raises(OutputError) as caught:
        refuse_shared(pairs("a/IN1.dat", second))
    assert str(caught.value).startswith(f"a/IN1.dat and {second} would both write OUT1.")
    assert caught.value.exit_code == 2


def test_the_same_file_by_two_names_is_seen(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    first = ("x.dat", result_paths("x.dat", "young", str(tmp_path / "real")))
    second = ("y/x.dat", result_paths("x.dat", "young", str(tmp_path / "link")))
    with pytest.raises(OutputError, match="would both write"):
        refuse_shared([first, second])


def test_a_result_never_overwrites_a_deck(tmp_path):
    deck = str(tmp_path / "crank.OUT")
    with pytest.raises(OutputError, match=f"would overwrite the deck {deck}"):
        refuse_shared(pairs(deck, folder=str(tmp_path)))


def test_table_and_hdf5_of_one_deck_must_differ():
    with pytest.raises(OutputError, match=r"a\.dat: two of its results would be the same file \./x"):
        refuse_shared(pairs("a.dat", out="x", h5="./x"))
    with pytest.raises(OutputError, match="two of its results"):
        refuse_shared(pairs("IN1.h5"))


def test_devices_take_any_number_of_results():
    assert refuse_shared(pairs("a.dat", "b.dat", out=os.devnull)) is None


def test_only_one_table_goes_to_standard_output():
    with pytest.raises(OutputError, match=r"a\.dat and b\.dat would both write to standard output"):
        refuse_shared(pairs("a.dat", "b.dat", out="-"))
