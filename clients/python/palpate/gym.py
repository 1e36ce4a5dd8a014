"""A Gymnasium environment: press one tool of a scene against a body with a wanted force.

>>> from palpate.gym import PressEnv  # doctest: +SKIP
>>> env = PressEnv(palpate.Scene.load("scenes/teardrop.toml"), direction=(-1.0, 0.0, 0.0))  # doctest: +SKIP
"""

from typing import Any, Optional

import gymnasium
import numpy as np

from ._native import Scene


class PressEnv(gymnasium.Env):  # type: ignore[type-arg,misc,unused-ignore]
    """Actions move the tool, rewards are for the wanted force.

    Observation: offset of the tool from its start (3,) m, force (3,) N, depth (m). Action: velocity of the tool, each
    component in [-1, 1] times ``speed`` m/s. Reward: minus the deviation of the force from ``force`` newtons against
    ``direction``, relative to it. The episode is truncated after ``steps`` actions of ``ticks`` ticks each.
    """

    metadata: "dict[str, Any]" = {"render_modes": []}

    def __init__(
        self,
        scene: Scene,
        tool: Optional[str] = None,
        *,
        force: float = 1.0,
        direction: "tuple[float, float, float]" = (-1.0, 0.0, 0.0),
        speed: float = 0.1,
        reach: float = 0.06,
        ticks: int = 10,
        steps: int = 200,
    ) -> None:
        self.simulation = scene.simulate()
        self.tool = tool if tool is not None else scene.tools[0]
        self.start = scene.start(self.tool)
        self.direction = np.asarray(direction) / np.linalg.norm(direction)
        self.force, self.speed, self.reach, self.ticks, self.steps = force, speed, reach, ticks, steps
        self.offset, self.count = np.zeros(3), 0
        self.step_s = ticks * scene.dt
        bound = np.array([reach] * 3 + [1e3] * 3 + [1.0])
        self.observation_space = gymnasium.spaces.Box(-bound, bound, dtype=np.float64)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, shape=(3,), dtype=np.float64)

    def _observe(self, velocity: Any) -> "tuple[Any, Any]":
        place = [*(self.start.position + self.offset), *self.start.orientation, *velocity, 0.0, 0.0, 0.0]
        out = self.simulation.step({self.tool: place}, self.ticks)
        force = out.force[self.tool]
        return np.concatenate([self.offset, force, [out.depth[self.tool]]]), force

    def reset(self, *, seed: Optional[int] = None, options: "Optional[dict[str, Any]]" = None) -> "tuple[Any, dict[str, Any]]":
        """Tool and bodies back at their start."""
        super().reset(seed=seed)
        self.simulation.reset()
        self.offset, self.count = np.zeros(3), 0
        return self._observe(np.zeros(3))[0], {}

    def step(self, action: Any) -> "tuple[Any, float, bool, bool, dict[str, Any]]":
        """One action: ``ticks`` ticks."""
        velocity = np.clip(action, -1.0, 1.0) * self.speed
        moved = np.clip(self.offset + velocity * self.step_s, -self.reach, self.reach)
        velocity, self.offset = (moved - self.offset) / self.step_s, moved
        observation, force = self._observe(velocity)
        self.count += 1
        reward = -abs(float(-force @ self.direction) - self.force) / self.force
        return observation, reward, False, self.count >= self.steps, {"hash": self.simulation.hash()}
