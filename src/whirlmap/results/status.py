"""How the run of one operating point ended."""

from enum import IntEnum

import numpy as np


class Status(IntEnum):
    """Status of one operating point; the sentence of each is shown to people."""

    ok = 0
    contact = 1
    diverged = 2
    unresolved = 3
    failed = 4
    sticks = 5
    chatters = 6

    @property
    def sentence(self) -> str:
        """What the status means."""
        return SENTENCES[self]


SENTENCES = {
    Status.ok: "ran to its end",
    Status.contact: "a stop that the model declares was reached, such as a journal its bearing",
    Status.diverged: "a state grew beyond the model's bound, or passed through a pole of the equations",
    Status.unresolved: "a step failed, also with steps 1024 times shorter: try more steps per T",
    Status.failed: "could not be computed",
    Status.sticks: "sticks on two surfaces at once, or on one with tangent vectors: that motion is not followed",
    Status.chatters: "crosses surfaces at which its rates change more than 64 times in each of ever shorter steps",
}


def flags(kind: type[IntEnum]) -> dict[str, object]:
    """CF attributes of an integer variable that holds members of an enumeration."""
    return {
        "flag_values": np.array([int(k) for k in kind], dtype=np.int8),
        "flag_meanings": " ".join(k.name for k in kind),
    }
