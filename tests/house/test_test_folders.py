"""Where tests stand: their folders are those of the package, but for the ones that CONTRIBUTING.md names."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TESTS, PACKAGE = ROOT / "tests", ROOT / "flexmb_cli"
RULES = next(
    line
    for line in (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("\n* ")
    if line.startswith("Tests stand in")
)
FOLDERS = sorted(path.parent for path in TESTS.rglob("__init__.py") if path.parent != TESTS)


def test_folders_of_tests_are_those_of_the_package_or_named_on_the_page():
    strange = [
        name
        for folder in FOLDERS
        if not (PACKAGE / (name := folder.relative_to(TESTS).as_posix())).is_dir()
        and f"`{name}`" not in RULES
    ]
    assert FOLDERS and not strange


def test_folders_that_the_page_names_hold_tests():
    named = [word for word in RULES.split("`")[1::2] if "<" not in word and not word.endswith(".py")]
    assert named and not [name for name in named if not (TESTS / name).is_dir()]


def test_every_folder_with_tests_is_a_package():
    """Many base names repeat: pytest tells files of one name apart by their packages."""
    plain = {path.parent for path in TESTS.rglob("test_*.py")} - {TESTS, *FOLDERS}
    assert not plain
