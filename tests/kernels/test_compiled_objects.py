"""Objects of compiled kernels: their entries, for which machines they are, and how they are loaded."""

import ast
import importlib
import inspect
import operator
import re
from collections import namedtuple
from pathlib import Path

import numpy as np
import pytest

from flexmb_cli.kernels import _arguments, _entry, _jit, signatures
from flexmb_cli.kernels.constrained import speeds
from flexmb_cli.kernels.linalg import lu
from flexmb_cli.run.outcome import RunOptions
from flexmb_cli.run.solution import run_deck

PACKAGE = Path(_jit.__file__).parents[1]
compiled = pytest.mark.skipif(_jit.interpreted(), reason="nothing is compiled")


def called_by_python():
    """(kernel's module, function) of every kernel that a module outside `kernels` names in a call."""
    for path in PACKAGE.rglob("*.py"):
        if path.parent.name in ("kernels", "joints"):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        modules, functions = {}, {}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("kernels"):
                below = node.module.removeprefix("kernels").lstrip(".")
                for name in node.names:
                    known = functions if below else modules
                    known[name.asname or name.name] = (below, name.name) if below else name.name
        for node in ast.walk(tree):
            if (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id in modules
            ):
                yield modules[node.value.id], node.attr
            elif isinstance(node, ast.Name) and node.id in functions:
                yield functions[node.id]


def test_every_kernel_that_python_calls_has_a_signature():
    """A kernel without one would be compiled by the first run, and no wheel would contain it."""
    named = set(called_by_python())
    assert len(named) > 60
    for module, function in named:
        found = getattr(importlib.import_module(f"flexmb_cli.kernels.{module}"), function, None)
        if isinstance(found, _entry.Entry) and not isinstance(found, _entry.PlainEntry):
            assert signatures.unit_of(f"{module}.{function}"), f"{module}.{function}"


@pytest.mark.parametrize("name", signatures.TUPLES)
def test_every_tuple_has_the_fields_of_its_class(name):
    place, words = signatures.TUPLES[name]
    module, _, kind = place.partition(":")
    fields = getattr(importlib.import_module(f"flexmb_cli.{module}"), kind)._fields
    assert len(words.split()) == len(fields), dict(zip(fields, words.split(), strict=False))


PLACES = {**signatures.RECORDS, **{name: place for name, (place, _) in signatures.TUPLES.items()}}


@pytest.mark.parametrize("name", PLACES)
def test_the_order_of_fields_is_in_the_name_of_an_object(monkeypatch, name):
    """Code that was compiled for another order would read one array as another."""
    module, _, constant = PLACES[name].partition(":")
    place = importlib.import_module(f"flexmb_cli.{module}")
    defined = getattr(place, constant)
    first, second, *others = getattr(defined, "_fields", None) or defined.names
    if name in signatures.TUPLES:
        words = signatures.TUPLES[name][1].split()
        other = namedtuple(constant, [second, first, *others], module=defined.__module__)
        other.__qualname__ = constant
        as_words = name
    else:
        words, as_words = [], f"{name}1"
        other = np.dtype([(field, defined[field]) for field in (second, first, *others)])

    def named():
        signatures.parameter.cache_clear()
        return _entry.Unit("one", {"kernel": [signatures.parameter(as_words)]}).name

    before = named()
    monkeypatch.setattr(place, constant, other)
    changed = named()
    monkeypatch.undo()
    assert changed != before == named(), words


def test_every_signature_is_that_of_a_kernel():
    for unit in signatures.UNITS:
        for name, parameters in signatures.unit_parameters(unit).items():
            module, _, function = name.rpartition(".")
            kernel = getattr(importlib.import_module(f"flexmb_cli.kernels.{module}"), function)
            function = getattr(kernel, "py_func", kernel)
            assert function.__code__.co_argcount == len(parameters), name


# A deck of each analysis, shortened, and how it is solved.
ANALYSES = {
    "young/IN1-1-1.dat": (),
    "young/dynamics/IN-ANDREWS.dat": ("time.end=0.0001",),
    "young/dynamics/IN-RSSR-MASS.dat": (),
    "dafms/pendulum.DAT": ("time.IT=2",),
    "vsdf/pendulum.vsdf": ("time.end=0.0001",),
}


