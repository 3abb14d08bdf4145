#!/usr/bin/env python3
"""The verdicts of bench/ab.py on made times, whose truth is known."""
import math
import pathlib
import random
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
import ab  # noqa: E402


def machine(change, scatter=0.01, bursts=0.1, seed=0):
    """A machine whose times scatter, and now and then double; the head is slower by `change`."""
    dice = random.Random(seed)

    def sample(side):
        time = 40.0 * (1.0 + change * side) * math.exp(dice.gauss(0.0, scatter))
        return {"step": time * (2.0 if dice.random() < bursts else 1.0)}
    return sample


def verdicts(change, count, **options):
    return [ab.gate(machine(change, seed=seed, **options))["step"][3] for seed in range(count)]


class Verdicts(unittest.TestCase):
    def setUp(self):
        random.seed(1)

    def test_interval_of_a_median_covers(self):
        inside = 0
        for seed in range(400):
            dice = random.Random(seed)
            low, high = ab.interval([math.exp(dice.gauss(0.0, 1.0)) for _ in range(15)], 0.05)
            inside += low <= 1.0 <= high
        self.assertGreaterEqual(inside, 370)  # 380 are promised at least; binomial, three deviations
        self.assertEqual(ab.interval([1.0], 0.05), (0.0, math.inf))

    def test_unchanged_code_is_hardly_ever_called_changed(self):
        said = verdicts(0.0, 300)
        self.assertLess(ab.upper(said.count("worse") + said.count("better"), 300), 0.02)
        self.assertGreater(said.count("same"), 200)

    def test_slowdowns_are_found(self):
        self.assertGreaterEqual(verdicts(0.05, 50).count("worse"), 48)
        self.assertGreaterEqual(verdicts(0.10, 50).count("worse"), 50)
        self.assertGreaterEqual(verdicts(-0.05, 50).count("better"), 48)

    def test_too_much_scatter_is_inconclusive_not_the_same(self):
        self.assertNotIn("same", verdicts(0.0, 30, scatter=0.3))

    def test_a_small_change_is_the_same(self):
        said = verdicts(0.01, 50, scatter=0.005, bursts=0.0)
        self.assertGreaterEqual(said.count("same"), 48)
        self.assertEqual(said.count("worse"), 0)

    def test_a_lost_benchmark_fails_and_a_new_one_does_not(self):
        lost = ab.gate(lambda side: {"a": 1.0} if side else {"a": 1.0, "b": 1.0})
        self.assertEqual(lost["b"][3], "missing")
        self.assertEqual(ab.exit_code(lost), 5)
        new = ab.gate(lambda side: {"a": 1.0, "b": 1.0} if side else {"a": 1.0})
        self.assertEqual(new["b"][3], "new")
        self.assertEqual(ab.exit_code(new), 0)

    def test_nothing_compared_is_undecided(self):
        self.assertEqual(ab.exit_code({}), 4)
        self.assertEqual(ab.exit_code(ab.gate(lambda side: {"a": 1.0} if side else {})), 4)

    def test_upper_bound_of_a_rate(self):
        self.assertAlmostEqual(ab.upper(0, 300), 1.0 - 0.05 ** (1.0 / 300), places=9)
        self.assertAlmostEqual(ab.upper(1, 300), 0.01573, places=4)


if __name__ == "__main__":
    unittest.main()
