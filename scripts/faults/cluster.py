"""Kills of studies that the workers of a Dask cluster solve."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from importlib.util import find_spec
from threading import Timer

from .child import Hit, run_process
from .judge import KILLED, faults_of_end, faults_of_files, faults_of_finish
from .stage import Command, study, undisturbed
from .stops import Verdict

CLUSTER = """
import sys

from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(int(sys.argv[1]), threads_per_worker=1, dashboard_address=None) as cluster:
        print(cluster.scheduler_address, *(worker.pid for worker in cluster.workers.values()), flush=True)
        input()
"""
MOST_KILLS = 12


def kill_driver_of_cluster(stage, chance, number, folder) -> Verdict:
    """SIGKILL of the process that hands out the cases; given again, the study ends with the same bytes."""
    if find_spec("distributed") is None:
        return Verdict("sweep on Dask", skipped="Dask is not installed")
    command = _study(1500, folder)
    with _cluster(folder.parent, 1) as (address, _):
        command.arguments += ("--scheduler", address)
        before = command.prepare(folder, with_old=False)
        ended = command.run(folder, Hit(signal.SIGKILL, chance.uniform(2.0, 12.0)), run_process)
        found = faults_of_end(ended, {0, KILLED}) + faults_of_files(command, folder, before, ended)
        found += faults_of_finish(command, folder, before, command.finish(folder, run_process))
    return Verdict(command.name, found, not found and ended.code == KILLED)


def kill_driver_and_worker_of_cluster(stage, chance, number, folder) -> Verdict:
    """2,000 cases on two workers: one of them is killed, and the driver again and again until all is done."""
    if find_spec("distributed") is None:
        return Verdict("sweep on Dask", skipped="Dask is not installed")
    command, found, kills = _study(2000, folder), [], 0
    with _cluster(folder.parent, 2) as (address, workers):
        command.arguments += ("--scheduler", address)
        before = command.prepare(folder, with_old=False)
        death = Timer(chance.uniform(2.0, 5.0), os.kill, (workers[0], signal.SIGKILL))
        death.start()
        while kills < MOST_KILLS and not (folder / "s.h5").exists() and not found:
            ended = command.run(folder, Hit(signal.SIGKILL, chance.uniform(1.5, 4.0)), run_process)
            found += faults_of_end(ended, {0, KILLED}) + faults_of_files(command, folder, before, ended)
            kills += ended.code == KILLED
        death.join()
        found += faults_of_finish(command, folder, before, command.finish(folder, run_process))
    return Verdict(command.name, found, kills)


def _study(count, folder):
    files = ("sweep", "s.toml", "-q"), ("s.h5",), {"s.toml": study(count)}
    return undisturbed(Command("sweep on Dask", *files, resumable=True), folder.parent / "whole")


@contextmanager
def _cluster(folder, workers):
    """Address of a cluster and the numbers of its processes, as long as it is wanted."""
    script = folder / "cluster.py"
    script.write_text(CLUSTER)
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    arguments = [sys.executable, script, str(workers)]
    with subprocess.Popen(arguments, text=True, cwd=folder, **pipes) as cluster:
        address, *numbers = cluster.stdout.readline().split()
        yield address, [int(number) for number in numbers]
        cluster.stdin.write(os.linesep)
        cluster.stdin.close()