@compiled
@pytest.mark.parametrize("deck", ANALYSES)
def test_runs_hand_over_what_the_signatures_describe(tmp_path, monkeypatch, deck):
    """A field more in a tuple of work arrays, and each kernel would be compiled on its own, in no wheel."""
    taken, call = set(), _entry.Entry.__call__

    def checked(entry, *values):
        unit = signatures.unit_of(entry._name)
        if unit is not None:
            taken.add(entry._name)
            parameters = signatures.unit_parameters(unit)[entry._name]
            assert _arguments.Words(parameters).pack(values), entry._name
        return call(entry, *values)

    monkeypatch.setattr(_entry.Entry, "__call__", checked)
    options = RunOptions(folder=str(tmp_path), changes=ANALYSES[deck])
    outcome = run_deck(str(PACKAGE.parent / "decks" / deck), options)
    assert outcome.exit_code == 0, outcome.faults
    assert taken


def test_numbers_arrays_and_tuples_are_packed_as_described():
    values = (3, 2.5, True, np.arange(6.0).reshape(2, 3), (np.zeros(2, int), 7))
    words = _arguments.Words([_arguments.describe(value) for value in values])
    assert words.pack(values)
    integers, floats = words._room
    assert (integers[0], floats[1], integers[2]) == (3, 2.5, 1)
    assert list(integers)[3:6] == [values[3].ctypes.data, 2, 3]
    assert list(integers)[6:9] == [values[4][0].ctypes.data, 2, 7]


OTHER = [
    np.zeros((2, 2)),
    np.zeros(4, np.float32),
    np.zeros(8)[::2],
    np.asfortranarray(np.zeros((2, 3))),
    np.frombuffer(bytes(32)),
    [0.0, 1.0],
    1.0,
]


@pytest.mark.parametrize("value", OTHER, ids=lambda value: str(type(value).__name__))
def test_other_arrays_are_not_taken(value):
    """Code for another type, order or dimension would read, or write, beyond the array."""
    assert not _arguments.Words([_arguments.Array(1, np.dtype(float))]).pack((value,))


def test_a_tuple_that_comes_again_is_not_packed_anew():
    words = _arguments.Words([_arguments.describe((np.zeros(2),))])
    one, other = (np.zeros(2),), (np.zeros(2),)
    assert words.pack((one,)) and words.pack((other,))
    assert words._room[0][0] == other[0].ctypes.data
    assert words.pack((one,)) and words._room[0][0] == one[0].ctypes.data


@compiled
@pytest.mark.parametrize("place", [np.zeros(14)[::2], np.zeros(7, np.float32)])
def test_what_no_object_takes_is_interpreted_or_compiled_apart(place):
    place[3] = 2.0
    speeds.normalise(1, place)
    assert place[3] == 1.0


@compiled
def test_too_few_arguments_are_refused():
    with pytest.raises(TypeError):
        lu.substitute(1)


KERNELS = PACKAGE / "kernels"
NUMBA = KERNELS / "_numba.py"
# What the kernels' compiler names in texts or asks of objects: no attribute of a name that is imported.
OTHERS = {
    ("numba.core.codegen", "JITCodeLibrary"): {"_get_module_for_linking"},
    ("numba.core.compiler_lock", "global_compiler_lock"): {"__enter__"},
    ("numba.core.registry", "CPUDispatcher"): {"compile", "overloads"},
    ("numba.core.registry", "cpu_target"): {
        f"target_context.{name}"
        for name in (
            "call_conv",
            "codegen",
            "declare_function",
            "get_abi_sizeof",
            "get_data_type",
            "make_tuple",
        )
    },
}


