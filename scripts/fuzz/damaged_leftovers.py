"""What flexmb keeps for itself: drafts of `new`, journals of runs, caches of flexible bodies."""

import io
import json
import os
import shutil

import fe_seeds
import numpy as np
from answer import Answer, answered
from damage import NUMBERS, WORDS, damaged_bytes, damaged_text
from damaged_decks import DECKS

from flexmb_cli.errors import BAD_INPUT, DONE

DRAFTS = {"young": 40, "dafms": 40, "vsdf": 40}


def draft_seeds(folder):
    """Drafts as far as answers of 1 and of Enter lead."""
    for dialect, count in DRAFTS.items():
        work = folder / dialect
        work.mkdir()
        for k, answer in enumerate((b"1", b"", b"1 1", b"0")):
            typed = b"a title\n" + b"\n".join([answer] * count)
            answered(["new", dialect, "--draft", "-o", str(work / f"{k}.dat")], typed + b"\n!\n")
    assert list(folder.rglob("*.draft"))


def go_on_with_draft(chance, seeds, work):
    drafts = sorted(seeds.rglob("*.draft"))
    path = chance.choice(drafts)
    raw = damaged_text(chance, path.read_bytes(), chance.choice(drafts).read_bytes())
    (work / "x.dat.draft").write_bytes(raw)
    answers = [
        chance.choice((*NUMBERS, *WORDS, "", "1", "1 2 3", "?", "<", ">", "< driver.1")) for _ in range(4)
    ]
    typed = "\n".join(answers).encode("utf-8", "surrogatepass")
    return answered(["new", path.parent.name, "--draft", "-o", str(work / "x.dat")], typed)


def resume_file_seeds(folder):
    """The journal of a run of some rows, kept as a kill would leave it."""
    from flexmb_cli.run.checkpoint import ResumeFile

    fe = (DECKS / "dafms" / "sliding_mass.DAT").read_text().splitlines()
    (folder / "x.DAT").write_text("\n".join(fe) + "\n")
    keep, ResumeFile.remove = ResumeFile.remove, ResumeFile.close
    try:
        done = answered(["run", str(folder / "x.DAT"), "-o", str(folder)])
    finally:
        ResumeFile.remove = keep
    assert done.code == DONE and (folder / "x.resume").exists(), done.errors


def resume_from_file(chance, seeds, work):
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


def cache_seeds(folder):
    fe_seeds.write_seeds(folder)
    os.environ["FLEXMB_CACHE_DIR"] = str(folder / "cache")
    try:
        answered(["modes", str(folder / "mm.vsdf")])
    finally:
        del os.environ["FLEXMB_CACHE_DIR"]
    assert len(list((folder / "cache").rglob("*.body"))) == 1


def reduce_from_cache(chance, seeds, work):
    """A damaged cache of a flexible body changes nothing."""
    shutil.copytree(seeds / "cache", work / "cache")
    (victim,) = (work / "cache").rglob("*.body")
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
    """The file with one array missing, of another shape, type or value."""
    stored = io.BytesIO(raw)
    notes = np.load(stored)
    arrays = {"notes": notes} | {name: np.load(stored) for name in json.loads(str(notes))["arrays"]}
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
    for array in arrays.values():
        np.save(stream, array)
    return stream.getvalue()
