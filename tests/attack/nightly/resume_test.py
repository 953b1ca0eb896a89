"""Runs that are killed or stopped at more moments than in resume_test.py. A stop request must be answered within 1.2 s.

    python3 nightly/resume_test.py PATH_TO_MOTTLE
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from attack import support  # noqa: E402  (found by the line above)
from interrupted_runs import InterruptedRuns  # noqa: E402


class ResumeTest(InterruptedRuns):
    def test_kills_while_the_results_are_written(self):
        self.assert_resumes_when_killed_at("study.toml", "history.csv", "cloud-initial.csv", "cloud-final.csv", "clouds.csv",
                                           "result.json", "report.html")

    def test_a_stop_request_is_answered_within_a_second(self):
        self.assert_stops_at(0.1, 0.3, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6)


if __name__ == "__main__":
    support.main()
