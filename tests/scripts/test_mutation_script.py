"""scripts/mutate: its edits are what they say, and its lists still name functions and statements."""

import ast
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def modules():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(TOP / "scripts" / "mutate"))
        import mutate
        import mutations
        import tree

        yield mutate, mutations, tree


@pytest.fixture(scope="module")
def mutants(modules):
    """Raises ValueError where a pattern of bookkeeping.toml fits no function any more."""
    return modules[1].all_mutants(TOP, modules[2].kernel_files(TOP))


def test_every_mutant_is_one_edit_that_python_can_read(mutants):
    sources = {m.file: (TOP / m.file).read_bytes() for m in mutants}
    trees = {file: ast.dump(ast.parse(source)) for file, source in sources.items()}
    for m in mutants[::29]:
        source = sources[m.file]
        edited = source[: m.begin] + m.text.encode() + source[m.end :]
        assert ast.dump(ast.parse(edited)) != trees[m.file], m.key


def test_signs_factors_and_indices_are_edited(modules, tmp_path):
    code = "@kernel\ndef f(a, b):\n    for i in range(2):\n        a[i, 0] -= 2.0 * b[i + 1]\n"
    (tmp_path / "flexmb_cli").mkdir()
    path = tmp_path / "flexmb_cli" / "k.py"
    path.write_text(code)
    finder = modules[1]._Finder(code.encode(), "k.py", "f")
    after = {m.after for m in finder.mutants(ast.parse(code).body[0])}
    assert after == {
        "a[i, 0] += 2.0 * b[i + 1]",
        "a[i, 0] -= 2.0 / b[i + 1]",
        "a[i, 0] -= (2.0)",
        "a[i, 0] -= 1.0 * b[i + 1]",
        "a[i, 0] -= 2.0 * b[i - 1]",
        "a[i, 0] -= 2.0 * b[i + 2]",
        "a[i, 1] -= 2.0 * b[i + 1]",
    }


def test_kernels_made_within_functions_are_edited(modules, tmp_path):
    path = tmp_path / "k.py"
    path.write_text("def make(f):\n    @kernel\n    def step(h):\n        return f(-h)\n\n    return step\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(modules[1], "skipped_functions", dict)
        found = modules[1].all_mutants(tmp_path, [path])
    assert [(m.function, m.after) for m in found] == [("step", "return f(+h)")]


def test_the_steps_of_integrators_are_among_the_mutants(mutants):
    assert {"attempt", "fill_dense", "take_step"} <= {m.function for m in mutants}


def test_the_sample_takes_all_files_and_kinds_in_proportion(modules, mutants):
    drawn = modules[1].sample(mutants, 300, 1)
    assert len({m.name for m in drawn}) == 300
    for kind in ("sign", "factor", "index"):
        share = sum(m.kind == kind for m in mutants) / len(mutants)
        assert sum(m.kind == kind for m in drawn) == pytest.approx(300 * share, abs=15)


def test_equivalent_mutants_are_still_made(modules, mutants):
    keys = {m.key for m in mutants}
    assert [key for key in modules[0].equivalents() if key not in keys] == []
