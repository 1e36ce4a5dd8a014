#!/usr/bin/env python3
"""A Gymnasium environment with a random policy. Needs ``pip install gymnasium``."""

import argparse

import palpate as pp
from palpate.gym import PressEnv
from press_and_plot import SCENE


def episode(env: PressEnv, steps: int, seed: int) -> "tuple[float, int]":
    """Mean reward, and the hash of the state at the end."""
    env.reset(seed=seed)
    env.action_space.seed(seed)
    total, info = 0.0, {"hash": 0}
    for _ in range(steps):
        action = env.action_space.sample()
        action[0] -= 0.5  # towards the body on average
        _, reward, terminated, truncated, info = env.step(action.clip(-1.0, 1.0))
        total += reward
        if terminated or truncated:
            break
    return total / steps, info["hash"]


def main() -> None:
    parser = argparse.ArgumentParser(description="A random policy presses a soft body.")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    env = PressEnv(pp.Scene(SCENE), force=0.5, steps=args.steps)
    first, again = episode(env, args.steps, args.seed), episode(env, args.steps, args.seed)
    print(f"{args.steps} steps, mean reward {first[0]:.3f}, same again: {first == again}")


if __name__ == "__main__":
    main()
