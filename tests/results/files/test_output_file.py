"""Commands that read results never write over what they read, and only where a file can be."""

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from tests.results.figures.turning_bar import write_bar

COMMANDS = [["plot", "-o", "{}.png"], ["report", "-o", "{}.html"], ["export", "--to", "csv", "-o", "{}.csv"]]
COMMANDS += [["export", "--to", "vtkhdf", "-o", "{}.vtkhdf"], ["export", "--to", "mat", "-o", "{}.mat"]]


@pytest.fixture
def bar(tmp_path, monkeypatch, deck, mechanism, rows):
    pytest.importorskip("matplotlib"), pytest.importorskip("plotly")
    monkeypatch.chdir(tmp_path)
    return write_bar(tmp_path / "r.h5", deck, mechanism, rows, range(7))


def commanded(arguments, stem, result):
    word, *options = [argument.format(stem) for argument in arguments]
    return CliRunner().invoke(cli, [word, str(result), *options])


@pytest.mark.parametrize("arguments", COMMANDS, ids=lambda a: " ".join(a))
@pytest.mark.parametrize("by_link", [False, True])
def test_the_result_that_is_read_is_not_written_over(arguments, by_link, bar):
    output = arguments[-1].format("same")
    os.rename(bar, output)
    if by_link:
        os.symlink(output, "link.h5")
    before = Path(output).read_bytes()
    done = commanded(arguments, "same", "link.h5" if by_link else output)
    assert done.exit_code == 2
    assert f"-o {output} would overwrite" in done.stderr
    assert Path(output).read_bytes() == before


def test_a_picture_does_not_overwrite_what_is_laid_over_it(bar):
    os.link(bar, "other.png")
    os.rename("other.png", "o.png")
    done = CliRunner().invoke(cli, ["plot", str(bar), "--with", "o.png", "-o", "o.png"])
    assert done.exit_code == 2
    assert "-o o.png would overwrite" in done.stderr


@pytest.mark.parametrize("arguments", COMMANDS, ids=lambda a: " ".join(a))
def test_the_name_of_a_folder_is_no_name_of_a_file(arguments, bar):
    done = commanded([*arguments[:-1], f"{arguments[-1]}/"], "new", bar)
    assert done.exception.exit_code == 2
    assert "it is a folder" in str(done.exception)
    assert os.listdir() == ["r.h5"]


def test_a_page_goes_to_standard_output_as_to_a_file(bar):
    commanded(["report", "-q", "-o", "{}.html"], "page", bar)
    done = CliRunner().invoke(cli, ["report", str(bar), "-o", "-"])
    assert done.stdout_bytes == Path("page.html").read_bytes()
    assert "r.h5 → standard output, " in done.stderr


def test_a_picture_cannot_go_to_standard_output(bar):
    done = CliRunner().invoke(cli, ["plot", str(bar), "-o", "-"])
    assert (done.exit_code, done.stdout) == (2, "")
    assert "a picture cannot go to standard output; -o names a file" in done.stderr
