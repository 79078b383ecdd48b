"""Numbers and records for FORTRAN input: every field filled with the digits its columns can hold."""

from collections.abc import Iterable, Sequence


def filled(value: float, width: int) -> str:
    """The spelling of `value` in at most `width` columns that reads back closest to it.

    Always with a decimal point, which overrides the one a FORMAT implies; without it `width` columns
    would be read as a number with decimals.  "" where they are too few.
    """
    if value == 0:
        return "0.0"
    spellings = [text for text in (_fixed(value, width), _exponential(value, width)) if text]
    return min(spellings, key=lambda text: abs(float(text) - value), default="")


def _fixed(value: float, width: int) -> str:
    for decimals in range(width, 0, -1):
        text = f"{value:.{decimals}f}".replace("-0.", "-.")
        text = text[1:] if text.startswith("0.") else text
        if len(text) <= width:
            text = text.rstrip("0")
            digits = text.strip("-.")
            return (text + "0" if text.endswith(".") else text) if digits else ""
    return ""


def _exponential(value: float, width: int) -> str:
    for digits in range(width, 0, -1):
        mantissa, exponent = f"{value:.{digits}E}".split("E")
        text = f"{mantissa.rstrip('0')}E{int(exponent)}"
        if len(text) <= width:
            return text
    return ""


def real_list(values: Iterable[float], width: int, per_line: int) -> str:
    """A list of reals, `per_line` fields of `width` columns in a record, lines ended by LF."""
    return _lines([filled(float(value), width).rjust(width) for value in values], per_line)


def integer_list(values: Sequence[int], per_line: int = 10) -> str:
    """A list of integers under FORMAT(10I5), lines ended by LF."""
    return _lines([f"{value:5d}" for value in values], per_line)


def indexed(number: int, values: Sequence[float]) -> str:
    """One record I5,nF10.5."""
    return f"{number:5d}" + real_list(values, 10, len(values))


def _lines(fields: list[str], per_line: int) -> str:
    chunks = [fields[i : i + per_line] for i in range(0, len(fields), per_line)]
    return "".join("".join(chunk) + "\n" for chunk in chunks)
