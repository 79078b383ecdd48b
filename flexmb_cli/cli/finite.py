"""A real number on the command line: in a range, and neither nan nor inf."""

import math

import click


class Finite(click.FloatRange):
    """`click.FloatRange` for finite numbers."""

    def convert(self, value, param, ctx):
        """The number, or a usage error that names the option."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is no finite number", param, ctx)
        return number
