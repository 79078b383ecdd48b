"""Files that were changed or damaged: decks and options under --resume, journals, results."""

from . import trip as trips
from .child import Hit
from .judge import faults_of_end, faults_of_files, faults_of_finish
from .stops import Verdict, _go_on
from .trip import Trip

OPTIONS = (("--rtol", "1e-7"), ("--atol", "1e-7"), ("--set", "gravity.1=1.0"), ("--method", "radau"))


def other_run_resumed(stage, chance, number, folder) -> Verdict:
    """--resume with another deck, other options or of another version: refused, and the journal stays."""
    command = _trees(stage, number)
    before = command.prepare(folder, with_old=False)
    resume_file = _stopped(command, folder, chance)
    if resume_file is None:
        return Verdict(command.name, skipped="the run was over")
    kept, options = resume_file.read_bytes(), ()
    deck = folder / next(iter(command.inputs))
    way = number // 2 % 6
    if way == 0:
        deck.write_bytes(deck.read_bytes() + b" ")
    elif way == 1:
        resume_file.write_bytes(kept.replace(b'{"flexmb": "', b'{"flexmb": "9.', 1))
        kept = resume_file.read_bytes()
    else:
        options = OPTIONS[way - 2]
    ended = command.run_other((*command.arguments, "--resume", *options), folder)
    found = faults_of_end(ended, {2})
    if resume_file.read_bytes() != kept:
        found.append("the journal was changed")
    deck.write_bytes(command.inputs[deck.name])
    resume_file.write_bytes(kept.replace(b'{"flexmb": "9.', b'{"flexmb": "', 1))
    found += faults_of_finish(command, folder, before, _go_on(command, folder, Hit()))
    return Verdict(command.name, found, not found)


