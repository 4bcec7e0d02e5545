"""The scenario file as one frozen object; a block per class, a unit in every key name.

To add a key: add a Field with bounds and a description to its block, then write the JSON schema and the page of all
keys anew with `cube-sim schema > scenarios/scenario.schema.json` and `cube-sim reference scenario > docs/scenario.md`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator
from pydantic.types import Strict
from pydantic_core.core_schema import ValidationInfo

from cube_sim.scenario.allocation_block import AllocationBlock
from cube_sim.scenario.attitude_blocks import AlongPathBlock, AnyAttitude
from cube_sim.scenario.battery_block import BatteryBlock
from cube_sim.scenario.check_blocks import AllowedForcesCheckBlock, AnyCheck, PathEndCheckBlock
from cube_sim.scenario.check_windows import require_windows_inside
from cube_sim.scenario.current_block import CurrentProfileBlock
from cube_sim.scenario.event_blocks import AnyEvent
from cube_sim.scenario.file_names import ModelFile
from cube_sim.scenario.guidance_block import GuidanceBlock
from cube_sim.scenario.knowledge_block import KnowledgeBlock
from cube_sim.scenario.navigation_blocks import NavigationBlock, require_slower_than
from cube_sim.scenario.path_blocks import AnyPath, PythonPathBlock
from cube_sim.scenario.phase_blocks import PhaseBlock, WaypointBlock
from cube_sim.scenario.python_block import NAME, NAMED_OR_OWN, OwnPython
from cube_sim.scenario.samples_block import SamplesBlock
from cube_sim.scenario.setpoint_block import SetpointsBlock
from cube_sim.scenario.stop_blocks import AnyStop, require_time_to_stop
from cube_sim.scenario.telemetry_block import TelemetryBlock
from cube_sim.scenario.values import (
    ZERO,
    Angles3,
    Block,
    Coordinate,
    HullVelocity,
    Name,
    Newtons2,
    Numbers,
    Place,
    Rate,
    Rates3,
    Seconds,
    Speed,
    WaterVelocity,
    refuse,
)
from cube_sim.scenario.windows import Schedule

MOST_TICKS = 24 * 3600 * 50
"""Control periods of the longest run: a day at 50 Hz, some 5 GB of rows in memory."""


class PhysicsBlock(Block):
    """How MuJoCo integrates."""

    integrator: Literal["RK4", "implicitfast", "Euler"] = Field(default="RK4", description="MuJoCo's integrator.")
    step_s: float = Field(default=0.01, ge=1e-5, le=1, description="Physics step [s].")


class InitialBlock(Block):
    """The vehicle's state at time 0."""

    position_m: Place = Field(default=ZERO, description="Body origin in world axes [m].")
    attitude_deg: Angles3 = Field(
        default=ZERO,
        description="[roll, pitch, yaw] [deg]: yaw about z, pitch about the new y, roll about the new x.",
    )
    velocity_m_s: HullVelocity = Field(default=ZERO, description="Velocity over ground in body axes [m/s].")
    rates_deg_s: Rates3 = Field(default=ZERO, description="Angular velocity in body axes [deg/s].")


class ThrustersBlock(Block):
    """Changes to the model's thrusters."""

    dead_zone_N: Newtons2 | None = Field(  # noqa: N815 - N is the newton
        default=None,
        description="Smallest attainable forces [F_DZ-, F_DZ+] of each thruster [N]. Default: the model's.",
    )

    @field_validator("dead_zone_N")
    @classmethod
    def _around_zero(cls, dead_zone_N: Newtons2 | None) -> Newtons2 | None:
        if dead_zone_N is not None and not dead_zone_N[0] <= 0.0 <= dead_zone_N[1]:
            refuse(f"must be [F_DZ-, F_DZ+] with F_DZ- <= 0 <= F_DZ+, got {list(dead_zone_N)}")
        return dead_zone_N


class PlanarGainsBlock(Block):
    """The planar law of Lapierre and Soetanto 2007; its k2 is guidance.target_gain_per_s."""

    angle_gain_per_s: Rate = Field(default=0.5, description="k1: decay of the angle to the approach direction [1/s].")
    yaw_rate_gain_per_s: Rate = Field(default=1.0, description="k3: decay of the yaw rate's error [1/s].")
    surge_gain_per_s: Rate = Field(default=1.0, description="k4: decay of the surge speed's error [1/s].")
    angle_stiffness_per_s2: Rate = Field(default=0.1, description="k5: stiffness beyond k1 k3 [1/s^2].")
    least_speed_m_s: Speed = Field(
        default=0.1,
        description="Surge speed below which side-slip is not believed [m/s]; the speed wanted stays above it.",
    )


