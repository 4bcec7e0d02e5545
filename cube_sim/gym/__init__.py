"""Flights as environments of Gymnasium, for reinforcement learning; needs the extra `gym`.

Importing it registers the ids of `cube_sim.gym.registration`, for example `cube_sim/CubeHelix-v0`.
"""

try:
    import gymnasium as gymnasium
except ImportError as error:
    raise ImportError(f"cube_sim.gym needs gymnasium: pip install 'cube-sim[gym]' ({error})") from error

from cube_sim.gym.actions import ActionScale
from cube_sim.gym.flight_env import FlightEnv
from cube_sim.gym.layout import ObservationLayout
from cube_sim.gym.registration import IDS, register_all
from cube_sim.gym.reward import FollowingReward, Stepped
from cube_sim.gym.vector import make_vec

__all__ = ["IDS", "ActionScale", "FlightEnv", "FollowingReward", "ObservationLayout", "Stepped", "make_vec"]

register_all()
