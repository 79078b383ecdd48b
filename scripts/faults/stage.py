"""The commands that are hit, what they need, and what they give when nothing happens."""

import itertools
from dataclasses import dataclass, field, replace
from pathlib import Path

from .child import UNHIT, Ended, Hit, run_forked
from .trip import Trip

DECKS = Path(__file__).resolve().parents[2] / "decks"
ANSWERS = [
    *["a crank", "1 1 1 0 0 0 0 0 0 5 0 0", "", "", "1 6", "0 2 0", "1 0.5 0 0"],
    *["1 1 0", "1 2 0", "1 3 0", "1 4 0", "1 5 0", "0 1 0.1", "0"],
]
VALUES = [1, 12, 3, 4, 2, 3, 4, 3, 3, 3, 3, 3, 3, 1]  # that each line of the answers gives
OLD = bytes(4)  # what a loss of power leaves of a result, which the next command replaces
STUDY = """
deck = "{deck}"
[parameters]
"driver.1.B" = {{ from = 100.0, to = 200.0, count = {count} }}
[results]
top = "max body.3.z"
path = "series point.1.z"
"""


@dataclass
class Command:
    """A command of flexmb in a folder with `inputs`; it writes `outputs`, over `old` files if there are any.

    `again` is what brings it to its end after a hit.  `whole` and `deeds` are what the undisturbed
    command gave: the bytes of every output, and how many deeds it took; `seconds` how long.
    """

    name: str
    arguments: tuple
    outputs: tuple[str, ...] = ()
    inputs: dict[str, bytes] = field(default_factory=dict)
    again: tuple = ()
    resumable: bool = False
    stdin: bytes = b""
    old: dict[str, bytes] = field(default_factory=dict)
    whole: dict[str, bytes] = field(default_factory=dict)
    said: bytes = b""
    deeds: int = 0
    seconds: float = 0.0

    def prepare(self, folder: Path, with_old: bool) -> dict[str, bytes]:
        """Make `folder` as it is before the command; the files in it."""
        files = dict(self.inputs)
        if with_old:
            files |= {output: self.old.get(output, OLD) for output in self.outputs}
        for name, content in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)
        return files

    def run(self, folder: Path, hit: Hit = UNHIT, run=run_forked) -> Ended:
        """The command, hit."""
        return run(self.arguments, folder, replace(hit, stdin=hit.stdin or self.stdin))

    def run_other(self, arguments, folder: Path, hit: Hit = UNHIT) -> Ended:
        """The command with other arguments."""
        return run_forked(arguments, folder, replace(hit, stdin=hit.stdin or self.stdin))

    def finish(self, folder: Path, run=run_forked) -> Ended:
        """The command once more, to go on or to begin anew."""
        return run((*self.arguments, *self.again), folder, Hit(stdin=self.stdin))


def undisturbed(command: Command, folder: Path) -> Command:
    """`command` with what it gives in the empty `folder` when nothing happens."""
    folder.mkdir(parents=True)
    command.prepare(folder, with_old=False)
    trip = Trip(str(folder))
    ended = command.run(folder, Hit(trip=trip))
    if ended.code != 0:
        raise SystemExit(f"{command.name} fails undisturbed, exit {ended.code}: {ended.stderr}")
    command.whole = {output: (folder / output).read_bytes() for output in command.outputs}
    command.deeds, command.seconds, command.said = trip.count, ended.seconds, ended.stdout
    return command


def _run(name, deck, stem, *options, suffix=".dat", resumable=False):
    outputs = [f"out/{stem}{suffix}", f"out/{stem}.h5"]
    if "dafms" in deck:
        outputs += [f"out/{stem}.T2", f"out/{stem}.T3"]
    again = ("--resume",) if resumable else ()
    own = _files_of(DECKS / deck) if resumable else {}
    arguments = ("run", Path(deck).name if own else DECKS / deck, "-o", "out", *options)
    return Command(name, arguments, tuple(outputs), own, again, resumable)


def _files_of(deck: Path) -> dict[str, bytes]:
    """Deck and matrices of a run that goes on: they lie in its folder, where they can be changed."""
    matrices = deck.parent.glob(f"fe/{deck.stem}_*")
    return {str(path.relative_to(deck.parent)): path.read_bytes() for path in (deck, *matrices)}


