"""``evenroad plan``: a path on a map."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

if TYPE_CHECKING:
    from evenroad.points import PointSet
    from evenroad.roadmap import Rule
    from evenroad.world import GridMap

DEFAULT_FAMILY = "even"


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Plan a short path for a disk robot on a map, write a picture and a JSON result.

    A bare image (.png, .pgm): unit = pixel, x right, y DOWN, origin in the top-left corner, dark = obstacle.
    A ROS map_server file (.yaml): unit = metre, map frame, y up.
    """

    map: Annotated[Path, tyro.conf.Positional]
    """The map: a .png or .pgm image, or a ROS map_server .yaml."""
    start: tuple[float, float]
    """Start of the robot's centre, x y in map units."""
    goal: tuple[float, float]
    """Goal of the robot's centre, x y in map units."""
    robot_radius: float
    """Radius of the robot, > 0, in map units."""
    clearance: float = 0.0
    """Margin to keep from every obstacle, added to the radius, >= 0."""
    n: Annotated[int, tyro.conf.arg(aliases=["-n"])] = 512
    """How many points to draw."""
    k: Annotated[int | None, tyro.conf.arg(aliases=["-k"])] = None
    """Connect each milestone with its k nearest, symmetrised (default 10)."""
    connect_radius: float | None = None
    """Connect milestones up to this distance instead, in map units."""
    sampler: str = "auto"
    """even, hickernell, mpmc, korobov, lattice, halton, sobol, sukharev or uniform; auto takes even where it ships for
    this n, else scrambled Halton, and says which."""
    plain: bool = False
    """halton and sobol: the plain sequence instead of the scrambled one."""
    skip: int = 0
    """halton and sobol: index of the first point of the sequence."""
    allow_fewer: bool = False
    """sukharev: take the largest grid with at most n points."""
    seed: int = 0
    """Seed of everything random; the same command gives the same path."""
    raw: bool = False
    """Leave the path as it runs along the roadmap, without shortcutting it."""
    unknown_is_free: bool = False
    """Let the robot pass through unknown cells of a ROS map."""
    out: Path | None = None
    """Where results go: OUT.png and OUT.json. Default: the map's stem in the current folder, with -plan added
    where that would overwrite the map."""
    csv: bool = False
    """Also write the path as OUT.csv."""

    def run(self) -> int:
        """Plan, write, report; return 0 when solved, else 1."""
        from evenroad.cli.plan_table import print_plan
        from evenroad.io import plan_record, save_json, save_path_csv
        from evenroad.roadmap import plan
        from evenroad.viz import save_plan_picture
        from evenroad.world import load_map

        rule = self._rule()
        gridmap = load_map(self.map, unknown_is_free=self.unknown_is_free)
        files = self._files()
        world = gridmap.world(self.robot_radius, clearance=self.clearance)
        self._require_on_map(gridmap)
        points, note = self._points()
        result = plan(world, self.start, self.goal, points, rule=rule, shorten=not self.raw)
        save_json(files["json"], plan_record(result, self._query()))
        if "csv" in files:
            # An earlier run's path must not pass for this one's.
            files["csv"].unlink(missing_ok=True)
            if result.path is None:
                del files["csv"]
            else:
                save_path_csv(files["csv"], result.path, ("x", "y"))
        save_plan_picture(files["png"], result, world)
        print_plan(result, note, list(files.values()))
        return 0 if result.solved else 1

    def _rule(self) -> Rule:
        from evenroad.errors import InvalidValue
        from evenroad.roadmap import KNearest, Radius

        if self.connect_radius is None:
            return KNearest(10 if self.k is None else self.k)
        if self.k is not None:
            raise InvalidValue("give -k or --connect-radius, not both")
        return Radius(self.connect_radius)

    def _points(self) -> tuple[PointSet, str]:
        """Draw the set, and say in words which one it is."""
        from evenroad._checks import require_count
        from evenroad._rng import generator
        from evenroad.points import make_sampler
        from evenroad.points.bank import open_bank

        require_count("n", self.n)
        generator(self.seed)
        name, note = self.sampler, ""
        if name == "auto":
            name = DEFAULT_FAMILY
            if not open_bank().has(DEFAULT_FAMILY, self.n, 2):
                name, note = "halton", f"the bank has no set of n={self.n}"
        points = make_sampler(name, **self._options(name)).draw(self.n, 2, rng=self.seed)
        return points, note

    def _options(self, name: str) -> dict[str, Any]:
        """Return the sampler's options, refusing those that this sampler would silently ignore."""
        from evenroad.errors import InvalidValue

        takes = {"halton": {"plain", "skip"}, "sobol": {"plain", "skip"}, "sukharev": {"allow_fewer"}}.get(
            name, set()
        )
        for option in ("plain", "skip", "allow_fewer"):
            if getattr(self, option) and option not in takes:
                raise InvalidValue(f"--{option.replace('_', '-')} does not go with the sampler {name!r}")
        if "plain" in takes:
            return {"scramble": not self.plain, "start": self.skip}
        return {"allow_fewer": self.allow_fewer} if "allow_fewer" in takes else {}

    def _files(self) -> dict[str, Path]:
        """Return where results go, refusing what cannot be written or would overwrite the map."""
        from evenroad._files import require_writable_folder
        from evenroad.errors import InvalidValue
        from evenroad.world.gridmap.load import map_files

        if self.out is not None and not self.out.name:
            raise InvalidValue(f"--out must end with a file name, got {str(self.out)!r}")
        inputs = {source.resolve() for source in map_files(self.map)}
        stem = self.out if self.out is not None else Path(self.map.stem)
        if self.out is None and any(path.resolve() in inputs for path in self._named(stem).values()):
            stem = Path(f"{self.map.stem}-plan")
        files = self._named(stem)
        for path in files.values():
            if path.resolve() in inputs:
                raise InvalidValue(f"--out {stem} would overwrite the map {path}")
            require_writable_folder(path)
        return files

    def _named(self, stem: Path) -> dict[str, Path]:
        suffixes = ("json", "png", "csv") if self.csv else ("json", "png")
        return {suffix: stem.with_name(f"{stem.name}.{suffix}") for suffix in suffixes}

    def _require_on_map(self, gridmap: GridMap) -> None:
        import numpy as np

        from evenroad.errors import InvalidValue

        for name, value in (("start", self.start), ("goal", self.goal)):
            if not gridmap.contains(np.array([value]))[0]:
                corners = gridmap.space.from_cube(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
                outline = ", ".join(f"({x:g}, {y:g})" for x, y in corners)
                raise InvalidValue(
                    f"{name} {value[0]:g} {value[1]:g} lies outside the map, whose corners are {outline}"
                )

    def _query(self) -> dict[str, Any]:
        return {
            "map": str(self.map),
            "robot_radius": self.robot_radius,
            "clearance": self.clearance,
            "n": self.n,
            "sampler": self.sampler,
            "plain": self.plain,
            "skip": self.skip,
            "allow_fewer": self.allow_fewer,
            "seed": self.seed,
            "raw": self.raw,
            "unknown_is_free": self.unknown_is_free,
        }
