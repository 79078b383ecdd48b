"""Kills of studies that the workers of a Dask cluster solve."""

import os
import signal
import subprocess
import sys
from importlib.util import find_spec

from .child import Hit, run_process
from .judge import KILLED, faults_of_end, faults_of_files, faults_of_finish
from .stage import Command, study, undisturbed
from .stops import Verdict

CLUSTER = """
from distributed import LocalCluster

if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        print(cluster.scheduler_address, flush=True)
        input()
"""


def kill_driver_of_cluster(stage, chance, number, folder) -> Verdict:
    """SIGKILL of the process that hands out the cases; given again, the study ends with the same bytes."""
    if find_spec("distributed") is None:
        return Verdict("sweep on Dask", skipped="Dask is not installed")
    alone = Command(
        "sweep on Dask", ("sweep", "s.toml", "-q"), ("s.h5",), {"s.toml": study(1500)}, resumable=True
    )
    command = undisturbed(alone, folder.parent / "whole")
    script = folder.parent / "cluster.py"
    script.write_text(CLUSTER)
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, script], text=True, cwd=folder.parent, **pipes) as cluster:
        command.arguments += ("--scheduler", cluster.stdout.readline().strip())
        before = command.prepare(folder, with_old=False)
        ended = command.run(folder, Hit(signal.SIGKILL, chance.uniform(2.0, 12.0)), run_process)
        found = faults_of_end(ended, {0, KILLED}) + faults_of_files(command, folder, before, ended)
        found += faults_of_finish(command, folder, before, command.finish(folder, run_process))
        cluster.stdin.write(os.linesep)
        cluster.stdin.close()
    return Verdict(command.name, found, not found and ended.code == KILLED)
