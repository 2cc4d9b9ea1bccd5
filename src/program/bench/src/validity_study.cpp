// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/validity_study.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include "trocar/agent/skill.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"
#include "trocar/patient/patient.h"
#include "trocar/record/trace.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach_measures.h"

namespace trocar::bench {
namespace {

using agent::Surgeon;
using agent::SurgeonSkill;
using nlohmann::json;
using scene::Scene;

constexpr double kMostSeconds = 400;  // of one attempt, simulated
constexpr std::uint64_t kPersonStep = 1000003, kRepeatStep = 7919;

/// One kind of people.
struct Group {
  std::string name;
  SurgeonSkill skill;
  std::string error;  ///< of a careless one, which is made by its name
  int repeats = 1;
  bool is_level = false;  ///< done on every patient, too
};

/// What is still to be played.
struct Job {
  std::string task;
  const Group* group = nullptr;
  int person = 0, repeat = 0, patient = 0;
  bool on_patient = false;
  std::uint64_t seed = 0;
};

using Key = std::tuple<std::string, std::string, int, int, int>;
Key KeyOf(const StudyAttempt& attempt) {
  return {attempt.task, attempt.group, attempt.person, attempt.repeat, attempt.patient};
}

base::Result<std::shared_ptr<const Scene>> ReadScene(const StudyOptions& options, const std::string& task,
                                                     std::uint64_t seed,
                                                     const std::filesystem::path& patient = {}) {
  const auto path = files::FindTask(task);
  if (!path.ok()) return path.error();
  auto read = files::ReadTask(*path, {options.level, seed, patient});
  if (!read.ok()) return read.error();
  return std::make_shared<const Scene>(std::move(*read));
}

/// How a task is called in what is written: the name of its file.
std::string NameOfTask(const std::string& task) {
  return task.ends_with(".json") ? std::filesystem::path(task).stem().string() : task;
}

/// The n-th generated patient of a study.
std::filesystem::path PatientFolder(const StudyOptions& options, int patient) {
  return options.folder / "patients" / std::to_string(options.seed + static_cast<std::uint64_t>(patient));
}

/// Generates the patients that are not there yet.
base::Status MakePatients(const StudyOptions& options) {
  for (int patient = 0; patient < options.patients; ++patient) {
    const std::filesystem::path folder = PatientFolder(options, patient);
    std::error_code failure;
    if (std::filesystem::exists(folder, failure)) continue;
    std::filesystem::create_directories(folder.parent_path(), failure);
    const auto made = anatomy::GeneratePatient(options.seed + static_cast<std::uint64_t>(patient));
    if (!made.ok()) return made.error();
    if (auto written = files::WritePatient(folder, *made); !written.ok()) return written;
  }
  return {};
}

std::vector<Group> ListGroups(const StudyOptions& options, const Scene& scene) {
  std::vector<Group> groups;
  for (int level = 0; level < agent::kSkillLevelCount; ++level) {
    const auto one = static_cast<agent::SkillLevel>(level);
    groups.push_back({std::string(agent::NameOf(one)), agent::LevelSkill(one), "", options.repeats, true});
  }
  const SurgeonSkill able = agent::LevelSkill(agent::SkillLevel::kExpert);
  for (int i = 0; options.has_weaknesses && i < agent::kWeaknessCount; ++i) {
    const auto weakness = static_cast<agent::Weakness>(i);
    if (agent::CanShow(weakness, scene))
      groups.push_back({std::string(agent::NameOf(weakness)), agent::PlantWeakness(able, weakness), "", 1});
  }
  for (const agent::SurgeonEntry& entry : agent::ListSurgeons()) {
    if (!options.has_careless || *entry.error == 0 || !entry.suits(scene)) continue;
    groups.push_back({entry.name, {}, entry.error, 1});
  }
  return groups;
}

base::Result<std::unique_ptr<Surgeon>> MakePerson(const StudyOptions& options, const Job& job,
                                                  std::shared_ptr<const Scene> scene) {
  if (!job.group->error.empty()) return agent::MakeSurgeon(job.group->name, std::move(scene), job.seed);
  const std::uint64_t who = options.seed + kPersonStep * static_cast<std::uint64_t>(job.person + 1);
  return agent::MakeSkilledSurgeon(std::move(scene),
                                   agent::SampleSkill(job.group->skill, options.spread, who), job.seed);
}

base::Result<StudyAttempt> PlayAttempt(const StudyOptions& options, const Job& job) {
  const auto scene =
      ReadScene(options, job.task, job.seed,
                job.on_patient ? PatientFolder(options, job.patient) : std::filesystem::path());
  if (!scene.ok()) return scene.error();
  auto person = MakePerson(options, job, *scene);
  if (!person.ok()) return person.error();
  auto simulation = simulation::Simulation::Make(*scene);
  if (!simulation.ok()) return simulation.error();
  record::TraceBuilder trace(*simulation);
  trace.Add(simulation->GetSnapshot());
  while (!(*person)->HasFinished() && simulation->GetSnapshot().time < kMostSeconds) {
    const scene::Input input = (*person)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    trace.Add(simulation->GetSnapshot(), input.controls);
  }
  const simulation::Snapshot& end = simulation->GetSnapshot();
  const training::AttemptTrace made = trace.Calc();
  const auto metrics = training::CalcAttemptMetrics(made);
  if (!metrics.ok()) return metrics.error();
  StudyAttempt attempt{NameOfTask(job.task), job.group->name, job.person, job.repeat, job.seed, job.patient};
  attempt.phase = std::string(scene::PhaseName(end.task.phase));
  attempt.is_completed = end.task.phase == scene::TaskPhase::kCompleted;
  attempt.seconds = end.time;
  const auto& rules = (*scene)->task->errors;
  for (std::size_t e = 0; e < rules.size(); ++e)
    attempt.is_caught = attempt.is_caught || (rules[e].name == job.group->error && end.task.errors[e] > 0);
  // a dawdler is caught by the end of the time
  attempt.is_caught =
      attempt.is_caught || (job.group->error == "time_over" && end.task.phase == scene::TaskPhase::kTimeOver);
  for (const training::MetricValue& value : metrics->values) {
    if (value.phase.empty() && value.tool.empty())
      attempt.values.push_back({value.metric, value.hand, value.value});
  }
  for (const training::CoachMeasure& measure : training::CalcCoachMeasures(made))
    attempt.values.push_back({"coach:" + measure.name, "", measure.value});
  return attempt;
}

json ToJson(const StudyAttempt& attempt) {
  json values = json::array();
  for (const StudyValue& value : attempt.values) values.push_back({value.metric, value.hand, value.value});
  return {{"task", attempt.task},        {"group", attempt.group},
          {"person", attempt.person},    {"repeat", attempt.repeat},
          {"seed", attempt.seed},        {"patient", attempt.patient},
          {"phase", attempt.phase},      {"completed", attempt.is_completed},
          {"caught", attempt.is_caught}, {"seconds", attempt.seconds},
          {"values", std::move(values)}};
}

std::optional<StudyAttempt> FromJson(const std::string& line) {
  const auto parsed = host::ParseJson<json>(line, "attempts.jsonl", host::kSmallJson);
  if (!parsed.ok() || !parsed->is_object() || !parsed->contains("values"))
    return std::nullopt;  // cut where the study was stopped
  const json& read = *parsed;
  try {
    StudyAttempt attempt{read.at("task"),   read.at("group"), read.at("person"),
                         read.at("repeat"), read.at("seed"),  read.value("patient", 0)};
    attempt.phase = read.at("phase");
    attempt.is_completed = read.at("completed");
    attempt.is_caught = read.at("caught");
    attempt.seconds = read.at("seconds");
    for (const json& value : read.at("values"))
      attempt.values.push_back({value.at(0), value.at(1), value.at(2)});
    return attempt;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

/// What must be the same for attempts to be compared.
json DescribeStudy(const StudyOptions& options) {
  return {{"format", "trocar-study"},
          {"version", 1},
          {"program", std::string(host::VersionText())},
          {"level", options.level},
          {"spread", options.spread},
          {"seed", options.seed}};
}

base::Result<std::vector<StudyAttempt>> ReadBefore(const StudyOptions& options) {
  namespace fs = std::filesystem;
  std::error_code failure;
  fs::create_directories(options.folder, failure);
  const fs::path head = options.folder / "study.json", file = options.folder / "attempts.jsonl";
  const std::string mine = host::FormatJson(DescribeStudy(options), 2) + "\n";
  std::vector<StudyAttempt> before;
  if (fs::exists(head, failure)) {
    const auto theirs = host::ReadFile(head);
    if (!theirs.ok()) return theirs.error();
    if (*theirs != mine) {
      return base::Error{base::ErrorCode::kUsage,
                         head.string() +
                             " is of a study with another level, spread, seed or program; choose another "
                             "folder with -o, or give the same options"};
    }
  } else if (const auto written = host::WriteFile(head, mine); !written.ok()) {
    return written.error();
  }
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    if (auto attempt = FromJson(line)) before.push_back(std::move(*attempt));
  }
  return before;
}

/// The groups of each task, and all jobs in their order.
struct Plan {
  std::map<std::string, std::vector<Group>> groups;
  std::map<std::string, int> patients;  // 0 where the task has none
  std::vector<Job> jobs;
};

base::Result<Plan> MakePlan(const StudyOptions& options) {
  Plan plan;
  for (const std::string& task : options.tasks) {
    const auto scene = ReadScene(options, task, options.seed);
    if (!scene.ok()) return scene.error();
    if (!(*scene)->task)
      return base::Error{base::ErrorCode::kUsage,
                         "\"" + task + "\" is no training task; see trocar play --list"};
    if ((*scene)->HasPatient() && options.patients == 0)
      return base::Error{
          base::ErrorCode::kUsage,
          "\"" + task + "\" has a patient; say with --patients on how many generated ones it is done"};
    if (plan.groups.contains(task)) continue;
    plan.groups[task] = ListGroups(options, **scene);
    plan.patients[task] = (*scene)->HasPatient() ? options.patients : 0;
  }
  // person after person, so that a study that is stopped early has some of every group
  for (int person = 0; person < options.people; ++person) {
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(person) +
                                 kRepeatStep * static_cast<std::uint64_t>(repeat);
      for (const auto& [task, groups] : plan.groups) {
        for (const Group& group : groups) {
          if (repeat >= group.repeats) continue;
          const int patients = plan.patients[task];
          // to repeat is asked on one patient, to go to another one of the first attempts
          const int most = repeat == 0 && group.is_level ? std::max(1, patients) : 1;
          for (int patient = 0; patient < most; ++patient)
            plan.jobs.push_back({task, &group, person, repeat, patient, patients > 0, seed});
        }
      }
    }
  }
  return plan;
}

}  // namespace

base::Result<std::size_t> CountStudyAttempts(const StudyOptions& options) {
  const auto plan = MakePlan(options);
  if (!plan.ok()) return plan.error();
  return plan->jobs.size();
}

base::Result<std::vector<StudyAttempt>> RunStudy(
    const StudyOptions& options, const std::function<void(const std::string&, double)>& progress) {
  const auto plan = MakePlan(options);
  if (!plan.ok()) return plan.error();
  if (const auto made = MakePatients(options); !made.ok()) return made.error();
  auto before = ReadBefore(options);
  if (!before.ok()) return before.error();
  std::map<Key, StudyAttempt> done;
  for (StudyAttempt& attempt : *before) done.insert_or_assign(KeyOf(attempt), std::move(attempt));
  std::vector<Job> open;
  for (const Job& job : plan->jobs) {
    if (!done.contains({NameOfTask(job.task), job.group->name, job.person, job.repeat, job.patient}))
      open.push_back(job);
  }
  std::ofstream out(options.folder / "attempts.jsonl", std::ios::app);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stops{false};
  std::mutex mutex;
  std::optional<base::Error> error;
  const host::Stopwatch watch;
  const auto work = [&] {
    for (;;) {
      const std::size_t n = next.fetch_add(1);
      if (n >= open.size() || stops.load()) return;
      if (options.most_seconds > 0 && watch.Seconds() > options.most_seconds) return;
      auto attempt = PlayAttempt(options, open[n]);
      const std::lock_guard lock(mutex);
      if (!attempt.ok()) {
        error = attempt.error();
        stops.store(true);
        return;
      }
      out << host::FormatJson(ToJson(*attempt)) << '\n' << std::flush;
      if (!out) {
        error = base::Error{base::ErrorCode::kFileUnwritable,
                            (options.folder / "attempts.jsonl").string() +
                                ": cannot be written; check the folder, its rights and the space left"};
        stops.store(true);
        return;
      }
      done.insert_or_assign(KeyOf(*attempt), std::move(*attempt));
      if (progress)
        progress(open[n].task + ", " + open[n].group->name + " " + std::to_string(open[n].person + 1),
                 static_cast<double>(plan->jobs.size() - open.size() + n + 1) /
                     static_cast<double>(plan->jobs.size()));
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) return *error;
  std::vector<StudyAttempt> all;
  for (const Job& job : plan->jobs) {
    const auto found =
        done.find({NameOfTask(job.task), job.group->name, job.person, job.repeat, job.patient});
    if (found != done.end()) all.push_back(found->second);
  }
  return all;
}

}  // namespace trocar::bench
