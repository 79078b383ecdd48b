"""A study on the workers of a Dask cluster, a task for each block of cases."""

import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from ..errors import ANALYSIS_FAILED, BAD_INPUT, FlexmbError
from ..extras import needed
from ..version import __version__
from .sweep import BlockDone, Job, Sweep, solve_block
from .workers import IN_FLIGHT, keep, note_deaths

PATIENCE = 20  # s for a scheduler that does not answer, also on the way
MUSTER = 60  # s for a first worker
CENSUS = 1.0  # s between two looks for new workers, each a message


class ClusterError(FlexmbError):
    """The Dask cluster cannot be used (exit 2), or was lost (exit 1)."""

    def __init__(self, message: str, exit_code: int = BAD_INPUT, id: str = ""):
        super().__init__(message, id=id)
        self.exit_code = exit_code


def require_dask() -> None:
    """Raise MissingExtra when Dask's `distributed` is not there."""
    needed("distributed", "distributed", "cluster", "--scheduler")


@contextmanager
def client_of(address: str) -> Iterator[Any]:
    """A client of the Dask cluster whose scheduler is at `address`.

    Raises MissingExtra without Dask, ClusterError when there is no scheduler, or when it is lost.
    """
    require_dask()
    from distributed import Client
    from distributed.comm.addressing import get_address_host_port

    try:
        # A Client of an address that is none hangs when it is thrown away.
        get_address_host_port(address)
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as fault:
        raise ClusterError(f"no Dask scheduler answers at {address}: {fault}", id="STUDY-005") from fault
    with client:
        try:
            yield client
        except (CancelledError, OSError) as fault:
            reason = " ".join(str(fault).split())  # newer versions of Dask explain on several lines
            message = f"the Dask scheduler at {address} was lost: {reason}; the same command continues it"
            raise ClusterError(message, ANALYSIS_FAILED, id="STUDY-006") from fault


def solve_on_cluster(sweep: Sweep, blocks: list[int], advance: Callable[[int], None], address: str) -> None:
    """Solve `blocks` on the Dask cluster whose scheduler is at `address`, a few at a time.

    Raises as `client_of`, and ClusterError when there is no worker, or workers lack flexmb or have another
    version.
    """
    with client_of(address) as client:
        _Cluster(client, sweep, advance, address).solve(blocks)


def solve_share(job: Job, blocks: list[int]) -> list[BlockDone]:
    """Solve some blocks of a study; raises ClusterError in a worker of another version."""
    version = dict(job.identity)["version"]
    if version != __version__:
        raise ClusterError(
            f"a worker has flexmb {__version__}, this study is solved by {version}", id="STUDY-007"
        )
    return [solve_block(job, block) for block in blocks]


def _handed_on(job: Job) -> Job:
    return job


class _Cluster:
    """Blocks on their way through a Dask cluster.

    A worker that dies takes all that waited for it down, too: what was struck is solved with nothing beside
    it before anything else is handed out.
    """

    def __init__(self, client: Any, sweep: Sweep, advance: Callable[[int], None], address: str):
        from distributed import as_completed

        self.client, self.sweep, self.advance, self.address = client, sweep, advance, address
        # No scattered data: those are lost with the workers that have them, a task is done anew.
        self.shared = client.submit(_handed_on, sweep.job, pure=False)
        self.rest: deque[int] = deque()
        self.struck: deque[int] = deque()
        self.deaths: Counter[tuple[int, int]] = Counter()
        self.given: dict[str, int] = {}  # blocks by the key of their future
        self.threads, self.counted = 1, -CENSUS
        self.arriving = as_completed(loop=client.loop)

    def solve(self, blocks: list[int]) -> None:
        self._await_workers()
        self.rest.extend(blocks)
        self._hand_out()
        for future in self.arriving:
            self._finish(future)
            self._hand_out()

    def _await_workers(self) -> None:
        try:
            # A cluster that grows as it is needed has been given its first task.
            self.client.wait_for_workers(1, timeout=MUSTER)
        except TimeoutError as fault:
            message = f"no worker has joined the Dask scheduler at {self.address} within {MUSTER} s"
            raise ClusterError(message, id="STUDY-008") from fault

    def _hand_out(self) -> None:
        if self.struck:
            if not self.given:
                self._submit(self.struck.popleft())
            return
        if time.monotonic() - self.counted >= CENSUS:
            self.threads, self.counted = max(1, sum(self.client.nthreads().values())), time.monotonic()
        while self.rest and len(self.given) < self.threads * IN_FLIGHT:
            self._submit(self.rest.popleft())

    def _submit(self, block: int) -> None:
        # Impure: blocks that are given once more have cases that the first attempt lacked.
        future = self.client.submit(solve_share, self.shared, [block], pure=False)
        self.given[future.key] = block
        self.arriving.add(future)

    def _finish(self, future: Any) -> None:
        """Keep what a future brings; what its workers died of is given once more."""
        from distributed import KilledWorker

        block = self.given.pop(future.key)
        try:
            for done in future.result():
                keep(self.sweep, done, self.advance)
        except KilledWorker:
            self._give_again(block)
        except ImportError as fault:
            raise ClusterError(
                f"the workers of {self.address} need flexmb installed: {fault}", id="STUDY-009"
            ) from fault

    def _give_again(self, block: int) -> None:
        """Hand out a block again that lacks cases; those stored were solved, though their worker died.

        A complete block is not handed out again: if it ended its worker, no death would be counted.
        """
        job = self.sweep.job
        codes = [case.exit_code for case in job.stored(block)]
        if len(codes) == len(job.cases(block)):
            keep(self.sweep, BlockDone(block, 0, sum(code != 0 for code in codes)), self.advance)
        else:
            note_deaths(job, [block], self.deaths)
            self.struck.append(block)
