"""pytest plugins: `Mapper` records the lines that each test runs, `Judge` runs chosen tests until one fails.

Times are processor seconds: other work on the machine does not count.
"""

import json
import multiprocessing
import os
import signal
import time
import warnings

import coverage
import pytest

HARDEST = 100.0  # s, of a test whose lines are recorded; a slower one is left out


class TooLong(BaseException):
    """Not an Exception: the code under test may catch those."""


class Limited:
    """Ends a test that takes longer than `limit(item)`, and keeps the outcome of the test at hand."""

    bad, text = "", ""

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_setup(self, item):
        self.bad, self.text = "", ""
        yield from self._bounded(item)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item):
        yield from self._bounded(item)

    def _bounded(self, item):
        signal.signal(signal.SIGVTALRM, _stop)
        signal.setitimer(signal.ITIMER_VIRTUAL, self.limit(item))
        yield
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_makereport(self, item, call):
        report = (yield).get_result()
        if report.outcome != "passed" and not self.bad:
            self.bad = report.outcome
            self.text = f"{call.excinfo.typename}: {str(call.excinfo.value)[:160]}"


def _stop(_number, _frame):
    raise TooLong("the time allowed is over")


class Mapper(Limited):
    """Appends one JSON line per test: outcome, seconds, and {file: [line, ...]} of the given files."""

    def __init__(self, path, files, known, digests):
        self.path, self.files, self.known, self.digests = path, files, known, digests

    def limit(self, item):
        return HARDEST

    def pytest_collection_modifyitems(self, items):
        items[:] = [item for item in items if self._key(item) not in self.known]

    def _key(self, item):
        return item.nodeid, self.digests.get(item.nodeid.partition("::")[0])

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item, nextitem):
        traced = coverage.Coverage(data_file=None, config_file=False, include=self.files, messages=False)
        begin = time.process_time()
        traced.start()
        yield
        traced.stop()
        seconds = time.process_time() - begin
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a test without kernels has no data
            data = traced.get_data()
        lines = {name: sorted(data.lines(name)) for name in data.measured_files() if data.lines(name)}
        name, digest = self._key(item)
        record = {"test": name, "digest": digest, "bad": self.bad, "text": self.text, "seconds": seconds}
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(record | {"lines": lines}) + "\n")


class Judge(Limited):
    """Runs the tests of `limits` {test: seconds} in its order; `killer` is the first that fails.

    `until`: processor seconds of this process, beyond which no test goes; `late` tells that one would have.
    """

    def __init__(self, limits, until):
        self.limits, self.until, self.ran, self.killer, self.late = limits, until, 0, None, False

    def limit(self, item):
        return max(0.01, min(self.limits[item.nodeid], self.until - time.process_time()))

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items):
        place = {name: k for k, name in enumerate(self.limits)}
        items[:] = sorted((i for i in items if i.nodeid in place), key=lambda i: place[i.nodeid])

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item, nextitem):
        if not multiprocessing.parent_process().is_alive():
            os._exit(1)
        yield
        self.ran += 1
        self.late = time.process_time() >= self.until
        if self.late:
            item.session.shouldstop = "the time of this mutant is over"
        elif self.bad == "failed":
            self.killer = item.nodeid
