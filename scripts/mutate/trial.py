"""The trial of one mutant, in a process of its own: the tests that cover its line, until one fails.

The process begins as a copy of one that has imported numpy, scipy and pytest, but nothing of flexmb.
"""

import importlib
import os
import resource
import sys
import time
from collections import defaultdict
from itertools import islice, zip_longest

PRELOADED = [
    *("numpy", "scipy.linalg", "scipy.sparse.linalg", "scipy.integrate", "scipy.optimize", "h5py"),
    *("scipy.spatial.transform", "pytest", "hypothesis", "coverage", "plugin"),
]
FOR_OTHERS = 0.3  # of a mutant's time: until then tests that do not run its line are tried, too
FIRST = 12  # tests that are tried before all others are collected
PLUGINS = ("-p", "no:cacheprovider", "-p", "_hypothesis_pytestplugin")  # loading all takes a second
SLACK, SLOWER = 5.0, 4.0  # s, and times what a test took when its lines were recorded
MEMORY = 4 << 30  # bytes


def covering_tests(records: list[dict], file: str, lines: range) -> tuple[dict[str, float], ...]:
    """Return two {test: seconds allowed}: tests that run one of the lines, and the others of their files.

    The latter matter where tests share what the first of them computed.  The files take turns, and each
    gives its fastest test first.
    """
    passed = [r for r in records if not r["bad"]]
    covering = [r for r in passed if not set(lines).isdisjoint(r["lines"].get(file, ()))]
    names, homes = {r["test"] for r in covering}, {_home(r) for r in covering}
    others = [r for r in passed if _home(r) in homes and r["test"] not in names]
    return _limits(covering), _limits(others)


def _limits(records):
    return {r["test"]: SLACK + SLOWER * r["seconds"] for r in _in_turns(records)}


def _home(record):
    return record["test"].partition("::")[0]


def _in_turns(records):
    files = defaultdict(list)
    for record in sorted(records, key=lambda r: r["seconds"]):
        files[_home(record)].append(record)
    return [record for turn in zip_longest(*files.values()) for record in turn if record is not None]


def judge(sender, tree: str, package: str, limits: tuple, most: float, log: str) -> None:
    """Send {killer, why, late, ran, seconds} of the tests of `limits`, run in `tree` against `package`.

    most: processor seconds.
    """
    out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(out, 1)
    os.dup2(out, 2)
    os.chdir(tree)
    sys.path[:0] = [package, tree]
    sys.dont_write_bytecode = True
    importlib.import_module("flexmb_cli")  # pytest puts the tree before everything else
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    begin, ran = time.process_time(), 0
    covering, others = limits
    first, rest = dict(islice(covering.items(), FIRST)), dict(islice(covering.items(), FIRST, None))
    for part, budget in ((first, most), (rest, most), (others, FOR_OTHERS * most)):
        found = _run(part, begin + budget, package)
        ran += found.ran
        if found.killer is not None or found.late:
            break
    seconds = round(time.process_time() - begin, 1)
    why = found.text if found.killer else ""
    sender.send({"killer": found.killer, "why": why, "late": found.late, "ran": ran, "seconds": seconds})
    sender.close()


def _run(limits, until, package):
    import pytest
    from plugin import Judge

    judge = Judge(limits, until)
    if not limits or time.process_time() > until:
        return judge
    files = sorted({name.partition("::")[0] for name in limits})
    options = ["-x", *PLUGINS, "--hypothesis-seed=0", "--rootdir=."]
    code = pytest.main([*options, *files], plugins=[judge])
    if code != pytest.ExitCode.OK and judge.killer is None and not judge.late:
        judge.killer, judge.text = "collection", f"pytest ends with {code!r}"
    _require_mutant(package)
    return judge


def _require_mutant(package):
    """The tests must not have found another flexmb."""
    import flexmb_cli

    if not flexmb_cli.__file__.startswith(package):
        raise ImportError(f"tests ran against {flexmb_cli.__file__}, not {package}")
