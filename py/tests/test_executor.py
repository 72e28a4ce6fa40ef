"""Sweeps by other processes, of which some are killed, against those of one process."""

import asyncio
import faulthandler
import os
import pickle
import random
import signal
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import opm_kinematics as opm
import pytest
from opm_kinematics import _executor
from opm_kinematics._executor import run

#: Of the moments at which workers are killed.
SEED = int(os.environ.get("OPM_TEST_SEED", "5"))

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


@contextmanager
def within(seconds, what):
    """Fails the test, and shows where its threads are, where the body takes longer; gives what sets another limit."""

    def again(seconds, what):
        def late(*_):
            faulthandler.dump_traceback(all_threads=True, file=sys.__stderr__)
            pytest.fail(f"not done in {seconds} s: {what}")

        signal.signal(signal.SIGALRM, late)
        # Once more every 10 s, for what cleans up and hangs too.
        signal.setitimer(signal.ITIMER_REAL, seconds, 10)

    before = signal.getsignal(signal.SIGALRM)
    again(seconds, what)
    try:
        yield again
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


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
    with pytest.raises(KeyboardInterrupt):
        sweep(Here([KeyboardInterrupt()]))
    with pytest.raises(opm.OpmError, match="expected a concurrent.futures.Executor"):
        sweep(3)
    with pytest.raises(opm.OpmError, match="gave 3, expected"):
        sweep(lambda: 3)
    with pytest.raises(opm.OpmError, match="shards are given, but no executor"):
        opm.sweep(manipulator, shards=3, **GRID)


def test_whatever_the_executor_raises_a_lost_part_runs_again(manipulator, alone):
    # The first is what Dask's executor makes of a result whose worker is lost while it is fetched.
    signs = [
        AttributeError("'int' object has no attribute 'with_traceback'"),
        TypeError("cannot unpack"),
        ValueError("state"),
        asyncio.CancelledError(),
        TimeoutError(),
        pickle.UnpicklingError("cut off"),
    ]
    here = Here(signs, every=5)
    agree(opm.sweep(manipulator, executor=here, **GRID), alone)
    assert not here.signs and here.calls == 34 + len(signs)


class Garbling(Here):
    """One of its futures gives something else than what the work gave."""

    def submit(self, fn, /, *args, **kwargs):
        future = super().submit(fn, *args, **kwargs)
        if self.calls == 4:
            future = Future()
            future.set_result((3, 4, 5))
        return future


def test_what_is_no_answer_is_a_lost_part(manipulator, alone):
    here = Garbling([])
    agree(opm.sweep(manipulator, executor=here, **GRID), alone)
    assert here.calls == 35


class Unpicklable(Exception):
    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


class Failing:
    """Work that fails by itself, which says nothing about workers."""

    errors = [ZeroDivisionError("work"), AttributeError("work"), OSError("disk"), BrokenExecutor("work"), Unpicklable(1, 2)]

    def count(self, number):
        raise self.errors[number]


def test_what_the_work_raises_is_raised_once():
    for number, error in enumerate(Failing.errors):
        here = Here([])
        expected, message = (type(error), str(error)) if number < 4 else (RuntimeError, "Unpicklable: 1 and 2")
        with pytest.raises(expected, match=f"^{message}$"):
            run(here, Failing(), "count", [(number,)])
        assert here.calls == 1


def test_an_empty_workspace(manipulator):
    found = opm.sweep(manipulator, executor=Here([]), x=5.0)
    assert found.count == 0 and found.points(executor=Here([])).shape == (0, 5)
    assert found.imaginary_range["theta11"] is None


class Doomed(ProcessPoolExecutor):
    """A pool of which one worker is killed soon."""

    def submit(self, fn, /, *args, **kwargs):
        future = super().submit(fn, *args, **kwargs)
        if args[2][0] == 10:
            os.kill(next(iter(self._processes)), signal.SIGKILL)
        return future


