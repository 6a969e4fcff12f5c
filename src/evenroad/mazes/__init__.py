"""Three mazes that ship with evenroad, drawn by ``tools/draw_mazes.py``: 640 x 480 pixels, a disk of radius 6."""

from evenroad.mazes.maze import LEVELS as LEVELS
from evenroad.mazes.maze import Maze as Maze
from evenroad.mazes.maze import load_maze as load_maze
