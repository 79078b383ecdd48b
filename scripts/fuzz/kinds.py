"""The kinds of input that flexmb reads: seeds of each, how it is damaged, and the command that gets it."""

import json
import os
import random
import shutil
import traceback
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import fe_seeds
from answer import Answer, answered
from damage import NUMBERS, WORDS, damaged_bytes, damaged_text
from hdf5_damage import damage_structure

from flexmb_cli.errors import BAD_INPUT, DONE, FlexmbError, compiler_style
from flexmb_cli.read.dialects import read_deck
from flexmb_cli.read.text import decode

TOP = Path(__file__).parents[2]
DECKS = TOP / "decks"


@dataclass(frozen=True)
class Kind:
    """`seeds` fills a folder once; `attempt` damages files in `work`, a fresh folder, and answers."""

    name: str
    seeds: Callable[[Path], None]
    attempt: Callable[[random.Random, Path, Path], Answer]


def _nothing(folder: Path) -> None:
    pass


def _decks(*dialects):
    found = [path for name in dialects for path in sorted((DECKS / name).rglob("*"))]
    return [path for path in found if path.suffix.lower() in (".dat", ".vsdf")]


# Decks, read and built in this process without a command: a thousand a second.


def _deck_read(dialect, chance, seeds, work):
    decks = _decks(dialect)
    path = chance.choice(decks)
    other = chance.choice(decks if chance.random() < 0.8 else _decks("young", "dafms", "vsdf"))
    raw = damaged_text(chance, path.read_bytes(), other.read_bytes())
    (work / path.name).write_bytes(raw)
    return _built(path.name, raw, path.parent)


def _built(name, raw, folder) -> Answer:
    """Read, build and list a deck."""
    from flexmb_cli.write.echo import echo

    lines, faults, told = [], (), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            source = decode(name, raw)
            lines = source.lines
            deck = read_deck(source)
            told = echo(deck)
            faults = (*deck.warnings, *_model(deck, folder))
    except FlexmbError as refused:
        return Answer(refused.exit_code, told, "", _unfit(name, refused.faults, lines))
    except Exception:
        return Answer(None, told, "", traceback.format_exc())
    return Answer(DONE, told, "", _unfit(name, faults, lines))


def _model(deck, folder):
    """The doubts of the model that a deck describes."""
    name = f"build_{deck.dialect}"
    build = getattr(import_module(f"flexmb_cli.model.{name}"), name)
    return build(deck, folder)[1] if deck.dialect == "vsdf" else build(deck)[1]


def _unfit(name, faults, lines):
    """What is wrong with faults as they are shown: each is a sentence without unprintable characters."""
    for line in compiler_style(name, faults, lines).split("\n"):
        if not all(char.isprintable() or char == "\t" for char in line):
            return f"unprintable character in {line!r}"
        if "Traceback" in line or "None" in line.partition("; read")[0]:
            return f"no sentence: {line!r}"
    return ""


# Commands.


def _check(chance, seeds, work):
    decks = _decks("young", "dafms")
    path = chance.choice(decks)
    raw = damaged_text(chance, path.read_bytes(), chance.choice(decks).read_bytes())
    (work / path.name).write_bytes(raw)
    options = chance.choice(([], ["--json"], ["--jacobian", "estimate"]))
    return answered(["check", str(work / path.name), *options])


def _fe(chance, seeds, work):
    deck = chance.choice(sorted(seeds.glob("*.vsdf")))
    files = json.loads((seeds / "files.json").read_text())
    victim = chance.choice([*files[deck.name], deck.name] if chance.random() < 0.1 else files[deck.name])
    for name in (deck.name, *files[deck.name]):
        if name != victim:
            os.link(seeds / name, work / name)
    raw = (seeds / victim).read_bytes()
    other = (seeds / chance.choice(sorted({n for names in files.values() for n in names}))).read_bytes()
    damaged = damaged_bytes if victim.endswith(".bin") else damaged_text
    (work / victim).write_bytes(damaged(chance, raw, other))
    return answered(["modes", str(work / deck.name), *chance.choice(([], ["--json"]))])


def _fe_seeds(folder):
    (folder / "files.json").write_text(json.dumps(fe_seeds.write_seeds(folder)))


