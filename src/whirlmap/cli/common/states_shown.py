"""Which states of a system a picture shows first."""

from whirlmap.integrate.system import System


def swing_of(system: System) -> list[str]:
    """States that a picture of this system shows first."""
    return [s.name for s in system.model.swing] or [system.states[0]]


def partner_of(system: System, state: str) -> str:
    """State against which another is drawn: the one that its rate equals, else the next one."""
    names = system.states
    return system.model.velocities.get(state, names[(names.index(state) + 1) % len(names)])
