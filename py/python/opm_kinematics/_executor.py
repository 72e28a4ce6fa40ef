"""Parts of some work on any executor: submitted as pickled specifications, run again if a worker is lost.

What the work itself returns or raises comes back in an :class:`_Answer`. Anything else that a future returns or raises comes
from the executor, and says that the part was lost. Parts have no side effects: a lost one runs again.

A future may also never complete: an error can end the coroutine that completes a future of Dask's executor, where a worker
is lost while a result is fetched. So where nothing comes for a while, the missing parts are submitted once more. The first
answer counts.
"""

import itertools
import pickle
import queue
from asyncio import CancelledError
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from functools import partial
from types import TracebackType
from typing import Any

from ._native import OpmError

__all__ = ["Workers", "run"]

#: Parts for each worker, so that all have work to the end and little is lost with one; and for workers of an unknown number.
SHARDS_EACH = 8
SHARDS = 64

#: How often a part is run again before it is given up.
RETRIES = 3

#: After how many seconds without an answer the missing parts are submitted once more; doubled each time.
PATIENCE = 10.0

#: A number for each submission. Dask takes two calls with equal arguments for one, with one state.
SUBMISSIONS = itertools.count()

#: What a future raises for a lost part. The rest of BaseException, as KeyboardInterrupt, ends the whole work.
LOST = (Exception, CancelledError)


