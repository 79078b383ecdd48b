"""No module needs itself, by whatever way: imports within functions and for annotations alone count, too."""

from graphlib import CycleError, TopologicalSorter

import pytest

from tests.house.test_house import MODULES, PACKAGE, imports_of


def name_of(path):
    parts = ("flexmb_cli", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules_of(full, known):
    """Yield the module that holds an imported name: the longest of its beginnings that is one."""
    names = [".".join(full[:count]) for count in range(len(full), 0, -1)]
    yield from [name for name in names if name in known][:1]


def graph_of(imports):
    """Modules that each module imports; `imports`: full names as tuples, by the names of the modules."""
    return {
        module: {name for one in full for name in modules_of(one, imports)} - {module}
        for module, full in imports.items()
    }


def test_no_imports_close_a_circle():
    graph = graph_of({name_of(path): imports_of(path) for path in MODULES})
    assert len(graph) > 400
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as circle:
        pytest.fail(" ← ".join(circle.args[1]))


def test_a_circle_is_seen():
    graph = graph_of({"a": [("b", "x")], "b": [("a", "y", "z")]})
    with pytest.raises(CycleError):
        TopologicalSorter(graph).prepare()
