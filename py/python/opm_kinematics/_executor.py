"""Parts of a sweep on any executor: submitted as pickled specifications, run again where a worker is lost."""

from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, as_completed
from typing import Any, Protocol

from ._native import OpmError

__all__ = ["run"]

#: How often a part is run again before it is given up.
RETRIES = 3

#: What says that a worker is lost, not that the work has failed; and what Dask says, which need not be installed.
LOST = (BrokenExecutor, CancelledError, OSError)
LOST_BY_NAME = {"KilledWorker"}


class Plan(Protocol):
    """Work that is divided into parts: `task` names a method that takes the number of a part, from 1, and how many."""


def run(executor: Executor | Callable[[], Executor], plan: Plan, task: str, parts: int) -> list[Any]:
    """What the parts give, in their order.

    Parameters
    ----------
    executor : concurrent.futures.Executor or callable
        One; or what makes one, which is asked again where a broken one takes no more work, and closed then.
    plan : Plan
        Pickled with every part.
    task : str
    parts : int

    Raises
    ------
    OpmError
        A part was lost with its worker again and again, or the executor is broken.
    Exception
        What the work itself raised.
    """
    made = None if isinstance(executor, Executor) else executor
    if made is not None and not callable(made):
        raise OpmError(f"executor is {executor!r}, expected a concurrent.futures.Executor, or a function that makes one")
    results: dict[int, Any] = {}
    lost: BaseException | None = None
    for _ in range(1 + RETRIES):
        pool = made() if made is not None else executor
        if not isinstance(pool, Executor):
            raise OpmError(f"executor gave {pool!r}, expected a concurrent.futures.Executor")
        try:
            lost = _round(pool, plan, task, parts, results)
        finally:
            if made is not None:
                pool.shutdown(wait=False, cancel_futures=True)
        if len(results) == parts:
            return [results[number] for number in range(1, parts + 1)]
        if made is None and isinstance(lost, BrokenExecutor):
            break  # such a one never takes work again
    hint = "; give a function that makes executors, to go on in a new one" if isinstance(lost, BrokenExecutor) else ""
    raise OpmError(
        f"{parts - len(results)} of {parts} parts were lost with their workers ({type(lost).__name__}: {lost}){hint}"
    ) from lost


def _round(pool: Executor, plan: Plan, task: str, parts: int, results: dict[int, Any]) -> BaseException | None:
    """Runs the parts that have no result once, and gives the last sign of a lost worker."""
    futures: dict[Future[Any], int] = {}
    lost: BaseException | None = None
    try:
        for number in range(1, parts + 1):
            if number in results:
                continue
            try:
                futures[pool.submit(_work, plan, task, number, parts)] = number
            except BrokenExecutor as error:
                lost = error
                break
        for future in as_completed(futures):
            try:
                results[futures[future]] = future.result()
            except BaseException as error:
                if not isinstance(error, LOST) and type(error).__name__ not in LOST_BY_NAME:
                    raise
                lost = error
    finally:
        for future in futures:
            future.cancel()
    return lost


def _work(plan: Plan, task: str, number: int, parts: int) -> Any:
    return getattr(plan, task)(number, parts)
