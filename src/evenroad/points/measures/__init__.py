"""Measures of a point set: discrepancies, dispersion, separation and energy.

``MEASURES`` holds the L2 discrepancies by name: ``MEASURES["hickernell"].rooted(points)``.
"""

from evenroad.points.measures.covering import DispersionBounds as DispersionBounds
from evenroad.points.measures.covering import dispersion_bounds as dispersion_bounds
from evenroad.points.measures.measure import MEASURES as MEASURES
from evenroad.points.measures.measure import Measure as Measure
from evenroad.points.measures.measure import star_discrepancy as star_discrepancy
from evenroad.points.measures.separation import riesz_rooted as riesz_rooted
from evenroad.points.measures.separation import separation as separation
