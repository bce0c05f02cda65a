"""A line that is left out within a table is named."""

import numpy as np

from whirlmap.recordings.signal import read_signal


def test_a_comment_within_the_table_is_named(tmp_path):
    lines = ["t[s],x[um]", *(f"{k / 100:.2f},{np.sin(k):.4f}" for k in range(50))]
    lines[31] = "#" + lines[31]
    file = tmp_path / "marked.csv"
    file.write_text("\n".join(lines))
    notices = " ".join(read_signal(file, column="x").notices)
    assert "line 32: a comment within the table, '#0.30" in notices
