"""How a motion is simulated: everything of a scenario but structure, ground and studies."""

from __future__ import annotations

from typing import Any, NamedTuple

from ._tables import Tables


class Settings(NamedTuple):
    """Keyword arguments of everything that simulates, with the defaults of the program."""

    model: str = "four_links"
    impact: str = "max_restitution"
    restitution: float | None = None
    initial_sway: str | None = None
    initial_rotation_rad: float | None = None
    longest_step_s: float | None = None
    shortest_step_s: float | None = None
    friction_coefficient: float | None = None
    duration_s: float = 10.0
    output_step_s: float = 0.005
    relative_tolerance: float = 1e-9
    rest_energy_ratio: float = 1e-8
    gravity_m_s2: float = 9.81

    def tables(self) -> Tables:
        """The tables of a scenario that say so."""
        tables: Tables = {
            "simulation": {
                "duration_s": self.duration_s,
                "output_step_s": self.output_step_s,
                "relative_tolerance": self.relative_tolerance,
                "rest_energy_ratio": self.rest_energy_ratio,
                "gravity_m_s2": self.gravity_m_s2,
            }
        }
        if self.impact != "max_restitution" or self.restitution is not None:
            tables["impact"] = _given(model=self.impact, restitution=self.restitution)
        if self.initial_sway is not None or self.initial_rotation_rad is not None:
            tables["initial"] = _given(
                sway=self.initial_sway, rotation_rad=self.initial_rotation_rad
            )
        free_hinges = _given(
            longest_step_s=self.longest_step_s,
            shortest_step_s=self.shortest_step_s,
            friction_coefficient=self.friction_coefficient,
        )
        if self.model == "free_hinges":
            if "impact" in tables:
                raise ValueError(
                    "`impact` and `restitution` go with four links: with free hinges impacts follow from the blocks"
                )
            tables["free_hinges"] = free_hinges
        elif free_hinges:
            names = " and ".join(f"`{name}`" for name in free_hinges)
            raise ValueError(f"{names}: of free hinges only; give model=\"free_hinges\", or leave it out")
        return tables


def _given(**values: Any) -> Tables:
    return {key: value for key, value in values.items() if value is not None}
