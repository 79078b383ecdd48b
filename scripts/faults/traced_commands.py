"""The commands whose system calls are followed, also those that go on with what was stopped."""

import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from . import trip as trips
from .child import Hit
from .stage import Command, Stage, study, undisturbed
from .trip import Trip

WANTED = ("run young", "run dafms", "run vsdf", "sweep")


def traced_commands(stage: Stage, top: Path, wanted) -> Iterator[tuple[Command, bool]]:
    """(command, whether there are old outputs); small ones, for each call is tried."""
    for name in WANTED:
        if wanted and name not in wanted:
            continue
        command = _small_study(stage, top) if name == "sweep" else stage.commands[name]
        yield command, False
        yield command, True
        if command.resumable:
            yield _stopped(command, top), False


def _small_study(stage, top):
    command = replace(stage.commands["sweep"], inputs={"s.toml": study(6)})
    return undisturbed(command, top / "whole" / "small sweep")


def _stopped(command, top):
    """`command` as it goes on with what a stopped one has left."""
    kept = next(filter(None, (_left_by_stop(command, top, share) for share in (2, 3, 4, 6, 8))), None)
    if kept is None:
        raise SystemExit(f"{command.name}: cannot be stopped so that there is something to go on with")
    return replace(command, name=f"{command.name}, stopped", inputs=command.inputs | kept,
                   arguments=(*command.arguments, *command.again), again=())  # fmt: skip


def _left_by_stop(command, top, share):
    """What SIGTERM at a part of the deeds leaves to go on with."""
    folder = top / f"stopped {command.name} {share}"
    folder.mkdir()
    command.prepare(folder, with_old=False)
    trip = Trip(str(folder), command.deeds // share, trips.STOP, signal.SIGTERM)
    command.run(folder, Hit(trip=trip))
    left = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return {name: content for name, content in left.items() if is_left_by_stop(name)}


def is_left_by_stop(name: str) -> bool:
    """Whether a file is what a stopped command keeps to go on with."""
    return name.endswith(".resume") or ".parts/" in name


def prepared(command: Command, folder: Path, with_old: bool) -> dict[str, bytes]:
    """A fresh `folder` with what the command needs; the files in it."""
    folder.mkdir(parents=True)
    return command.prepare(folder, with_old)
