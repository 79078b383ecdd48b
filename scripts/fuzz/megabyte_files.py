"""Files of a megabyte that are made to take long: one filling many times, and large ones in good order."""

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import fe_seeds
import h5py
import numpy as np

SIZE = 10**6
HEADS = {
    "young": "2 1 1 1 0 0 0 0 0 2 0 1\n",
    "dafms": "    1    2\nDFMB TITLE\n    1    0    0    0    0\n",
    "vsdf": "VSDF TITLE\nBODY\n    1 RIGD\nTABL\n",
    "study": 'deck = "x"\n[parameters]\n"a" = ',
    "listing": "TIME= 0.000\n-----\nPOSITION\nBODY       X         Y         Z         e0\n",
}
FILLINGS = {
    "one line": "1 ",
    "digits": "9",
    "blank lines": "\n",
    "the same card": "    1       1.0       1.0\n",
    "repeat counts": "999999*1.0\n",
    "open braces": "{",
    "open brackets": "[",
    "braces in pairs": "{}",
    "letters": "a",
    "bad words": "x\n",
}
BODY, TIME = "0 0 0 1 0 0 0\n", "0 1 1\n"
FE_FILLINGS = ("one line", "digits", "blank lines", "the same card", "bad words")
COMMANDS = {"study": "sweep", "listing": "diff"}


@dataclass(frozen=True)
class Case:
    """`prepare` writes the files into a folder: arguments of flexmb, and what is typed."""

    kind: str
    filling: str
    prepare: Callable[[Path], tuple[list[str], bytes]]


def cases(seeds: Path) -> Iterator[Case]:
    """All of them; `seeds` holds the folders bricks, drafts and journal."""
    for kind, head in HEADS.items():
        for name, filling in FILLINGS.items():
            yield _text(kind, name, head + _filled(filling))
    for kind, name, text in chain(_in_good_order(), _whole_mechanisms()):
        yield _text(kind, name, text)
    yield from _bricks(seeds / "bricks")
    yield from _results(seeds / "journal")
    yield from _drafts(seeds / "drafts")
    yield from _resume_files(seeds / "journal")


