from evenroad.points.npz import load_points as load_points
from evenroad.points.npz import save_points as save_points
from evenroad.points.pointset import Origin as Origin
from evenroad.points.pointset import PointSet as PointSet
from evenroad.points.samplers import SAMPLERS as SAMPLERS
from evenroad.points.samplers import Sampler as Sampler
from evenroad.points.samplers import draw as draw
from evenroad.points.samplers import make_sampler as make_sampler
