"""The page of the block ELEMENTS is that of its words."""

import sys

from tests.house.test_plain_words import TOP

sys.path.insert(0, str(TOP / "docs" / "_ext"))
import elements_page


def test_the_tables_of_the_page_are_those_of_the_words():
    page = elements_page.FILE.read_text(encoding="utf-8")
    assert page == elements_page.text(page), "run `python docs/_ext/elements_page.py`"