def _result_seeds(folder):
    """Results and listings of all dialects, some twenty rows each, and one that a failure cut short."""
    fe_seeds.write_seeds(folder)
    dafms = (DECKS / "dafms" / "shaft_beam_n2.DAT").read_text().splitlines()
    steps = next(k for k, line in enumerate(dafms) if line.strip().isdigit() and int(line) > 100)
    dafms[steps] = f"{20:5d}"
    (folder / "beam.DAT").write_text("\n".join(dafms) + "\n")
    shutil.copy(DECKS / "young" / "IN2-4-1.dat", folder / "IN2-4-1.dat")
    shutil.copy(DECKS / "young" / "IN4-BAR.dat", folder / "IN4-BAR.dat")
    decks = [str(folder / name) for name in ("beam.DAT", "IN2-4-1.dat", "IN4-BAR.dat", "mm.vsdf")]
    done = answered(["run", *decks, "-o", str(folder)])
    _study_seeds(folder)
    answered(["sweep", str(folder / "grid.toml"), "-o", str(folder / "study.h5")])
    assert done.code == DONE, done.errors
    assert len(list(folder.glob("*.h5"))) == len(decks) + 1, done.errors


def _hdf5_bytes(chance, seeds, work):
    results = sorted(seeds.glob("*.h5"))
    path = chance.choice(results)
    raw = damaged_bytes(chance, path.read_bytes(), chance.choice(results).read_bytes())
    (work / "r.h5").write_bytes(raw)
    return _shown(chance, path, work)


def _hdf5_structure(chance, seeds, work):
    path = chance.choice(sorted(seeds.glob("*.h5")))
    shutil.copy(path, work / "r.h5")
    shutil.copy(path, work / "other.h5")
    damage_structure(chance, work / "r.h5")
    return _shown(chance, path, work)


def _shown(chance, intact, work):
    """A command on the damaged result in `work`."""
    result = str(work / "r.h5")
    commands = [
        *4 * [["table", result, "--list"]],
        *4
        * [["table", result, "body", "energy", "coordinate", "-f", chance.choice(("csv", "jsonl", "text"))]],
        *2 * [["table", result, "*"]],
        *2 * [["table", result, "time", "--from", "0.01", "--to", "0.02"]],
        *3 * [["diff", result, str(intact)]],
        *3 * [["diff", str(intact), result, "--same-attitude", "--json"]],
        *[["export", result, "--to", form, "-o", str(work / "x")] for form in ("csv", "vtkhdf", "mat")],
        ["report", result, "-o", str(work / "x.html")],
    ]
    if chance.random() < 0.05:
        commands = [["plot", result, "-o", str(work / "x.svg")]]
    return answered(chance.choice(commands))


def _listing(chance, seeds, work):
    names = [path for path in sorted(seeds.iterdir()) if path.suffix in (".OUT", ".T2", ".T3")]
    names += sorted(seeds.glob("OUT*.dat"))
    path = chance.choice(names)
    (work / "x").write_bytes(damaged_text(chance, path.read_bytes(), chance.choice(names).read_bytes()))
    pair = [str(work / "x"), str(path)]
    options = chance.choice(([], ["--json"], ["--explain"], ["--same-attitude"], ["--last-digit", "1"]))
    return answered(["diff", *(pair if chance.random() < 0.5 else pair[::-1]), *options])


STUDY = """\
deck = "IN1-3-1.dat"
dialect = "auto"
sampling = "grid"

[parameters]
"driver.1.B" = { from = 1.0, to = 2.0, count = 2, scale = "linear" }
"body.1.x" = [0.0, 0.5]

[results]
top = "max body.1.z"
path = "series body.1.x"
"""
SAMPLE = """\
deck = "IN1-3-1.dat"
sampling = "latin-hypercube"
count = 3
seed = 7
[parameters]
"driver.1.B" = { from = 1.0, to = 2.0, scale = "log" }
[results]
top = "mean body.1.z"
"""


def _study_seeds(folder):
    shutil.copy(DECKS / "young" / "IN1-3-1.dat", folder)
    (folder / "grid.toml").write_text(STUDY)
    (folder / "sample.toml").write_text(SAMPLE)
    shutil.copy(DECKS / "studies" / "rssr.toml", folder / "rssr.toml")


