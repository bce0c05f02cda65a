"""What ``diagnose --json`` prints of a diagnosis: label, evidence and amplitudes as plain numbers."""

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from whirlmap.analysis.diagnosis.perturbed_ensemble import number
from whirlmap.analysis.variational.kaplan_yorke import kaplan_yorke, kaplan_yorke_error
from whirlmap.results.findings import Findings
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

if TYPE_CHECKING:
    import xarray as xr


def verdict_json(ds: "Findings | xr.Dataset") -> dict[str, Any]:
    """What ``diagnose --json`` prints: label, evidence and amplitudes as plain numbers, unknown ones as None."""
    votes = json.loads(ds.attrs["indicators"])
    exponent, error = (
        np.asarray(ds[name]) if name in ds else np.zeros(0) for name in ("lyapunov", "lyapunov_error")
    )
    common = ds.attrs.get("common_multiple")  # absent where the forcing has no common period
    common_time = None if common is None else ds.attrs["period_T_time"] * common
    n = int(ds["period_T"])
    names = [str(q) for q in np.asarray(ds["quantity"])]
    swing, rms, largest = (map(number, np.asarray(ds[name])) for name in ("peak_to_peak", "rms", "maximum"))
    amplitude = {q: {"peak_to_peak": a, "rms": b} for q, a, b in zip(names, swing, rms, strict=True)}
    roles = json.loads(ds.attrs.get("roles", "{}"))
    journals = {output: bearing for bearing, output in roles.get("eccentricities", {}).items()}
    eccentricity = {q: e for q, e in zip(names, largest, strict=True) if q in journals}
    clearance = {output: roles.get("clearances", {}).get(bearing, 1) for output, bearing in journals.items()}
    dimension = votes.get("dimension", {})
    label = Regime(int(ds["regime"]))
    periodic = label == Regime.periodic
    return {
        "regime": label.label,
        "period": n if periodic or (label == Regime.locked and n) else None,
        "period_common": int(ds["period_common"]) if periodic else None,
        "period_turns": {k: abs(v) * n for k, v in json.loads(ds.attrs["clocks"]).items()} if periodic else None,
        "confidence": number(ds["confidence"]),
        "starts": int(ds["starts"]),
        "starts_agree": int(ds["starts_agree"]),
        "growth_rate": number(ds["growth_rate"]),
        "thinning": number(ds["thinning"]),
        "rotation_number": number(ds["rotation_number"]),
        "winding": number(ds["rotation_number"]),
        "drift_rate": number(ds["drift_rate"]),
        "drift_state": str(np.asarray(ds["state"])[int(ds["drift_state"])]) if int(ds["drift_state"]) >= 0 else None,
        "lyapunov": [number(v) for v in exponent],
        "lyapunov_error": [number(v) for v in error],
        "lyapunov_per_common_period": [None if common_time is None else number(v * common_time) for v in exponent],
        "divergence": number(ds["divergence"]) if "divergence" in ds else None,
        "divergence_error": number(ds["divergence_error"]) if "divergence_error" in ds else None,
        "phase_exponent": number(ds["phase_exponent"]) if "phase_exponent" in ds else None,
        "kaplan_yorke": kaplan_yorke(exponent),
        "kaplan_yorke_error": kaplan_yorke_error(exponent, error) if exponent.size else None,
        "correlation_dimension": dimension.get("value"),
        "correlation_dimension_error": dimension.get("error"),
        "indicators": votes,
        "amplitude": amplitude,
        "max_eccentricity": eccentricity,
        "min_film": {k: None if v is None else clearance[k] * (1 - v) for k, v in eccentricity.items()},
        "status": Status(int(ds["status"])).name,
        "end_time": number(ds["end_time"]),
        "end_reason": ds.attrs.get("end_reason"),
    }