class Workers:
    """An executor, or one that is made when it is needed, and again where a broken one takes no more work.

    Those that are made here are closed with it, or when they are broken; one that is given is left as it is.

    Parameters
    ----------
    executor : concurrent.futures.Executor or callable
        An executor, or a function that makes one.
    """

    def __init__(self, executor: Executor | Callable[[], Executor]) -> None:
        self._given = executor if isinstance(executor, Executor) else None
        self._make = executor
        self._made: Executor | None = None
        if self._given is None and not callable(executor):
            raise OpmError(f"executor is {executor!r}, expected a concurrent.futures.Executor, or a function that makes one")

    def __enter__(self) -> "Workers":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the executor that was made."""
        if self._made is not None:
            # What has not begun is cancelled by now. Dask's executor has no option for that.
            self._made.shutdown(wait=False)
            self._made = None

    def shards(self) -> int:
        """A suitable number of parts for the executor, which is made if there is none yet."""
        workers = _number_of_workers(self._executor())
        return SHARDS if workers is None else SHARDS_EACH * workers

    def run(
        self,
        plan: object,
        task: str,
        parts: Sequence[tuple[Any, ...]],
        fold: Callable[[Any, Any], Any] | None = None,
    ) -> Any:
        """The results of the parts.

        Parameters
        ----------
        plan : object
            Pickled with every part.
        task : str
            Which method of the plan works on a part.
        parts : sequence of tuple
            Its arguments, one tuple for each part.
        fold : callable, optional
            Combines the results of two parts, in the order in which they come, so that only one is kept.

        Returns
        -------
        list or object
            One result for each part, in their order; or the one result of `fold`.

        Raises
        ------
        OpmError
            A part was lost with its worker repeatedly, or the executor is broken.
        Exception
            What the work itself raised.
        """
        results = _Results(fold)
        missing = dict(enumerate(parts))
        lost: BaseException | None = None
        for _ in range(1 + RETRIES):
            lost = _round(self._executor(), plan, task, missing, results)
            if not missing:
                return results.all(len(parts))
            if isinstance(lost, BrokenExecutor):
                if self._given is not None:
                    break  # a broken executor never takes work again
                self.close()
        hint = "; give a function that makes executors, to go on in a new one" if isinstance(lost, BrokenExecutor) else ""
        raise OpmError(
            f"{len(missing)} of {len(parts)} parts were lost with their workers ({type(lost).__name__}: {lost}){hint}"
        ) from lost

    def _executor(self) -> Executor:
        if self._given is not None:
            return self._given
        if self._made is None:
            made = self._make()  # type: ignore[operator]
            if not isinstance(made, Executor):
                raise OpmError(f"executor gave {made!r}, expected a concurrent.futures.Executor")
            self._made = made
        return self._made


def run(
    executor: Executor | Callable[[], Executor],
    plan: object,
    task: str,
    parts: Sequence[tuple[Any, ...]],
    fold: Callable[[Any, Any], Any] | None = None,
) -> Any:
    """:meth:`Workers.run` of workers who have nothing else to do."""
    with Workers(executor) as workers:
        return workers.run(plan, task, parts, fold)


class _Results:
    """The results of the parts: one by one, or folded."""

    def __init__(self, fold: Callable[[Any, Any], Any] | None) -> None:
        self._fold, self._folded, self._each = fold, [], {}  # type: ignore[var-annotated]

    def add(self, number: int, result: Any) -> None:
        if self._fold is None:
            self._each[number] = result
        else:
            self._folded = [self._fold(self._folded[0], result) if self._folded else result]

    def all(self, parts: int) -> Any:
        return self._folded[0] if self._fold is not None else [self._each[number] for number in range(parts)]


def _round(
    pool: Executor, plan: object, task: str, missing: dict[int, tuple[Any, ...]], results: _Results
) -> BaseException | None:
    """Runs the parts that are missing once, removes those that have a result, and returns the evidence of a lost worker.

    If the executor is broken, that is the evidence: it takes no more work.
    """
    submitted = _Submitted(pool, plan, task)
    patience = PATIENCE
    lost: BaseException | None = None
    try:
        lost = submitted.add(missing)
        while submitted.futures:
            try:
                number, future = submitted.done.get(timeout=patience)
            except queue.Empty:
                if not submitted.running():
                    lost = submitted.add({number: missing[number] for number in submitted.futures}) or lost
                    patience *= 2
                continue
            if number not in submitted.futures:
                continue  # another submission of this part was first
            # A future keeps its result: with the last reference to it both go. Other submissions of the part go with it.
            submitted.drop(number)
            try:
                answer = future.result()
                if not isinstance(answer, _Answer):
                    raise TypeError(f"the executor gave {type(answer).__name__} for the answer of a part")
            except LOST as error:
                lost = lost if isinstance(lost, BrokenExecutor) else error
                continue
            if answer.error is not None:
                raise answer.error
            results.add(number, answer.result)
            del missing[number]
    finally:
        for number in list(submitted.futures):
            submitted.drop(number)
    return lost


class _Submitted:
    """The parts that are under way, each with the futures of its submissions."""

    def __init__(self, pool: Executor, plan: object, task: str) -> None:
        self._pool, self._plan, self._task = pool, plan, task
        self.futures: dict[int, list[Future[Any]]] = {}
        #: The futures that are done, each with the number of its part.
        self.done: queue.SimpleQueue[tuple[int, Future[Any]]] = queue.SimpleQueue()

    def add(self, parts: dict[int, tuple[Any, ...]]) -> BrokenExecutor | None:
        """Submits parts, up to the first that a broken executor refuses; gives what it raised."""
        for number, part in parts.items():
            try:
                future = self._pool.submit(_work, self._plan, self._task, part, next(SUBMISSIONS))
            except BrokenExecutor as error:
                return error
            self.futures.setdefault(number, []).append(future)
            future.add_done_callback(partial(self._put, number))
        return None

    def _put(self, number: int, future: Future[Any]) -> None:
        self.done.put((number, future))

    def drop(self, number: int) -> None:
        """Forgets a part, and cancels what has not begun of it."""
        for future in self.futures.pop(number):
            future.cancel()

    def running(self) -> bool:
        """Whether the executor says that it works on a part.

        Those of the standard library, of loky and of mpi4py do. That of Dask never does.
        """
        return any(future.running() for futures in self.futures.values() for future in futures)


def _number_of_workers(executor: Executor) -> int | None:
    """How many parts an executor works on at a time, if it says so.

    The pools of the standard library, of loky and of mpi4py have a fixed number of workers. That of a Dask cluster
    may grow with what it has to do.
    """
    number = getattr(executor, "_max_workers", None)
    if number is None and (client := getattr(executor, "_client", None)) is not None:
        number = max(sum(client.nthreads().values()), SHARDS // SHARDS_EACH)
    return number if isinstance(number, int) and number > 0 else None


class _Answer:
    """The result of a part, or the exception that its work raised. Only :func:`_work` makes one."""

    __slots__ = ("error", "result")

    def __init__(self, result: Any, error: Exception | None = None) -> None:
        self.result, self.error = result, error

    def __reduce__(self) -> tuple[type["_Answer"], tuple[Any, Exception | None]]:
        return _Answer, (self.result, self.error)


def _work(plan: object, task: str, part: tuple[Any, ...], _submission: int) -> _Answer:
    try:
        return _Answer(getattr(plan, task)(*part))
    except Exception as error:
        return _Answer(None, _portable(error))


def _portable(error: Exception) -> Exception:
    """The error; or, if it cannot be pickled and would look like a lost part, one with the same message."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
