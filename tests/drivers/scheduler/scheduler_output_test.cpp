// What the commands of schedulers print, as their manuals show it.
#include <gmock/gmock.h>

#include "drivers/scheduler/scheduler_call.hpp"

namespace {

using mottle::SystemFailure;
using mottle::drivers::clock_text;
using mottle::drivers::CommandAnswer;
using mottle::drivers::job_number;
using mottle::drivers::read_bjobs;
using mottle::drivers::read_bsub;
using mottle::drivers::read_qstat;
using mottle::drivers::read_sacct;
using mottle::drivers::read_scontrol;
using mottle::drivers::read_squeue;
using mottle::drivers::refuse_answer;
using mottle::drivers::SchedulerSilent;
using mottle::drivers::TaskReport;
using mottle::drivers::TooManyTasks;
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

// As OpenPBS prints it, with the functions of a shell in the environment that its JSON cannot hold.
TEST(SchedulerOutput, QstatTellsTasksAndLeavesOutTheArrayItself) {
  const std::vector<TaskReport> reports = read_qstat(
      "Job Id: 7[].s\n    Job_Name = mottle-1\n    job_state = B\n\n"
      "Job Id: 7[1].s\n    Job_Name = mottle-1\n    job_state = R\n    exec_host = n4/0*2\n"
      "    Variable_List = PBS_O_HOME=/home/me,N=007,BASH_FUNC_ml%%=() {  local a=\"\\$1\"\n"
      "    job_state = x\n },PBS_O_PATH=/usr/bin:/a/long/\n\tfolder\n    comment = Job run at\n\t noon\n\n"
      "Job Id: 7[2].s\n    Job_Name = mottle-1\n    job_state = X\n    comment = killed\n    Exit_status = 271\n\n"
      "Job Id: 8.s\n    Job_Name = mott\n\tle-2\n    job_state = F\n    Exit_status = 0\n\n"
      "Job Id: 9.s\n    Job_Name = another\n    job_state = R\n\n",
      {"mottle-1", "mottle-2"});
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(reports[0], (TaskReport{"mottle-1", 1, State::running, "n4", "Job run at noon", false}));
  EXPECT_EQ(reports[1], (TaskReport{"mottle-1", 2, State::ended, "", "killed (exit status 271)", false}));
  EXPECT_EQ(reports[2].task, 1);
  EXPECT_TRUE(reports[2].is_success);
}

TEST(SchedulerOutput, QstatThatPrintsSomethingElseGivesNoAnswer) {
  EXPECT_THROW(read_qstat("qstat: Connection refused", {}), SchedulerSilent);
  EXPECT_THROW(read_qstat("\tJob_Name = m\n", {"m"}), SchedulerSilent);
  EXPECT_TRUE(read_qstat("", {"m"}).empty());
  EXPECT_TRUE(read_qstat("Job Id: 1.s\n\tx\nJob Id: [\n    Job_Name = m\n", {"m"}).empty());
}

TEST(SchedulerOutput, AJobsNumberIsFoundBehindWordsOfTheSite) {
  EXPECT_EQ(job_number("123\n"), "123");
  EXPECT_EQ(job_number("Welcome\n2 nodes are idle\n123;cluster\n"), "123");
  EXPECT_EQ(job_number("your quota: 80 %\n123[].server.site\n"), "123[].server.site");
  EXPECT_EQ(job_number("no number\n"), "");
  EXPECT_EQ(read_bsub("<<Project: none>>\nJob <123> is submitted to default queue <normal>.\n"), "123");
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

TEST(SchedulerOutput, LimitsOfTasksAreToldApart) {
  const auto passes = [](const char* words) {
    try {
      refuse_answer("sbatch", CommandAnswer{false, "", words});
    } catch (const TooManyTasks& refusal) {
      return refusal.is_passing();
    }
  };
  EXPECT_TRUE(
      passes("sbatch: error: QOSMaxSubmitJobPerUserLimit\nsbatch: error: Batch job submission failed: Job violates "
             "accounting/QOS policy (job submit limit, user's size and/or time limits)"));
  EXPECT_TRUE(passes("qsub: would exceed queue generic's per-user limit of jobs in 'Q' state"));
  EXPECT_FALSE(passes("sbatch: error: Batch job submission failed: Invalid job array specification"));
  EXPECT_FALSE(passes("qsub: Array job exceeds server or queue size limit"));
  EXPECT_FALSE(passes("Job array index too large. Job not submitted."));
}

TEST(SchedulerOutput, TimesAreRoundedUpToSeconds) {
  EXPECT_EQ(clock_text(std::chrono::minutes(150)), "02:30:00");
  EXPECT_EQ(clock_text(std::chrono::milliseconds(1001)), "00:00:02");
  EXPECT_EQ(clock_text(std::chrono::hours(100)), "100:00:00");
}

}  // namespace
