"""``evenroad robots``, ``scenes``, ``maps`` and ``samplers``: what can be named, and what each is."""

from __future__ import annotations

import json
from dataclasses import dataclass

from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.errors import UnknownName


@dataclass(frozen=True, kw_only=True)
class Names:
    """Options of the lists of names."""

    part: Positional[str | None] = None
    """Only names that have this in them."""
    json: bool = False
    """Print JSON instead of a table."""

    def names(self) -> dict[str, str]:
        """Return the names, each with what it is."""
        raise NotImplementedError

    def run(self) -> int:
        """Print them."""
        every = self.names()
        found = {name: about for name, about in every.items() if (self.part or "").casefold() in name.casefold()}
        if not found:
            raise UnknownName.among("part of a name", self.part, every)
        if self.json:
            print(json.dumps(found, indent=2))
        else:
            print_table(list(found.items()))
        return 0


@dataclass(frozen=True, kw_only=True)
class Robots(Names):
    """List the robots that have names, as `--robot` takes them: the shipped ones and those of the extra [robots].

    Example: evenroad robots panda
    """

    def names(self) -> dict[str, str]:
        """Return the names of robots."""
        from evenroad.loading.find import ROBOTS, list_robots

        return {name: "ships with evenroad" if name in ROBOTS else "of the extra [robots]" for name in list_robots()}


@dataclass(frozen=True, kw_only=True)
class Scenes(Names):
    """List the scenes that ship, as `evenroad plan SCENE --robot ROBOT` takes them.

    Example: evenroad scenes
    """

    def names(self) -> dict[str, str]:
        """Return the names of scenes, with their obstacles."""
        from evenroad.scenes.scene_file import SCENES, load_scene

        return {name: ", ".join(load_scene(name).names) or "nothing but the robot" for name in SCENES}


@dataclass(frozen=True, kw_only=True)
class Maps(Names):
    """List the maps that ship, as `evenroad plan MAP --robot-radius R` takes them.

    Example: evenroad maps
    """

    def names(self) -> dict[str, str]:
        """Return the names of maps, with their sizes."""
        from evenroad.world.gridmap.load import MAPS, SHIPPED, load_map

        # Not the file of that name here, such as a picture of a plan.
        grids = {name.removesuffix(".png"): load_map(MAPS / name) for name in SHIPPED}
        units = {True: "m", False: "pixel"}
        return {
            name: f"{grid.shape[1]} by {grid.shape[0]} cells of {grid.resolution:g} {units[grid.frame.y_up]}"
            for name, grid in grids.items()
        }


@dataclass(frozen=True, kw_only=True)
class Samplers(Names):
    """List the samplers of points, as `evenroad points --sampler` and `er.draw` take them.

    Example: evenroad samplers
    """

    def names(self) -> dict[str, str]:
        """Return the names of samplers, with what they draw."""
        from evenroad.points.samplers import SAMPLERS, make_sampler

        return {name: make_sampler(name).about for name in sorted(SAMPLERS)}
