"""Wrong machines: one change of a machine that loads, and what the message has to name."""

GOOD = """model = "machine"
[operation]
reference = "pinion"
speed = "9000 rpm"
[lubricant]
mu = "0.015 Pa*s"
[[shaft]]
name = "pinion"
material = "steel"
elements = [ { L = "100 mm", d = "50 mm" }, { L = "100 mm", d = "60 mm", d_i = "10 mm" } ]
[[shaft]]
name = "gear"
E = "210 GPa"
nu = 0.3
rho = "7800 kg/m^3"
elements = [ { L = "100 mm", d = "60 mm" }, { L = "100 mm", d = "60 mm" } ]
[[disk]]
name = "impeller"
shaft = "pinion"
at = 1
m = "3 kg"
[[bearing]]
name = "drive_end"
shaft = "pinion"
at = 0
R = "25 mm"
L = "12 mm"
c = "40 um"
[[bearing]]
name = "free_end"
shaft = "pinion"
at = 2
R = "25 mm"
L = "12 mm"
c = "40 um"
support = "pedestal"
[[bearing]]
name = "gear_end"
shaft = "gear"
at = 0
R = "30 mm"
L = "15 mm"
c = "50 um"
[[bearing]]
name = "gear_other"
shaft = "gear"
at = 2
R = "30 mm"
L = "15 mm"
c = "50 um"
[[support]]
name = "pedestal"
m = "10 kg"
k = "1e8 N/m"
c = "1e4 N*s/m"
[[mesh]]
name = "teeth"
driver = "pinion"
driven = "gear"
at = [1, 1]
z = [20, 41]
module = "3 mm"
alpha = "20 deg"
beta_c = "0 deg"
K_m = "1e8 N/m"
T = "20 N*m"
[[unbalance]]
name = "u"
shaft = "pinion"
at = 1
U = "30 g*mm"
"""
IDLER = """
[[shaft]]
name = "idler"
material = "steel"
elements = [ { L = "100 mm", d = "60 mm" }, { L = "100 mm", d = "60 mm" } ]
[[bearing]]
name = "i1"
shaft = "idler"
at = 0
R = "30 mm"
L = "15 mm"
c = "50 um"
[[bearing]]
name = "i2"
shaft = "idler"
at = 2
R = "30 mm"
L = "15 mm"
c = "50 um"
"""


#: The first bearing, and what stands in its place.
JOURNAL = """R = "25 mm"
L = "12 mm"
c = "40 um"
"""
BY_COEFFICIENTS = 'kind = "coefficients"\n'
TABLE = """table = [
 { speed = "2000 rpm", k_xx = "1e8 N/m", c_xx = "3e4 N*s/m" },
 { speed = "9500 rpm", k_xx = "2e8 N/m", c_xx = "2e4 N*s/m" },
]
"""


def mesh(name, driver, driven):
    return f"""
[[mesh]]
name = "{name}"
driver = "{driver}"
driven = "{driven}"
at = [1, 1]
z = [20, 41]
module = "3 mm"
alpha = "20 deg"
beta_c = "0 deg"
K_m = "1e8 N/m"
T = "20 N*m"
"""


