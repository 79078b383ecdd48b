"""What builds the documentation: its link checker, descriptions of the gallery, commands of its figures."""

import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from docutils import nodes
from PIL import Image

TOP = Path(__file__).resolve().parents[2]
DOCS = TOP / "docs"
sys.path.insert(0, str(DOCS / "_ext"))

import breaks  # noqa: E402
import deck_picture  # noqa: E402
import deck_runs  # noqa: E402
import gallery  # noqa: E402
import links  # noqa: E402
import mathml  # noqa: E402
import pictures  # noqa: E402

from flexmb_cli import solve  # noqa: E402

DECKS = [deck for page in gallery.GROUPS for deck in gallery.decks_of(page)]
PAGES = [page for page in DOCS.rglob("*.md") if not {"_build", "gallery", "reproduced.md"} & set(page.parts)]


def test_broken_links_anchors_and_pictures_are_found(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text(
        '<h1 id="top">A</h1><a href="sub/b.html#place">b</a><a href="#top">t</a><a href="https://x.org">x</a>'
    )
    (tmp_path / "sub/b.html").write_text(
        '<p id="place"></p><a href="../a.html#nowhere">a</a><a href="c.html">c</a><img src="d.png">'
        '<a href="#">e</a>'
    )
    found, inside, outside = links.broken(tmp_path)
    assert [line.split(": ", 1) for line in found] == [
        ["sub/b.html", "../a.html#nowhere: no such place"],
        ["sub/b.html", "c.html: no such file"],
        ["sub/b.html", "d.png: no such file"],
    ]
    assert (inside, outside) == (6, 1)


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: deck.name)
def test_every_deck_of_the_gallery_is_described(deck):
    assert len(gallery.purpose(deck)) > 15


def test_the_gallery_has_every_supplied_deck():
    supplied = [p for p in (TOP / "decks").rglob("*") if p.suffix in (".dat", ".DAT", ".vsdf")]
    assert len(DECKS) == len(supplied) >= 52 and set(DECKS) == set(supplied)


def test_a_body_that_turns_about_its_origin_has_curves(tmp_path):
    """IN1-4-1: its origin rests, its point moves on a circle; IN1-1-1 rests as a whole."""
    pictures_of = {}
    for name in ("IN1-4-1", "IN1-1-1"):
        solve(TOP / "decks/young" / f"{name}.dat").save(tmp_path / f"{name}.h5")
        paths = tmp_path / f"{name}.png", tmp_path / f"{name}-curves.png"
        moves = deck_picture.draw(tmp_path / f"{name}.h5", *paths)
        pictures_of[name] = moves, *(path.exists() for path in paths)
    assert pictures_of == {"IN1-4-1": (True, True, True), "IN1-1-1": (False, True, False)}


def test_the_index_of_the_gallery_has_every_deck_once_and_single_bodies_last():
    sections = gallery.sections(DECKS)
    listed = [deck for group in sections.values() for deck in group]
    assert sorted(listed) == sorted(DECKS)
    last = {deck.stem for deck in list(sections.values())[-1]}
    assert last == {deck.stem for deck in DECKS if re.match(r"IN[12]-\d-\d", deck.stem)}


@pytest.mark.parametrize("deck", pictures.MACHINES)
def test_a_format_shows_a_deck_of_the_folder_beside_its_machine(deck):
    """The block is the file; the picture is that of its result, see below."""
    file = TOP / "decks" / deck
    text = (file.parent / "FORMAT.md").read_text(encoding="utf-8")
    block = re.search(r'<div class="beside">\n\n```text\n(.*?)\n```', text, re.DOTALL)[1]
    assert block == file.read_text(encoding="utf-8").rstrip("\n")
    assert f"pictures/machines/{file.parent.name}.png" in text


def test_file_names_may_break_behind_strokes_and_options_not_at_all():
    body = '<span class="pre">/fe/a.py</span> <span class="pre">--set</span><td><p>FE-001</p></td>'
    context = {"body": body}
    breaks._mark(None, "page", "page.html", context, None)
    assert context["body"] == (
        '<span class="pre">/fe/<wbr>a.py</span> <span class="pre whole">--set</span>'
        '<td><p class="whole">FE-001</p></td>'
    )


def test_names_of_tests_may_break_between_their_words():
    """The table of elements was 1.3 times as wide as its column at 1280 pixels."""
    context = {"body": '<span class="pre">a/test_b.py::test_stop</span>'}
    breaks._mark(None, "page", "page.html", context, None)
    assert context["body"] == ('<span class="pre">a/<wbr>test_<wbr>b.py::<wbr>test_<wbr>stop</span>')


def test_parentheses_of_matrices_need_no_font_for_mathematics():
    """Without one, Chromium drew them as high as one row."""
    shown = mathml.mathml(r"f(x) = \begin{pmatrix} a \\ b \end{pmatrix} \begin{pmatrix} c \end{pmatrix}")
    assert shown.count('<mtable class="matrix">') == shown.count("</mtable>") == 2
    assert shown.count("&#x00028;") == shown.count("&#x00029;") == 1  # those of f(x) stay


