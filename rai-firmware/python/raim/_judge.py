"""Ranges in, verdicts out: whole days as numpy arrays."""

from __future__ import annotations

import ctypes
import dataclasses
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from . import _library as c
from ._library import LIBRARY, demand

# `rai_range_t`.
_RANGE = np.dtype(
    {
        "names": ["x_m", "y_m", "z_m", "range_m", "sigma_m", "system", "number"],
        "formats": ["<f8", "<f8", "<f8", "<f8", "<f8", "u1", "u1"],
        "offsets": [0, 8, 16, 24, 32, 40, 41],
        "itemsize": 48,
    }
)


@dataclasses.dataclass(frozen=True)
class Judgements:
    """Verdicts on epochs. Every field is an array over the epochs; NaN is an undefined number."""

    state: npt.NDArray[np.str_]
    """State: `protected`, `alert` or `unavailable`."""
    reason: npt.NDArray[np.str_]
    """Reason of the state, in the words of the sentences: `OK`, `EXCLUDED`, `FAULT`, `HPL`, …"""
    hpl_m: npt.NDArray[np.float64]
    """Horizontal protection level, m; infinite without a bound."""
    vpl_m: npt.NDArray[np.float64]
    """Vertical protection level, m; infinite without a bound."""
    position_m: npt.NDArray[np.float64]
    """Earth-fixed position, m, shape (epochs, 3)."""
    covariance_m2: npt.NDArray[np.float64]
    """Covariance of east, north and up: EE, EN, EU, NN, NU, UU, m², shape (epochs, 6)."""
    statistic: npt.NDArray[np.float64]
    """Statistic of the global test, `√(SSE/dof)`."""
    threshold: npt.NDArray[np.float64]
    """Threshold of the global test."""
    dof: npt.NDArray[np.int64]
    """Degrees of freedom of the global test."""
    is_used: npt.NDArray[np.bool_]
    """True for a satellite in the position, shape (epochs, satellites)."""
    residual_m: npt.NDArray[np.float64]
    """Range minus distance and clock, m, shape (epochs, satellites); of an excluded satellite its bias."""

    @property
    def is_protected(self) -> npt.NDArray[np.bool_]:
        """True if the position may be used."""
        return self.state == "protected"


def judge(
    ranges_m: npt.ArrayLike,
    positions_m: npt.ArrayLike,
    sigmas_m: npt.ArrayLike,
    *,
    satellites: Sequence[str] | None = None,
    times_s: npt.ArrayLike | None = None,
    phase: str = "NPA",
    method: str = "AUTO",
    policy: str = "T1",
    levels: str = "BOUND",
    independent: bool = False,
    **settings: float,
) -> Judgements:
    """Judges epochs: detects and excludes faulty satellites, and bounds the error of the position.

    `ranges_m` has the shape (epochs, satellites) or (satellites,): pseudoranges corrected for satellite clock, group
    delay and atmosphere, m; NaN for an absent satellite. `positions_m` has one more axis of three earth-fixed
    coordinates at the instant of transmission, m. `sigmas_m` has the shape of the ranges, or one that numpy expands to
    it. `satellites` names the columns, as `G05`; without it they are GPS satellites 1 to 32. `times_s` are seconds of
    any continuous time scale, by default 1 s apart. Further settings are fields of `rai_settings_t`: `hal_m`, `val_m`,
    `max_speed_m_s`, `recovery_epochs`, …

    Raises `ValueError` for shapes that do not fit, and `RefusedError` for settings out of their range.
    """
    ranges = np.atleast_2d(np.asarray(ranges_m, float))
    epochs, columns = ranges.shape
    positions = np.broadcast_to(np.asarray(positions_m, float), (epochs, columns, 3))
    sigmas = np.broadcast_to(np.asarray(sigmas_m, float), (epochs, columns))
    times = np.arange(epochs, dtype=float) if times_s is None else np.broadcast_to(np.asarray(times_s, float), (epochs,))
    table = np.zeros((epochs, columns), _RANGE)
    table["range_m"], table["sigma_m"] = ranges, sigmas
    table["x_m"], table["y_m"], table["z_m"] = np.moveaxis(positions, 2, 0)
    names = _names(satellites, columns)
    table["system"] = [ord(name[0]) for name in names]
    table["number"] = [int(name[1:]) for name in names]
    is_present = np.isfinite(ranges) & np.isfinite(positions).all(axis=2) & np.isfinite(sigmas)
    if is_present.sum(axis=1).max(initial=0) > c.MAX_SATELLITES:
        raise ValueError(f"an epoch must have at most {c.MAX_SATELLITES} satellites")
    monitor = _monitor(phase, method, policy, levels, settings)
    return _run(monitor, table, is_present, times, independent)