def test_process_pools_one_of_which_breaks(manipulator, alone):
    made = []

    def make():
        kind = ProcessPoolExecutor if made else Doomed
        made.append(kind(2, mp_context=get_context("spawn")))
        return made[-1]

    with within(90, "the sweep"):
        found = opm.sweep(manipulator, executor=make, threads=1, **GRID)
    agree(found, alone)
    assert len(made) == 2
    with within(90, "points and mask"), ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        np.testing.assert_array_equal(found.points(executor=pool), alone.points())
        np.testing.assert_array_equal(found.mask(executor=pool), alone.mask())


class Threads(ThreadPoolExecutor):
    """The standard library's, which counts its calls."""

    calls = 0

    def submit(self, fn, /, *args, **kwargs):
        self.calls += 1
        return super().submit(fn, *args, **kwargs)


class Cluster(Here):
    """As Dask's executor tells how many threads its workers have: none at first, where they are still to come."""

    def __init__(self, *threads):
        super().__init__([])
        self._client = SimpleNamespace(nthreads=lambda: {f"tcp://{number}": count for number, count in enumerate(threads)})


def test_parts_follow_the_number_of_workers(manipulator):
    grid = GRID | {"x": (-0.25, 0.25, 301)}
    alone = opm.sweep(manipulator, threads=1, **grid)
    most = -(-alone.poses // 2**15)
    assert most > 96
    pools = [(Threads(1), 8), (Threads(3), 24), (Threads(64), most), (Here([]), 64), (Cluster(), 64), (Cluster(2, 2), 64), (Cluster(8, 4), 96)]
    for pool, parts in pools:
        with pool:
            assert opm.sweep(manipulator, threads=1, executor=pool, **grid).count == alone.count
            assert pool.calls == parts
            opm.sweep(manipulator, threads=1, executor=pool, shards=5, **grid)
            assert pool.calls == parts + 5


class Slow:
    """A sweep of which every part takes its time, so that a worker can be killed in the middle of one."""

    def __init__(self, sweep, folder):
        self.sweep, self.folder = sweep, folder

    def _count(self, number, of):
        (self.folder / f"{number}-{os.getpid()}").touch()
        time.sleep(0.15)
        return self.sweep._count(number, of)


class Killing(Executor):
    """A cluster's; it kills a worker when so many parts have come back."""

    def __init__(self, client, after):
        pids = client.run(os.getpid)
        assert os.getpid() not in pids.values() and len(pids) == 2
        self.inner, self.victim = client.get_executor(pure=False), next(iter(pids.values()))
        self.after, self.submitted, self.returned, self.killed = after, 0, 0, None

    def submit(self, fn, /, *args, **kwargs):
        future = self.inner.submit(fn, *args, **kwargs)
        self.submitted += 1
        future.add_done_callback(self.came)
        return future

    def came(self, _):
        self.returned += 1
        if self.returned == self.after:
            self.killed = self.victim
            os.kill(self.victim, signal.SIGKILL)


def test_a_dask_cluster_of_which_a_worker_is_killed(alone, tmp_path: Path):
    distributed = pytest.importorskip("distributed")
    parts = 24
    with (
        within(90, "Dask"),
        distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        # Two workers, which may become more.
        assert _executor.Workers(client.get_executor(pure=False)).shards() == 64
        executor = Killing(client, after=4)
        counted = run(executor, Slow(alone, tmp_path), "_count", [(number, parts) for number in range(1, parts + 1)])
    here = [alone._count(number, parts) for number in range(1, parts + 1)]
    assert counted == here and sum(part[1] for part in counted) == alone.count
    began = [name.name.split("-") for name in tmp_path.iterdir()]
    # Both worked; what the killed one had begun was begun again by another process.
    assert executor.killed in {int(pid) for _, pid in began} and len({pid for _, pid in began}) >= 2
    assert len(began) > parts and {int(number) for number, _ in began} == set(range(1, parts + 1))


class Stuck(Here):
    """Some of its futures never complete: those of the calls that are given."""

    def __init__(self, calls, signs=(), every=7):
        super().__init__(signs, every)
        self.stuck, self.silent = set(calls), []

    def submit(self, fn, /, *args, **kwargs):
        future = super().submit(fn, *args, **kwargs)
        if self.calls in self.stuck:
            future = Future()
            self.silent.append(future)
        return future


def test_parts_whose_futures_never_complete_are_submitted_again(alone, monkeypatch):
    monkeypatch.setattr(_executor, "PATIENCE", 0.05)
    parts = [(number, 12) for number in range(1, 13)]
    expected = [alone._count(*part) for part in parts]
    with within(30, "run"):
        # Two parts are silent at first, and one of the two that are submitted again; then the last is lost.
        here = Stuck({3, 12, 14}, [KilledWorker("gone")], every=15)
        assert run(here, alone, "_count", parts) == expected
        assert here.calls == 12 + 2 + 1 + 1 and all(future.cancelled() for future in here.silent)
        # All of them, and nothing else to wake up for.
        assert run(Stuck(range(1, 13)), alone, "_count", parts) == expected


class Late(Executor):
    """Says nothing, as Dask's executor, until a part is submitted again; then the first submission is done first, or not."""

    def __init__(self, *order):
        self.order, self.futures, self.calls = order, [], 0

    def submit(self, fn, /, *args, **kwargs):
        self.calls += 1
        self.futures.append((Future(), fn(*args, **kwargs)))
        future = self.futures[-1][0]
        if len(self.futures) == 2:
            for number in self.order:
                other, answer = self.futures[number]
                if other.set_running_or_notify_cancel():
                    other.set_result(answer)
        return future


class Number:
    def same(self, number):
        return number


@pytest.mark.parametrize("order", [(0,), (1,), (0, 1), (1, 0)])
def test_the_first_answer_of_a_part_counts(order, monkeypatch):
    monkeypatch.setattr(_executor, "PATIENCE", 0.05)
    late = Late(*order)
    with within(30, "run"):
        assert run(late, Number(), "same", [(3,)], fold=lambda one, two: one + two) == 3
    assert late.calls == 2 and all(future.done() for future, _ in late.futures)


class Sleeping:
    def sleep(self, seconds):
        time.sleep(seconds)
        return seconds


def test_a_slow_part_is_not_lost(monkeypatch):
    monkeypatch.setattr(_executor, "PATIENCE", 0.01)
    # Threads say what they work on; then nothing is submitted again.
    with Threads(1) as pool, within(30, "run"):
        assert run(pool, Sleeping(), "sleep", [(0.3,), (0.2,)]) == [0.3, 0.2]
        assert pool.calls == 2


class Single(Here):
    """Its shutdown has no other options, as that of Dask's executor."""

    closed = False

    def shutdown(self, wait=True):
        self.closed = True


def test_executors_that_are_made_are_closed():
    single = Single([])
    assert run(lambda: single, Number(), "same", [(1,), (2,)]) == [1, 2]
    assert single.closed


@pytest.fixture
def threads_of_dask():
    """A Dask client whose worker is a thread of this process."""
    distributed = pytest.importorskip("distributed")
    with (
        within(50, "Dask"),
        distributed.LocalCluster(1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def first_result(client, monkeypatch, change):
    """Changes what the first of Dask's futures gives to its executor: `change` gets the future and its result."""
    from distributed.client import Future as DaskFuture

    given, changed = DaskFuture._result, []

    async def result(self, raiseit=True):
        result = await given(self, raiseit)
        if not changed:
            changed.append(self)
            change(self, result)
        return result

    monkeypatch.setattr(DaskFuture, "_result", result)
    return changed


@pytest.mark.parametrize("state", ["lose", "reset"])
def test_dask_takes_a_result_for_an_exception(state, threads_of_dask, monkeypatch):
    # The state changes after the result is there: `AttributeError: ... no attribute 'with_traceback'`, or a TypeError.
    changed = first_result(threads_of_dask, monkeypatch, lambda future, _: getattr(future._state, state)())
    parts = [((number, number, number),) for number in range(6)]
    assert run(threads_of_dask.get_executor(), Number(), "same", parts) == [part for part, in parts]
    assert changed


def test_dask_raises_where_nobody_listens(threads_of_dask, monkeypatch):
    # The coroutine that completes a future of the executor ends with the error. The future stays as it is.
    def fail(_future, _result):
        raise KilledWorker("while it was fetched")

    monkeypatch.setattr(_executor, "PATIENCE", 0.5)
    changed = first_result(threads_of_dask, monkeypatch, fail)
    # By default Dask takes equal calls for one.
    assert run(threads_of_dask.get_executor(), Number(), "same", [(number,) for number in range(6)]) == list(range(6))
    assert changed


#: Workers that are killed in each of the two tests below. More by the environment: 50 are 100 in all.
KILLS = int(os.environ.get("OPM_TEST_KILLS", "2"))


class Steady:
    """A sweep of which every part takes long enough that a kill at a random moment meets all states of a part."""

    def __init__(self, sweep):
        self.sweep = sweep

    def _count(self, number, of):
        time.sleep(0.01)
        return self.sweep._count(number, of)


def test_process_pools_whose_workers_are_killed_at_random_moments(alone):
    parts = [(number, 24) for number in range(1, 25)]
    expected = [alone._count(*part) for part in parts]
    rng = random.Random(SEED)
    killed = runs = 0
    while killed < KILLS:
        pools = []

        def make():
            pools.append(ProcessPoolExecutor(2, mp_context=get_context("spawn")))
            return pools[-1]

        def kill():
            nonlocal killed
            # From a pool that is not yet made to one whose work is done.
            processes = list((pools[0]._processes or {}).values()) if pools else []
            for process in processes[:1]:
                process.kill()
                killed += 1

        timer = threading.Timer(rng.uniform(0.05, 1.5), kill)
        start = time.monotonic()
        with within(60, f"the sweep while worker {killed + 1} is killed"):
            timer.start()
            assert run(make, Steady(alone), "_count", parts) == expected
            timer.join()
        runs += 1
        print(f"pool: run {runs}, {killed} killed, {len(pools)} pools, {time.monotonic() - start:.2f} s", flush=True)
        assert 1 <= len(pools) <= 2


def connected(cluster, number, seconds):
    """The nannies whose workers the scheduler knows: as many as asked for, unless they take too long."""
    end = time.monotonic() + seconds
    while True:
        known = cluster.scheduler.workers
        nannies = [nanny for nanny in list(cluster.workers.values()) if nanny.worker_address in known and nanny.pid]
        if len(nannies) >= number or time.monotonic() > end:
            return nannies
        time.sleep(0.05)


def test_a_dask_cluster_whose_workers_are_killed_at_random_moments(alone):
    distributed = pytest.importorskip("distributed")
    parts = [(number, 24) for number in range(1, 25)]
    expected = [alone._count(*part) for part in parts]
    rng = random.Random(SEED)
    killed = 0
    while killed < KILLS:
        with (
            within(60, "a Dask cluster starts, or ends") as again,
            distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
            distributed.Client(cluster) as client,
        ):
            # A nanny can give up: then it is a new cluster's turn.
            while killed < KILLS and len(nannies := connected(cluster, 2, seconds=20)) == 2:
                again(60, f"the sweep while worker {killed + 1} is killed")
                timer = threading.Timer(rng.uniform(0.0, 0.4), os.kill, (rng.choice(nannies).pid, signal.SIGKILL))
                start = time.monotonic()
                timer.start()
                assert run(client.get_executor(pure=False), Steady(alone), "_count", parts) == expected
                timer.join()
                killed += 1
                print(f"Dask: {killed} killed, {time.monotonic() - start:.2f} s", flush=True)
                again(60, "a Dask cluster gets a new worker, or ends")


# Only large rounds go to an executor: the last of these are.
BOXES = {"over": {"x": (-0.2, 0.2), "y": (-0.2, 0.2), "zeta": (-0.3, 0.3), "xi": (0.0, 0.3)}, "tolerance": 0.0, "budget": 60_000}


def measures(found):
    return found.lower, found.upper, found.boxes, found.stop, found.over


@pytest.fixture(scope="module")
def measured(manipulator):
    found = opm.measure(manipulator, threads=1, **BOXES)
    assert found.stop == "budget" and 0 < found.lower < found.upper < found.whole
    return found


def test_measures_ask_executors_for_large_rounds(manipulator, measured):
    signs = [KilledWorker("gone"), OSError("reset")]
    here = Here(signs, every=2)
    found = opm.measure(manipulator, executor=here, **BOXES)
    assert measures(found) == measures(measured) and here.calls >= 4 and not here.signs
    # Half of the budget, and the rounds are not worth anybody's while; the same when nobody may have two.
    small = BOXES | {"budget": 10_000}
    for more, boxes in [({}, small), ({"shards": 1}, BOXES)]:
        nobody = Here([])
        found = opm.measure(manipulator, executor=nobody, **boxes, **more)
        assert measures(found) == measures(opm.measure(manipulator, **boxes)) and nobody.calls == 0


def test_measures_of_every_section_and_mode_on_executors(manipulator):
    theta = {name: (-0.5, 0.5) for name in manipulator.imaginary_names}
    for options in [
        {"section": "upper"},
        {"section": "lower", "over": {"x": (-0.2, 0.2), "y": (-0.2, 0.2), **theta}},
        {"mode": "any", "over": {"x": (-0.2, 0.2), "y": (-0.2, 0.2), "zeta": (-0.3, 0.3), "xi": (0.0, 0.3)}},
        {"mode": "-+ ++ ++ +", "over": {"x": (-0.4, 0.4), "y": (-0.4, 0.4), "zeta": (-0.3, 0.3), "xi": (0.0, 0.3)}},
    ]:
        here = Here([])
        found = opm.measure(manipulator, executor=here, tolerance=0.0, budget=50_000, **options)
        assert measures(found) == measures(opm.measure(manipulator, tolerance=0.0, budget=50_000, **options))
        assert here.calls > 0 and found.upper > 0


def test_measures_by_process_pools(manipulator, measured):
    made = []

    def make():
        made.append(ProcessPoolExecutor(2, mp_context=get_context("spawn")))
        return made[-1]

    with within(90, "measure"):
        assert measures(opm.measure(manipulator, executor=make, threads=1, **BOXES)) == measures(measured)
    # One pool for all rounds.
    assert len(made) == 1
    over = {name: (low, high, 2) for name, (low, high) in BOXES["over"].items()}
    swept = opm.sweep(manipulator, threads=1, **over)
    with within(90, "measure"), ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = swept.measure(tolerance=0.0, budget=BOXES["budget"], executor=pool)
    assert measures(found) == measures(measured)


def test_measures_by_a_dask_cluster_of_which_a_worker_is_killed(manipulator, measured):
    distributed = pytest.importorskip("distributed")
    with (
        within(90, "Dask"),
        distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        executor = Killing(client, after=1)
        found = opm.measure(manipulator, executor=executor, threads=1, **BOXES)
        assert measures(found) == measures(measured)
        # It was in the middle: parts were submitted after the worker had gone.
        assert executor.killed is not None and executor.submitted > 2
        assert executor.killed not in client.run(os.getpid).values()


def test_ctrl_c_stops_a_measure_by_an_executor(manipulator):
    threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        opm.measure(manipulator, executor=Here([]), **BOXES | {"budget": 2**40})
    assert time.monotonic() - start < 30  # alone it would take years