class SafeModeBlock(Block):
    """What to do when the path cannot be followed."""

    action: Literal["hold", "surface"] = Field(
        default="hold", description="Keep the position as well as what is left of the thrusters can, or rise."
    )
    surface_m: Coordinate = Field(
        default=0.0, description="Height to rise to, world axes [m]; not above that at which the hull floats."
    )
    speed_m_s: Speed = Field(default=0.2, description="Bound on the velocity asked for [m/s].")
    drop_weight_N: float = Field(  # noqa: N815 - N is the newton
        default=0.0,
        ge=0,
        le=1e6,
        description="Weight in water of the ballast dropped when it surfaces, at the centre of mass; its inertia is"
        " taken as none [N].",
    )
    distance_limit_m: float | None = Field(
        default=0.0,
        ge=0,
        le=1e6,
        description="Distance from its target at which a vehicle that was nearer gives the path up, until other"
        " thrusters work; null: never [m]. Default, 0: 10 m, for a vehicle that its fins steer no less than twice the"
        " diameter of the tightest turn that they hold.",
    )
    patience_s: Seconds = Field(
        default=10.0, description="Time beyond that limit, coming no nearer, until it is given up [s]."
    )


LawName = Literal["motion_6dof", "planar_lapierre_2007"]
AnyLaw = Annotated[Annotated[LawName, NAME] | OwnPython, NAMED_OR_OWN]


class ControlBlock(Block):
    """The loops that turn errors into a wrench, each given by the time it takes to remove 63 % of one."""

    law: AnyLaw | None = Field(
        default=None,
        description="motion_6dof: all axes, or those the thrusters have. planar_lapierre_2007: a force ahead and a"
        " torque about the vertical, on a level path. Default: the planar law for a vehicle built with just these two.",
    )
    planar: PlanarGainsBlock = PlanarGainsBlock()
    velocity_time_s: Seconds | None = Field(
        default=None,
        description="Velocity loop [s]. Default: 0.5 s, or six delays if that is more; a delay is the thrusters' lag"
        " and 1.5 control periods.",
    )
    attitude_time_s: Seconds | None = Field(
        default=None, description="Attitude loop [s]. Default: 0.5 s, or ten delays if that is more."
    )
    rate_time_s: Seconds | None = Field(
        default=None, description="Angular rate loop [s]. Default: 0.15 s, or three delays if that is more."
    )
    disturbance_time_s: Seconds | None = Field(
        default=1.0,
        description="Estimate of the wrench the model does not explain [s]; null: no estimate.",
    )
    current_time_s: Seconds | None = Field(
        default=5.0,
        description="Estimate of the current, from the wrench still water does not explain [s]; null, or without"
        " disturbance_time_s: none, and"
        " what the current does counts as a disturbance.",
    )
    faults: Literal["diagnosed", "told", "ignored"] = Field(
        default="diagnosed",
        description="How the controller learns of faults of thrusters and fins: from commands and responses, at once,"
        " or never.",
    )
    cost_limit: float | None = Field(
        default=None,
        ge=1e-3,
        le=1e12,
        description="Directions of the wrench that cost more thruster force than this are given up, as if thrusters "
        "were missing: N per N, torques divided by the thrusters' rms lever arm, as `cube-sim analyze` lists them. "
        "Default: ten times what the cheapest one costs, as long as the vehicle flies without what is dearer.",
    )
    safe_mode: SafeModeBlock = SafeModeBlock()
    attitude: AnyAttitude = Field(
        default=AlongPathBlock(mode="along_path"), description="Which attitude the vehicle takes."
    )
    priority: Literal["path", "attitude"] | None = Field(
        default=None,
        description="What the thrusters give when they cannot give all. path: the force the path needs, and what is"
        " left of the torque; attitude: by allocation.torque_weight. Default: path for the modes free and look_at,"
        " attitude for the others.",
    )


