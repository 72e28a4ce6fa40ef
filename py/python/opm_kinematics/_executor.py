"""Parts of some work on any executor: submitted as pickled specifications, run again where a worker is lost.

What the work itself gives or raises comes back in an :class:`_Answer`. So whatever else a future gives or raises was made by the
executor, and says that the part was lost. Parts have no side effects: a lost one runs again.
"""

import pickle
from asyncio import CancelledError
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, as_completed
from types import TracebackType
from typing import Any

from ._native import OpmError

__all__ = ["Workers", "run"]

#: Parts for each worker, so that all have work to the end and little is lost with one; and for workers of an unknown number.
SHARDS_EACH = 8
SHARDS = 64

#: How often a part is run again before it is given up.
RETRIES = 3

#: What a future raises for a lost part. The rest of BaseException, as KeyboardInterrupt, ends the whole work.
LOST = (Exception, CancelledError)


class Workers:
    """An executor, or one that is made when it is needed, and again where a broken one takes no more work.

    Those that are made here are closed with it, or when they are broken; one that is given is left as it is.

    Parameters
    ----------
    executor : concurrent.futures.Executor or callable
        One; or what makes one.
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
            self._made.shutdown(wait=False, cancel_futures=True)
            self._made = None

    def shards(self) -> int:
        """How many parts are good for the executor, which is made where it is not yet."""
        workers = _number_of_workers(self._executor())
        return SHARDS if workers is None else SHARDS_EACH * workers

    def run(
        self,
        plan: object,
        task: str,
        parts: Sequence[tuple[Any, ...]],
        fold: Callable[[Any, Any], Any] | None = None,
    ) -> Any:
        """What the parts give.

        Parameters
        ----------
        plan : object
            Pickled with every part.
        task : str
            Which method of the plan works on a part.
        parts : sequence of tuple
            Its arguments, a tuple a part.
        fold : callable, optional
            Puts the results of two parts together, in whatever order they come: so that one alone is kept.

        Returns
        -------
        list or object
            A result a part, in their order; or the one that they fold to.

        Raises
        ------
        OpmError
            A part was lost with its worker again and again, or the executor is broken.
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
                    break  # such a one never takes work again
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
    """What has come of the parts: one by one, or folded."""

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
    """Runs the parts that are missing once, takes those away that have a result, and gives a sign of a lost worker.

    A broken executor is the sign that it gives first: such a one takes no more work.
    """
    futures: dict[Future[Any], int] = {}
    lost: BaseException | None = None
    try:
        for number, part in missing.items():
            try:
                futures[pool.submit(_work, plan, task, part)] = number
            except BrokenExecutor as error:
                lost = error
                break
        for future in as_completed(list(futures)):
            # A future keeps its result: with the last reference to it both go.
            number = futures.pop(future)
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
        for future in futures:
            future.cancel()
    return lost


def _number_of_workers(executor: Executor) -> int | None:
    """How many parts an executor works on at a time, where it tells.

    The pools of the standard library, of loky and of mpi4py have a fixed number of workers. That of a Dask cluster
    may grow with what it has to do.
    """
    number = getattr(executor, "_max_workers", None)
    if number is None and (client := getattr(executor, "_client", None)) is not None:
        number = max(sum(client.nthreads().values()), SHARDS // SHARDS_EACH)
    return number if isinstance(number, int) and number > 0 else None


class _Answer:
    """What a part gave, or what its work raised: nothing but :func:`_work` makes one."""

    __slots__ = ("error", "result")

    def __init__(self, result: Any, error: Exception | None = None) -> None:
        self.result, self.error = result, error

    def __reduce__(self) -> tuple[type["_Answer"], tuple[Any, Exception | None]]:
        return _Answer, (self.result, self.error)


def _work(plan: object, task: str, part: tuple[Any, ...]) -> _Answer:
    try:
        return _Answer(getattr(plan, task)(*part))
    except Exception as error:
        return _Answer(None, _portable(error))


def _portable(error: Exception) -> Exception:
    """The error, or one that says the same, where it cannot be pickled: it would look like a lost part."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
