"""Mazes for a disk robot: three that ship with evenroad, drawn by ``tools/draw_mazes.py``, and random ones."""

from evenroad.research.mazes.maze import LEVELS as LEVELS
from evenroad.research.mazes.maze import DrawnMaze as DrawnMaze
from evenroad.research.mazes.maze import Maze as Maze
from evenroad.research.mazes.maze import MazeDesign as MazeDesign
from evenroad.research.mazes.maze import draw_maze as draw_maze
from evenroad.research.mazes.maze import load_maze as load_maze