class Scenario(Block):
    """A mission of one vehicle: model, water, path, control and what must come out of it."""

    schema_version: Literal[1] = Field(description="Version of this file format.")
    name: Name = Field(description="Letters, digits, '_', '-', '.'; names the run's folder.")
    description: str = Field(default="", description="What the scenario shows, for readers.")
    include: str | None = Field(
        default=None,
        exclude=True,
        description="A scenario file, relative to this one, whose keys hold where this one says nothing. Blocks are"
        " merged key by key; a list is replaced as a whole, and so is a block of another type, mode or kind.",
    )
    model: ModelFile = Field(description="MJCF file, relative to the scenario file.")
    vehicle: str | None = Field(
        default=None,
        min_length=1,
        description="Body of the hull that is flown; needed when the model has several. Default: its only one.",
    )
    seed: int = Field(default=0, ge=0, lt=2**63, description="Root of every random stream.")
    duration_s: float = Field(gt=0, le=86400, description="Simulated time [s], a day at most.")
    physics: PhysicsBlock = PhysicsBlock()
    control_period_s: float = Field(
        default=0.02,
        gt=0,
        le=10,
        description="Time between two thruster commands [s]; an integer multiple of physics.step_s.",
    )
    current_m_s: WaterVelocity = Field(default=ZERO, description="Velocity of the water, world axes [m/s].")
    current_profile: CurrentProfileBlock | None = Field(
        default=None, description="The current by depth, in place of current_m_s. Default: the same at every depth."
    )
    surface_m: Coordinate | None = Field(
        default=0.0,
        description="Height of the water's surface, world axes [m]; above it nothing carries, drives or damps. null:"
        " that of the model's water:surface, or none.",
    )
    initial: InitialBlock = InitialBlock()
    thrusters: ThrustersBlock = ThrustersBlock()
    parameters: dict[str, Numbers] = Field(
        default={},
        description="Values in place of the custom numerics of the model that flies, by their names, for example"
        " hull:added_mass; and of what its elements say: hull:mass, hull:centre_of_mass, hull:inertia,"
        " hull:thruster_lag. The controller knows them as well, unless knowledge.model names a file.",
    )
    battery: BatteryBlock | None = Field(
        default=None,
        description="What feeds the thrusters. Default: a constant voltage, that of the model's characteristic.",
    )
    path: AnyPath = Field(description="The curve to follow, or the point to hold.")
    guidance: GuidanceBlock
    control: ControlBlock = ControlBlock()
    phases: Annotated[tuple[PhaseBlock, ...], Strict(False)] = Field(
        default=(),
        description="Legs with paths of their own, flown one after the other, in place of `path`. The last goes on to"
        " the end of the run. Every law flies them, but a whole controller of one's own.",
    )
    waypoints: Annotated[tuple[WaypointBlock, ...], Strict(False)] = Field(
        default=(),
        exclude=True,
        description="Points to go to, in place of `phases`: each is a straight leg, and a point that is held then where"
        " it asks for that.",
    )
    navigation: NavigationBlock | None = Field(
        default=None, description="Sensors and an estimate for the controller. Default: it sees the true state."
    )
    knowledge: KnowledgeBlock = KnowledgeBlock()
    telemetry: TelemetryBlock = TelemetryBlock()
    allocation: AllocationBlock = AllocationBlock()
    setpoints: dict[str, SetpointsBlock] = Field(
        default={},
        description="What actuators of the model are told over time that are neither thrusters nor servos of fins, by"
        " their names: ballast, moving masses, joints of an arm. At time 0 they are where they are told to be. The"
        " controller is not told.",
    )
    events: Annotated[tuple[AnyEvent, ...], Strict(False)] = Field(
        default=(), description="What happens during the run."
    )
    stop: Annotated[tuple[AnyStop, ...], Strict(False)] = Field(
        default=(), description="What ends the run before its time; the first that is met does."
    )
    checks: Annotated[tuple[AnyCheck, ...], Strict(False)] = Field(
        description="What the run must show; at least one.", json_schema_extra={"minItems": 1}
    )
    samples: SamplesBlock | None = Field(
        default=None, description="Many flights with values of their own. Default: there is this one alone."
    )

    @property
    def steps_per_tick(self) -> int:
        """Physics steps in one control period."""
        return round(self.control_period_s / self.physics.step_s)

    @property
    def ticks(self) -> int:
        """Whole control periods in the run."""
        return int(self.duration_s / self.control_period_s * (1 + 1e-12))

    @field_validator("include")
    @classmethod
    def _in_a_file(cls, include: str | None) -> str | None:
        if include is not None:  # that of a file is followed before its values are looked at
            refuse("only a file includes another; load that one")
        return include

    @field_validator("schema_version", mode="before")
    @classmethod
    def _whole_number(cls, schema_version: Any) -> Any:
        # Python takes true for 1.
        if isinstance(schema_version, bool | float):
            refuse(f"must be 1, got {str(schema_version).lower()}")
        return schema_version

    @field_validator("control_period_s")
    @classmethod
    def _whole_steps(cls, control_period_s: float, info: ValidationInfo) -> float:
        physics = info.data.get("physics")
        if physics is not None:
            steps = control_period_s / physics.step_s
            if round(steps) < 1 or abs(steps - round(steps)) > 1e-9 * steps:
                refuse(
                    f"must be an integer multiple of physics.step_s: {control_period_s:g} s is"
                    f" {steps:.6g} steps of {physics.step_s:g} s",
                    because=("physics", "step_s"),
                )
        duration_s = info.data.get("duration_s")
        if duration_s is not None and duration_s < control_period_s:
            refuse(
                f"must not exceed duration_s: {control_period_s:g} s against {duration_s:g} s", because=("duration_s",)
            )
        if duration_s is not None and duration_s / control_period_s > MOST_TICKS:
            refuse(
                f"{duration_s:g} s in periods of {control_period_s:g} s are {duration_s / control_period_s:.3g}; a run"
                f" is recorded in memory and has {MOST_TICKS} at most",
                because=("duration_s",),
            )
        return control_period_s

    @field_validator("current_profile")
    @classmethod
    def _one_current(cls, profile: CurrentProfileBlock | None, info: ValidationInfo) -> CurrentProfileBlock | None:
        if profile is not None and any(info.data.get("current_m_s", ())):
            refuse("give either current_m_s or current_profile", because=("current_m_s",))
        return profile

    @field_validator("waypoints")
    @classmethod
    def _written_out_as_phases(
        cls, waypoints: tuple[WaypointBlock, ...], info: ValidationInfo
    ) -> tuple[WaypointBlock, ...]:
        if waypoints and info.data.get("phases"):
            refuse("are phases, written in short: give either phases or waypoints", because=("phases",))
        return waypoints[:0]

    @field_validator("phases")
    @classmethod
    def _from_the_first(cls, phases: tuple[PhaseBlock, ...], info: ValidationInfo) -> tuple[PhaseBlock, ...]:
        if phases and "path" in info.data and info.data["path"] != phases[0].path:
            refuse("the path is that of the first phase: leave `path` out", because=("path",))
        return phases

    @field_validator("navigation")
    @classmethod
    def _readings_the_loop_can_take(
        cls, navigation: NavigationBlock | None, info: ValidationInfo
    ) -> NavigationBlock | None:
        control_period_s = info.data.get("control_period_s")
        if navigation is not None and control_period_s is not None:
            require_slower_than(navigation, control_period_s)
        return navigation

    @field_validator("events")
    @classmethod
    def _distinct_events(cls, events: tuple[AnyEvent, ...]) -> tuple[AnyEvent, ...]:
        _require_distinct_names("events", [event.name for event in events])
        return events

    @field_validator("stop")
    @classmethod
    def _distinct_within_the_run(cls, stop: tuple[AnyStop, ...], info: ValidationInfo) -> tuple[AnyStop, ...]:
        _require_distinct_names("stop", [each.name for each in stop])
        require_time_to_stop(stop, info.data.get("duration_s"))
        return stop

    @field_validator("checks")
    @classmethod
    def _distinct_and_complete(cls, checks: tuple[AnyCheck, ...], info: ValidationInfo) -> tuple[AnyCheck, ...]:
        if not checks and not (info.context or {}).get("several"):
            refuse("a run without checks shows nothing: give at least one")
        seen: dict[str, int] = {}
        for index, check in enumerate(checks):
            first = seen.setdefault(check.title, index)
            if first != index:
                refuse(
                    f"checks {first} and {index} are both called '{check.title}'; give one another name",
                    index,
                )
        require_windows_inside(checks, Schedule(*(info.data.get(key) for key in ("events", "phases", "duration_s"))))
        path = info.data.get("path")
        may_be_open = isinstance(path, PythonPathBlock)  # only the path itself says
        if not may_be_open and getattr(path, "laps", 1.0) is None and getattr(path, "closed", True):
            for index, check in enumerate(checks):
                if isinstance(check, PathEndCheckBlock):
                    refuse("a closed path run without end has no end to reach: give path.laps", index, "kind")
        allocation = info.data.get("allocation")
        if allocation is None:
            return checks
        return tuple(
            check.model_copy(update={"allow_off": allocation.allow_off})
            if isinstance(check, AllowedForcesCheckBlock) and check.allow_off is None
            else check
            for check in checks
        )


def _require_distinct_names(what: str, names: Sequence[str | None]) -> None:
    for index, name in enumerate(names):
        if name is not None and name in names[:index]:
            refuse(f"{what} {names.index(name)} and {index} are both called '{name}'", index, "name")
