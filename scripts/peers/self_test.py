#!/usr/bin/env python3
"""Tests of the comparison's own arithmetic, on synthetic curves; tests/peers_test.cpp runs them."""
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import assess  # noqa: E402
import measure  # noqa: E402
import problem  # noqa: E402
import table  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


def row(name, kind, points, precision, seconds):
    result = {"integrand": "f", "n": 1024, "seconds_per_n": {"min": seconds, "median": seconds, "count": 1}}
    return {"name": name, "kind": kind, "points": points, "precision": precision, "problems": [result]}


class Slow:
    """A contender whose clock is its own."""

    def __init__(self, name, seconds):
        self.entry, self.seconds, self.calls = {"name": name}, seconds, 0

    def measure(self, *_):
        self.calls += 1
        if self.seconds is None:
            raise measure.Failure("no")
        return self.seconds, 0.5


class Assess(unittest.TestCase):
    def test_time_to_a_tolerance_is_that_of_the_n_of_the_fitted_line(self):
        curve = [{"n": n, "error": 4 / n, "seconds": 1e-6 * n} for n in (256, 1024, 4096, 16384)]
        found = {t["tolerance"]: t for t in assess.times_to(curve)["time_to"]}
        self.assertAlmostEqual(found[1e-3]["n"], 4000, places=6)
        self.assertAlmostEqual(found[1e-3]["seconds"], 4e-3, places=9)
        self.assertFalse(found[1e-3]["extrapolated"])
        self.assertAlmostEqual(found[1e-6]["seconds"], 4, places=6)
        self.assertTrue(found[1e-6]["extrapolated"])

    def test_an_error_that_does_not_fall_reaches_nothing(self):
        curve = [{"n": n, "error": 0.25, "seconds": 1e-6} for n in (256, 1024, 4096)]
        self.assertTrue(all(t["n"] is None and t["seconds"] is None for t in assess.times_to(curve)["time_to"]))

    def test_below_the_smallest_n_no_time_is_saved(self):
        curve = [{"n": 256, "error": 1e-9, "seconds": 3.0}, {"n": 512, "error": 1e-10, "seconds": 4.0}]
        self.assertEqual(assess.seconds_at(curve, 2), 3.0)
        self.assertAlmostEqual(assess.seconds_at(curve, 256 * math.sqrt(2)), math.sqrt(12))
        self.assertEqual(assess.seconds_at(curve, 1024), 8.0)

    def test_the_fastest_peer_of_the_allowed_kind_is_the_measure(self):
        rows = [row("own", "subject", "qmc", "fp32", 1.0), row("slow", "peer", "qmc", "fp64", 20.0),
                row("fast", "peer", "qmc", "fp32", 9.0), row("other", "peer", "random", "fp32", 0.1)]
        subject = {"name": "own", "precision": "fp32", "against": ["qmc"], "required": 10}
        (line,) = assess.throughput_headlines(rows, "f", [subject])
        self.assertEqual((line["peer"], line["ratio"], line["met"]), ("fast", 9.0, False))
        (line,) = assess.throughput_headlines(rows, "f", [dict(subject, required=9)])
        self.assertTrue(line["met"])
        (line,) = assess.throughput_headlines(rows, "f", [{k: subject[k] for k in ("name", "precision", "against")}])
        self.assertNotIn("met", line)
        wide = [row("own", "subject", "qmc", "fp64", 1.0), *rows[1:]]
        (line,) = assess.throughput_headlines(wide, "f", [dict(subject, precision="fp64")])
        self.assertEqual(line["peer"], "slow")

    def test_a_missed_headline_is_printed_as_missed(self):
        text = table.headline_table([assess.headline("w", "f", 8, ("own", 1.0), ("peer", 9.0), 10)])
        self.assertIn("MISSED", text)
        self.assertNotIn("MISSED", table.headline_table([assess.headline("w", "f", 8, ("own", 1.0), ("peer", 10.0), 10)]))


class Rounds(unittest.TestCase):
    def test_rounds_alternate_and_end_for_the_slow_and_for_those_that_fail(self):
        quick, slow, broken = Slow("quick", 0.1), Slow("slow", 8.0), Slow("broken", None)
        replicates = {"quick": 4, "slow": 4, "broken": 4}
        times, failures = measure.rounds_of([quick, slow, broken], None, 1024, replicates, 5, 3.0, 1)
        self.assertEqual((quick.calls, slow.calls, broken.calls), (5, 1, 1))
        self.assertEqual(times["slow"], [2.0])
        self.assertAlmostEqual(times["quick"][4], 0.025)
        self.assertEqual(list(failures), ["broken"])

    def test_jobs_last_about_as_long_for_all(self):
        self.assertEqual([measure.replicates_for(s) for s in (1e-6, 1e-3, 5e-3, 10)], [64, 50, 10, 2])

    def test_a_peer_that_ends_is_a_failure_with_its_last_words(self):
        command = [sys.executable, "-c", "import sys; sys.exit('library is missing')"]
        peer = measure.Peer({"name": "p"}, command, {})
        with self.assertRaisesRegex(measure.Failure, "library is missing"):
            peer.measure(problem.problems(ROOT)[0], 256, 2, 1)
        peer.process.stdin.close()
        peer.process.stdout.close()
        peer.log.close()


class Problems(unittest.TestCase):
    def test_a_job_reads_back_as_it_was_written(self):
        for p in problem.problems(ROOT):
            self.assertEqual(problem.parse_job(p.job(1024, 4, 7)), (p, 1024, 4, 7))


if __name__ == "__main__":
    unittest.main()