def _filled(filling):
    return filling * (SIZE // len(filling))


def _text(kind, filling, text):
    def prepare(work):
        path = str(work / "x.dat")
        Path(path).write_text(text)
        options = [] if kind in COMMANDS else ["--dialect", kind]
        return [COMMANDS.get(kind, "check"), path, *([path] if kind == "listing" else options)], b""

    return Case(kind, filling, prepare)


def _whole_mechanisms():
    """YOUNG decks that end where they should: bodies and constraints as many as a megabyte holds."""
    n = SIZE // 31
    grounds = "".join(f"{k} 0 0 0 0 0 0\n" for k in range(1, n + 1))
    grounded = f"{n} 0 0 0 0 0 0 0 0 0 0 {n}\n{n * BODY}{grounds}{TIME}"
    yield "young", "grounded bodies", grounded
    yield "young", "grounded bodies in a line", grounded.replace("\n", " ")
    held = (SIZE // 8) * "1 1 0\n"
    yield "young", "simplified", f"2 0 0 0 0 0 0 0 0 {SIZE // 8} 0 0\n{2 * BODY}{held}{TIME}"
    held = (SIZE // 9) * "1 2 1 0\n"
    yield "young", "distances", f"2 0 0 0 0 0 0 0 0 0 {SIZE // 9} 0\n{2 * BODY}{held}{TIME}"
    moved = (SIZE // 11) * "1 1 0 0 0\n"
    yield "young", "drivers", f"2 {SIZE // 11} 0 0 0 0 0 0 0 0 0 0\n{2 * BODY}{moved}{TIME}"


def _in_good_order():
    """Cards and names by the ten thousand, each in its place."""
    n = 20_000
    bodies = "".join(f"{k}.0 0 0 1 0 0 0\n" for k in range(n))
    yield "young", "bodies", f"{n} 1 0 0 0 0 0 0 0 0 0 0\n{bodies}1 0 0 0\n0 1 0.1\n"
    joints = "".join(f"1 2 0 0 {k} 0 0 0 0\n" for k in range(n))
    yield "young", "joints", f"2 1 0 {n} 0 0 0 0 0 0 0 0\n0 0 0 1 0 0 0\n1 0 0 1 0 0 0\n{joints}1 0 0 0\n"
    masses = "".join(f"MASS {k} 1 0 0 0 1 1 1\n" for k in range(n))
    yield "young", "masses", f"2 1 0 0 0 0 0 0 0 0 0 0\n{2 * '0 0 0 1 0 0 0' + chr(10)}\nDYNAMICS\n{masses}"
    chain = "".join(f"{k:5d}{k - 1:5d}    0    1    0\n" for k in range(1, n))
    yield "dafms", "bodies", f"{n:5d}    2\nDFMB T\n{chain}"
    cards = "".join(f"{k:5d} RIGD       1.0       1.0       1.0       1.0\n" for k in range(n))
    yield "vsdf", "bodies", f"VSDF T\nBODY\n{cards}END\nSTAR\nSTOP\n"
    cards = "".join(f"{k:5d} REVO    0    0    0{k:5d}    1    5\n" for k in range(n))
    yield "vsdf", "joints", f"VSDF T\nBODY\n    1 RIGD\nJOIN\n{cards}END\nSTAR\nSTOP\n"
    points = "".join(f"    1{k * 1e-3:10.3f}{k % 7:10.1f}\n" for k in range(40_000))
    yield "vsdf", "points of a table", f"VSDF T\nBODY\n    1 RIGD\nTABL\n{points}END\nSTAR\nSTOP\n"
    head = 'deck = "x"\n[parameters]\n'
    yield "study", "parameters", head + "".join(f'"body.{k}.x" = [1, 2]\n' for k in range(2 * n))
    yield "study", "parameters that are wrong", head + "".join(f'"body.{k}.x" = "a"\n' for k in range(2 * n))
    yield "study", "unknown keys", "".join(f"key{k} = 1\n" for k in range(3 * n)) + head + "a = [1]\n"
    yield (
        "study",
        "results",
        head + '"a" = [1]\n[results]\n' + "".join(f'n{k} = "max b.{k}"\n' for k in range(2 * n)),
    )
    yield "study", "dotted keys", head + ".".join("a" for _ in range(SIZE // 2)) + " = 1\n"
    yield "study", "values", head + '"a" = [' + "1.5," * (SIZE // 4) + "]\n[results]\nx = 'max y'\n"
    rows = "".join(f"{k:5d}   1.00000   0.00000   0.00000   1.00000\n" for k in range(n))
    yield "listing", "bodies", HEADS["listing"] + rows
    yield "listing", "times", HEADS["listing"].join("" for _ in range(SIZE // 80))
    yield "listing", "rows of a series", "".join(f"{k * 1e-3:12.7f}{k:15.6E}\n" for k in range(35_000))


def _bricks(seeds):
    """Each file of each brick, with its last lines again and again, or with something else behind them."""
    files = fe_seeds.files_of_decks()
    for deck, names in files.items():
        for victim in names:
            raw = (seeds / victim).read_bytes()
            last = b"\n".join(raw.split(b"\n")[-2:]) if not victim.endswith(".bin") else raw[-64:]
            behind = {"its last line": last} | {name: FILLINGS[name].encode() for name in FE_FILLINGS}
            for name, filling in behind.items():
                content = raw + filling * ((SIZE - len(raw)) // len(filling))
                yield Case(victim, name, _brick(seeds, deck, names, {victim: content}))
    for name, changed in _large_bodies():
        yield Case("mm", name, _brick(seeds, "mm.vsdf", files["mm.vsdf"], changed))


def _brick(seeds, deck, names, changed):
    def prepare(work):
        for name in (deck, *names):
            (work / name).unlink(missing_ok=True)
            if name in changed:
                (work / name).write_bytes(changed[name])
            else:
                os.link(seeds / name, work / name)
        return ["modes", str(work / deck)], b""

    return prepare


def _large_bodies():
    """Bodies of many nodes: one whose points hold to the ground only, one whose matrices are full."""
    n = 7000
    nodes = "".join(f"{k} {k} {k % 7} {k % 5}\n" for k in range(1, n + 1))
    head = "%%MatrixMarket matrix coordinate real symmetric\n"
    diagonal = head + f"{3 * n} {3 * n} {3 * n}\n" + "".join(f"{k} {k} 1.5\n" for k in range(1, 3 * n + 1))
    yield "loose points", {"n.txt": nodes.encode(), "m.mtx": diagonal.encode(), "k.mtx": diagonal.encode()}
    zero = head + f"{3 * n} {3 * n} {3 * n}\n" + "".join(f"{k} {k} 0.0\n" for k in range(1, 3 * n + 1))
    yield "no stiffness", {"n.txt": nodes.encode(), "m.mtx": diagonal.encode(), "k.mtx": zero.encode()}
    n = 80
    nodes = "".join(f"{k} {k} {k % 7} {k % 5}\n" for k in range(1, n + 1))
    chance = np.random.default_rng(1)
    root = chance.standard_normal((3 * n, 3 * n))
    text = "%%MatrixMarket matrix array real general\n" + f"{3 * n} {3 * n}\n"
    full = (text + "".join(f"{v:.8e}\n" for v in (root @ root.T).ravel())).encode()
    yield "full matrices", {"n.txt": nodes.encode(), "m.mtx": full, "k.mtx": full}


def _results(seeds):
    """A result with far more of something than flexmb writes."""
    # A packed megabyte is a milliard of zeros.
    packed = {"compression": "gzip", "compression_opts": 9, "shuffle": True, "dtype": "f8"}

    def many(file):
        for k in range(3000):
            file[f"body/more {k}"] = float(k)

    def names(file):
        del file["body/name"]
        file["body/name"] = [f"body {k}" for k in range(30_000)]

    def deck(file):
        del file["deck"]
        file["deck"] = "x" * SIZE

    def attributes(file):
        file.attrs["comment"] = "x" * 60_000
        for k in range(15):
            file["time"].attrs[f"a{k}"] = "x" * 60_000

    def zeros(file):
        del file["time"]
        file.create_dataset("time", data=np.zeros(10**7), chunks=(10**5,), **packed)

    def chunk(file):
        del file["time"]
        file.create_dataset("time", shape=(5,), maxshape=(None,), chunks=(2**25,), **packed)[...] = 1.0

    def declared(file):
        del file["time"]
        file.create_dataset("time", shape=(2**40,), chunks=(2**20,), **packed)

    commands = (["table", "{}", "*"], ["table", "{}", "--list"], ["diff", "{}", "{}"])
    for change in (many, names, deck, attributes, zeros, chunk, declared):
        for command in commands:
            yield Case("hdf5", f"{change.__name__}, {command[0]}", _result(seeds / "x.h5", change, command))


def _result(original, change, command):
    def prepare(work):
        path = work / "r.h5"
        shutil.copy(original, path)
        with h5py.File(path, "r+") as file:
            change(file)
        return [word.format(path) for word in command], b""

    return prepare


def _drafts(seeds):
    for dialect in ("young", "dafms", "vsdf"):
        raw = max(seeds.joinpath(dialect).glob("*.draft"), key=lambda path: path.stat().st_size).read_bytes()
        last = b"\n".join(raw.split(b"\n")[-2:])
        fillings = {"its last line": last} | {name: text.encode() for name, text in FILLINGS.items()}
        for name, filling in fillings.items():
            yield Case(f"{dialect} draft", name, _draft(dialect, raw + filling * (SIZE // len(filling))))


def _draft(dialect, raw):
    def prepare(work):
        (work / "x.dat.draft").write_bytes(raw)
        return ["new", dialect, "--draft", "-o", str(work / "x.dat")], b"1\n?\n"

    return prepare


def _resume_files(seeds):
    raw = (seeds / "x.resume").read_bytes()
    head, _, entries = raw.partition(b"\n")
    contents = {
        "entries": raw + entries * (SIZE // len(entries)),
        "zeros": raw + bytes(SIZE),
        "a head": head + b" " * SIZE + b"\n" + entries,
        "open brackets": b"[" * SIZE,
        "a length": head + b"\n" + b"\xff" * SIZE,
    }
    for name, content in contents.items():
        yield Case("journal", name, _resume_file(seeds / "x.DAT", content))


def _resume_file(deck, raw):
    def prepare(work):
        shutil.copy(deck, work / "x.DAT")
        (work / "x.resume").write_bytes(raw)
        return ["run", str(work / "x.DAT"), "--resume", "-o", str(work)], b""

    return prepare