def _study(chance, seeds, work):
    """A study is prepared: read, its deck built, its names looked up."""
    from flexmb_cli.run.sweep import Sweep

    path = _damaged_study(chance, seeds, work)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            Sweep.of(str(path), str(work / "parts"))
    except FlexmbError as refused:
        return Answer(refused.exit_code, "", "", _unfit("x.toml", refused.faults, ()))
    except Exception:
        return Answer(None, "", "", traceback.format_exc())
    return Answer(DONE, "", "")


def _damaged_study(chance, seeds, work):
    studies = sorted(seeds.glob("*.toml"))
    raw = damaged_text(chance, chance.choice(studies).read_bytes(), chance.choice(studies).read_bytes())
    os.link(seeds / "IN1-3-1.dat", work / "IN1-3-1.dat")
    (work / "x.toml").write_bytes(raw)
    return work / "x.toml"


def _study_parts(chance, seeds, work):
    """A stopped study goes on from damaged parts."""
    for name in ("grid.toml", "IN1-3-1.dat"):
        os.link(seeds / name, work / name)
    arguments = ["sweep", str(work / "grid.toml"), "-o", str(work / "x.h5")]
    if not (seeds / "parts").exists():
        _leave_parts(seeds, arguments, work)
    shutil.copytree(seeds / "parts", work / "x.h5.parts", dirs_exist_ok=True)
    victim = chance.choice(sorted((work / "x.h5.parts").iterdir()))
    raw = victim.read_bytes()
    victim.write_bytes(damaged_bytes(chance, raw, raw))
    return answered(arguments)


def _leave_parts(seeds, arguments, work):
    from flexmb_cli.run.sweep import Sweep, solve_block

    made = Sweep.of(arguments[1], str(work / "first"))
    for block in made.pending():
        solve_block(made.job, block)
    shutil.copytree(work / "first", seeds / "parts")


DRAFTS = {"young": 40, "dafms": 40, "vsdf": 40}


def _draft_seeds(folder):
    """Drafts as far as answers of 1 and of Enter lead."""
    for dialect, count in DRAFTS.items():
        work = folder / dialect
        work.mkdir()
        for k, answer in enumerate((b"1", b"", b"1 1", b"0")):
            typed = b"a title\n" + b"\n".join([answer] * count)
            answered(["new", dialect, "-o", str(work / f"{k}.dat")], typed + b"\n!\n")
    assert list(folder.rglob("*.draft"))


def _draft(chance, seeds, work):
    drafts = sorted(seeds.rglob("*.draft"))
    path = chance.choice(drafts)
    raw = damaged_text(chance, path.read_bytes(), chance.choice(drafts).read_bytes())
    (work / "x.dat.draft").write_bytes(raw)
    answers = [
        chance.choice((*NUMBERS, *WORDS, "", "1", "1 2 3", "?", "<", ">", "< driver.1")) for _ in range(4)
    ]
    typed = "\n".join(answers).encode("utf-8", "surrogatepass")
    return answered(["new", path.parent.name, "-o", str(work / "x.dat")], typed)


def _resume_seeds(folder):
    """The journal of a run of some rows, kept as a kill would leave it."""
    from flexmb_cli.run.checkpoint import Journal

    fe = (DECKS / "dafms" / "sliding_mass.DAT").read_text().splitlines()
    (folder / "x.DAT").write_text("\n".join(fe) + "\n")
    keep, Journal.remove = Journal.remove, Journal.close
    try:
        done = answered(["run", str(folder / "x.DAT"), "-o", str(folder)])
    finally:
        Journal.remove = keep
    assert done.code == DONE and (folder / "x.resume").exists(), done.errors


def _resume(chance, seeds, work):
    """`run --resume` on a damaged journal: refused, or the bytes of a run that was not stopped."""
    os.link(seeds / "x.DAT", work / "x.DAT")
    raw = (seeds / "x.resume").read_bytes()
    (work / "x.resume").write_bytes(damaged_bytes(chance, raw, raw))
    answer = answered(["run", str(work / "x.DAT"), "--resume", "-o", str(work)])
    same = answer.code == BAD_INPUT or all(
        (work / name).read_bytes() == (seeds / name).read_bytes() for name in ("x.h5", "x.T2", "x.OUT")
    )
    fault = answer.fault or ("" if same else "other bytes than those of a run that was not stopped")
    return Answer(answer.code, answer.output, answer.errors, fault)


