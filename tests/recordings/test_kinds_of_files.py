"""Every kind of file: read to the last digit, or refused with the line and a reason."""

import numpy as np
import pytest
from tests.recordings.kinds import KINDS

from whirlmap.errors import InputError
from whirlmap.recordings.description import describe_file
from whirlmap.recordings.signal import read_signal


@pytest.mark.parametrize("variant", range(10))
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_read_right_or_refused(kind, variant, tmp_path):
    made = kind(variant)
    file = tmp_path / f"x{made.suffix}"
    file.write_bytes(made.content)
    if made.refused:
        with pytest.raises(InputError) as refusal:
            read_signal(file, **made.options)
        assert made.refused in str(refusal.value)
        return
    found = read_signal(file, **made.options)
    filled = "filled" in " ".join(found.notices)
    np.testing.assert_allclose(found.values, made.values, rtol=0, atol=2e-3 if filled else 0)
    assert found.rate == pytest.approx(made.rate, rel=1e-3 if made.warned == "rounded" else 5e-5)
    assert made.warned in " | ".join(found.notices)
    assert "\n" not in "".join(found.notices)
    assert describe_file(file)["rows"] >= found.values.size - 60
