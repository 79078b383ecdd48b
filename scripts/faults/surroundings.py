"""What a command may find around it: closed streams, full pipes, odd names, locales, masks of permissions."""

import os
import shutil
import stat
from pathlib import Path

from .child import Hit, run_process
from .judge import faults_of_end, faults_of_files, said_the_same
from .stage import DECKS
from .stops import Verdict

LOCALES = (
    {"LC_ALL": "C"},
    {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"},
    {"LC_ALL": "de_DE.ISO-8859-1", "LANG": "de_DE"},
    {"TZ": "Pacific/Kiritimati"},
    {"TZ": ":nowhere", "LC_ALL": "xx_YY"},
    {"PYTHONIOENCODING": "ascii"},
)
NAMES = (
    b"a b",
    b"-x",
    b"\xff\xfe",
    b"\xe4\xf6",
    "größe".encode(),
    b"new\nline",
    b"a'b\"c",
    b"%s{}",
    b"a*?[1]",
    b"$HOME",
)


def closed_streams(stage, chance, number, folder) -> Verdict:
    """Standard input, output or error closed from the start, one or several."""
    commands = list(stage.commands.values())
    command = stage.spread(commands, number)
    closed = tuple(stream for stream in range(3) if (1 + number // len(commands) % 7) >> stream & 1)
    before = command.prepare(folder, with_old=False)
    ended = command.run(folder, Hit(closed=closed))
    allowed = {0, 1, 2} if command.name == "new" and 0 in closed else {0}
    if command.name == "new" and 0 in closed and ended.code:
        return Verdict(command.name, [] if ended.code in allowed else [f"exit {ended.code}"])
    found = faults_of_end(ended, allowed) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def full_standard_output(stage, chance, number, folder) -> Verdict:
    """Standard output on a full disk: told, exit 1; files are written all the same."""
    commands = [c for c in stage.commands.values() if c.said]
    command = stage.spread(commands, number)
    before = command.prepare(folder, with_old=False)
    ended = command.run(folder, Hit(stdout="/dev/full"))
    found = faults_of_end(ended, {1}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def full_table_on_standard_output(stage, chance, number, folder) -> Verdict:
    """`run --out -` on a full disk: exit 1, other results whole, partial or absent."""
    command = stage.spread(
        [c for c in stage.writers if c.name.startswith("run") and c.name != "run several decks"], number
    )
    command.prepare(folder, with_old=False)
    ended = command.run_other((*command.arguments, "--out", "-"), folder, Hit(stdout="/dev/full"))
    return Verdict(command.name, faults_of_end(ended, {1}))


def odd_names(stage, chance, number, folder) -> Verdict:
    """Decks, folders and results with names that shells and terminals stumble over."""
    name = os.fsdecode(NAMES[number % len(NAMES)])
    command = stage.commands["run young"]
    shutil.copy(DECKS / "young/IN4-BAR.dat", folder / f"IN{name}.dat")
    shutil.copy(DECKS / "young/IN4-BAR.dat", folder / f"{name}.dat")
    found = []
    for deck, out in ((f"IN{name}.dat", f"OUT{name}"), (f"{name}.dat", name)):
        arguments = ["run", "--set", "time.step=0.05", "-o", f"to {name}", "--json", "--", deck]
        found += faults_of_end(command.run_other(arguments, folder), {0})
        suffix = "dat" if out.startswith("OUT") else "OUT"
        table = folder / f"to {name}" / f"{out}.{suffix}"
        same = table.is_file() and table.read_bytes() == command.whole["out/OUT4-BAR.dat"]
        found += [] if same else [f"{table.name!r} is not there or has other bytes"]
        result = f"to {name}/{out}.h5"
        for words in (
            ["table", result, "body.1.x"],
            ["report", result, "-o", f"{name}.html"],
            ["check", "--", deck],
            ["export", result, "--to", "csv"],
            ["plot", result, "body.2", "-o", f"to {name}/p.svg"],
        ):
            found += faults_of_end(command.run_other(words, folder), {0})
    return Verdict(f"the name {name!r}", found)


def other_locales(stage, chance, number, folder) -> Verdict:
    """Locales and time zones do not change a byte."""
    command = stage.spread(list(stage.commands.values()), number)
    before = command.prepare(folder, with_old=False)
    ended = command.run(folder, Hit(environment=LOCALES[number % len(LOCALES)]), run_process)
    found = faults_of_end(ended, {0}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found + said_the_same(command, ended))


def narrow_masks(stage, chance, number, folder) -> Verdict:
    """umask 077: results are the user's alone, an old one keeps its permissions."""
    command = stage.spread(stage.writers, number)
    with_old = chance.random() < 0.5
    before = command.prepare(folder, with_old)
    ended = command.run(folder, Hit(begin=lambda: os.umask(0o077)))
    found = faults_of_end(ended, {0}) + faults_of_files(command, folder, before, ended)
    wanted = 0o644 if with_old else 0o600
    for output in command.outputs:
        mode = stat.S_IMODE(Path(folder / output).stat().st_mode)
        found += [] if mode == wanted else [f"{output} has mode {mode:o}, not {wanted:o}"]
    return Verdict(command.name, found)
