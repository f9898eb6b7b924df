"""The parts of fleet/fleet_tools by themselves; fleet_test.cpp runs it. Needs no Snakemake."""
import argparse
import math
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "fleet"))
from fleet_tools import aggregate, calibration, intervals, planner_figure, provenance, steps, table  # noqa: E402


class Intervals(unittest.TestCase):
    """Values of scipy 1.10: chi2.ppf and beta.ppf."""

    def near(self, found, expected):
        for a, b in zip(found, expected):
            self.assertTrue(math.isclose(a, b, rel_tol=1e-8, abs_tol=1e-12), (found, expected))

    def test_poisson(self):
        self.near(intervals.poisson_rate(0, 1.0), (0.0, 3.6888794541139354))
        self.near(intervals.poisson_rate(1, 1.0), (0.025317807984289876, 5.571643390938898))
        self.near(intervals.poisson_rate(7, 10.0), (0.28143630515198653, 1.4422675361702376))
        self.near(intervals.poisson_rate(100, 1.0), (81.36399125092314, 121.62679379242638))
        self.assertIsNone(intervals.poisson_rate(0, 0.0))

    def test_clopper_pearson(self):
        self.near(intervals.clopper_pearson(0, 10), (0.0, 0.3084971078187608))
        self.near(intervals.clopper_pearson(10, 10), (0.6915028921812392, 1.0))
        self.near(intervals.clopper_pearson(16, 17), (0.7131106033327794, 0.9985118256087334))
        self.near(intervals.clopper_pearson(5, 5000), (0.0003247744747778161, 0.0023321105911455896))
        self.assertIsNone(intervals.clopper_pearson(0, 0))

    def test_they_contain_the_ratio_and_narrow_with_more(self):
        low, high = intervals.clopper_pearson(3, 30)
        more = intervals.clopper_pearson(300, 3000)
        self.assertTrue(low < more[0] < 0.1 < more[1] < high)


def seconds(end_s, failed, stop_at_s=None, speed_mps=10.0):
    return [{"since": float(t), "remaining": end_s - t, "time": 60.0, "state": "FAILING" if t == stop_at_s else "OK",
             "speed": speed_mps, "failed": failed} for t in range(int(end_s) + 1)]


class PlannerFigure(unittest.TestCase):
    def judge(self, *arguments, **options):
        return planner_figure.judge(0.0, seconds(*arguments, **options))

    def test_a_failure_is_stoppable_from_three_seconds_on(self):
        self.assertEqual(self.judge(20.0, True, 15)["in_time"], 1, "5 s of stopping end at 20 s")
        self.assertEqual(self.judge(20.0, True, 16)["in_time"], 0)
        self.assertEqual(self.judge(20.0, True)["stoppable"], 1)
        self.assertEqual(self.judge(7.0, True, 3), self.judge(7.0, True, 3) | {"stoppable": 0, "unstoppable": 1, "told": 1})

    def test_used(self):
        found = self.judge(20.0, True, 10)
        self.assertEqual((found["used_s"], found["could_s"]), (10.0, 15.0))
        sound = self.judge(20.0, False, 10)
        self.assertEqual((sound["sound"], sound["sound_stopped"], sound["sound_used_s"], sound["sound_could_s"]), (1, 1, 10.0, 20.0))

    def test_a_failure_by_a_fault_is_stoppable_from_the_fault_on(self):
        rows = seconds(20.0, True, 17)
        self.assertEqual(planner_figure.judge(100.0, rows, [110.0])["stoppable"], 1)
        self.assertEqual(planner_figure.judge(100.0, rows, [116.0])["unstoppable"], 1)
        self.assertEqual(planner_figure.judge(100.0, rows, [90.0, 130.0])["stoppable"], 1, "not a fault of this start")

    def test_a_time_that_the_stop_needs_is_a_stop(self):
        self.assertTrue(planner_figure.demands_stop({"state": "OK", "time": 5.0, "speed": 10.0}))
        self.assertFalse(planner_figure.demands_stop({"state": "OK", "time": 5.1, "speed": 10.0}))
        self.assertFalse(planner_figure.demands_stop({"state": "DEGRADED", "time": -1.0, "speed": 10.0}))


class Calibration(unittest.TestCase):
    def test_never_judged_on_what_was_fitted(self):
        recordings = {name: table.Recording({"name": name, "tag_road": road}) for name, road in
                      (("a", "town"), ("b", "town"), ("c", "country"))}
        self.assertEqual(calibration.choose(recordings, {"road": "town"}, {"road": "country"}), (["a", "b"], ["c"]))
        for fit, judge in (({"road": "town"}, {"road": ["town", "country"]}), ({}, {"road": "town"}), ({"road": "sea"}, {"road":
                           "town"}), ({"weather": "wet"}, {"road": "town"})):
            with self.assertRaises(calibration.Refused):
                calibration.choose(recordings, fit, judge)

    def test_the_same_drive_by_another_name_is_refused(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "fitted.yaml").write_text(f"{provenance.FITTED_ON}a 1234abcd\nmonitor: {{}}\n")
            (folder / "fleet.csv").write_text("name,simulate\na,--seed 1\nb,--seed 2\n")
            steps.write_json(folder / "runs/b/odometry.json", {"status": steps.OK, "identity": "1234abcd"})
            arguments = argparse.Namespace(fitted=str(folder / "fitted.yaml"), table=str(folder / "fleet.csv"), names=["b"],
                                           runs=str(folder / "runs"))
            with self.assertRaisesRegex(calibration.Refused, "b is the drive a"):
                calibration.judge(arguments)

    def test_groups_are_merged(self):
        self.assertEqual(calibration.merge({"m": {"a": 1, "b": 2}}, {"m": {"b": 3}, "f": 4}), {"m": {"a": 1, "b": 3}, "f": 4})


class Aggregate(unittest.TestCase):
    def test_what_parameters_were_fitted_on_is_not_judged(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "fitted.yaml").write_text(f"{provenance.FITTED_ON}a 1234abcd\n")
            result = {"name": "a", "status": steps.OK, "error": "", "identity": "1234abcd"}
            steps.write_json(folder / "results/a/result.json", result)
            recordings = {name: table.Recording({"name": name}) for name in ("a", "absent")}
            found = aggregate.aggregate(recordings, folder / "results", [str(folder / "fitted.yaml")])
            self.assertEqual([row["status"] for row in found["not_judged"]], ["fitted on", "no result"])

    def test_rates(self):
        found = aggregate.rate(2, 4.0)
        self.assertEqual(found["per_hour"], 0.5)
        self.assertEqual(aggregate.rate_text(found), "0.500 (0.0606..1.81; 2)")
        self.assertEqual(aggregate.ratio_text(aggregate.ratio(0, 0)), "- (none)")


if __name__ == "__main__":
    unittest.main()
