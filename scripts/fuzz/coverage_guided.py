"""Bytes that lead to ever new lines of the readers: atheris, guided by coverage.

Example: scripts/fuzz/run bytes --runs 20000 --seconds 60 --seed 1 --keep found
Readers of decks of three dialects, of every finite-element format, of studies and of HDF5 results, each in a
process of its own for at most `--runs` inputs and `--seconds`.  Exit 1 when an input is not answered, 2 when
atheris, which has wheels for some versions of Python only, is not installed.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from contextlib import suppress
from importlib import import_module
from pathlib import Path

SLOW, MEMORY = 2.0, 2048  # s of processor time, MB
LONGEST, LONGEST_HDF5 = 4096, 16384  # bytes of an input


def main() -> int:
    options = _options()
    try:
        import atheris
    except ImportError:
        version = ".".join(map(str, sys.version_info[:2]))
        print(f"atheris is not installed; is there a wheel for Python {version}?", file=sys.stderr)
        return 2
    if options.alone:
        return _guide(atheris, options)
    names = options.kind or list(_target_names())
    outcomes = [_hunt(name, options) for name in names]
    total = sum(runs for runs, _ in outcomes)
    wrong = sum(bad for _, bad in outcomes)
    print(f"{total} inputs, {wrong} readers met one that they do not answer as they should")
    return 1 if wrong else 0


def _options():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--runs", type=int, default=10_000, help="most inputs of each reader")
    parser.add_argument("--seconds", type=int, default=60, help="longest time for each reader")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", action="append", metavar="READER")
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument("--alone", type=Path, metavar="FOLDER", help=argparse.SUPPRESS)
    return parser.parse_args()


def _target_names():
    from fe_readers import READERS

    yield from ("young", "dafms", "vsdf", "study", "hdf5")
    yield from READERS


def _hunt(name, options) -> tuple[int, bool]:
    """Inputs tried of one reader, and whether one was not answered."""
    with tempfile.TemporaryDirectory(prefix="bytes-") as folder:
        folder = Path(folder)
        (folder / "corpus").mkdir()
        for number, raw in enumerate(_seeds(name)):
            (folder / "corpus" / str(number)).write_bytes(raw)
        command = [sys.executable, *sys.argv, "--kind", name, "--alone", str(folder)]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        counted = json.loads((folder / "counted").read_text() or "[0, 0]")
        reported = (folder / "fault").read_text() if (folder / "fault").exists() else ""
        found = [path for path in folder.iterdir() if path.name.startswith(("crash", "timeout", "oom"))]
        if found and options.keep:
            options.keep.mkdir(parents=True, exist_ok=True)
            for path in found:
                shutil.copy(path, options.keep / f"{name.replace(' ', '-')}-{path.name[:14]}")
    lines = re.findall(r"cov: (\d+)", done.stderr)
    bad = bool(found or done.returncode)
    print(
        f"{name:22} {counted[0]:7} inputs, {counted[1]:7} accepted, {lines[-1] if lines else '?'} edges",
        flush=True,
    )
    if bad:
        print(f"    exit {done.returncode}: {(reported or done.stderr).strip()[-1500:]}", flush=True)
    return counted[0], bad


def _seeds(name):
    """Small files in good order."""
    import fe_seeds
    from damaged_decks import DECKS
    from damaged_studies import SAMPLE, STUDY

    if name in ("young", "dafms", "vsdf"):
        paths = [path for path in (DECKS / name).rglob("*") if path.suffix.lower() in (".dat", ".vsdf")]
        yield from (path.read_bytes() for path in sorted(paths) if path.stat().st_size < LONGEST)
    elif name == "study":
        yield from (STUDY.encode(), SAMPLE.encode())
    elif name == "hdf5":
        yield _small_result()
    else:
        with tempfile.TemporaryDirectory() as folder:
            fe_seeds.write_seeds(Path(folder))
            for path in sorted(Path(folder).iterdir()):
                if path.suffix in FILES.get(name.split()[-1], ()) or "two rows" in name:
                    yield path.read_bytes()[:LONGEST]


FILES = {
    "MM": (".mtx", ".array"),
    "ABQ": (".abq", ".coo"),
    "DMIG": (".pch",),
    "OP4": (".op4", ".bin"),
    "HB": (".hb",),
    "CCX": (".sti", ".mas", ".dof"),
    "ANS": (".mapping",),
    "TXT": (".txt",),
    "CDB": (".cdb",),
    "INP": (".inp",),
    "BDF": (".bdf",),
}


def _small_result():
    import io

    import h5py

    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        file["time"] = [0.0, 0.1]
        file["time"].make_scale("time")
        file["body/name"] = ["a", "b"]
        file["body/body"] = [1, 2]
        file["body/body"].make_scale("body")
        file["body/position"] = [[[0.0] * 3] * 2] * 2
        for axis, scale in ((0, "time"), (1, "body/body")):
            file["body/position"].dims[axis].attach_scale(file[scale])
    return stream.getvalue()


def _guide(atheris, options) -> int:
    """Have libFuzzer try inputs of one reader until one is not answered, or they are enough."""
    name, folder = options.kind[-1], options.alone
    with atheris.instrument_imports(include=["flexmb_cli.deck", "flexmb_cli.model", "flexmb_cli.results"]):
        attempt = _attempt(name, folder)
    counted = [0, 0]

    def one_input(raw):
        start = time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                fault = attempt(raw)
        except Exception as error:
            fault = repr(error)
            raise
        finally:
            took = time.process_time() - start
            counted[0] += 1
            if counted[0] % 100 == 0 or counted[0] == options.runs:
                (folder / "counted").write_text(json.dumps(counted))
        counted[1] += fault is None
        if fault or took > SLOW:
            (folder / "fault").write_text(fault or f"slow: {took:.1f} s")
            raise AssertionError(fault or f"slow: {took:.1f} s")

    (folder / "counted").write_text("[0, 0]")
    words = [f"-runs={options.runs}", f"-max_total_time={options.seconds}", f"-seed={options.seed}"]
    words += [
        f"-max_len={LONGEST_HDF5 if name == 'hdf5' else LONGEST}",
        "-timeout=20",
        f"-rss_limit_mb={MEMORY}",
        f"-artifact_prefix={folder}/",
    ]
    atheris.Setup([sys.argv[0], *words, str(folder / "corpus")], one_input)
    atheris.Fuzz()
    return 0


def _attempt(name, folder):
    """What answers bytes: None when they are accepted, "" when they are refused, or the fault.

    What is imported here is instrumented.
    """
    if name in ("young", "dafms", "vsdf"):
        return _deck(name)
    if name == "study":
        return _study()
    return _result(folder / "x") if name == "hdf5" else _finite_element_file(name, folder / "x")


def _deck(name):
    from damaged_decks import DECKS, built

    import_module("flexmb_cli.cli.check")
    for dialect in ("young", "dafms", "vsdf"):
        import_module(f"flexmb_cli.dialects.{dialect}.reader")
        import_module(f"flexmb_cli.dialects.{dialect}.build")

    def attempt(raw):
        answer = built("x.deck", raw, DECKS / name)
        return answer.fault or (None if answer.code == 0 else "")

    return attempt


def _study():
    from flexmb_cli.deck.text import decode
    from flexmb_cli.errors import DeckError
    from flexmb_cli.study.reader import read_study

    def attempt(raw):
        try:
            read_study(decode("x.toml", raw))
        except DeckError:
            return ""
        return None

    return attempt


def _finite_element_file(name, path):
    from fe_readers import read_file

    def attempt(raw):
        path.write_bytes(raw)
        return "" if read_file(name, path) else None

    return attempt


def _result(path):
    from flexmb_cli.errors import FlexmbError
    from flexmb_cli.results.quantities.quantities import names, open_result

    def attempt(raw):
        path.write_bytes(raw)
        with suppress(FlexmbError), open_result(str(path)) as result:
            names(result)
            return None
        return ""

    return attempt


if __name__ == "__main__":
    sys.exit(main())
