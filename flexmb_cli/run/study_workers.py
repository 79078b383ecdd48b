"""Who solves the blocks of a study: this process, processes beside it, or the workers of a Dask cluster."""

from collections import Counter
from collections.abc import Callable, Iterable

from ..errors import BAD_INPUT, FlexmbError
from .sweep import MOST_DEATHS, BlockDone, Sweep, give_up_case, next_case, solve_block

IN_FLIGHT = 4  # blocks a worker is given ahead


class ClusterError(FlexmbError):
    """The Dask cluster cannot be used (exit 2)."""

    exit_code = BAD_INPUT


def solve_here(sweep: Sweep, blocks: Iterable[int], advance: Callable[[int], None]) -> None:
    """Solve `blocks` in this process."""
    for block in blocks:
        sweep.done[block] = solve_block(sweep.job, block, advance)


def solve_in_processes(sweep: Sweep, blocks: list[int], advance: Callable[[int], None], jobs: int) -> None:
    """Solve `blocks` in `jobs` processes.  A process that dies is replaced, and its blocks go on.

    A case at which three processes died is recorded as failed.
    """
    waiting, deaths = list(blocks), Counter()
    while waiting:
        finished = _pool(sweep.job, waiting, jobs, lambda done: _keep(sweep, done, advance))
        waiting = [block for block in waiting if block not in finished]
        if waiting:
            _note_deaths(sweep.job, waiting[: jobs * IN_FLIGHT], deaths)


def _pool(job, blocks, jobs, keep):
    """Solve blocks in a pool until all are done or one of its processes dies; the blocks that are done."""
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    rest, running, finished = iter(blocks), set(), set()
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), initializer=_ignore_interrupts)
    try:
        while True:
            for block in rest:
                running.add(pool.submit(solve_block, job, block))
                if len(running) >= jobs * IN_FLIGHT:
                    break
            if not running:
                return finished
            ended, running = wait(running, return_when=FIRST_COMPLETED)
            for done in (future.result() for future in ended):
                finished.add(done.block)
                keep(done)
    except BrokenProcessPool:
        return finished
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _ignore_interrupts():
    """Ctrl-C reaches every process of the terminal; the driver ends the workers itself."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _keep(sweep, done: BlockDone, advance):
    sweep.done[done.block] = done
    advance(done.solved)


def _note_deaths(job, blocks, deaths):
    for block in blocks:
        case = next_case(job, block)
        deaths[case] += 1
        if deaths[case] >= MOST_DEATHS:
            give_up_case(job, block)


def solve_on_cluster(sweep: Sweep, blocks: list[int], advance, address: str) -> None:
    """Solve `blocks` on the Dask cluster whose scheduler is at `address`; a few blocks a worker at a time.

    Raises ClusterError when there is no Dask, no scheduler or no worker, or when workers lack flexmb.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError:
        message = "--scheduler needs Dask's `distributed`: pip install 'flexmb[cluster]'"
        raise ClusterError(message) from None
    try:
        # A Client of an address that is none hangs when it is thrown away.
        get_address_host_port(address)
        client = Client(address, timeout=20, set_as_default=False)
    except (OSError, ValueError) as fault:
        raise ClusterError(f"no Dask scheduler answers at {address}: {fault}") from fault
    with client:
        _Cluster(client, sweep, advance, address).solve(blocks)


class _Cluster:
    """Blocks on their way through a Dask cluster."""

    def __init__(self, client, sweep, advance, address):
        from distributed import as_completed

        self.client, self.sweep, self.advance, self.address = client, sweep, advance, address
        self.shared = client.scatter(sweep.job, broadcast=True)
        self.deaths = Counter()
        self.block_of = {}
        self.arriving = as_completed(loop=client.loop)

    def solve(self, blocks):
        rest = iter(blocks)
        for block in rest:
            self._submit(block)
            if len(self.block_of) >= self._most():
                break
        for future in self.arriving:
            again = self._finish(future)
            for block in [again] if again is not None else rest:
                self._submit(block)
                if len(self.block_of) >= self._most():
                    break

    def _most(self):
        return max(1, len(self.client.nthreads())) * IN_FLIGHT

    def _submit(self, block):
        # Impure: a block that is given once more has cases that the first attempt lacked.
        future = self.client.submit(solve_block, self.shared, block, pure=False)
        self.block_of[future.key] = block
        self.arriving.add(future)

    def _finish(self, future):
        """Keep what a future brings; the block to be given once more if its workers died."""
        from distributed import KilledWorker

        block = self.block_of.pop(future.key)
        try:
            _keep(self.sweep, future.result(), self.advance)
        except KilledWorker:
            _note_deaths(self.sweep.job, [block], self.deaths)
            return block
        except ImportError as fault:
            raise ClusterError(f"the workers of {self.address} need flexmb installed: {fault}") from fault
        return None
