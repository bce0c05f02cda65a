"""Arrays in JSON: their bytes as base64 text, with type and shape, which a page reads without parsing numbers."""

import base64
import json
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Types that a page reads as typed arrays.
TYPES = {"float64": "f8", "float32": "f4", "int32": "i4", "int8": "i1", "uint8": "u1"}


def encoded(array: NDArray[Any]) -> dict[str, Any]:
    """An array as ``{"type", "shape", "data"}``: ``f8``, ``f4``, ``i4``, ``i1`` or ``u1``, little-endian.

    The last index is the fastest.     Whole numbers become ``i4``, other numbers of unlisted types ``f8``.
    """
    if array.dtype.name not in TYPES:
        array = array.astype(np.int32 if array.dtype.kind in "iub" else np.float64)
    plain = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    data = base64.b64encode(plain.tobytes()).decode()
    return {"type": TYPES[array.dtype.name], "shape": list(array.shape), "data": data}


def decoded(value: dict[str, Any]) -> NDArray[Any]:
    """The array that `encoded` made this of."""
    flat = np.frombuffer(base64.b64decode(value["data"]), dtype=np.dtype(f"<{value['type']}"))
    return flat.reshape(value["shape"])


def json_text(value: Any) -> str:
    """JSON that every browser reads: numbers that are not finite become null."""
    return json.dumps(_plain(value), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(name): _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