#: What is wrong -> (text, what stands in its place; None to add at the end), parts of the message.
WRONG = {
    "station beyond the shaft": ('at = 2\nR = "25 mm"', 'at = 7\nR = "25 mm"', ["[[bearing]] free_end: at", "0 to 2"]),
    "distance beyond the shaft": ('at = 1\nm = "3 kg"', 'at = "450 mm"\nm = "3 kg"', ["[[disk]] impeller: at", "200 mm"]),
    "bearing on no shaft": ('name = "free_end"\nshaft = "pinion"', 'name = "free_end"\nshaft = "pinon"',
                            ["[[bearing]] free_end: shaft", "'pinon'", "Did you mean 'pinion'?"]),
    "two names alike": ('name = "gear_other"', 'name = "gear_end"', ["[[bearing]] gear_end: name", "'gear_end'"]),
    "name of another kind": ('name = "u"', 'name = "pinion"', ["[[unbalance]] pinion: name", "a shaft too"]),
    "loop of meshes": (None, IDLER + mesh("second", "gear", "idler") + mesh("third", "idler", "pinion"),
                       ["[[mesh]]", "loop", "tree"]),
    "disconnected shaft": (None, IDLER, ["[[shaft]] idler", "no mesh"]),
    "negative diameter": ('d = "50 mm"', 'd = "-50 mm"', ["[[shaft]] pinion: d", "must be above 0"]),
    "hole wider than the shaft": ('d_i = "10 mm"', 'd_i = "70 mm"', ["[[shaft]] pinion: elements", "element 2"]),
    "missing unit": ('c = "40 um"\nsupport', "c = 40\nsupport", ["[[bearing]] free_end: c", "without a unit", "radial"
                                                                                                              " clearance"]),
    "wrong unit": ('R = "30 mm"', 'R = "30 kg"', ["[[bearing]] gear_end: R", "kg"]),
    "zero mass": ('m = "10 kg"', 'm = "0 kg"', ["[[support]] pedestal: m", "must be above 0"]),
    "support of nothing": ('support = "pedestal"\n', "", ["[[support]] pedestal", "no bearing"]),
    "unknown support": ('support = "pedestal"', 'support = "pedestel"', ["[[bearing]] free_end: support", "Did you mean"]),
    "unknown key": ('U = "30 g*mm"', 'U = "30 g*mm"\nphse = "3 deg"', ["[[unbalance]] u: phse", "Did you mean 'phase'?"]),
    "a diameter for a radius": ('R = "30 mm"', 'D = "60 mm"', ["[[bearing]] gear_end: D", "R (radius) is half of it"]),
    "a diametral clearance": ('c = "50 um"', 'C_d = "0.1 mm"', ["gear_end: C_d", "c (radial clearance) is half"]),
    "a word for its symbol": ('m = "3 kg"', 'mass = "3 kg"', ["impeller: mass", "Did you mean 'm' (mass of a disk)?"]),
    "a word for several symbols": ('U = "30 g*mm"', 'U = "3 g*mm"\neccentricity = "1 um"',
                                   ["u: eccentricity", "Did you mean 'e' (eccentricity of the shaft's whole mass)?"]),
    "unknown table": (None, '[[bearings]]\nname = "x"\n', ["'bearings'", "Did you mean 'bearing'?"]),
    "single table": ('[[support]]', "[support]", ["[support]", "[[support]]"]),
    "unknown film": ('support = "pedestal"\n', 'support = "pedestal"\nfilm = "long"\n', ["free_end: film", "short"]),
    "porous without a ring": ('support = "pedestal"\n', 'support = "pedestal"\nfilm = "porous"\n',
                              ["[[bearing]] free_end", "no Phi", "film = porous"]),
    "no speed": ('speed = "9000 rpm"\n', "", ["[operation]", "no speed"]),
    "no reference": ('reference = "pinion"\n', "", ["[operation]", "no reference", "pinion, gear"]),
    "no oil": ('[lubricant]\nmu = "0.015 Pa*s"\n', "", ["[[bearing]] drive_end", "no lubricant"]),
    "one number of teeth": ("z = [20, 41]", "z = 20", ["[[mesh]] teeth: z", "[31, 93]"]),
    "no tooth": ("z = [20, 41]", "z = [20, 0]", ["[[mesh]] teeth: z", "[31, 93]"]),
    "two modules on one wheel": (None, IDLER + mesh("second", "pinion", "idler").replace('"3 mm"', '"4 mm"'),
                                 ["[[mesh]] second: module", "one wheel of 20 teeth", "mesh teeth"]),
    "half a tooth": ("z = [20, 41]", "z = [20.5, 41]", ["[[mesh]] teeth: z"]),
    "two bearings in one place": ('name = "free_end"\nshaft = "pinion"\nat = 2', 'name = "free_end"\nshaft ='
                                                                                 ' "pinion"\nat = 0',
                                  ["[[bearing]] free_end: at", "second bearing"]),
    "shaft without a bearing": (None, IDLER.split("[[bearing]]")[0] + mesh("second", "gear", "idler"),
                                ["[[shaft]] idler", "no bearing"]),
    "unknown material": ('material = "steel"', 'material = "steal"', ["[[shaft]] pinion: material", "Did you mean"
                                                                                                    " 'steel'?"]),
    "damper with a fixed arc": ('support = "pedestal"\n', 'support = "pedestal"\nkind = "damper"\narc = "fixed"\n',
                                ["[[bearing]] free_end: arc", "spin"]),
    "coupling without torsion": (None, '[[coupling]]\nname = "motor"\nshaft = "pinion"\nat = 0\nk_t = "1e4 N*m/rad"\n',
                                 ["[[coupling]] motor", 'torsion = "free"']),
    "torsion without a coupling": ('reference = "pinion"', 'reference = "pinion"\ntorsion = "free"', ["teeth", "coupling"]),
    "driver drives itself": ('driven = "gear"', 'driven = "pinion"', ["[[mesh]] teeth: driven", "two shafts"]),
    "mass beside elements": ('material = "steel"', 'material = "steel"\nm = "4 kg"', ["pinion: m", "beside elements"]),
    "given twice": ('k = "1e8 N/m"', 'k = "1e8 N/m"\nk_x = "2e8 N/m"', ["[[support]] pedestal: k", "k_x given twice"]),
    "modes that leave nothing": ('material = "steel"', 'material = "steel"\nmodes = 4', ["pinion: modes", "fewer"]),
    "coefficients without a number": (JOURNAL, BY_COEFFICIENTS, ["[[bearing]] drive_end", "no coefficient", "k_xx"]),
    "radius of coefficients": (JOURNAL, BY_COEFFICIENTS + 'k_xx = "1e8 N/m"\nR = "25 mm"\n',
                               ["[[bearing]] drive_end: R", "unknown key"]),
    "coefficient beside a table": (JOURNAL, BY_COEFFICIENTS + f'k_xx = "1e8 N/m"\n{TABLE}',
                                   ["[[bearing]] drive_end: k_xx", "beside a table"]),
    "one row": (JOURNAL, BY_COEFFICIENTS + TABLE.replace('{ speed = "2000 rpm"', '#'),
                ["[[bearing]] drive_end: table", "two rows"]),
    "speeds that fall": (JOURNAL, BY_COEFFICIENTS + TABLE.replace("2000", "9900"),
                         ["[[bearing]] drive_end: table", "row 2", "ascending"]),
    "gap in a table": (JOURNAL, BY_COEFFICIENTS + TABLE.replace(', c_xx = "2e4 N*s/m"', ""),
                       ["[[bearing]] drive_end: table", "no c_xx in row 2"]),
    "row without a speed": (JOURNAL, BY_COEFFICIENTS + TABLE.replace('speed = "2000 rpm", ', ""),
                            ["[[bearing]] drive_end", "no speed"]),
    "unit in a table": (JOURNAL, BY_COEFFICIENTS + TABLE.replace('"2e4 N*s/m"', '"2e4 N/m"'),
                        ["[[bearing]] drive_end: c_xx", "N/m"]),
    "rub without a clearance": (None, '[[rub]]\nname = "seal"\nshaft = "pinion"\nat = 1\nK_r = "1e8 N/m"\n',
                                ["[[rub]] seal", "no clearance"]),
    "rub in a journal": (None, '[[rub]]\nname = "seal"\nshaft = "pinion"\nat = 0\nK_r = "1e8 N/m"\n'
                         'clearance = "1 mm"\n', ["[[rub]] seal: at", "contact"]),
    "coupling to nothing": (None, '[[coupling]]\nname = "m"\nshaft = "pinion"\nat = 0\nto = "motor"\nk_r = "1e6 N/m"\n',
                            ["[[coupling]] m: to", "'motor'"]),
    "coupling in a loop": (None, '[[coupling]]\nname = "m"\nshaft = "pinion"\nat = 1\nto = "gear"\nat_to = 1\n'
                           'k_r = "1e6 N/m"\n', ["m", "loop", "tree"]),
    "coupling without a spring": (None, '[[coupling]]\nname = "m"\nshaft = "pinion"\nat = 1\n',
                                  ["[[coupling]] m", "neither k_t nor k_r"]),
    "name with a dash": ('name = "u"', 'name = "left-plane"', ["[[unbalance]]", "letters, digits and underscores"]),
}  # fmt: skip
