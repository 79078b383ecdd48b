"""Who solves the blocks of a study: this process, processes beside it, or the workers of a Dask cluster."""

from collections import Counter
from collections.abc import Callable, Iterable

from ..errors import ANALYSIS_FAILED, BAD_INPUT, FlexmbError
from .sweep import MOST_DEATHS, BlockDone, Sweep, give_up_case, next_case, solve_block

IN_FLIGHT = 4  # blocks a worker is given ahead


class WorkersError(FlexmbError):
    """The processes of a study do not live long enough to solve anything (exit 1)."""

    exit_code = ANALYSIS_FAILED


class ClusterError(FlexmbError):
    """The Dask cluster cannot be used (exit 2)."""

    exit_code = BAD_INPUT


def solve_here(sweep: Sweep, blocks: Iterable[int], advance: Callable[[int], None]) -> None:
    """Solve `blocks` in this process."""
    for block in blocks:
        sweep.done[block] = solve_block(sweep.job, block, advance)


def solve_in_processes(sweep: Sweep, blocks: list[int], advance: Callable[[int], None], jobs: int) -> None:
    """Solve `blocks` in `jobs` processes.  A process that dies is replaced, and its blocks go on.

    A death takes down what runs beside it, too: a case seen at two deaths is solved with nothing beside it,
    and recorded as failed when its process dies even so.
    """
    waiting, deaths, barren = list(blocks), Counter(), 0
    while waiting:
        alone = [block for block in waiting if deaths[_place(sweep.job, block)] == MOST_DEATHS - 1][:1]
        given, processes = (alone, 1) if alone else (waiting, jobs)
        finished, struck = _pool(sweep.job, given, processes, lambda done: _keep(sweep, done, advance))
        waiting = [block for block in waiting if block not in finished]
        _note_deaths(sweep.job, struck, deaths)
        barren = 0 if finished or struck else barren + 1
        if barren == MOST_DEATHS:
            raise WorkersError(
                f"the processes that should solve cases ended {barren} times before they began one: killed "
                "from outside, or out of memory; fewer of them (-j) or none (-j 1) may do"
            )


def _pool(job, blocks, jobs, keep):
    """Solve blocks in a pool until all are done or one of its processes dies.

    The blocks that are done, and those that were being solved at a death.
    """
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    rest, running, finished = iter(blocks), set(), set()
    spawn = get_context("spawn")
    begun = spawn.RawArray("b", job.blocks)
    pool = ProcessPoolExecutor(jobs, spawn, initializer=_begin_process, initargs=(begun,))
    try:
        while True:
            for block in rest:
                running.add(pool.submit(_solve_noted, job, block))
                if len(running) >= jobs * IN_FLIGHT:
                    break
            if not running:
                return finished, set()
            ended, running = wait(running, return_when=FIRST_COMPLETED)
            for done in (future.result() for future in ended):
                finished.add(done.block)
                keep(done)
    except BrokenProcessPool:
        return finished, {block for block, mark in enumerate(begun) if mark} - finished
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _begin_process(begun):
    """Ctrl-C reaches every process of the terminal; a worker ends with its driver, however that ends."""
    import signal

    from .orphans import end_with_parent

    global _begun
    _begun = begun
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _solve_noted(job, block):
    """Solve a block; who looks on can tell in whose midst a process died."""
    _begun[block] = 1
    done = solve_block(job, block)
    _begun[block] = 0
    return done


def _keep(sweep, done: BlockDone, advance):
    sweep.done[done.block] = done
    # Cases of a process that died count too, but it could not tell.
    advance(len(sweep.job.cases(done.block)) - sweep.kept[done.block])


def _note_deaths(job, blocks, deaths):
    """A death at the case that is next in each of `blocks`."""
    for block in blocks:
        place = _place(job, block)
        if place[1] in job.cases(block):
            deaths[place] += 1
            if deaths[place] >= MOST_DEATHS:
                give_up_case(job, block)


def _place(job, block):
    return block, next_case(job, block)


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
