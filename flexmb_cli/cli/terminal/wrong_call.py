"""A wrong call of a command, with the identifier of its message."""

import click


class WrongCall(click.UsageError):
    """Options or arguments that a command refuses; `id` is the fault's.

    What click itself refuses, such as an unknown option, has the identifier of `_refuse_usage`.
    """

    def __init__(self, message: str, ctx: click.Context | None = None, *, id: str):
        super().__init__(message, ctx)
        self.id = id