def runs() -> list[Command]:
    """`flexmb run` of every dialect, short."""
    goes_on = {"suffix": ".OUT", "resumable": True}
    return [
        _run("run young", "young/IN4-BAR.dat", "OUT4-BAR", "--set", "time.step=0.05"),
        _run("run young inverse", "young/dynamics/IN4-BAR-MASS.dat", "OUT4-BAR-MASS"),
        _run("run young forward", "young/dynamics/IN-BRICARD.dat", "OUT-BRICARD", "--set", "time.end=1",
             resumable=True),
        _run("run dafms", "dafms/pendulum.DAT", "pendulum", "--set", "time.IT=1500", **goes_on),
        _run("run dafms flexible", "dafms/two_link_n2.DAT", "two_link_n2", "--rtol", "1e-6", **goes_on),
        _run("run dafms absolute", "dafms/fourbar_rigid.DAT", "fourbar_rigid", "--formulation", "absolute",
             **goes_on),
        _run("run vsdf", "vsdf/spinup.vsdf", "spinup", "--set", "time.end=1", **goes_on),
        Command("run several decks", ("run", DECKS / "young/IN4-BAR.dat", DECKS / "young/IN2-6-1.dat",
                DECKS / "young/IN5BODY.dat"), tuple(f"OUT{n}" for n in ("4-BAR.dat", "4-BAR.h5", "2-6-1.dat",
                "2-6-1.h5", "5BODY.dat", "5BODY.h5"))),
    ]  # fmt: skip


def study(count: int) -> bytes:
    """A study of so many variants of the RSSR."""
    return STUDY.format(deck=DECKS / "young/IN-RSSR.dat", count=count).encode()


def others(results: dict[str, Command]) -> list[Command]:
    """Commands that write something else, from the results of `runs`."""
    young = results["run young"].whole["out/OUT4-BAR.h5"]
    table = results["run young"].whole["out/OUT4-BAR.dat"]
    tree = results.get("run dafms flexible", results["run young"]).whole
    tree = next(content for name, content in tree.items() if name.endswith(".h5"))
    changed = table.replace(b"0.919", b"0.918")
    inputs = {"y.h5": young, "d.h5": tree, "new.dat": table}
    answers = "".join(f"{line}\n" for line in ANSWERS).encode()
    diff = ("diff", "kept.dat", "new.dat", "--update")
    return [
        Command("sweep", ("sweep", "s.toml", "-q", "-o", "s.h5"), ("s.h5",), {"s.toml": study(60)},
                resumable=True),
        Command("sweep parquet", ("sweep", "s.toml", "-o", "s.parquet"), ("s.parquet",),
                {"s.toml": study(3)}, resumable=True),
        Command("plot", ("plot", "y.h5", "body.3.velocity", "-o", "p.svg"), ("p.svg",), inputs),
        Command("report", ("report", "y.h5", "-o", "r.html"), ("r.html",), inputs),
        *(Command(f"export {to}", ("export", "d.h5", "--to", to, "-o", f"e.{to}"), (f"e.{to}",), inputs)
          for to in ("vtkhdf", "csv", "mat")),
        Command("diff --update", diff, ("kept.dat",), inputs, old={"kept.dat": changed}),
        Command("new", ("new", "young", "-o", "IN-C.dat", "--force", "--draft"), ("IN-C.dat",),
                resumable=True, stdin=answers),
    ]  # fmt: skip


def readers(results: dict[str, Command]) -> list[Command]:
    """Commands that write to standard output only."""
    inputs = {"y.h5": results["run young"].whole["out/OUT4-BAR.h5"]}
    deck = DECKS / "dafms/fourbar_rigid.DAT"
    return [
        Command("table", ("table", "y.h5", "body.*.z"), inputs=inputs),
        Command("beam", ("beam", "--length", "1", "--nodes", "2", "--ei", "1000", "--rho", "5")),
        Command("check", ("check", deck)),
        Command("modes", ("modes", DECKS / "young/dynamics/IN-BRICARD.dat")),
        Command("verify", ("verify", deck, "--set", "time.IT=20")),
    ]


class Stage:
    """All commands with what they give undisturbed, by name; `writers` have outputs."""

    def __init__(self, folder: Path, wanted=()):
        made = {}
        wanted = wanted and {"run young", *wanted}  # whose results others read
        for make in (lambda: runs(), lambda: others(made), lambda: readers(made)):
            for command in make():
                if not wanted or command.name in wanted:
                    _load(command, folder / "loading" / command.name)
                    made[command.name] = undisturbed(command, folder / "whole" / command.name)
        self.commands = made

    @property
    def writers(self) -> list[Command]:
        """Commands with outputs."""
        return [command for command in self.commands.values() if command.outputs]

    @property
    def resumable(self) -> list[Command]:
        """Commands that go on where they were hit."""
        return [command for command in self.writers if command.resumable]

    def spread(self, commands, number: int) -> Command:
        """One of `commands`, each in its turn."""
        return next(itertools.islice(itertools.cycle(commands), number % len(commands), None))


def _load(command, folder):
    """Run `command` in this process, so that the forks find modules and kernels."""
    import contextlib
    import io
    import os
    import signal
    import sys

    from flexmb_cli.cli import cli
    from flexmb_cli.run.outcome import Stop

    folder.mkdir(parents=True)
    command.prepare(folder, with_old=False)
    before, here = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)], os.getcwd()
    stdin, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(command.stdin))
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            cli.main([str(word) for word in command.arguments], standalone_mode=False)
    except SystemExit:
        pass
    finally:
        os.chdir(here)
        sys.stdin, Stop.asked = stdin, None
        for number, handler in zip((signal.SIGINT, signal.SIGTERM), before, strict=True):
            signal.signal(number, handler)