def _cache_seeds(folder):
    fe_seeds.write_seeds(folder)
    os.environ["FLEXMB_CACHE_DIR"] = str(folder / "cache")
    try:
        answered(["modes", str(folder / "mm.vsdf")])
    finally:
        del os.environ["FLEXMB_CACHE_DIR"]
    assert len(list((folder / "cache").rglob("*.npz"))) == 1


def _cache(chance, seeds, work):
    """A damaged cache of a flexible body changes nothing."""
    shutil.copytree(seeds / "cache", work / "cache")
    (victim,) = (work / "cache").rglob("*.npz")
    raw = victim.read_bytes()
    victim.write_bytes(
        _changed_arrays(chance, raw) if chance.random() < 0.5 else damaged_bytes(chance, raw, raw)
    )
    arguments = ["modes", str(seeds / "mm.vsdf")]
    wanted = answered(arguments)
    os.environ["FLEXMB_CACHE_DIR"] = str(work / "cache")
    try:
        found = answered(arguments)
    finally:
        del os.environ["FLEXMB_CACHE_DIR"]
    same = (found.code, found.output, found.errors) == (wanted.code, wanted.output, wanted.errors)
    fault = found.fault or ("" if same else "the answer differs from that without a cache")
    return Answer(found.code, found.output, found.errors, fault)


def _changed_arrays(chance, raw):
    """The archive with one array missing, of another shape, type or value."""
    import io

    import numpy as np

    with np.load(io.BytesIO(raw)) as stored:
        arrays = {name: stored[name] for name in stored.files}
    name = chance.choice(sorted(arrays))
    change = chance.randrange(6)
    if change == 0:
        del arrays[name]
    elif change == 1:
        arrays[name] = arrays[name].reshape(-1)[:-1]
    elif change == 2:
        arrays[name] = arrays[name].astype(str)
    elif change == 3:
        arrays[name] = np.zeros((2, 2, 2))
    elif change == 4 and arrays[name].dtype.kind == "f":
        arrays[name] = arrays[name] * np.nan
    else:
        arrays["notes"] = np.array(
            chance.choice(("{", "[]", "{}", '{"warnings": [["x", "y"]], "dropped": {}}'))
        )
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def _names(chance, seeds, work):
    """Names and values given as arguments: --set, patterns of quantities, tolerances."""
    word = chance.choice(
        (*NUMBERS, *WORDS, "body", "driver", "1", "x", "omega", "B", "*", "?", "[a-", "[!", ".", "=")
    )
    words = [
        word if chance.random() < 0.5 else chance.choice(("body", "1", "driver", "x", "B", "*"))
        for _ in "abc"
    ]
    text = chance.choice((".", "=", ",", "")).join(words).replace("\0", "")[:2000]
    result = str(seeds / "OUT4-BAR.h5")
    table = str(seeds / "OUT4-BAR.dat")
    return answered(
        chance.choice(
            (
                ["table", result, "--", text],
                ["table", result, "--list", "--", text],
                ["check", str(seeds / "IN4-BAR.dat"), "--set", text],
                ["check", str(seeds / "IN4-BAR.dat"), "--set", f"driver.1.B={text}"],
                ["diff", table, table, "--tol", text],
                ["diff", table, table, "--atol", text],
                ["check", str(seeds / "IN4-BAR.dat"), "--jacobian", text],
            )
        )
    )


def kinds() -> Iterator[Kind]:
    """All kinds, the quick ones first."""
    for dialect in ("young", "dafms", "vsdf"):
        yield Kind(f"{dialect}-deck", _nothing, lambda *a, dialect=dialect: _deck_read(dialect, *a))
    yield Kind("study", _study_seeds, _study)
    yield Kind("finite-element-file", _fe_seeds, _fe)
    yield Kind("listing", _result_seeds, _listing)
    yield Kind("hdf5-bytes", _result_seeds, _hdf5_bytes)
    yield Kind("hdf5-structure", _result_seeds, _hdf5_structure)
    yield Kind("argument", _result_seeds, _names)
    yield Kind("checked-deck", _nothing, _check)
    yield Kind("draft", _draft_seeds, _draft)
    yield Kind("body-cache", _cache_seeds, _cache)
    yield Kind("study-parts", _study_seeds, _study_parts)
    yield Kind("journal", _resume_seeds, _resume)


KINDS = {kind.name: kind for kind in kinds()}
