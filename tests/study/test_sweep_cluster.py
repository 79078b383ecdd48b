"""Studies on a Dask cluster: every case is there once whoever dies, and only what is lethal is given up."""

import os
import signal
from types import SimpleNamespace

import pytest

from flexmb_cli.study import cluster as study_cluster
from flexmb_cli.study import workers
from flexmb_cli.study.sweep import Sweep, next_case, solve_block
from tests.study.studies import SAMPLED, SMALL, flexmb, written

pytestmark = pytest.mark.processes

LIMIT = 240  # s for a test, of which a quiet machine takes ten


@pytest.fixture(autouse=True)
def ended_in_time():
    """End a test whose cluster never answers: workers that Dask cannot start again are waited for."""
    if not hasattr(signal, "alarm"):
        yield
        return

    def give_up(number, frame):
        raise AssertionError(f"the cluster has not answered for {LIMIT} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(LIMIT)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def test_a_dask_cluster_survives_the_kill_of_a_worker(tmp_path):
    """Two worker processes, one killed while they solve: every case is there once, as solved here."""
    from distributed import LocalCluster

    here = Sweep.of(str(written(tmp_path / "here", SAMPLED, count=300)), str(tmp_path / "here/parts"))
    workers.solve_here(here, here.pending(), lambda cases: None)
    sweep = Sweep.of(str(written(tmp_path / "there", SAMPLED, count=300)), str(tmp_path / "there/parts"))
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        victims = [worker.pid for worker in cluster.workers.values()][:1]

        def advance(cases):
            while victims:
                os.kill(victims.pop(), signal.SIGKILL)

        study_cluster.solve_on_cluster(sweep, sweep.pending(), advance, cluster.scheduler_address)
    one, other = (list(found.results()) for found in (here, sweep))
    assert [r.case for r in other] == list(range(300))
    for a, b in zip(one, other, strict=True):
        assert (a.exit_code, a.rows, a.values.tolist()) == (b.exit_code, b.rows, b.values.tolist())


def test_a_scheduler_that_ends_on_the_way_is_told(tmp_path, monkeypatch):
    from distributed import LocalCluster

    monkeypatch.setattr(study_cluster, "PATIENCE", 2)
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=300)), str(tmp_path / "parts"))
    cluster = LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None)
    with pytest.raises(
        study_cluster.ClusterError, match=r"was lost: .*; the same command continues it"
    ) as lost:
        study_cluster.solve_on_cluster(
            sweep, sweep.pending(), lambda cases: cluster.close(), cluster.scheduler_address
        )
    assert lost.value.exit_code == 1
    assert 0 < len(list(sweep.results())) < 300


def test_a_cluster_without_workers_is_not_waited_for_without_end(tmp_path, monkeypatch):
    from distributed import LocalCluster

    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=3)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_cluster, "MUSTER", 1)
    with (
        LocalCluster(n_workers=0, dashboard_address=None) as cluster,
        pytest.raises(study_cluster.ClusterError, match="no worker has joined") as refused,
    ):
        study_cluster.solve_on_cluster(sweep, [0], lambda cases: None, cluster.scheduler_address)
    assert refused.value.exit_code == 2


def test_a_worker_of_another_version_solves_nothing(tmp_path, monkeypatch):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=3)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_cluster, "__version__", "9.9.9")
    with pytest.raises(study_cluster.ClusterError, match=r"a worker has flexmb 9\.9\.9, this study"):
        study_cluster.solve_share(sweep.job, [0])
    assert not list(sweep.results())


SOLVE_SHARE = study_cluster.solve_share


def share_ends_at_case_77(job, blocks):
    """In place of `solve_share`, in a worker: case 77 ends it, when those before are solved."""
    for block in blocks:
        # What comes next in a complete block is the first case of another.
        if 77 in job.cases(block) and next_case(job, block) == 77:
            os._exit(1)
        solve_block(job, block)
    return SOLVE_SHARE(job, blocks)


def test_only_the_case_that_ends_workers_of_a_cluster_is_given_up(tmp_path, monkeypatch):
    """What waited for the worker that died is taken for struck by Dask, too, and is solved all the same."""
    import dask
    from distributed import LocalCluster

    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=100)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_cluster, "solve_share", share_ends_at_case_77)
    monkeypatch.setattr(workers, "MOST_DEATHS", 2)  # to start another worker takes seconds
    reported = []
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        study_cluster.solve_on_cluster(sweep, sweep.pending(), reported.append, cluster.scheduler_address)
    assert [result.case for result in sweep.results()] == list(range(100)) and sum(reported) == 100
    assert [result.case for result in sweep.results() if result.exit_code] == [77]


def share_whose_answer_is_lost(job, blocks):
    """In place of `solve_share`: the worker dies when all is solved, before it can tell."""
    from distributed import KilledWorker

    ATTEMPTS.append(blocks)
    if len(ATTEMPTS) > 20:
        raise AssertionError("the same blocks are handed out again and again")
    SOLVE_SHARE(job, blocks)
    raise KilledWorker("share", SimpleNamespace(address="here"), 1)


ATTEMPTS = []  # shares that were tried: the worker is a thread of this process


def test_what_a_worker_kept_before_it_died_is_not_handed_out_again(tmp_path, monkeypatch):
    from distributed import LocalCluster

    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=10)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_cluster, "solve_share", share_whose_answer_is_lost)
    monkeypatch.setattr("tests.study.test_sweep_cluster.ATTEMPTS", [])
    reported = []
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=None
    ) as cluster:
        study_cluster.solve_on_cluster(sweep, sweep.pending(), reported.append, cluster.scheduler_address)
    assert sorted(block for share in ATTEMPTS for block in share) == list(range(10))
    assert sum(reported) == 10 and sorted(sweep.done) == list(range(10)) and sweep.failed == 0


def test_a_scheduler_that_does_not_answer_is_told(tmp_path, monkeypatch):
    sweep = Sweep.of(str(written(tmp_path, SAMPLED, count=3)), str(tmp_path / "parts"))
    monkeypatch.setattr(study_cluster, "PATIENCE", 1)
    with pytest.raises(study_cluster.ClusterError, match="no Dask scheduler answers at tcp:"):
        study_cluster.solve_on_cluster(sweep, [0], lambda cases: None, "tcp://127.0.0.1:1")


@pytest.mark.parametrize("address", ["nowhere", "post://office:1"])
def test_what_is_no_address_of_a_scheduler_is_told(tmp_path, address):
    done = flexmb("sweep", written(tmp_path, SMALL), "--scheduler", address, cwd=tmp_path, check=False)
    assert done.returncode == 2 and f"no Dask scheduler answers at {address}" in done.stderr
    assert "Traceback" not in done.stderr
