// What the commands of schedulers print, as their manuals show it.
#include <gmock/gmock.h>

#include "drivers/scheduler/scheduler_call.hpp"

namespace {

using mottle::SystemFailure;
using mottle::drivers::clock_text;
using mottle::drivers::CommandAnswer;
using mottle::drivers::read_bjobs;
using mottle::drivers::read_qstat;
using mottle::drivers::read_sacct;
using mottle::drivers::read_scontrol;
using mottle::drivers::read_squeue;
using mottle::drivers::refuse_answer;
using mottle::drivers::SchedulerSilent;
using mottle::drivers::TaskReport;
using State = mottle::drivers::TaskReport::State;

TEST(SchedulerOutput, SqueueTellsWaitingRunningAndEndedTasks) {
  const std::vector<TaskReport> reports = read_squeue(
      "mottle-1|1|RUNNING|n3|None\nmottle-1|2|PENDING||Resources\nmottle-1|3|TIMEOUT|n1|TimeLimit\n"
      "mottle-1|4|COMPLETED|n2|None\nmottle-1|5|REQUEUED|n2|None\nmottle-1|N/A|RUNNING|n1|None\n");
  ASSERT_EQ(reports.size(), 5U);
  EXPECT_EQ(reports[0], (TaskReport{"mottle-1", 1, State::running, "n3", "RUNNING", false}));
  EXPECT_EQ(reports[1].words, "PENDING (Resources)");
  EXPECT_EQ(reports[1].state, State::waiting);
  EXPECT_EQ(reports[2], (TaskReport{"mottle-1", 3, State::ended, "n1", "TIMEOUT", false}));
  EXPECT_TRUE(reports[3].is_success);
  EXPECT_EQ(reports[4].state, State::waiting);  // it will start again
}

TEST(SchedulerOutput, ScontrolTellsTasksByTheirNumbers) {
  const std::vector<TaskReport> reports = read_scontrol(
      "JobId=5 ArrayJobId=5 ArrayTaskId=4-5,7%2 JobName=mottle-1 UserId=me(1) JobState=PENDING Reason=Resources "
      "NodeList=(null) Comment=JobState=FAILED\n"
      "JobId=8 ArrayJobId=5 ArrayTaskId=2 JobName=mottle-1 JobState=RUNNING NodeList=n3\n"
      "JobId=9 ArrayJobId=5 ArrayTaskId=1 JobName=mottle-1 JobState=NODE_FAIL NodeList=n1\n"
      "JobId=10 JobName=another JobState=RUNNING NodeList=n1\nslurm_load_jobs error\n");
  ASSERT_EQ(reports.size(), 5U);
  EXPECT_EQ(reports[0], (TaskReport{"mottle-1", 4, State::waiting, "", "PENDING", false}));
  EXPECT_EQ(reports[2].task, 7);
  EXPECT_EQ(reports[3], (TaskReport{"mottle-1", 2, State::running, "n3", "RUNNING", false}));
  EXPECT_EQ(reports[4], (TaskReport{"mottle-1", 1, State::ended, "n1", "NODE_FAIL", false}));
}

TEST(SchedulerOutput, SacctTellsHowTasksEnded) {
  const std::vector<TaskReport> reports = read_sacct(
      "mottle-1|5_1|COMPLETED|n1\nmottle-1|5_2|CANCELLED by 1000|n2\nmottle-1|5_[3-4%1]|PENDING|None assigned\n"
      "other|6|RUNNING|n1\nSlurm accounting storage is disabled\n");
  ASSERT_EQ(reports.size(), 4U);
  EXPECT_TRUE(reports[0].is_success);
  EXPECT_EQ(reports[1], (TaskReport{"mottle-1", 2, State::ended, "n2", "CANCELLED", false}));
  EXPECT_EQ(reports[3], (TaskReport{"mottle-1", 4, State::waiting, "", "PENDING", false}));
}

TEST(SchedulerOutput, QstatTellsTasksAndLeavesOutTheArrayItself) {
  const std::vector<TaskReport> reports = read_qstat(
      R"({"Jobs": {"7[].s": {"Job_Name": "mottle-1", "job_state": "B"},
        "7[1].s": {"Job_Name": "mottle-1", "job_state": "R", "exec_host": "n4/0*2"},
        "7[2].s": {"Job_Name": "mottle-1", "job_state": "X", "Exit_status": 271, "comment": "killed"},
        "8.s": {"Job_Name": "mottle-2", "job_state": "F", "Exit_status": 0},
        "9.s": {"Job_Name": "another", "job_state": "R"}}})",
      {"mottle-1", "mottle-2"});
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0].node, "n4");
  EXPECT_EQ(reports[1], (TaskReport{"mottle-1", 2, State::ended, "", "killed (exit status 271)", false}));
  EXPECT_EQ(reports[2].task, 1);
  EXPECT_TRUE(reports[2].is_success);
  EXPECT_THROW(read_qstat("qstat: Connection refused", {}), SchedulerSilent);
}

TEST(SchedulerOutput, QstatsJsonOfAnotherShapeIsNoAnswerOrNoTask) {
  for (const char* text : {"[]", "null", "\"x\"", R"({"Jobs": [1]})"})
    EXPECT_THROW(read_qstat(text, {}), SchedulerSilent);
  EXPECT_TRUE(read_qstat("{}", {"m"}).empty());
  EXPECT_TRUE(read_qstat(R"({"Jobs": {"1.s": 3, "2.s": {"Job_Name": 5}}})", {"m"}).empty());
  const std::vector<TaskReport> reports =
      read_qstat(R"({"Jobs": {"1.s": {"Job_Name": "m", "job_state": "R", "comment": 7, "exec_host": null}}})", {"m"});
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_EQ(reports[0].words, "R");
}

TEST(SchedulerOutput, BjobsTellsWhyATaskEnded) {
  const std::vector<TaskReport> reports = read_bjobs(
      "mottle-1[1]|1|PEND|-|-\nmottle-1[2]|2|EXIT|n1|TERM_RUNLIMIT: job killed after reaching LSF run time limit\n"
      "mottle-1[3]|3|DONE|n1|-\n");
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0], (TaskReport{"mottle-1", 1, State::waiting, "", "PEND", false}));
  EXPECT_TRUE(reports[1].words.starts_with("TERM_RUNLIMIT"));
  EXPECT_TRUE(reports[2].is_success);
}

TEST(SchedulerOutput, OneThatIsOutOfReachIsNotOneThatRefuses) {
  const auto refusal = [](const char* words) { refuse_answer("sbatch", CommandAnswer{false, "", words}); };
  EXPECT_THROW(refusal("sbatch: error: Unable to contact slurm controller (connect failure)"), SchedulerSilent);
  EXPECT_THROW(refusal("sbatch: error: Batch job submission failed: Socket timed out on send/recv operation"),
               SchedulerSilent);
  try {
    refusal("sbatch: error: invalid partition specified: x");
    FAIL();
  } catch (const SchedulerSilent&) {
    FAIL();
  } catch (const SystemFailure& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("invalid partition"));
  }
}

TEST(SchedulerOutput, TimesAreRoundedUpToSeconds) {
  EXPECT_EQ(clock_text(std::chrono::minutes(150)), "02:30:00");
  EXPECT_EQ(clock_text(std::chrono::milliseconds(1001)), "00:00:02");
  EXPECT_EQ(clock_text(std::chrono::hours(100)), "100:00:00");
}

}  // namespace
