"""What every controller answers, so that the loop and the recording need not know which one flies."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol, runtime_checkable

from cube_sim.control.authority import Authority, Capability
from cube_sim.guidance.law import TargetView
from cube_sim.spatial import State, Vector


class Decision(NamedTuple):
    """One tick of a controller; vectors in body axes unless said otherwise.

    Attributes:
        wrench: F_B^d (6,) demanded of the thrusters [N, N m].
        secondary: the part (6,) of it that gives way when the thrusters cannot make all; zero where nothing does.
        disturbance: estimate (6,) of what the model does not explain [N, N m].
        current: estimate (3,) of the water's velocity [m/s], world axes.
        view: the vehicle seen from the virtual target.
        remaining: arc length from the target to the end of the path [m].
        velocity: desired velocity of the body origin over ground (3,) [m/s].
        rates: desired angular velocity (3,) [rad/s].
        quaternion: desired attitude q_WD (4,) wxyz.
        attitude_error: angle between desired and actual attitude [rad].
        authority: how it flies with the thrusters it believes to have.
        pace: share of the speed along the path that is asked for; below 1 where the thrusters cannot keep it.
        given_up: why the path is no longer followed and what is done instead; "" while it is.
        fins_water: the velocity of the water (3,) in which fins are turned [m/s], world axes: what is not explained yet
            is taken for water, too; None for `current`.
    """

    wrench: Vector
    secondary: Vector
    disturbance: Vector
    current: Vector
    view: TargetView
    remaining: float
    velocity: Vector
    rates: Vector
    quaternion: Vector
    attitude_error: float
    authority: Authority
    pace: float = 1.0
    given_up: str = ""
    fins_water: Vector | None = None


class Controller(Protocol):
    """A law from the vehicle's state to the wrench that should act on it; keeps its own virtual target."""

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """The wrench for the coming tick.

        Args:
            state: the vehicle now.
            applied: wrench (6,) [N, N m] the thrusters were allocated over the tick before, body axes.
            dt: length of a tick [s].
            force_ratio: share of their force that the supply leaves the thrusters.
        """
        ...

    def view(self, state: State) -> TargetView:
        """The vehicle as seen from its target now; nothing moves on."""
        ...

    def reconfigure(self, left: Capability) -> None:
        """Go on with other thrusters, which can do what is left."""
        ...


@runtime_checkable
class GoesOn(Protocol):
    """A controller that can fly one path after another."""

    def take_up(self, other: Any) -> None:
        """Fly the course of another from here on, with what is known of the vehicle and its water.

        Args:
            other: a controller of the same class and vehicle on another path, which has not flown.
        """
        ...