def test_formulas_of_a_line_stand_in_parts_of_their_own():
    """Phones showed the first of three equations: one row of MathML cannot break."""
    body = []
    translator = type("Translator", (), {"body": body})
    with pytest.raises(nodes.SkipNode):
        mathml._block(translator, nodes.math_block("", r"a = 1, \qquad b = 2 \qquad c = 3"))
    (shown,) = body
    assert shown.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">') == 3
    body.clear()
    with pytest.raises(nodes.SkipNode):
        mathml._block(translator, nodes.math_block("", r"\qquad + b"))  # indented below the line before
    assert body[0].count("<math ") == 1


def test_a_card_of_the_gallery_has_picture_sentence_and_live_page():
    (machines, *_) = gallery.sections(DECKS).items()
    cards = gallery._cards(*machines).split("{grid-item-card} ")[1:]
    assert len(cards) == len(machines[1])
    assert "img-top: ../pictures/gallery/slider_crank_stress.vsdf.png" in cards[0]
    assert 'href="../live/slider_crank_stress.vsdf.html"' in cards[0]
    assert all(re.search(r"\n\n[A-Z].{15,}\.\n\n<a", card) for card in cards)


@pytest.mark.parametrize(
    "deck, speeds",
    [
        # Two rotors about axes through their origins: the gallery said 0 m/s, hinge 1.
        ("dafms/motor_gear.DAT", []),
        # The crank of 0.1 m turns at the 146.6 rad/s of its driver.
        ("young/IN-RSSR-COELHO.dat", ["14.66 m/s, point 1"]),
    ],
)
def test_the_largest_speed_is_named_where_places_move(deck, speeds, tmp_path):
    solve(TOP / "decks" / deck).save(tmp_path / "result.h5")
    with h5py.File(tmp_path / "result.h5") as file:
        found = [
            value.partition(", at ")[0] for name, value in gallery._motion(file) if name == "largest speed"
        ]
    assert found == speeds


def test_a_changed_deck_or_finite_element_file_has_another_digest(tmp_path):
    file = tmp_path / "a"
    file.write_text("1")
    first = deck_runs.digest([file], "x")
    file.write_text("2")
    assert len({first, deck_runs.digest([file], "x"), deck_runs.digest([file], "y")}) == 3


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))
def test_every_figure_of_a_page_is_drawn_by_the_build_after_its_command(page):
    """The pictures of the build are those of `pictures.py`, each below a `flexmb plot` that is shown."""
    drawn = {target for *_, target in (*pictures.FIGURES, *pictures.STUDY_FIGURES)}
    in_gallery = {f"{deck.stem}{deck.suffix.lower()}.png": deck.name for deck in DECKS}
    text = page.read_text(encoding="utf-8")
    for match in re.finditer(r"\{(?:figure|image)\} (\S+)", text):
        name = Path(match[1]).name
        before = text[: match.start()]
        of_command = name in drawn and "flexmb plot" in before
        of_deck = name in in_gallery and in_gallery[name] in before and "flexmb report" in before
        assert name == "slider-crank.gif" or of_command or of_deck, match[0]


def test_what_a_page_includes_is_linked_for_readers_of_the_files():
    """A Git host shows the text of a page, not what Sphinx puts into it."""
    included = [(page, name) for page in PAGES for name in re.findall(r"\{include\} (\S+)", page.read_text())]
    assert len(included) > 3
    assert not [page.name for page, name in included if f"]({name})" not in page.read_text()]


@pytest.mark.parametrize(
    "page",
    sorted(page for page in PAGES if page.name == "index.md" and page.parent != DOCS),
    ids=lambda page: page.parent.name,
)
def test_an_index_links_its_pages_for_readers_of_the_files(page):
    """A Git host does not show the table of contents that Sphinx makes."""
    text = page.read_text(encoding="utf-8")
    (tree,) = re.findall(r"```\{toctree\}\n:hidden:\n\n(.*?)```", text, re.DOTALL)
    assert re.findall(r"^\* \[[^]]+\]\(([\w-]+)\.md\): \S", text, re.MULTILINE) == tree.split()


def test_the_pictures_of_the_readme_are_those_of_the_script(tmp_path):
    """The curves to a tenth of a point, and the size and number of frames: other versions of matplotlib round
    otherwise."""
    pictures.of_readme(tmp_path)
    drawn, stored = (curves_of(folder / "ball.svg") for folder in (tmp_path, pictures.PICTURES))
    assert [len(one) for one in drawn] == [len(one) for one in stored] and len(drawn) >= 2
    for new, old in zip(drawn, stored, strict=True):
        np.testing.assert_allclose(new, old, atol=0.1)
    for name in {Path(deck).parent.name for deck in pictures.MACHINES}:
        new, old = (
            Image.open(folder / "machines" / f"{name}.png") for folder in (tmp_path, pictures.PICTURES)
        )
        assert np.abs(np.asarray(new, float) - np.asarray(old, float)).mean() < 1
    films = [Image.open(folder / "slider-crank.gif") for folder in (tmp_path, pictures.PICTURES)]
    assert films[0].n_frames == films[1].n_frames > 50 and films[0].size == films[1].size
    last = [np.asarray(film.convert("L"), float) for film in films if film.seek(60) is None]
    assert np.abs(last[0] - last[1]).mean() < 1


def curves_of(path):
    """Lines of more than 10 points in an SVG picture."""
    lines = re.findall(r'<path d="([^"]*)"', path.read_text(encoding="utf-8"))
    points = [np.array(re.findall(r"-?[\d.]+", line), float) for line in lines]
    return [each for each in points if len(each) > 20]