def damaged_resume_file(stage, chance, number, folder) -> Verdict:
    """A journal cut, zeroed or garbled: the run goes on from what is whole, or says that it cannot."""
    command = _trees(stage, number)
    before = command.prepare(folder, with_old=False)
    resume_file = _stopped(command, folder, chance)
    if resume_file is None:
        return Verdict(command.name, skipped="the run was over")
    content = resume_file.read_bytes()
    damaged = _damaged(chance, content, content.index(b"\n"), number // 2)
    resume_file.write_bytes(damaged)
    ended = _go_on(command, folder, Hit())
    found = faults_of_end(ended, {0, 2})
    if ended.code == 2:
        found += [] if ".resume" in ended.stderr else ["refused without naming the journal"]
        found += [] if resume_file.read_bytes() == damaged else ["refused, but the journal was changed"]
        resume_file.unlink()
        ended = _go_on(command, folder, Hit())
    elif damaged != content and resume_file.name not in ended.stderr:
        found.append("a damaged journal without a word")
    found += faults_of_finish(command, folder, before, ended)
    return Verdict(command.name, found, not found)


def _trees(stage, number):
    return stage.spread([c for c in stage.resumable if c.name.startswith("run")], number)


def _stopped(command, folder, chance):
    """The journal of a run that was killed; None when none was left."""
    trip = Trip(str(folder), chance.randint(command.deeds // 2, command.deeds))
    command.run(folder, Hit(trip=trip))
    for path in folder.rglob(".flexmb-*.tmp"):
        path.unlink()
    for output in command.outputs:
        (folder / output).unlink(missing_ok=True)
    return next(folder.rglob("*.resume"), None)


def _damaged(chance, content, first_line, way):
    """`content` cut in its first line, at its end, between or within entries; garbled; with a huge length."""
    if way % 8 == 0:
        return content[: chance.randint(0, first_line)]
    if way % 8 == 1:
        return content[: first_line + 1 + chance.randint(0, 12)]
    if way % 8 in (2, 3):
        return content[: chance.randint(first_line + 13, len(content) - 1)]
    at = chance.randrange(len(content))
    if way % 8 == 4:
        return content[:at] + bytes(len(content) - at)
    if way % 8 == 5:
        return content + chance.randbytes(chance.randint(1, 5000))
    if way % 8 == 6:
        huge = chance.choice((2**31, 2**40, 2**62, 2**64 - 1)).to_bytes(8, "little")
        return content[: first_line + 1] + huge + content[first_line + 9 :]
    return _flipped(chance, content)


def _flipped(chance, content):
    damaged = bytearray(content)
    for _ in range(chance.choice((1, 1, 5, 50))):
        damaged[chance.randrange(len(damaged))] ^= chance.randrange(1, 256)
    return bytes(damaged)


def changed_study(stage, chance, number, folder) -> Verdict:
    """A stopped study whose file was changed is refused; as it was it goes on."""
    command = stage.commands["sweep"]
    before = command.prepare(folder, with_old=False)
    trip = Trip(str(folder), chance.randint(8, command.deeds - 8))
    command.run(folder, Hit(trip=trip))
    study = folder / "s.toml"
    if not (folder / "s.h5.parts/study.json").exists():
        return Verdict(command.name, skipped="nothing was left, or all was done")
    study.write_bytes(before["s.toml"].replace(b"100.0", b"101.0"))
    ended = command.run(folder)
    found = faults_of_end(ended, {2})
    study.write_bytes(before["s.toml"])
    found += faults_of_finish(command, folder, before, command.finish(folder))
    return Verdict(command.name, found, not found)


def damaged_parts(stage, chance, number, folder) -> Verdict:
    """Cases of a stopped study cut or garbled: they are solved again."""
    command = stage.commands["sweep"]
    before = command.prepare(folder, with_old=False)
    command.run(folder, Hit(trip=Trip(str(folder), chance.randint(command.deeds // 2, command.deeds - 8))))
    parts = sorted(folder.rglob("*.part"))
    if not parts:
        return Verdict(command.name, skipped="no case was kept")
    for part in chance.sample(parts, min(len(parts), 3)):
        content = part.read_bytes()
        cut = content[: chance.randint(0, len(content))]
        part.write_bytes(_flipped(chance, content) if content and chance.random() < 0.5 else cut)
    found = faults_of_finish(command, folder, before, command.finish(folder))
    return Verdict(command.name, found, not found)


def damaged_result(stage, chance, number, folder) -> Verdict:
    """A result cut or garbled, for all that read results: read as far as it goes, or refused in words."""
    commands = [c for c in stage.commands.values() if any(name.endswith(".h5") for name in c.inputs)]
    command = stage.spread(commands, number)
    before = command.prepare(folder, chance.random() < 0.5)
    if command.name == "diff --update":
        return _damaged_diff(command, chance, folder)
    name = next(word for word in command.arguments if str(word) in command.inputs)
    content = command.inputs[name]
    cut = number // len(commands) % 3 < 2
    damaged = content[: chance.randrange(len(content))] if cut else _flipped(chance, content)
    before[name] = damaged
    (folder / name).write_bytes(damaged)
    ended = command.run(folder)
    found = faults_of_end(ended, {2} if cut else {0, 2})
    if ended.code == 2:
        found += faults_of_files(command, folder, before, ended)
    return Verdict(command.name, found)


def _damaged_diff(command, chance, folder):
    """A cut table never becomes the reference when it cannot be read; one that can is what was asked for."""
    result = folder / "y.h5"
    content = result.read_bytes()
    (folder / "kept.h5").write_bytes(content)
    result.write_bytes(content[: chance.randrange(len(content))])
    ended = command.run_other(("diff", "kept.h5", "y.h5", "--update"), folder)
    found = faults_of_end(ended, {2})
    found += [] if (folder / "kept.h5").read_bytes() == content else ["the reference was lost"]
    return Verdict(command.name, found)


def broken_draft(stage, chance, number, folder) -> Verdict:
    """The draft of a dialogue, cut anywhere, is gone on with or refused, and stays."""
    command = stage.commands["new"]
    before = command.prepare(folder, with_old=False)
    command.run(
        folder, Hit(trip=Trip(str(folder), chance.randint(command.deeds // 2, command.deeds - 6), trips.KILL))
    )
    for path in folder.glob(".flexmb-*.tmp"):
        path.unlink()
    draft = folder / "IN-C.dat.draft"
    content = draft.read_bytes()
    draft.write_bytes(content[: chance.randrange(len(content))])
    kept = draft.read_bytes()
    ended = command.run(folder, Hit(stdin=b"\n"))
    found = faults_of_end(ended, {2})
    found += [] if draft.read_bytes() == kept else ["the draft was changed"]
    ended = command.run_other((*command.arguments, "--restart"), folder)
    return Verdict(command.name, found + faults_of_finish(command, folder, before, ended))