def araim(
    ranges_m: npt.ArrayLike, positions_m: npt.ArrayLike, sigmas_m: npt.ArrayLike, *, phase: str = "LPV200", **others
) -> Judgements:
    """Judges epochs by ARAIM, which compares the solutions with and without every plausible set of satellites.

    The parameters are those of `judge`. The probabilities of faults are those of the ICAO's standards.
    """
    return judge(ranges_m, positions_m, sigmas_m, phase=phase, method="SEPARATION", **others)


def _names(satellites: Sequence[str] | None, columns: int) -> list[str]:
    names = [f"G{number:02}" for number in range(1, 33)][:columns] if satellites is None else list(satellites)
    if len(names) != columns:
        raise ValueError(f"satellites must name {columns} columns, not {len(names)}")
    for name in names:
        if not (len(name) in (2, 3) and name[0] in "GRECJ" and name[1:].isdigit()):
            raise ValueError(f"a satellite must be named like G05, not {name!r}")
    return names


def _monitor(phase: str, method: str, policy: str, levels: str, settings: dict[str, float]):
    wanted = c.Settings()
    demand(LIBRARY.rai_settings_preset(wanted, c.choice("phase", c.PHASES, phase)))
    wanted.method = c.choice("method", c.METHODS, method)
    wanted.policy = c.choice("policy", c.POLICIES, policy)
    wanted.levels = c.choice("levels", c.LEVELS, levels)
    known = {name for name, *_ in c.Settings._fields_} - {"size", "reserved", "method", "policy", "levels"}
    for name, value in settings.items():
        if name not in known:
            raise TypeError(f"{name!r} is no setting; the settings are {', '.join(sorted(known))}")
        setattr(wanted, name, type(getattr(wanted, name))(value))
    size = LIBRARY.rai_monitor_size()
    monitor = c.memory(size)
    demand(LIBRARY.rai_monitor_init(monitor, ctypes.sizeof(monitor), wanted))
    return monitor


def _run(monitor, table, is_present, times, independent: bool) -> Judgements:
    epochs, columns = table.shape
    number = {name: np.full(epochs, np.nan) for name in ("hpl_m", "vpl_m", "statistic", "threshold")}
    position, covariance = np.full((epochs, 3), np.nan), np.full((epochs, 6), np.nan)
    states, reasons, dof = [], [], np.zeros(epochs, np.int64)
    is_used, residual = np.zeros((epochs, columns), bool), np.full((epochs, columns), np.nan)
    verdict, accuracy = c.Verdict(), c.Accuracy()
    residuals, count = (c.Residual * c.MAX_SATELLITES)(), ctypes.c_size_t()
    for epoch in range(epochs):
        present = np.flatnonzero(is_present[epoch])
        ranges = np.ascontiguousarray(table[epoch, present])
        if independent:
            demand(LIBRARY.rai_monitor_forget(monitor))
        demand(LIBRARY.rai_monitor_judge(monitor, times[epoch], ranges.ctypes.data, len(present), verdict))
        demand(LIBRARY.rai_monitor_accuracy(monitor, accuracy))
        demand(LIBRARY.rai_monitor_residuals(monitor, residuals, c.MAX_SATELLITES, count))
        states.append(c.STATES[verdict.state])
        reasons.append(c.reason(verdict.reason))
        for name, values in number.items():
            values[epoch] = getattr(verdict, name)
        dof[epoch] = verdict.dof
        position[epoch] = verdict.x_m, verdict.y_m, verdict.z_m
        covariance[epoch] = accuracy.covariance_m2
        place = {(ranges["system"][row], ranges["number"][row]): column for row, column in enumerate(present)}
        for known in residuals[: count.value]:
            column = place[ord(known.system), known.number]
            is_used[epoch, column], residual[epoch, column] = known.is_used, known.residual_m
    return Judgements(
        state=np.array(states, dtype=np.str_),
        reason=np.array(reasons, dtype=np.str_),
        position_m=position,
        covariance_m2=covariance,
        dof=dof,
        is_used=is_used,
        residual_m=residual,
        **number,
    )
