"""Sweeps by other processes, of which some are killed, against those of one process."""

import os
import pickle
import signal
import time
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import opm_kinematics as opm
import pytest

GRID = {"x": (-0.25, 0.25, 101), "y": (-0.2, 0.2, 81), "zeta": 0.1, "xi": (-0.9, 0.9, 15), "psi": (-0.3, 0.3, 9)}


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof").with_parameters(a2=0.055)


@pytest.fixture(scope="module")
def alone(manipulator):
    return opm.sweep(manipulator, threads=1, **GRID)


def agree(found, alone):
    assert (found.count, found.poses) == (alone.count, alone.poses) and 0 < found.fraction < 1
    assert found.imaginary_range == alone.imaginary_range
    np.testing.assert_array_equal(found.mask(), alone.mask())


class Here(Executor):
    """Works at once, on what has been pickled; every seventh part is lost, as the results say that are given."""

    def __init__(self, signs, every=7):
        self.signs, self.every, self.calls = list(signs), every, 0

    def submit(self, fn, /, *args, **kwargs):
        self.calls += 1
        future = Future()
        if self.signs and self.calls % self.every == 0:
            future.set_exception(self.signs.pop())
        else:
            work, given = pickle.loads(pickle.dumps((fn, args)))
            future.set_result(pickle.loads(pickle.dumps(work(*given))))
        return future


class KilledWorker(Exception):
    """As Dask calls it."""


def test_lost_parts_run_again(manipulator, alone):
    signs = [KilledWorker("gone"), OSError("reset"), KilledWorker("again")]
    for shards in (1, 5, 1000):
        here = Here(signs)
        found = opm.sweep(manipulator, executor=here, shards=shards, **GRID)
        agree(found, alone)
        parts = min(shards, -(-alone.poses // 2**15))
        assert here.calls == parts + (3 - len(here.signs))
        np.testing.assert_array_equal(found.mask(executor=Here(signs), shards=shards), alone.mask())
        np.testing.assert_array_equal(found.points(executor=Here(signs), shards=shards), alone.points())


def test_a_sweep_can_be_pickled(alone):
    again = pickle.loads(pickle.dumps(alone))
    agree(again, alone)
    np.testing.assert_array_equal(again.points(), alone.points())


def test_what_is_lost_for_good_is_told(manipulator):
    sweep = lambda executor, **more: opm.sweep(manipulator, executor=executor, **GRID, **more)  # noqa: E731
    with pytest.raises(opm.OpmError, match=r"34 of 34 parts were lost with their workers \(KilledWorker: gone\)$"):
        sweep(Here([KilledWorker("gone")] * 1000, every=1))
    broken = Here([BrokenExecutor("pool")] * 1000, every=1)
    with pytest.raises(opm.OpmError, match=r"lost with their workers \(BrokenExecutor: pool\); give a function"):
        sweep(broken)
    assert broken.calls == 34
    with pytest.raises(ZeroDivisionError, match="work"):
        sweep(Here([ZeroDivisionError("work")]))
    with pytest.raises(opm.OpmError, match="expected a concurrent.futures.Executor"):
        sweep(3)
    with pytest.raises(opm.OpmError, match="gave 3, expected"):
        sweep(lambda: 3)
    with pytest.raises(opm.OpmError, match="shards are given, but no executor"):
        opm.sweep(manipulator, shards=3, **GRID)


def test_an_empty_workspace(manipulator):
    found = opm.sweep(manipulator, executor=Here([]), x=5.0)
    assert found.count == 0 and found.points(executor=Here([])).shape == (0, 5)
    assert found.imaginary_range["theta11"] is None


class Doomed(ProcessPoolExecutor):
    """A pool of which one worker is killed soon."""

    def submit(self, fn, /, *args, **kwargs):
        future = super().submit(fn, *args, **kwargs)
        if len(args) > 2 and args[2] == 20:
            os.kill(next(iter(self._processes)), signal.SIGKILL)
        return future


def test_process_pools_one_of_which_breaks(manipulator, alone):
    made = []

    def make():
        kind = ProcessPoolExecutor if made else Doomed
        made.append(kind(2, mp_context=get_context("spawn")))
        return made[-1]

    found = opm.sweep(manipulator, executor=make, threads=1, **GRID)
    agree(found, alone)
    assert len(made) == 2
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        np.testing.assert_array_equal(found.points(executor=pool), alone.points())
        np.testing.assert_array_equal(found.mask(executor=pool), alone.mask())


class Slow:
    """A sweep of which every part takes its time, so that a worker can be killed in the middle of one."""

    def __init__(self, sweep, folder):
        self.sweep, self.folder = sweep, folder

    def _count(self, number, of):
        (self.folder / f"{number}-{os.getpid()}").touch()
        time.sleep(0.15)
        return self.sweep._count(number, of)


def test_a_dask_cluster_of_which_a_worker_is_killed(alone, tmp_path: Path):
    distributed = pytest.importorskip("distributed")
    from opm_kinematics._executor import run

    parts = 24
    with (
        distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = client.run(os.getpid)
        assert os.getpid() not in pids.values() and len(pids) == 2

        class Killing(Executor):
            """The cluster's; it kills a worker when the first parts have come back."""

            def __init__(self):
                self.inner, self.returned, self.killed = client.get_executor(pure=False), 0, None

            def submit(self, fn, /, *args, **kwargs):
                future = self.inner.submit(fn, *args, **kwargs)
                future.add_done_callback(self.came)
                return future

            def came(self, _):
                self.returned += 1
                if self.returned == 4:
                    self.killed = next(iter(pids.values()))
                    os.kill(self.killed, signal.SIGKILL)

        client.register_plugin  # noqa: B018
        executor = Killing()
        counted = run(executor, Slow(alone, tmp_path), "_count", parts)
    here = [alone._count(number, parts) for number in range(1, parts + 1)]
    assert counted == here and sum(part[1] for part in counted) == alone.count
    began = [name.name.split("-") for name in tmp_path.iterdir()]
    # Both worked; what the killed one had begun was begun again by another process.
    assert executor.killed in {int(pid) for _, pid in began} and len({pid for _, pid in began}) >= 2
    assert len(began) > parts and {int(number) for number, _ in began} == set(range(1, parts + 1))
