"""Settings of a simulation: the contents of a scenario except structure, ground and studies."""

from __future__ import annotations

from typing import Any, NamedTuple

from ._native import MODELS
from ._tables import Tables

_LONG_NAMES = {name: long for short, long in MODELS for name in (short, long)}


def long_name(model: object) -> str:
    """The name in results of a model of motion."""
    found = _LONG_NAMES.get(model) if isinstance(model, str) else None
    if found is None:
        raise ValueError(f"`model = {model!r}` is not one of {', '.join(_LONG_NAMES)}")
    return found


class Settings(NamedTuple):
    """Keyword arguments of all functions that simulate, with the defaults of the program."""

    model: str = "four_links"
    impact: str = "max_restitution"
    restitution: float | None = None
    restitution_factor: float | None = None
    initial_sway: str | None = None
    initial_rotation_rad: float | None = None
    initial_rate_rad_s: float | None = None
    initial_impulse_n_s: float | None = None
    initial_height_m: float | None = None
    longest_step_s: float | None = None
    shortest_step_s: float | None = None
    friction_coefficient: float | None = None
    normal_stiffness_gpa_m: float | None = None
    shear_stiffness_gpa_m: float | None = None
    stone_modulus_gpa: float | None = None
    mortar_modulus_gpa: float | None = None
    mortar_thickness_m: float | None = None
    damping_time_s: float | None = None
    damping_ratio: float | None = None
    damping_frequency_hz: float | None = None
    rebound_ratio: float | None = None
    compressive_strength_mpa: float | None = None
    contact: str | None = None
    contact_points: int | None = None
    duration_s: float | None = None
    output_step_s: float = 0.005
    relative_tolerance: float = 1e-9
    rest_energy_ratio: float = 1e-8
    gravity_m_s2: float = 9.81
    direction: str = "both"

    def tables(self) -> Tables:
        """The tables of a scenario for these settings."""
        tables: Tables = {
            "simulation": {
                # By default it follows the ground motion.
                **_given(duration_s=self.duration_s),
                "output_step_s": self.output_step_s,
                "relative_tolerance": self.relative_tolerance,
                "rest_energy_ratio": self.rest_energy_ratio,
                "gravity_m_s2": self.gravity_m_s2,
                "direction": self.direction,
            }
        }
        impact = _given(restitution=self.restitution, restitution_factor=self.restitution_factor)
        if self.impact != "max_restitution" or impact:
            tables["impact"] = {"model": self.impact, **impact}
        initial = _given(
            sway=self.initial_sway,
            rotation_rad=self.initial_rotation_rad,
            rate_rad_s=self.initial_rate_rad_s,
            impulse_n_s=self.initial_impulse_n_s,
            height_m=self.initial_height_m,
        )
        if initial:
            tables["initial"] = initial
        of_blocks = _given(
            longest_step_s=self.longest_step_s,
            friction_coefficient=self.friction_coefficient,
        )
        free_hinges = _given(shortest_step_s=self.shortest_step_s)
        elastic_joints = _given(
            normal_stiffness_gpa_m=self.normal_stiffness_gpa_m,
            shear_stiffness_gpa_m=self.shear_stiffness_gpa_m,
            stone_modulus_gpa=self.stone_modulus_gpa,
            mortar_modulus_gpa=self.mortar_modulus_gpa,
            mortar_thickness_m=self.mortar_thickness_m,
            damping_time_s=self.damping_time_s,
            damping_ratio=self.damping_ratio,
            damping_frequency_hz=self.damping_frequency_hz,
            rebound_ratio=self.rebound_ratio,
            compressive_strength_mpa=self.compressive_strength_mpa,
            contact=self.contact,
            contact_points=self.contact_points,
        )
        model = long_name(self.model)
        own = {"free_hinges": free_hinges, "elastic_joints": elastic_joints}
        for other, given in own.items():
            if given and model != other:
                raise ValueError(f"{_names(given)}: of {other.replace('_', ' ')} only; give model=\"{other}\", or leave it out")
        if model == "elastic_joints":
            if "impact" in tables:
                raise ValueError("`impact`, `restitution` and `restitution_factor` go with four links: elastic joints have no impacts")
            tables["elastic_joints"] = {**of_blocks, **elastic_joints}
        elif model == "free_hinges":
            if "impact" in tables:
                raise ValueError(
                    "`impact`, `restitution` and `restitution_factor` go with four links: with free hinges impacts follow from the blocks"
                )
            tables["free_hinges"] = {**of_blocks, **free_hinges}
        elif of_blocks:
            raise ValueError(
                f"{_names(of_blocks)}: of free hinges only, or of elastic joints; give model=\"free_hinges\", or leave it out"
            )
        return tables


def _names(given: Tables) -> str:
    return " and ".join(f"`{name}`" for name in given)


def _given(**values: Any) -> Tables:
    return {key: value for key, value in values.items() if value is not None}
