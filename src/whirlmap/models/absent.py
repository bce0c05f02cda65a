"""Effects that rotors on films have in general and these models do not: the answer to a user who asks for one by name.

Keys are beginnings of words, in small letters (a single letter is a whole word); values are sentences. A name that whirlmap
does not know is otherwise answered with the nearest spelling, which misleads where the thing itself is missing.
"""

_BEARINGS = "bearings here are plain circular ones (or squeeze-film dampers)"

_FEED = "films are fed at the pressure around them: how oil comes in is not modelled, and it has one temperature, T_oil"

_SEALS = "seals are not modelled: between its bearings unbalance, weight and teeth alone act on a rotor"

NOT_IN_ROTOR_MODELS = {
    "preload": f"{_BEARINGS}: preload is not modelled",
    "lobe": f"{_BEARINGS}: lobes are not modelled",
    "multilobe": f"{_BEARINGS}: lobes are not modelled",
    "elliptic": f"{_BEARINGS}: elliptical bores are not modelled",
    "lemon": f"{_BEARINGS}: lemon bores are not modelled",
    "tilting": f"{_BEARINGS}: tilting pads are not modelled",
    "pad": f"{_BEARINGS}: pads are not modelled",
    "groove": f"{_BEARINGS}: oil grooves are not modelled",
    "foil": f"{_BEARINGS}: foil bearings are not modelled",
    "magnetic": f"{_BEARINGS}: magnetic bearings are not modelled",
    "roller": f"{_BEARINGS}: rolling bearings are not modelled",
    "rolling": f"{_BEARINGS}: rolling bearings are not modelled",
    "supply": _FEED,
    "inlet": _FEED,
    "feed": _FEED,
    "thermal": "the film has one viscosity: how oil warms in it is not modelled, and `show` estimates it",
    "d": "bearings are given by their radius (R, R_1, R_2), half of the diameter",
    "diameter": "bearings are given by their radius (R, R_1, R_2), half of the diameter",
    "omega": "the speed of the first shaft is called speed, as in speed = 1500 rpm",
    "seal": _SEALS,
    "labyrinth": _SEALS,
    "gyroscop": "rotors move without tilting here: gyroscopic moments are not modelled",
    "misalign": "shafts are aligned here: misalignment is not modelled",
    "crack": "shafts are sound here: cracks are not modelled",
    "axial": "rotors move across their axis alone: axial motion and thrust are not modelled",
    "thrust": "rotors move across their axis alone: axial motion and thrust are not modelled",
    "helix": "teeth are straight here: helical gears are not modelled",
    "helical": "teeth are straight here: helical gears are not modelled",
}
