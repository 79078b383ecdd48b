"""Who solves the blocks of a study: this process, or processes beside it."""

from collections import Counter
from collections.abc import Callable, Iterable

from ..errors import ANALYSIS_FAILED, FlexmbError
from .sweep import MOST_DEATHS, BlockDone, Job, Sweep, give_up_case, next_case, solve_block

IN_FLIGHT = 4  # blocks a worker is given ahead


class WorkersError(FlexmbError):
    """The processes of a study do not live long enough to solve anything (exit 1)."""

    exit_code = ANALYSIS_FAILED


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
        finished, struck = _pool(sweep.job, given, processes, lambda done: keep(sweep, done, advance))
        waiting = [block for block in waiting if block not in finished]
        note_deaths(sweep.job, struck, deaths)
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
    from multiprocessing import active_children, get_context

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
    except BaseException:
        # What is then told to be kept shall not grow any more.
        for child in active_children():
            child.kill()
            child.join()
        raise
    finally:
        # Its threads would otherwise close their lines while Python, at its end, still writes to them.
        pool.shutdown(cancel_futures=True)


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


def keep(sweep: Sweep, done: BlockDone, advance: Callable[[int], None]) -> None:
    """Note that a block is done; `advance` is told how many cases this call brought."""
    sweep.done[done.block] = done
    # Cases of a process that died count too, but it could not tell.
    advance(len(sweep.job.cases(done.block)) - sweep.kept[done.block])


def note_deaths(job: Job, blocks: Iterable[int], deaths: Counter) -> None:
    """Count a death at the case that is next in each of `blocks`; a case with too many is given up."""
    for block in blocks:
        place = _place(job, block)
        if place[1] in job.cases(block):
            deaths[place] += 1
            if deaths[place] >= MOST_DEATHS:
                give_up_case(job, block)


def _place(job, block):
    return block, next_case(job, block)
