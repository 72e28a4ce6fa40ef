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
        labels = _labels(found)
        entries = [
            modes if dim == "mode" else range(n) if labels is None else labels
            for dim, n in zip(dims, found.reachable.shape, strict=True)
        ]
        if dims == ["mode"]:  # One pose in all modes is a table of one pose.
            dims, entries = ["pose", "mode"], [range(1), modes]
        index = pd.MultiIndex.from_product(entries, names=dims)
    elif dims == ["pose"]:
        index = getattr(found, "index", None)
    return pd.DataFrame({name: np.ravel(values) for name, values in columns.items()}, index=index)


def _labels(found: Any) -> Any:
    """The labels of the rows of poses, if they are of one level."""
    labels = getattr(found, "index", None)
    return labels if getattr(labels, "nlevels", 1) == 1 else None


#: The names along the axes of arrays, after those of the poses; numbers where there are none.
_AXES: dict[str, dict[str, tuple[str | list[str], ...]]] = {
    "Motion": {
        "joint_rates": ("joint_names",),
        "joint_accelerations": ("joint_names",),
        "imaginary_rates": ("imaginary_names",),
        "imaginary_accelerations": ("imaginary_names",),
    },
    "Analysis": {
        "efforts": ("joint_names",),
        "imaginary_efforts": ("imaginary_names",),
        "effort_jacobian": ("joint_names", ["FX", "FY", "FZ", "MX", "MY", "MZ"]),
    },
    "Accuracy": {
        "pose_error": ("pose_names",),
        "sensitivity": ("parameters", "pose_names"),
        "misfit_length": ("joints",),
        "misfit_angle": ("joints",),
        "permitted_alone": ("parameters",),
        "permitted_share": ("parameters",),
        "permitted_uniform": (["length", "angle"],),
    },
    "AccuracySamples": {"deviations": ("pose_names",), "misfit_length": ("joints",), "misfit_angle": ("joints",)},
    "ParameterJacobian": {"joints": ("joint_names", "parameters"), "pose": ("pose_names", "parameters")},
    "NearestReachable": {"poses": ("pose_names",)},
    "Nearest": {"poses": ("pose_names",), "rotation": (["x", "y", "z"],), "translation": (["x", "y", "z"],)},
}


def result_to_pandas(found: Any) -> Any:
    import pandas as pd  # type: ignore[import-untyped,unused-ignore]

    kind = type(found).__name__
    if kind == "Assemblies":
        return _assemblies(found, pd)
    if kind == "Calibration":
        names = ["before", "after", "standard_errors", "identifiable"]
        return pd.DataFrame({name: getattr(found, name) for name in names}, pd.Index(found.parameters, name="parameter"))
    if kind == "Certificate":
        names = ["what", "holds", "compared", "left_out", "because", "problem", "tolerance", "worst"]
        rows = {name: [getattr(one, name) for one in found.comparisons] for name in names}
        return pd.DataFrame(rows, pd.Index([one.name for one in found.comparisons], name="comparison"))
    own = [name for name in vars(type(found)) if not name.startswith("_")]
    if kind in ("Measure", "AccuracyBounds"):
        values = {name: getattr(found, name) for name in own if name != "to_pandas"}
        return pd.DataFrame({name: [value] for name, value in values.items() if isinstance(value, (bool, int, float, str))})
    return _at_poses(found, kind, own, pd)


def _at_poses(found: Any, kind: str, own: list[str], pd: Any) -> Any:
    """A row for each pose, a column for each number of it."""
    # The array without other axes than those of the poses; the places that are nearest have none.
    whole = next((getattr(found, name) for name in ("reachable", "distance", "failed") if hasattr(found, name)), None)
    lead = found.poses.shape[:-1] if whole is None else whole.shape
    columns: dict[str, Any] = {}
    for name in own:
        array = getattr(found, name)
        if not isinstance(array, np.ndarray) or array.shape[: len(lead)] != lead or name == "sizes":
            continue
        rest = array.shape[len(lead) :]
        axes = [getattr(found, of) if isinstance(of, str) else of for of in _AXES.get(kind, {}).get(name, ())]
        axes = axes or [list(map(str, range(n))) for n in rest]
        table = array.reshape(int(np.prod(lead)), *rest)
        for at in np.ndindex(*rest):
            label = ".".join([name, *(axis[i] for axis, i in zip(axes, at, strict=True))])
            columns[label] = table[(slice(None), *at)]
    if kind == "Clearance":
        known = columns.pop("pair")
        for end, label in enumerate(("one", "other")):
            columns[label] = [None if pair < 0 else found.pairs[pair][end] for pair in known]
    if kind in ("Nearest", "NearestReachable"):
        columns = {name.removeprefix("poses."): column for name, column in columns.items()}
    return pd.DataFrame(columns, index=_rows(found, lead, pd))


def _rows(found: Any, lead: tuple[int, ...], pd: Any) -> Any:
    """The labels of rows along these axes."""
    if len(lead) > 1:
        return pd.MultiIndex.from_product([range(n) for n in lead], names=[f"pose{i}" for i in range(len(lead))])
    return getattr(found, "index", None) if lead else None


def _assemblies(found: Any, pd: Any) -> Any:
    """A row for each assembly of each row of joint values."""
    lead = found.counts.shape
    places = [(*at, k) for at in np.ndindex(*lead) for k in range(found.counts[at])]

    def mode(place: tuple[int, ...]) -> Any:
        of = found.modes
        for i in place:
            of = of[i]
        return of

    columns: dict[str, Any] = {}
    parts = ((found.pose_names, found.poses), (found.joint_names, found.joints), (found.imaginary_names, found.imaginary))
    for names, table in parts:
        columns |= {name: [table[(*place, i)] for place in places] for i, name in enumerate(names)}
    columns["mode"] = [mode(place) for place in places]
    columns["within_limits"] = [bool(found.within_limits[place]) for place in places]
    columns["residual"] = [float(found.residuals[place]) for place in places]
    names = ["row"] if len(lead) == 1 else [f"row{i}" for i in range(len(lead))]
    if not lead:
        return pd.DataFrame(columns, pd.RangeIndex(len(places), name="assembly"))
    index = pd.MultiIndex.from_tuples(places, names=[*names, "assembly"]) if places else None
    return pd.DataFrame(columns, index)


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
