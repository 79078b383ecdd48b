"""Libraries that only some commands need."""

import importlib
from types import ModuleType

from .errors import BAD_INPUT, FlexmbError


class MissingExtra(FlexmbError):
    """A command needs a library that is not installed (exit 2)."""

    exit_code = BAD_INPUT
    of_the_call = True


def needed(module: str, package: str, extra: str, what: str, beside: tuple[str, ...] = ()) -> ModuleType:
    """Return the imported `module` of `package`, which `what` needs and the extra brings.

    Call it before any work begins.  Raises MissingExtra with the command that installs the extra, or the
    package and those `beside` it where no extra has it ("").
    """
    try:
        return importlib.import_module(module)
    except ImportError as fault:
        # What it imports would cost every start-up.
        from .installation import command_for, install_command

        absent = isinstance(fault, ModuleNotFoundError) and (fault.name or "") in (package, module)
        reason = "which is not installed" if absent else f"which cannot be imported ({fault})"
        command = install_command(extra) if extra else command_for([package, *beside])
        message = f"{what} needs {package}, {reason}; install it with: {command}"
        raise MissingExtra(message, id="FLEXMB-006") from fault