def tree_of(path):
    """The syntax of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def imports_of(path):
    """(name in the file, module, name there or nothing) of everything of numba and llvmlite in a file."""
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            found = [(one.asname or one.name, one.name, "") for one in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found = [(one.asname or one.name, node.module, one.name) for one in node.names]
        else:
            continue
        yield from (one for one in found if one[1].partition(".")[0] in ("numba", "llvmlite"))


def private_names(path, places):
    """{name in the file: (module, name there)} of what a file has of `places`, those of `_numba.py`."""
    if path == NUMBA:
        return places
    return {
        one.asname or one.name: places[one.name]
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.ImportFrom) and node.module == "_numba"
        for one in node.names
        if one.name in places
    }


def used_of(node):
    """Names, with attributes, that an expression uses, or that a class takes or replaces of its base."""
    if isinstance(node, ast.Attribute):
        yield ast.unparse(node)
    elif isinstance(node, ast.ClassDef):
        own = {
            one.attr
            for one in ast.walk(node)
            if isinstance(one, ast.Attribute) and type(one.ctx) is ast.Store
        }
        asked = set(re.findall(r"\b(?:super\(\)|self)\.(\w+)", ast.unparse(node))) - own
        methods = {one.name for one in node.body if isinstance(one, ast.FunctionDef)}
        yield from (f"{ast.unparse(base)}.{name}" for base in node.bases for name in asked | methods)


def private():
    """{(module, name or nothing): attributes} of all that kernels use of numba by way of `_numba.py`."""
    places = {name: (module, inside) for name, module, inside in imports_of(NUMBA)}
    found = {place: set() for place in places.values()}
    for path in KERNELS.glob("*.py"):
        names = private_names(path, places)
        for node in ast.walk(tree_of(path)):
            for used in used_of(node):
                name, _, attribute = used.partition(".")
                if name in names and attribute.replace(".", "").isidentifier():
                    found[names[name]].add(attribute)
    return {place: found[place] | OTHERS.get(place, set()) for place in found}


PRIVATE = private()


def test_kernels_give_numba_types_of_locals_that_every_version_takes():
    """numba 0.61 compiles no kernel without: "locals must not be None"."""
    from flexmb_cli.kernels import _linking

    assert _linking.Part(lambda x: x, _jit.OPTIONS).locals == {}


def test_what_is_private_to_numba_is_used_in_one_place():
    """All that numba does not promise to keep is imported by `_numba.py`."""
    inside = {
        path.name
        for path in PACKAGE.rglob("*.py")
        for _, module, name in imports_of(path)
        if module.startswith("numba.") or (module == "numba" and name)
    }
    assert inside == {"_numba.py"}


def test_the_list_of_what_is_private_to_numba_is_that_of_the_kernels():
    """It is read from the text of the kernels; these are some of each way in which they use numba."""
    assert len(PRIVATE) > 20 and set(OTHERS) <= set(PRIVATE)
    assert {"Array", "BaseTuple.from_types", "Function"} <= PRIVATE["numba.core", "types"]
    assert {"_get_module_for_linking"} <= PRIVATE["numba.core.codegen", "JITCodeLibrary"]
    assert {"define_pipelines", "state"} <= PRIVATE["numba.core.compiler", "Compiler"]
    assert {"fix_integer_index"} <= PRIVATE["numba.np", "arrayobj"]
    assert "TranslateByteCode" in PRIVATE["numba.core", "untyped_passes"]


def has(owner, attribute):
    """Whether an object has it, or a class whose constructor, or that of a base, makes it."""
    try:
        operator.attrgetter(attribute)(owner)
    except AttributeError:
        own = [kind for kind in getattr(owner, "__mro__", ()) if kind is not object]
        return any(f"self.{attribute} = " in inspect.getsource(kind) for kind in own)
    return True


@compiled
@pytest.mark.parametrize(("module", "name"), PRIVATE)
def test_what_is_private_to_numba_is_still_there(module, name):
    imported = importlib.import_module(module)
    found = getattr(imported, name, None) if name else imported
    if found is None:  # a module of a package
        found = importlib.import_module(f"{module}.{name}")
    missing = [attribute for attribute in PRIVATE[module, name] if not has(found, attribute)]
    assert not missing, f"numba changed {missing} of {module}.{name}: _numba.py"
