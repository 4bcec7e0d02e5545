"""What the controller believes of its vehicle."""

from __future__ import annotations

from dataclasses import replace

from cube_sim.control.planar.model import PlanarModel
from cube_sim.scenario.knowledge_block import KnowledgeBlock
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.lift import HullLift
from cube_sim.vehicle.vehicle import Vehicle

UNLIKELY_FACTOR = 5.0
"""Nobody knows a vehicle so badly (a choice); none at all of a part, or little, is tried on purpose."""


def believed_dynamics(true: Dynamics, knowledge: KnowledgeBlock, lift: HullLift | None = None) -> Dynamics:
    """The equations of motion the controller reckons with.

    Args:
        true: those of the vehicle.
        knowledge: factors on its numbers.
        lift: what the flow lifts of it.
    """
    dynamics = replace(
        true,
        mass_matrix=knowledge.mass * true.mass_matrix,
        displaced_mass=knowledge.mass * true.displaced_mass,
        added_mass=knowledge.added_mass * true.added_mass,
        linear_damping=knowledge.drag * true.linear_damping,
        quadratic_damping=knowledge.drag * true.quadratic_damping,
    )
    return dynamics if lift is None else lift.known_as(dynamics, knowledge.drag, knowledge.fins)


def believed_planar_model(true: PlanarModel, vehicle: Vehicle, knowledge: KnowledgeBlock) -> PlanarModel:
    """The same for the planar laws, whose coefficients mix what rigid body, added mass and hull do.

    By Kirchhoff's equations added mass pushes sideways in a turn with its surge part, ahead with its sway part, and
    turns the hull by the difference of both (the Munk moment); what is left in those coefficients is lift, so drag.
    """
    rigid, added = vehicle.mass_matrix, vehicle.added_mass
    mass, share, drag = knowledge.mass, knowledge.added_mass, knowledge.drag

    def mixed(coefficient: float, of_rigid: float, of_added: float) -> float:
        return mass * of_rigid + share * of_added + drag * (coefficient - of_rigid - of_added)

    munk = added[1, 1] - added[0, 0]
    weight_of_turning = rigid[1, 5]
    return PlanarModel(
        m_u=mixed(true.m_u, rigid[0, 0], added[0, 0]),
        m_v=mixed(true.m_v, rigid[1, 1], added[1, 1]),
        m_r=mixed(true.m_r, rigid[5, 5], added[5, 5]),
        m_ur=mixed(true.m_ur, rigid[0, 0], added[0, 0]),
        m_vr=mixed(true.m_vr, rigid[1, 1], added[1, 1]),
        D_u=drag * true.D_u,
        D_uu=drag * true.D_uu,
        D_v=drag * true.D_v,
        D_vv=drag * true.D_vv,
        D_uv=drag * true.D_uv,
        K_r=drag * true.K_r,
        K_rr=drag * true.K_rr,
        K_v=drag * true.K_v,
        K_vv=drag * true.K_vv,
        K_uv=mixed(true.K_uv, 0.0, munk),
        K_ur=mixed(true.K_ur, weight_of_turning, added[1, 5]),
    )


def unlikely_factor_words(knowledge: KnowledgeBlock) -> list[str]:
    """A sentence for each factor that nobody's ignorance explains: most likely it is the number itself."""
    factors = {name: getattr(knowledge, name) for name in ("mass", "added_mass", "drag", "thrust", "fins")}
    return [
        f"knowledge.{name} is a factor on what the model has, and the controller believes {factor:g} times that"
        for name, factor in factors.items()
        if factor > UNLIKELY_FACTOR
    ]
