"""Pictures of plans."""

from evenroad.viz.plan import draw_plan as draw_plan
from evenroad.viz.plan import save_plan_picture as save_plan_picture
