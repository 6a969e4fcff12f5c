"""Which configurations lie near which: exact, and with a fixed order among ties."""

from evenroad.roadmap.neighbours.find import nearest as nearest
from evenroad.roadmap.neighbours.find import within as within
