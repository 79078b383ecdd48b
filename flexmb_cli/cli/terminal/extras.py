"""Libraries that only some commands need."""

import importlib

import click


def needed(module: str, package: str, extra: str):
    """The imported `module`; without it a usage error that says how to install the extra."""
    try:
        return importlib.import_module(module)
    except ImportError as missing:
        raise click.UsageError(
            f"this command needs {package} ({missing}); install it with: pip install 'flexmb[{extra}]'"
        ) from missing
