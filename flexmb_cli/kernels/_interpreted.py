"""Kernels as plain Python within a block of code, beside their compiled forms."""

import importlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import FunctionType, ModuleType, SimpleNamespace

_PACKAGE = __package__ + "."
_interpreting: ContextVar[bool] = ContextVar("interpreting", default=False)
is_interpreting = _interpreting.get
_twins: dict[str, dict[str, object]] = {}  # globals of a module's interpreted functions, by its name


@contextmanager
def interpreting(interpreted: bool = True) -> Iterator[None]:
    """Run the kernels that are called within the block, in this thread, as plain Python."""
    token = _interpreting.set(interpreted)
    try:
        yield
    finally:
        _interpreting.reset(token)


def twin(function: Callable) -> Callable:
    """Return `function` of a kernel with globals in which kernels are plain functions too.

    Each call of another kernel would otherwise ask anew whether it is interpreted.
    """
    current = _globals_of(function.__module__).get(function.__name__)
    # Functions made within another one share their code: the closure distinguishes them.
    identity = function.__code__, function.__closure__
    if isinstance(current, FunctionType) and (current.__code__, current.__closure__) == identity:
        return current
    return function  # made within a function, or not a module's own any more


def _globals_of(module: str) -> dict[str, object]:
    if module not in _twins:
        names = vars(importlib.import_module(module))
        plain = _twins[module] = dict(names)
        for name, value in names.items():
            plain[name] = _plain(value, plain, module)
    return _twins[module]


def _plain(value: object, names: dict[str, object], module: str) -> object:
    """Return a global of `module` as interpreted functions shall see it."""
    function = getattr(value, "py_func", None)
    if function is not None:
        if "<locals>" in function.__qualname__:
            # Made for its closure, as the loops of integrators are: no module has it by its name.
            names = _globals_of(function.__module__)
        elif function.__module__ != module:
            return _globals_of(function.__module__)[function.__name__]
        return FunctionType(
            function.__code__, names, function.__name__, function.__defaults__, function.__closure__
        )
    if isinstance(value, ModuleType) and value.__name__.startswith(_PACKAGE):
        return SimpleNamespace(**_globals_of(value.__name__))
    return value
