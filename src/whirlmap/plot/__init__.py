"""Figures from Datasets: a Dataset in, Axes or a Figure out. Nothing here uses pyplot.

Every ``draw_...`` function takes ``ax=`` and returns the Axes that it drew into; without it a figure is made, which is
``ax.figure``. The ``..._figure`` functions compose these and return the Figure. A notebook shows both where they are the
last line of a cell. `save` writes PNG, SVG or PDF, `animate_orbit` a GIF. Settings of matplotlib that the user has
changed stay.

Examples
--------
>>> import whirlmap
>>> series = whirlmap.simulate(whirlmap.load("duffing", gamma=0.2), transient=100, periods=4)
>>> ax = whirlmap.plot.draw_phase_portrait(series, "x")
>>> ax.get_title(loc="left")
'phase portrait, 4 $T$'
>>> whirlmap.plot.save(ax.figure, "portrait.pdf").name
'portrait.pdf'
"""

from whirlmap.plot.common.save import encode as encode
from whirlmap.plot.common.save import save as save
from whirlmap.plot.figures.animation import animate_orbit as animate_orbit
from whirlmap.plot.figures.basins import attractors_figure as attractors_figure
from whirlmap.plot.figures.basins import basins_figure as basins_figure
from whirlmap.plot.figures.basins import draw_basins as draw_basins
from whirlmap.plot.figures.basins import draw_starts as draw_starts
from whirlmap.plot.figures.branches import branches_figure as branches_figure
from whirlmap.plot.figures.branches import event_curves_figure as event_curves_figure
from whirlmap.plot.figures.campbell import campbell_figure as campbell_figure
from whirlmap.plot.figures.diagnosis_figure import diagnosis_figure as diagnosis_figure
from whirlmap.plot.figures.diagnosis_figure import diagram_figure as diagram_figure
from whirlmap.plot.figures.diagnosis_figure import paper_diagram_figure as paper_diagram_figure
from whirlmap.plot.figures.diagnosis_figure import paper_orbit_figure as paper_orbit_figure
from whirlmap.plot.figures.improve import improve_figure as improve_figure
from whirlmap.plot.figures.machine import machine_figure as machine_figure
from whirlmap.plot.figures.regime_map import draw_regime_map as draw_regime_map
from whirlmap.plot.figures.regime_map import draw_shares as draw_shares
from whirlmap.plot.figures.regime_map import regime_line_figure as regime_line_figure
from whirlmap.plot.figures.regime_map import regime_map_figure as regime_map_figure
from whirlmap.plot.figures.response import response_figure as response_figure
from whirlmap.plot.figures.run_up import run_up_figure as run_up_figure
from whirlmap.plot.figures.signal_figure import series_figure as series_figure
from whirlmap.plot.figures.speeds import speeds_figure as speeds_figure
from whirlmap.plot.panels.branches import draw_branches as draw_branches
from whirlmap.plot.panels.branches import draw_event_curves as draw_event_curves
from whirlmap.plot.panels.convergence import draw_convergence as draw_convergence
from whirlmap.plot.panels.diagram import draw_diagram as draw_diagram
from whirlmap.plot.panels.dimension import draw_correlation_sum as draw_correlation_sum
from whirlmap.plot.panels.dimension import draw_local_slope as draw_local_slope
from whirlmap.plot.panels.orbit import draw_orbit as draw_orbit
from whirlmap.plot.panels.phase_portrait import draw_phase_portrait as draw_phase_portrait
from whirlmap.plot.panels.regime_strip import draw_exponents as draw_exponents
from whirlmap.plot.panels.regime_strip import draw_regime_strip as draw_regime_strip
from whirlmap.plot.panels.section import draw_section as draw_section
from whirlmap.plot.panels.spectrum import draw_full_spectrum as draw_full_spectrum
from whirlmap.plot.panels.spectrum import draw_power_spectrum as draw_power_spectrum
from whirlmap.plot.panels.time_series import draw_time_series as draw_time_series
from whirlmap.plot.panels.waterfall import draw_waterfall as draw_waterfall
