"""Reserved names, which a state or a parameter cannot have.

A varied parameter becomes a dimension of a Dataset, and a state a column of a table, beside the variables of the result. A
case file holds parameters beside its own keys.
"""

#: Keys of a case file that are not entries.
CASE_KEYS = ("model", "extends", "description", "start", "switches")

_RESULTS = """
    point direction quantity bearing state period exponent draw place other motions machine design window time step turn
    section regime rule status period_T period_common return_distance lyapunov lyapunov_error lyapunov_periods confidence
    winding end_time end_state end_periods start_found settled_after accelerated steps step_error step_verdict evaluation
    minimum maximum mean rms peak_to_peak max_eccentricity min_film max_load hysteresis common_multiple
    attractor attractor_of member indicator outcome vote start starts share share_error outcome_starts outcome_share
    outcome_share_error start_state start_regime start_status starts_agree zero_one zero_one_low digits winding_error
    amplitude tooth_contact verdict margin probability front rpm
    frequency frequency_step resolution power density floor line_frequency line_power line_present line_floor
    line_fraction broadband_fraction
    mode growth damping_ratio whirl line clock equilibrium drift_state drift_rate growth_rate thinning grazings
    phase_order clock_amplitude clock_phase spectrum elapsed end_speed
    rotation_number rotation_number_error
"""

#: Dimensions and variables of the Datasets that have varied parameters or states for dimensions.
RESULTS = frozenset(_RESULTS.split())


def fault(name: str) -> str:
    """Say why a quantity cannot have this name; empty where it can."""
    if not (name.isascii() and name.isidentifier()):
        return "is no name that files and the command line can hold: it consists of letters, digits and underscores"
    if name == "t":
        return "is the name of time"
    if name == "self":
        return "is a word of Python that functions with parameters by name cannot take"
    if name in CASE_KEYS:
        return "is a key of case files"
    return "is the name of a variable or a dimension of results" if name in RESULTS else ""
