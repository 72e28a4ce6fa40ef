"""Results as tables of pandas and datasets of xarray, which are imported only here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._native import Solutions, Sweep, Trajectory


def to_pandas(found: Solutions | Trajectory) -> Any:
    import pandas as pd  # type: ignore[import-untyped,unused-ignore]

    dims, columns = _columns(found)
    index = None
    if "t" in dims:
        index = pd.Index(found.times, name="t")  # type: ignore[union-attr]
    elif dims not in ([], ["pose"]):
        modes: list[str] = getattr(found, "modes", [])
        entries = [modes if dim == "mode" else range(n) for dim, n in zip(dims, found.reachable.shape, strict=True)]
        if dims == ["mode"]:  # One pose in all modes is a table of one pose.
            dims, entries = ["pose", "mode"], [range(1), modes]
        index = pd.MultiIndex.from_product(entries, names=dims)
    return pd.DataFrame({name: np.ravel(values) for name, values in columns.items()}, index=index)


def to_xarray(found: Solutions | Trajectory) -> Any:
    import xarray as xr

    dims, columns = _columns(found)
    coords = {"mode": found.modes} if "mode" in dims else {"t": found.times} if "t" in dims else {}  # type: ignore[union-attr]
    units = found.units
    variables = {
        name: (dims, values, {"units": units[name]} if name in units else {}) for name, values in columns.items()
    }
    return xr.Dataset(variables, coords, {"mode": found.mode})


def sweep_to_pandas(found: Sweep) -> Any:
    import pandas as pd  # type: ignore[import-untyped,unused-ignore]

    return pd.DataFrame(found.points(), columns=list(found.axes))


def sweep_to_xarray(found: Sweep) -> Any:
    import xarray as xr

    axes = {name: (name, values, {"units": found.units[name]}) for name, values in found.axes.items()}
    return xr.DataArray(found.mask(), axes, list(axes), "within_limits", {"kind": found.kind, "mode": found.mode})


def _columns(found: Solutions | Trajectory) -> tuple[list[str], dict[str, Any]]:
    """The names of the axes, and every column with those axes by its name."""
    columns: dict[str, Any] = {}
    if hasattr(found, "times"):
        dims = ["t"]
        columns.update(zip(found.pose_names, found.poses.T, strict=True))  # type: ignore[union-attr]
    else:
        modes = ["mode"] if found.mode == "all" else []
        # Poses along several axes are counted along each: pose0, pose1, ...
        axes = found.reachable.ndim - len(modes)
        dims = (["pose"] if axes == 1 else [f"pose{axis}" for axis in range(axes)]) + modes
    columns.update(found.items())
    flags = ["condition", "reachable", "within_limits", "regular"]
    columns.update((name, getattr(found, name)) for name in flags if hasattr(found, name))
    return dims, columns
