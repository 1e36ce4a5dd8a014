"""The watchdog does the arithmetic of all clients, which is kept beside the golden messages."""

import csv
import time
import unittest

from palpate import ForceFlags, ToolForce, Watchdog

from .golden import GOLDEN


class Law(unittest.TestCase):
    def test_forces_fade_and_come_back_as_in_all_clients(self) -> None:
        dog, run = Watchdog(), ""
        with (GOLDEN / "watchdog.csv").open(encoding="utf-8") as file:
            for line in csv.DictReader(file):
                if line["run"] != run:
                    dog, run = Watchdog(deadband=line["deadband"] == "1"), line["run"]
                now = float(line["time_ns"]) * 1e-9
                if line["comes"] == "1":
                    dog.heard(now)
                self.assertAlmostEqual(dog.gain(now), float(line["gain"]), 6, str(line))
                silence = float(line["silence_ns"]) * 1e-9 if line["silence_ns"] else None
                self.assertAlmostEqual(dog.silence(now), silence, 9, str(line))

    def test_a_force_in_full_is_the_one_that_came_and_one_that_is_not_says_so(self) -> None:
        force = ToolForce(
            3, 3, 0, 0, (1.0, 2.0, 2.0), (0.4, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 1e-3, 1, 0
        )
        dog = Watchdog()
        self.assertEqual((dog.gain(5.0), dog.silence(5.0)), (0.0, None))
        dog.heard(0.0)
        self.assertIs(dog.felt(force, 0.05), force)
        half = dog.felt(force, 0.055)
        self.assertAlmostEqual(half.force[2], 1.0)
        self.assertAlmostEqual(half.torque[0], 0.2)
        self.assertEqual(half.flags, ForceFlags.RAMPING)
        self.assertEqual(dog.felt(force, 0.061).force, (0.0, 0.0, 0.0))

    def test_its_clock_is_the_monotonic_one(self) -> None:
        dog = Watchdog()
        dog.heard()
        self.assertAlmostEqual(dog.silence(time.monotonic() + 100.0) or 0.0, 100.0, 0)


if __name__ == "__main__":
    unittest.main()
