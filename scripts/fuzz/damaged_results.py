"""Results and listings of runs: damaged, then shown, compared, exported; and names that no result has."""

import os
import random
import shutil

import fe_seeds
from answer import answered
from damage import NUMBERS, WORDS, damaged_bytes, damaged_text
from damaged_decks import DECKS
from damaged_studies import study_seeds
from hdf5_damage import damage_structure

from flexmb_cli.errors import DONE


def result_seeds(folder):
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
    study_seeds(folder)
    answered(["sweep", str(folder / "grid.toml"), "-o", str(folder / "study.h5")])
    assert done.code == DONE, done.errors
    assert len(list(folder.glob("*.h5"))) == len(decks) + 1, done.errors


def argument_seeds(folder):
    """With the kernels compiled that a late Jacobian wants: the time of a first run is none of an input's."""
    result_seeds(folder)
    answered(["check", str(folder / "IN4-BAR.dat"), "--jacobian", "50"])


def show_damaged_bytes(chance, seeds, work):
    results = sorted(seeds.glob("*.h5"))
    path = chance.choice(results)
    raw = damaged_bytes(chance, path.read_bytes(), chance.choice(results).read_bytes())
    (work / "r.h5").write_bytes(raw)
    return shown(chance, path, work)


def show_damaged_structure(chance, seeds, work):
    path = chance.choice(sorted(seeds.glob("*.h5")))
    shutil.copy(path, work / "r.h5")
    shutil.copy(path, work / "other.h5")
    if not _damaged_apart(chance.getrandbits(32), work / "r.h5"):
        shutil.copy(path, work / "r.h5")
    return shown(chance, path, work)


def _damaged_apart(number, path):
    """Whether the structure was damaged by a child: HDF5 may crash where it writes to what is damaged."""
    child = os.fork()
    if child == 0:
        try:
            damage_structure(random.Random(number), path)
        finally:
            os._exit(0)
    return os.waitpid(child, 0)[1] == 0


def shown(chance, intact, work):
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


def compare_listing(chance, seeds, work):
    names = [path for path in sorted(seeds.iterdir()) if path.suffix in (".OUT", ".T2", ".T3")]
    names += sorted(seeds.glob("OUT*.dat"))
    path = chance.choice(names)
    (work / "x").write_bytes(damaged_text(chance, path.read_bytes(), chance.choice(names).read_bytes()))
    pair = [str(work / "x"), str(path)]
    options = chance.choice(([], ["--json"], ["--explain"], ["--same-attitude"], ["--last-digit", "1"]))
    return answered(["diff", *(pair if chance.random() < 0.5 else pair[::-1]), *options])


def name_quantities(chance, seeds, work):
    """Names and values given as arguments: --set, patterns of quantities, tolerances."""
    word = chance.choice(
        (*NUMBERS, *WORDS, "body", "driver", "1", "x", "omega", "B", "*", "?", "[a-", "[!", ".", "=")
    )
    words = [
        word if chance.random() < 0.5 else chance.choice(("body", "1", "driver", "x", "B", "*"))
        for _ in range(chance.choice((1, 2, 3)))
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
