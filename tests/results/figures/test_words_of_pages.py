"""Title, note, curves and extremes of a report page, on the screen and on paper."""

import re

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from flexmb_cli.cli import cli
from flexmb_cli.results.figures.report_page import PageWords, report_page
from tests.results.results import value, write_result


@pytest.fixture
def path(tmp_path):
    path = write_result(tmp_path / "r.h5", 9)
    with h5py.File(path, "r+") as file:
        del file["energy"]  # which has the total only
    return path


def rows_of(page):
    table = page.partition('<table class="extremes">')[2].partition("</table>")[0]
    return [re.findall(r"<td>(.*?)</td>", row) for row in table.split("<tr>")[2:]]


def test_title_note_and_curves_are_those_of_the_user(path, tmp_path):
    page = tmp_path / "p.html"
    words = ["--title", "Wiper <drive>", "--note", "One & only.\\n\\nSecond part.", "--curves", "body.3.z"]
    done = CliRunner().invoke(cli, ["report", str(path), "-o", str(page), *words])
    assert done.exit_code == 0, done.output
    text = page.read_text()
    assert "<title>Wiper &lt;drive&gt;</title>" in text and "<h1>Wiper &lt;drive&gt;</h1>" in text
    assert re.findall(r'<p class="note">(.*?)</p>', text) == ["One &amp; only.", "Second part."]
    assert re.findall(r"<figcaption>(.*?)</figcaption>", text) == ["z of body 3 [m]"]


def test_extremes_are_those_of_the_rows_in_the_units_that_are_wanted(path):
    """Values by the closed rule of `results.value`, times 0.25 s a row."""
    z = np.array([value("body/position", row, 2, 2) for row in range(9)])
    with h5py.File(path) as result:
        page = report_page(result, words=PageWords(curves=("body.3.z",)))
    assert rows_of(page)[0] == [
        "z of body 3",
        "m",
        f"{z.min():.6g} at {0.25 * z.argmin():.6g} s",
        f"{z.max():.6g} at {0.25 * z.argmax():.6g} s",
    ]


def test_the_largest_reactions_are_sizes_of_vectors(path):
    with h5py.File(path, "r+") as result:
        force = result["reaction/force"][:]
        page = report_page(result)
    sizes = np.linalg.norm(force, axis=2)
    labels = {row[0]: row[3] for row in rows_of(page)}
    found = [text for label, text in labels.items() if label.startswith("force of")]
    assert len(found) == sizes.shape[1]
    row = int(sizes[:, 0].argmax())
    assert found[0].endswith(f"at {0.25 * row:.6g} s")


def test_a_name_that_is_none_and_words_of_a_film_are_refused(path, tmp_path):
    done = CliRunner().invoke(cli, ["report", str(path), "--curves", "body.9.z"])
    assert done.exit_code and "--curves body.9.z: the result has no such quantity" in str(done.exception)
    done = CliRunner().invoke(cli, ["report", str(path), "--movie", "f.mp4", "--title", "x"])
    assert done.exit_code == 2 and "for pages; leave out --movie" in done.output
