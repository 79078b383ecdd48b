"""Places where nothing can be written: folders of somebody else, folders in the way, missing ones."""

import os
from pathlib import Path

from .child import Hit
from .judge import faults_of_end, faults_of_files, faults_of_finish
from .stops import Verdict, _go_on

NOBODY = 65534


def read_only_folder(stage, chance, number, folder) -> Verdict:
    """A folder in which only others may write."""
    command = stage.spread(stage.writers, number)
    if os.geteuid() != 0:
        return Verdict(command.name, skipped="becoming another user needs root")
    before = command.prepare(folder, chance.random() < 0.5)
    _open_to_all(folder, 0o755, 0o644)
    ended = command.run(folder, Hit(begin=_become_nobody))
    found = faults_of_end(ended, {2}) + faults_of_files(command, folder, before, ended)
    found += _reported(ended, "permission denied")
    return Verdict(command.name, found)


def read_only_old(stage, chance, number, folder) -> Verdict:
    """Old outputs of somebody else in a folder in which everybody may write: they are replaced or kept."""
    command = stage.spread(stage.writers, number)
    if os.geteuid() != 0:
        return Verdict(command.name, skipped="becoming another user needs root")
    before = command.prepare(folder, with_old=True)
    _open_to_all(folder, 0o777, 0o600 if chance.random() < 0.5 else 0o644)
    for name in command.inputs:
        (folder / name).chmod(0o644)
    ended = command.run(folder, Hit(begin=_become_nobody))
    found = faults_of_end(ended, {0, 2}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def _open_to_all(folder, of_folders, of_files):
    for path in [folder, *folder.rglob("*")]:
        path.chmod(of_folders if path.is_dir() else of_files)


def _become_nobody():
    os.setgroups([])
    os.setresgid(NOBODY, NOBODY, NOBODY)
    os.setresuid(NOBODY, NOBODY, NOBODY)


def output_is_a_folder(stage, chance, number, folder) -> Verdict:
    """One of the outputs is a folder: refused before anything is solved, nothing else is touched."""
    command = stage.spread(stage.writers, number)
    before = command.prepare(folder, with_old=False)
    output = chance.choice(command.outputs)
    (folder / output).mkdir(parents=True)
    ended = command.run(folder, Hit())
    found = faults_of_end(ended, {2}) + faults_of_files(command, folder, before, ended)
    found += _reported(ended, "folder")
    (folder / output).rmdir()
    found += faults_of_finish(command, folder, before, _go_on(command, folder, Hit()))
    return Verdict(command.name, found)


def missing_folder(stage, chance, number, folder) -> Verdict:
    """The folder of the output does not exist (for `run` it is made), or is a file."""
    command = stage.spread([c for c in stage.writers if c.name != "run several decks"], number)
    before = command.prepare(folder, with_old=False)
    in_the_way = chance.random() < 0.5
    arguments = [_elsewhere(word, command) for word in command.arguments]
    if in_the_way:
        (folder / "none").write_bytes(b"a file\n")
        before["none"] = b"a file\n"
    ended = command.run_other(arguments, folder)
    makes = command.name.startswith("run") and not in_the_way
    found = faults_of_end(ended, {0} if makes else {2})
    if not makes:
        found += faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def _elsewhere(word, command):
    """Outputs in the folder none/below, which is not there."""
    if word == "out" or word in command.outputs:
        return f"none/below/{word}"
    return word


def failing_run_keeps_the_old(stage, chance, number, folder) -> Verdict:
    """A run that cannot begin leaves the results of the last one as they were."""
    command = stage.spread([c for c in stage.writers if c.name.startswith("run")], number)
    before = command.prepare(folder, with_old=True)
    change = chance.choice([("--set", "no.such.number=1"), ("--dialect", "young"), ("--dialect", "vsdf")])
    if change[1] in command.name or command.name == "run several decks":  # of YOUNG
        change = ("--set", "no.such.number=1")
    ended = command.run_other((*command.arguments, *change), folder)
    found = faults_of_end(ended, {2}) + faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def no_working_folder(stage, chance, number, folder) -> Verdict:
    """The folder in which the command is given has been removed."""
    command = stage.spread([c for c in stage.writers if not c.inputs], number)
    ended = command.run(folder, Hit(begin=lambda: Path(folder).rmdir()))
    folder.mkdir()
    return Verdict(command.name, faults_of_end(ended, {2}) + _reported(ended, "folder|no such file"))


def _reported(ended, words):
    import re

    return [] if re.search(words, ended.stderr) else [f"no word of {words!r}: {ended.stderr[-300:]!r}"]
