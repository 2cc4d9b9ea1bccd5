// SPDX-License-Identifier: Apache-2.0
#include "trocar/study/study.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::study {
namespace {

namespace fs = std::filesystem;

class StudyTest : public testing::Test {
 protected:
  void SetUp() override {
    options_.plan_file = folder_.Path() / "plan.json";
    options_.folder = folder_.Path() / "out";
    options_.workers = 2;
    WritePlan("expert", 0.2);
  }

  void WritePlan(const std::string& surgeon, double seconds) {
    std::ostringstream text;
    text
        << R"({"format": "trocar-study-plan", "version": 1, "name": "n", "task": "peg_transfer", "surgeons": [")"
        << surgeon << R"("], "seeds": [1, 4], "parameters": {"gravity": [5, 9.81]}, "most_seconds": )"
        << seconds << "}";
    ASSERT_TRUE(host::WriteFile(options_.plan_file, text.str()).ok());
  }
  base::Result<StudySummary> Start() {
    const auto plan = ReadPlan(options_.plan_file);
    if (!plan) return plan.error();
    return RunStudy(options_, *plan, nullptr);
  }
  std::vector<std::string> Lines() const {
    std::ifstream file(options_.folder / "runs.csv");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  int CountInDatabase() const {
    sqlite3* database = nullptr;
    int count = -1;
    sqlite3_open((options_.folder / "runs.sqlite").c_str(), &database);
    sqlite3_exec(
        database, "SELECT count(DISTINCT key) FROM runs WHERE seconds > 0",
        [](void* out, int, char** values, char**) {
          *static_cast<int*>(out) = std::atoi(values[0]);
          return 0;
        },
        &count, nullptr);
    sqlite3_close(database);
    return count;
  }

  hid_t Column(hid_t file, const char* name, std::size_t rows) const {
    const hid_t column = H5Dopen2(file, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(column);
    EXPECT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(rows)) << name;
    H5Sclose(space);
    return column;
  }
  /// Of runs.h5.
  std::vector<double> Numbers(const char* name, std::size_t rows) const {
    std::vector<double> numbers(rows);
    const hid_t file = H5Fopen((options_.folder / "runs.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t column = Column(file, name, rows);
    EXPECT_GE(H5Dread(column, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()), 0);
    H5Dclose(column), H5Fclose(file);
    return numbers;
  }
  std::vector<std::string> Texts(const char* name, std::size_t rows) const {
    const hid_t file = H5Fopen((options_.folder / "runs.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t column = Column(file, name, rows), type = H5Dget_type(column);
    const std::size_t width = H5Tget_size(type);
    std::string all(rows * width, '\0');
    EXPECT_GE(H5Dread(column, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0);
    H5Tclose(type), H5Dclose(column), H5Fclose(file);
    std::vector<std::string> texts;
    for (std::size_t row = 0; row < rows; ++row) texts.emplace_back(all.substr(row * width, width).c_str());
    return texts;
  }

  test::TemporaryFolder folder_;
  StudyOptions options_;
};

TEST_F(StudyTest, RunsEachOnceAndCollectsThem) {
  const auto summary = Start();
  ASSERT_TRUE(summary.ok()) << summary.error().Text();
  EXPECT_EQ(summary->done, 8U);
  EXPECT_EQ(summary->failed, 0U);
  EXPECT_EQ(Lines().size(), 9U);
  EXPECT_EQ(CountInDatabase(), 8);
  const auto report = host::ReadFile(options_.folder / "report.html");
  const auto plot = host::ReadFile(options_.folder / "plots/path_left_m-by-gravity.svg");
  ASSERT_TRUE(report.ok() && plot.ok());
  EXPECT_NE(report->find("Path of the left hand [m]"), std::string::npos);
  EXPECT_NE(report->find("<th>gravity</th>"), std::string::npos);
  std::istringstream head(Lines().at(0));
  for (std::string column; std::getline(head, column, ',');)
    EXPECT_EQ(report->find(column.find('_') != std::string::npos ? "<th>" + column : "no such text"),
              std::string::npos)
        << column << " has no words";
  EXPECT_EQ(plot->find("<svg xmlns="), 0U);
  EXPECT_NE(plot->find("class=\"line\""), std::string::npos);
  // again: nothing is played, and the table is the same
  const auto before = Lines();
  const auto stamp = fs::last_write_time(options_.folder / "results");
  ASSERT_TRUE(Start().ok());
  EXPECT_EQ(Lines(), before);
  EXPECT_EQ(fs::last_write_time(options_.folder / "results"), stamp);
}

// The same numbers in HDF5 as in the table of texts.
TEST_F(StudyTest, KeepsItsTableInHdf5) {
  ASSERT_TRUE(Start().ok());
  const auto lines = Lines();
  const std::vector<double> seeds = Numbers("seed", 8), gravity = Numbers("gravity", 8),
                            seconds = Numbers("seconds", 8), paths = Numbers("path_left_m", 8);
  const std::vector<std::string> keys = Texts("key", 8), surgeons = Texts("surgeon", 8);
  std::vector<std::string> columns;
  std::istringstream head(lines.at(0));
  for (std::string column; std::getline(head, column, ',');) columns.push_back(column);
  const auto at = [&](const std::string& column) {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin());
  };
  for (std::size_t row = 0; row < 8; ++row) {
    std::vector<std::string> values;
    std::istringstream line(lines.at(row + 1));
    for (std::string value; std::getline(line, value, ',');) values.push_back(value);
    EXPECT_EQ(keys[row], values.at(at("key")));
    EXPECT_EQ(surgeons[row], "expert");
    EXPECT_EQ(seeds[row], std::stod(values.at(at("seed"))));
    EXPECT_EQ(gravity[row], std::stod(values.at(at("gravity"))));
    EXPECT_EQ(seconds[row], std::stod(values.at(at("seconds"))));
    EXPECT_EQ(paths[row], std::stod(values.at(at("path_left_m"))));
  }
}

TEST_F(StudyTest, DoesNotDependOnTheNumberOfWorkers) {
  ASSERT_TRUE(Start().ok());
  const auto two = Lines();
  fs::remove_all(options_.folder);
  options_.workers = 3;
  ASSERT_TRUE(Start().ok());
  EXPECT_EQ(Lines(), two);
}

TEST_F(StudyTest, KnowsMomentsOfOperationsOnly) {
  const auto plan = ReadPlan(options_.plan_file);
  ASSERT_TRUE(plan.ok());
  StudyPlan wrong = *plan;
  wrong.until = Until::kCriticalView;
  const auto result = PlayRun(wrong, ListRuns(wrong).front());
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, base::ErrorCode::kStudyInvalid);
}

TEST_F(StudyTest, GoesOnWhereItWasStopped) {
  ASSERT_TRUE(Start().ok());
  const auto whole = Lines();
  // as after a kill: one result is missing, one is cut in the middle
  std::vector<fs::path> results;
  for (const auto& entry : fs::recursive_directory_iterator(options_.folder / "results"))
    if (entry.is_regular_file()) results.push_back(entry.path());
  ASSERT_EQ(results.size(), 8U);
  fs::remove(results[0]);
  std::ofstream(results[1]) << "{\"key\":";
  const auto summary = Start();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary->done, 8U);
  EXPECT_EQ(Lines(), whole);
}

TEST_F(StudyTest, IsCompleteAtTheSecondStartThoughRunsAreKilledAtRandom) {
  WritePlan("expert", 1);
  const auto plan = ReadPlan(options_.plan_file);
  ASSERT_TRUE(plan.ok());
  const pid_t study = fork();
  if (study == 0) {
    setpgid(0, 0);
    const auto summary = RunStudy(options_, *plan, nullptr);
    _exit(summary.ok() ? 0 : 1);
  }
  setpgid(study, study);
  // the whole group dies in the middle of its runs
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  kill(-study, SIGKILL);
  waitpid(study, nullptr, 0);
  // the lock is held until the last of its processes is gone
  auto summary = Start();
  for (int i = 0; i < 100 && !summary.ok() && summary.error().code == base::ErrorCode::kFileInUse; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    summary = Start();
  }
  ASSERT_TRUE(summary.ok()) << summary.error().Text();
  EXPECT_EQ(summary->done, 8U);
  EXPECT_EQ(Lines().size(), 9U);
  EXPECT_EQ(CountInDatabase(), 8);
}

std::vector<pid_t> ChildrenOf(pid_t process) {
  const std::string id = std::to_string(process);
  std::ifstream file("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(file), {}};
}
/// Ended, or waiting for whoever took it over to notice.
bool HasEnded(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string id, name, state;
  return !(file >> id >> name >> state) || state == "Z" || state == "X";
}

// issue 47: only the coordinator is killed. Its workers and their runs end with it, and the restart goes on at once.
TEST_F(StudyTest, WorkersEndWithAKilledCoordinator) {
  WritePlan("expert", 5);
  const auto plan = ReadPlan(options_.plan_file);
  ASSERT_TRUE(plan.ok());
  const pid_t study = fork();
  if (study == 0) _exit(RunStudy(options_, *plan, nullptr).ok() ? 0 : 1);
  std::vector<pid_t> started;
  for (int i = 0; i < 2000 && started.size() < 4; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    started.clear();
    for (const pid_t worker : ChildrenOf(study)) {
      started.push_back(worker);
      for (const pid_t run : ChildrenOf(worker)) started.push_back(run);
    }
  }
  ASSERT_GE(started.size(), 4U) << "two workers with a run each";
  kill(study, SIGKILL);
  waitpid(study, nullptr, 0);
  const auto summary = Start();
  ASSERT_TRUE(summary.ok()) << summary.error().Text();
  EXPECT_EQ(summary->done, 8U);
  EXPECT_EQ(CountInDatabase(), 8);
  for (const pid_t process : started) EXPECT_TRUE(HasEnded(process)) << process;
}

TEST_F(StudyTest, NamesARunThatFails) {
  WritePlan("nobody", 0.2);
  options_.attempts = 2;
  const auto summary = Start();
  ASSERT_TRUE(summary.ok()) << summary.error().Text();
  EXPECT_EQ(summary->done, 0U);
  EXPECT_EQ(summary->failed, 8U);
  EXPECT_NE(summary->failures.front().find("E-SCN-003"), std::string::npos) << summary->failures.front();
  EXPECT_NE(summary->failures.front().find("seed=1"), std::string::npos);
  EXPECT_NE(summary->failures.front().find("2 attempts"), std::string::npos);
}

TEST_F(StudyTest, IsNotMixedWithAnotherPlanOrProgram) {
  ASSERT_TRUE(Start().ok());
  WritePlan("novice", 0.2);
  const auto other = Start();
  ASSERT_FALSE(other.ok());
  EXPECT_EQ(other.error().code, base::ErrorCode::kStudyChanged);
  EXPECT_NE(other.error().message.find("another plan"), std::string::npos);
  WritePlan("expert", 0.2);
  std::string head = *host::ReadFile(options_.folder / "study.json");
  const std::size_t at = head.find("program_sha256") + 18;
  head[at] = head[at] == '0' ? '1' : '0';
  ASSERT_TRUE(host::WriteFile(options_.folder / "study.json", head).ok());
  const auto rebuilt = Start();
  ASSERT_FALSE(rebuilt.ok());
  EXPECT_NE(rebuilt.error().message.find("another program"), std::string::npos);
}

TEST_F(StudyTest, SaysThatAClusterIsNotThere) {
  const std::string before = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  for (const Backend backend : {Backend::kSlurm, Backend::kMpi}) {
    options_.backend = backend;
    const auto away = Start();
    ASSERT_FALSE(away.ok());
    EXPECT_EQ(away.error().code, base::ErrorCode::kClusterAway) << away.error().Text();
  }
  setenv("PATH", before.c_str(), 1);
}

TEST(FindWorker, ReadsWordsAndTheEnvironmentOfClusters) {
  const auto two = FindWorker("2/8");
  ASSERT_TRUE(two.ok());
  EXPECT_EQ(two->index, 2);
  EXPECT_EQ(two->count, 8);
  for (const char* wrong : {"8/8", "-1/2", "2", "a/b", "1/2/3", "auto"})
    EXPECT_FALSE(FindWorker(wrong).ok()) << wrong;
  setenv("SLURM_ARRAY_TASK_ID", "5", 1);
  setenv("SLURM_ARRAY_TASK_MIN", "4", 1);
  setenv("SLURM_ARRAY_TASK_COUNT", "3", 1);
  const auto task = FindWorker("auto");
  for (const char* name : {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_COUNT"})
    unsetenv(name);
  ASSERT_TRUE(task.ok());
  EXPECT_EQ(task->index, 1);
  EXPECT_EQ(task->count, 3);
}

}  // namespace
}  // namespace trocar::study
