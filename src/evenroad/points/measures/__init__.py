"""How even a set of points is: discrepancies, dispersion, separation, energy.

``MEASURES`` holds the L2 discrepancies by name: ``MEASURES["hickernell"].rooted(points)``.
"""

from evenroad.errors import UnknownName
from evenroad.points.measures.average_squared import AVERAGE_SQUARED as AVERAGE_SQUARED
from evenroad.points.measures.centred import CENTRED as CENTRED
from evenroad.points.measures.dispersion import dispersion_l2 as dispersion_l2
from evenroad.points.measures.dispersion import dispersion_linf as dispersion_linf
from evenroad.points.measures.dispersion import dispersion_lower_bound as dispersion_lower_bound
from evenroad.points.measures.hickernell import HICKERNELL as HICKERNELL
from evenroad.points.measures.measure import Measure as Measure
from evenroad.points.measures.mixture import MIXTURE as MIXTURE
from evenroad.points.measures.riesz import riesz_energy as riesz_energy
from evenroad.points.measures.riesz import riesz_energy_with_gradient as riesz_energy_with_gradient
from evenroad.points.measures.riesz import riesz_rooted as riesz_rooted
from evenroad.points.measures.riesz import riesz_rooted_with_gradient as riesz_rooted_with_gradient
from evenroad.points.measures.separation import separation as separation
from evenroad.points.measures.star import STAR as STAR
from evenroad.points.measures.star_discrepancy import star_discrepancy as star_discrepancy
from evenroad.points.measures.symmetric import SYMMETRIC as SYMMETRIC
from evenroad.points.measures.wrap_around import WRAP_AROUND as WRAP_AROUND

MEASURES: dict[str, Measure] = {
    measure.name: measure
    for measure in (STAR, HICKERNELL, CENTRED, WRAP_AROUND, MIXTURE, SYMMETRIC, AVERAGE_SQUARED)
}
"""The L2 discrepancies by name."""


def measure_named(name: str) -> Measure:
    """Return the measure of this name, or raise UnknownName with the known ones."""
    if name not in MEASURES:
        raise UnknownName.among("measure", name, MEASURES)
    return MEASURES[name]
