"""A study on the workers of a Dask cluster.

What is handed out at a time is large at first and small at the end: a message costs the scheduler some
milliseconds of a processor that may be a worker's too, and at the end no worker shall wait for another.
"""

import time
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import CancelledError
from typing import Any

from .. import __version__
from ..errors import ANALYSIS_FAILED, BAD_INPUT, FlexmbError
from ..extras import needed
from .sweep import BlockDone, Job, Sweep, solve_block
from .workers import IN_FLIGHT, keep, note_deaths

SHARES = 3  # so many as one that is handed out shall still be there for every thread
LONGEST_SHARE = 1.0  # s; who looks on, and who stops the study, shall not wait for much more
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


def solve_on_cluster(sweep: Sweep, blocks: list[int], advance: Callable[[int], None], address: str) -> None:
    """Solve `blocks` on the Dask cluster whose scheduler is at `address`, a few at a time.

    Raises MissingExtra without Dask, ClusterError when there is no scheduler or no worker, when the
    scheduler is lost, or when workers lack flexmb or have another version.
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
            _Cluster(client, sweep, advance, address).solve(blocks)
        except (CancelledError, OSError) as fault:
            reason = " ".join(str(fault).split())  # newer versions of Dask explain on several lines
            message = f"the Dask scheduler at {address} was lost: {reason}; the same command continues it"
            raise ClusterError(message, ANALYSIS_FAILED, id="STUDY-006") from fault


def solve_share(job: Job, blocks: list[int]) -> tuple[list[BlockDone], float]:
    """Solve some blocks of a study; what became of them, and the seconds it took.

    Raises ClusterError in a worker of another version.
    """
    version = dict(job.identity)["version"]
    if version != __version__:
        raise ClusterError(
            f"a worker has flexmb {__version__}, this study is solved by {version}", id="STUDY-007"
        )
    start = time.perf_counter()
    done = [solve_block(job, block) for block in blocks]
    return done, time.perf_counter() - start


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
        self.shares: dict[str, list[int]] = {}  # blocks by the key of their future
        self.seconds: float | None = None  # of a block, as reported last
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
            if not self.shares:
                self._submit([self.struck.popleft()])
            return
        self._count_threads()
        while self.rest and len(self.shares) < self.threads * IN_FLIGHT:
            self._submit([self.rest.popleft() for _ in range(self._size())])

    def _submit(self, share: list[int]) -> None:
        # Impure: blocks that are given once more have cases that the first attempt lacked.
        future = self.client.submit(solve_share, self.shared, share, pure=False)
        self.shares[future.key] = share
        self.arriving.add(future)

    def _count_threads(self) -> None:
        now = time.monotonic()
        if now - self.counted >= CENSUS:
            self.threads, self.counted = max(1, sum(self.client.nthreads().values())), now

    def _size(self) -> int:
        """Blocks of the next share."""
        if self.seconds is None:
            return 1
        fair = len(self.rest) // (SHARES * self.threads)
        return max(1, min(fair, int(LONGEST_SHARE / self.seconds)))

    def _finish(self, future: Any) -> None:
        """Keep what a future brings; what its workers died of is given once more."""
        from distributed import KilledWorker

        share = self.shares.pop(future.key)
        try:
            done, seconds = future.result()
        except KilledWorker:
            self._give_again(share)
        except ImportError as fault:
            raise ClusterError(
                f"the workers of {self.address} need flexmb installed: {fault}", id="STUDY-009"
            ) from fault
        else:
            self.seconds = max(seconds, 1e-6) / len(share)
            for block in done:
                keep(self.sweep, block, self.advance)

    def _give_again(self, share: list[int]) -> None:
        """Hand out again the blocks that a share lacks; stored cases were solved, though their worker died.

        A complete block is not handed out again: if it ended its worker, no death would be counted.
        """
        job = self.sweep.job
        kept = {block: [case.exit_code for case in job.stored(block)] for block in share}
        lacking = [block for block in share if len(kept[block]) < len(job.cases(block))]
        for block in share:
            if block not in lacking:
                keep(self.sweep, BlockDone(block, 0, sum(code != 0 for code in kept[block])), self.advance)
        note_deaths(job, lacking[:1], self.deaths)
        self.struck.extend(lacking[:1])
        self.rest.extendleft(reversed(lacking[1:]))
