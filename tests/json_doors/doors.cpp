// SPDX-License-Identifier: Apache-2.0
#include "doors.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "hands/device/src/haply/haply_messages.h"
#include "imaging/anatomy/src/label_names.h"
#include "judge/record/src/chunk.h"
#include "judge/record/src/recording_json.h"
#include "judge/store/src/database.h"
#include "platform/files/src/material_file.h"
#include "platform/files/src/script.h"
#include "program/bench/src/measured_cases.h"
#include "program/study/src/study_folder.h"
#include "trocar/assessment/attempt.h"
#include "trocar/assessment/certificate.h"
#include "trocar/assessment/course.h"
#include "trocar/assessment/exam.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/bench/validity_study.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/cli/run_command.h"
#include "trocar/contours/control_points.h"
#include "trocar/device/device_store.h"
#include "trocar/environment/environment.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/operation_parameters_file.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar/presenter/task_page.h"
#include "trocar/presenter/window_settings.h"
#include "trocar/presenter/window_sound.h"
#include "trocar/record/recording_list.h"
#include "trocar/rehearsal/rehearsal_state.h"
#include "trocar/render/looks.h"
#include "trocar/report/rating.h"
#include "trocar/report/xapi.h"
#include "trocar/scene/operation_level.h"
#include "trocar/scene/operation_parameters.h"
#include "trocar/store/attempts.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/names.h"
#include "trocar/store/people.h"
#include "trocar/store/spool.h"
#include "trocar/study/plan.h"
#include "trocar/training/coach.h"
#include "trocar/training/trace_file.h"
#include "trocar/training/validity.h"
#include "trocar/view/patient_colours.h"

namespace trocar::json_doors {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = TROCAR_SOURCE_DIR;
constexpr const char* kNothing = "nothing was taken";

void Write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(text.data(), static_cast<std::streamsize>(text.size()));
}

template <typename T>
std::string MessageOf(const base::Result<T>& result) {
  return result.ok() ? std::string() : result.error().Text();
}

std::string MessageOf(const std::optional<base::Error>& complaint) {
  return complaint ? complaint->Text() : std::string();
}

/// A reader of a file.
template <typename Read>
std::function<Feed(const fs::path&)> OfFile(Read read) {
  return [read](const fs::path& folder) -> Feed {
    return [read, path = folder / "given.json"](const std::string& text) {
      Write(path, text);
      return MessageOf(read(path));
    };
  };
}

/// A reader of a text.
template <typename Read>
std::function<Feed(const fs::path&)> OfText(Read read) {
  return [read](const fs::path&) -> Feed {
    return [read](const std::string& text) { return MessageOf(read(text)); };
  };
}

/// A reader that has no place for an error: whether it took anything.
template <typename Read>
std::function<Feed(const fs::path&)> OfTaking(Read read) {
  return [read](const fs::path&) -> Feed {
    return [read](const std::string& text) { return read(text) ? std::string() : kNothing; };
  };
}

/// A folder of data as the repository's, but for one file.
class OtherData {
 public:
  OtherData(const fs::path& folder, const fs::path& file) : path_(folder / "data" / file) {
    fs::path ours = folder / "data", theirs = kRoot;
    for (auto step = file.begin(); step != file.end(); ++step) {
      fs::create_directories(ours);
      for (const fs::directory_entry& entry : fs::directory_iterator(theirs)) {
        const fs::path name = entry.path().filename();
        const bool is_data = theirs != kRoot || name == "assets" || name == "scenes";
        if (is_data && name != *step) fs::create_symlink(entry.path(), ours / name);
      }
      ours /= *step, theirs /= *step;
    }
    ::setenv("TROCAR_DATA_DIR", (folder / "data").c_str(), 1);
  }

  void Put(const std::string& text) const { Write(path_, text); }

 private:
  fs::path path_;
};

/// A reader of the data that are delivered, one file of which is another one.
template <typename Read>
std::function<Feed(const fs::path&)> OfData(const char* file, Read read) {
  return [file, read](const fs::path& folder) -> Feed {
    return [read, data = std::make_shared<OtherData>(folder, file)](const std::string& text) {
      data->Put(text);
      return MessageOf(read());
    };
  };
}

record::Description MakeDescription() {
  record::Description d;
  d.kind = record::Description::Kind::kTask;
  d.name = "peg_transfer";
  d.level = "normal";
  d.tick_seconds = 0.01;
  d.player = "somebody";
  d.started = "2026-11-24T22:50:20+00:00";
  return d;
}

/// A recording without a tick whose parts of text are as they are given.
std::string MakeRecording(const std::string& description, const std::string& events,
                          const std::string& ending) {
  constexpr std::uint64_t kFile = 7;
  std::vector<std::byte> bytes = record::MakeFileHeader(kFile);
  std::uint64_t number = 0;
  for (const auto& [kind, text] :
       {std::pair{record::ChunkKind::kDescription, &description},
        std::pair{record::ChunkKind::kEvents, &events}, std::pair{record::ChunkKind::kEnding, &ending}})
    record::PutChunk(kFile, number++, kind, 0, record::BytesOf(*text), bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string WithOutcome(const std::string& outcome) {
  record::Ending ending;
  ending.outcome = outcome;
  return MakeRecording(record::WriteDescription(MakeDescription()), "[]", record::WriteEnding(ending));
}

std::string ReadBytes(const std::string& bytes) {
  const auto recording = record::ReadRecording(std::as_bytes(std::span(bytes)), "given");
  return recording.ok() ? recording->damage : recording.error().Text();
}

/// `trocar record info --json` of a file: what it says of an outcome that it cannot read; an error, too, where it prints
/// what is no JSON or much more than was given.
std::string PrintInfo(const fs::path& path) {
  const fs::path printed = path.parent_path() / "printed.json";
  std::fflush(stdout);
  const int before = ::dup(STDOUT_FILENO), file = ::open(printed.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(file, STDOUT_FILENO);
  std::string words[] = {"trocar", "record", "info", path.string(), "--json"};
  char* argv[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), words[4].data()};
  const int status = cli::RunCommand(5, argv);
  std::fflush(stdout);
  ::dup2(before, STDOUT_FILENO);
  ::close(before), ::close(file);
  if (status != 0) return "exit status " + std::to_string(status);
  if (fs::file_size(printed) > 40 * fs::file_size(path) + 10'000) ::abort();
  const auto text = host::ReadFile(printed);
  auto json = host::ParseJson<nlohmann::json>(*text, "what was printed", host::kLargeJson);
  if (!json.ok()) ::abort();
  return json->value("outcome_unreadable", "");
}

store::Attempt MakeAttempt() {
  store::Attempt attempt;
  attempt.recording_id = "0000000000000007";
  attempt.started = "2026-11-24T22:50:20+00:00";
  attempt.task = "peg_transfer";
  attempt.outcome = "{}";
  return attempt;
}

assessment::Attempt MakeExpertsAttempt() {
  assessment::Attempt attempt;
  attempt.task = "peg_transfer";
  attempt.score = 12;
  attempt.result.metrics.values.push_back({"time", "", "", 12.5, ""});
  return attempt;
}

training::AttemptTrace MakeTrace() {
  training::AttemptTrace trace;
  trace.dt = 0.01;
  trace.tool_names = {"grasper"};
  trace.organ_names = {"liver"};
  for (auto& hand : trace.hands) {
    hand.resize(3);
    for (training::ToolSample& sample : hand) sample.tip = {0.1, 0.2, 0.3}, sample.spin = 1;
  }
  trace.goals = {{"goal", 1.5, 10}};
  return trace;
}

store::Place MakePlace(const fs::path& folder) {
  store::Place place;
  place.url = (folder / "store.sqlite").string();
  place.folder = folder;
  return place;
}

/// An attempt in the store whose outcome gets past every check, as one of an older version did: the export holds it.
Feed OpenExport(const fs::path& folder) {
  auto store = std::make_shared<base::Result<store::Store>>(store::Store::Open(MakePlace(folder)));
  if (!store->ok()) return [](const std::string&) -> std::string { ::abort(); };
  const auto person = store::AddPerson(**store, store::Viewer::Owner(), store::Role::kTrainee);
  store::Attempt attempt = MakeAttempt();
  attempt.trainee = person->pseudonym;
  if (!store::AddAttempt(**store, attempt).ok()) ::abort();
  return [store, trainee = person->pseudonym, out = folder / "out"](const std::string& text) -> std::string {
    if (!(*store)->GetDatabase().Run("UPDATE attempt SET outcome = $1", {text}).ok()) ::abort();
    fs::remove_all(out);
    const auto exported = store::ExportPerson(**store, store::Viewer::Owner(), trainee, out);
    if (!exported.ok()) return exported.error().Text();
    const auto json = host::ReadFile(out / "person.json", std::size_t{1} << 30);
    if (!json.ok() || json->size() > 40 * text.size() + 10'000) ::abort();
    return {};
  };
}

Feed OpenAdding(const fs::path& folder) {
  auto store = std::make_shared<base::Result<store::Store>>(store::Store::Open(MakePlace(folder)));
  return [store, number = std::make_shared<int>(0)](const std::string& text) {
    store::Attempt attempt = MakeAttempt();
    attempt.recording_id = std::to_string(++*number);
    attempt.outcome = text;
    return MessageOf(store::AddAttempt(**store, attempt));
  };
}

Feed OpenImport(const fs::path& folder) {
  auto store = std::make_shared<base::Result<store::Store>>(store::Store::Open(MakePlace(folder)));
  return [store, path = folder / "given.json"](const std::string& text) {
    Write(path, text);
    return MessageOf(store::Import(**store, store::Viewer::Owner(), path));
  };
}

Feed OpenSpool(const fs::path& folder) {
  auto store = std::make_shared<base::Result<store::Store>>(store::Store::Open(MakePlace(folder)));
  return [store, place = MakePlace(folder)](const std::string& text) -> std::string {
    fs::create_directories(place.SpoolFolder());
    Write(place.SpoolFolder() / "given.json", text);
    const auto report = store::Spool(place).Deliver(**store);
    return report.added + report.known > 0 ? std::string() : kNothing;
  };
}

Feed OpenNames(const fs::path& folder) {
  return [path = folder / "names.json"](const std::string& text) {
    Write(path, text);
    ::chmod(path.c_str(), 0600);
    return MessageOf(store::ReadNames(path));
  };
}

Feed OpenQueue(const fs::path& folder) {
  return [folder](const std::string& text) -> std::string {
    Write(folder / "given.json", text);
    report::XapiQueue queue(folder);
    const auto erased = queue.Erase("nobody");
    return queue.List().empty() && erased.statements == 0 ? kNothing : std::string();
  };
}

/// Patients lie in a folder with their meshes.
Feed OpenPatient(const fs::path& folder) {
  const fs::path good = kRoot / "assets/patients/visible-human-male/patient";
  for (const fs::directory_entry& entry : fs::directory_iterator(good)) {
    if (entry.path().filename() != "patient.json")
      fs::create_symlink(entry.path(), folder / entry.path().filename());
  }
  return [folder](const std::string& text) {
    Write(folder / "patient.json", text);
    return MessageOf(files::ReadPatient(folder));
  };
}

Feed OpenStudyFolder(const fs::path& folder) {
  study::Run run;
  run.key = "ab0123456789";
  fs::create_directories(folder / "results/ab");
  fs::create_directories(folder / "failures");
  Write(folder / "plan.json", "{}");
  return [folder, run](const std::string& text) -> std::string {
    const study::StudyFolder study(folder);
    Write(folder / "study.json", text);
    Write(folder / "results/ab/ab0123456789.json", text);
    Write(folder / "failures/ab0123456789.json", text);
    const auto begun = study.Begin(folder / "plan.json");
    (void)study.FindFailure(run);  // notes that are damaged say so
    return begun.ok() || study.FindResult(run) ? std::string() : begun.error().Text();
  };
}

Feed OpenValidityStudy(const fs::path& folder) {
  return [folder](const std::string& text) -> std::string {
    bench::StudyOptions options;
    options.folder = folder;
    options.people = 0;
    fs::remove(folder / "study.json");
    Write(folder / "attempts.jsonl", text);
    const auto before =
        bench::RunStudy(options, {});  // without a task that asks for them, they are read for nothing
    return before.ok() ? kNothing : before.error().Text();
  };
}

base::Status ReadMaterialOf(const fs::path& path) {
  const auto scene = host::JsonDocument::Parse(
      R"({"materials": [{"organ": "liver", "file": ")" + path.filename().string() + "\"}]}", "scene");
  const auto read = files::ReadMaterials(scene->Root(), path.parent_path());
  if (!read.ok()) return read.error();
  return scene->Check();
}

const std::string kPatch = R"({"fluids": {"blood": {"viscosity_pa_s": 0.004}}})";

std::vector<Door> MakeDoors() {
  using std::string;
  return {
      {"outlines",
       {"src/imaging/contours/src/control_points.cpp ParseControlPoints"},
       OfText([](const string& text) {
         return contours::ParseControlPoints(text, "given", contours::Completeness::kDraft);
       }),
       "assets/patients/visible-human-male/control_points.json"},
      {"names of labels",
       {"src/imaging/anatomy/src/label_names.cpp ReadJsonTable"},
       OfFile(anatomy::ReadLabelNames),
       R"({"labels": {"background": 0, "liver": 1, "gallbladder": [1, 2]}, "regions": {}})"},
      {"patient",
       {"src/platform/files/src/patient_file.cpp ReadPatientUnchecked"},
       OpenPatient,
       "assets/patients/visible-human-male/patient/patient.json",
       false,
       20},
      {"attempts of experts",
       {"src/judge/assessment/src/attempt.cpp ReadAttempts"},
       OfFile(assessment::ReadAttempts),
       assessment::FormatAttempts({MakeExpertsAttempt()})},
      {"certificate",
       {"src/judge/assessment/src/certificate.cpp ReadCertificate"},
       OfText([](const string& text) { return assessment::ReadCertificate(text, "given", ""); })},
      {"course",
       {"src/judge/assessment/src/course_file.cpp ReadCourse"},
       OfFile([](const fs::path& path) { return assessment::ReadCourse(path); }),
       "assets/courses/cholecystectomy.json",
       false,
       60},
      {"operation of a course",
       {"src/judge/assessment/src/course_file.cpp ReadOperationOf"},
       OfData("scenes/cholecystectomy.json",
              [] { return assessment::ReadCourse(kRoot / "assets/courses/cholecystectomy.json"); })},
      {"exam", {"src/judge/assessment/src/exam.cpp ReadExam"}, OfFile(assessment::ReadExam)},
      {"published exam",
       {"src/judge/assessment/src/exam.cpp CheckPublished"},
       OfFile([](const fs::path& path) { return assessment::CheckPublished(path, {}); })},
      {"thresholds",
       {"src/judge/assessment/src/proficiency_file.cpp ReadProficiency"},
       OfFile(assessment::ReadProficiency),
       "assets/proficiency/cholecystectomy.json"},
      {"outcome of a recording, judged",
       {"src/judge/record/src/outcome.cpp ReadObject"},
       [](const fs::path& folder) -> Feed {
         return [path = folder / "given.trocar"](const string& text) {
           Write(path, WithOutcome(text));
           return MessageOf(centre::DescribeRecording(path, "somebody", {"course", "step"}));
         };
       },
       R"({"seconds": 12.5, "task": {"phase": "completed", "score": 80.5}, "operation": {"completed": true}})",
       true},
      {"outcome of a recording, printed",
       {"src/program/cli/src/record_command.cpp InfoJson"},
       [](const fs::path& folder) -> Feed {
         return [path = folder / "given.trocar"](const string& text) {
           Write(path, WithOutcome(text));
           return PrintInfo(path);
         };
       },
       R"({"seconds": 12.5, "task": {"phase": "completed", "score": 80.5, "errors": [1, 2]}})",
       true},
      {"outcome of a recording, in a list",
       {"src/judge/record/src/recording_list.cpp DescribeOutcome"},
       OfTaking([](const string& text) { return !record::DescribeOutcome(text).empty(); }),
       R"({"seconds": 12.5, "task": {"phase": "completed", "score": 80.5}, "operation": {"completed": true}})"},
      {"description of a recording",
       {"src/judge/record/src/recording_json.cpp Parse"},
       [](const fs::path&) -> Feed {
         return
             [](const string& text) { return ReadBytes(MakeRecording(text, "[]", record::WriteEnding({}))); };
       },
       record::WriteDescription(MakeDescription())},
      {"events of a recording",
       {"src/judge/record/src/recording_json.cpp Parse"},
       [](const fs::path&) -> Feed {
         return [](const string& text) {
           return ReadBytes(
               MakeRecording(record::WriteDescription(MakeDescription()), text, record::WriteEnding({})));
         };
       },
       R"([{"tick": 1, "kind": "grasped", "about": "", "hand": 1, "error": true}])"},
      {"ending of a recording",
       {"src/judge/record/src/recording_json.cpp Parse"},
       [](const fs::path&) -> Feed {
         return [](const string& text) {
           return ReadBytes(MakeRecording(record::WriteDescription(MakeDescription()), "[]", text));
         };
       },
       record::WriteEnding({})},
      {"poses of a haptic service",
       {"src/hands/device/src/haply/haply_messages.cpp Parse"},
       OfTaking([](const string& text) {
         device::haply::State state;
         return device::haply::ParseState(text, state) && !state.devices.empty();
       }),
       R"({"inverse3": [{"device_id": "a", "state": {"cursor_position": {"x": 0, "y": 0, "z": 0}}}],
           "wireless_verse_grip": [{"state": {"orientation": {"w": 1, "x": 0, "y": 0, "z": 0}, "buttons": {"a": true}}}]})"},
      {"forces for a haptic service",
       {"src/hands/device/src/haply/haply_messages.cpp Parse"},
       OfTaking([](const string& text) {
         std::vector<string> ids;
         std::array<math::Vec3, device::haply::kMaxDevices> forces;
         return device::haply::ParseForces(text, ids, forces) && !ids.empty();
       }),
       R"({"inverse3": [{"device_id": "a", "commands": {"set_cursor_force": {"values": {"x": 0, "y": 0, "z": 0}}}}]})"},
      {"settings of devices",
       {"src/hands/device/src/calibration/device_store.cpp LoadDeviceStore"},
       OfFile([](const fs::path& path) { return device::LoadDeviceStore(path).complaint; })},
      {"demonstration",
       {"src/program/presenter/src/task_page.cpp AddDemonstration"},
       OfData("scenes/demonstration.json",
              [] { return presenter::LoadTaskPage(presenter::TaskSection::kAll, {}); })},
      {"settings of the window",
       {"src/program/presenter/src/window_settings.cpp LoadWindowSettings"},
       OfFile([](const fs::path& path) { return presenter::LoadWindowSettings(path).complaint; })},
      {"settings of the sound",
       {"src/program/presenter/src/window_sound.cpp LoadSoundSettings"},
       OfFile([](const fs::path& path) { return presenter::LoadSoundSettings(path).complaint; })},
      {"rehearsal",
       {"src/program/rehearsal/src/rehearsal_state.cpp LoadRehearsal"},
       OfFile(rehearsal::LoadRehearsal)},
      {"looks",
       {"src/picture/render/src/looks.cpp ReadLooks"},
       OfFile(render::ReadLooks),
       "assets/looks/laparoscope.json"},
      {"colours of a patient",
       {"src/picture/view/src/patient_colours.cpp ReadPatientColours"},
       OfFile(view::ReadPatientColours),
       "assets/looks/patient.json"},
      {"form of a rating",
       {"src/judge/report/src/rating.cpp ReadRatingForm"},
       OfFile(report::ReadRatingForm),
       "assets/rating/osats.json"},
      {"rating", {"src/judge/report/src/rating.cpp ReadRating"}, OfFile(report::ReadRating)},
      {"statements of learning that wait",
       {"src/judge/report/src/xapi.cpp ReadStatement", "src/judge/report/src/xapi.cpp FindAccountName"},
       OpenQueue,
       R"({"id": "given", "actor": {"account": {"name": "nobody"}}})"},
      {"scene of a text",
       {"src/platform/files/src/find_scene.cpp ParseScene"},
       OfText([](const string& text) { return files::ParseScene(text, kRoot / "scenes/given.json"); })},
      {"scene by its name",
       {"src/platform/files/src/find_scene.cpp FindSceneFile"},
       OfData("scenes/cholecystectomy.json", [] { return files::FindSceneFile("cholecystectomy"); })},
      {"scene of a file",
       {"src/platform/files/src/operation_level_file.cpp ParsePatched"},
       OfFile([](const fs::path& path) { return files::ReadScene(path); })},
      {"operation of a file",
       {"src/platform/files/src/scene_file.cpp FindOperation"},
       OfFile([](const fs::path& path) -> base::Status {
         const auto found = files::FindOperation(path.string(), {}, 1, "normal");
         if (!found.ok()) return found.error();
         return *found ? base::Status() : base::Error{base::ErrorCode::kUnknownName, kNothing};
       })},
      {"material",
       {"src/platform/files/src/material_file.cpp ReadMaterialFile"},
       OfFile(ReadMaterialOf),
       "assets/materials/liver.json"},
      {"levels of operations",
       {"src/platform/files/src/operation_level_file.cpp ReadOperationLevels"},
       OfFile(files::ReadOperationLevels),
       "assets/operation/levels.json"},
      {"parameters of operations",
       {"src/platform/files/src/operation_level_file.cpp ParsePatched"},
       OfFile([](const fs::path& path) { return files::ReadOperationParameters(path, "{}"); }),
       "assets/operation/parameters.json"},
      {"what a level changes",
       {"src/platform/files/src/operation_level_file.cpp ParsePatched"},
       OfText([](const string& text) {
         return files::ReadOperationParameters(kRoot / "assets/operation/parameters.json",
                                               text.empty() ? " " : text);
       }),
       kPatch},
      {"script",
       {"src/platform/files/src/script.cpp ReadScript"},
       OfFile([](const fs::path& path) -> base::Status {
         const auto patient = files::ReadPatient(kRoot / "assets/patients/visible-human-male/patient");
         if (!patient.ok()) return patient.error();
         const auto script = files::ReadScript(path, *patient);
         return script.ok() ? base::Status() : script.error();
       }),
       "scenes/demonstration.script.json"},
      {"task",
       {"src/platform/files/src/task_file.cpp TaskForm::Parse",
        "src/platform/files/src/task_file.cpp TaskForm::MakeScene"},
       OfFile([](const fs::path& path) { return files::ReadTask(path); }),
       "scenes/tasks/peg_transfer.json",
       false,
       60},
      {"task of an environment",
       {"src/learn/environment/src/environment_model.cpp IsTask"},
       OfText([](const string& text) {
         environment::EnvironmentSettings settings;
         settings.task = (kRoot / "scenes/tasks/given.json").string();
         settings.document = text.empty() ? " " : text;  // none would be the file's
         return environment::EnvironmentModel::Make(settings);
       }),
       "scenes/tasks/peg_transfer.json",
       false,
       60},
      {"what another build measured",
       {"src/program/bench/src/measured_cases.cpp ReadMeasuredCases"},
       OfText([](const string& text) { return bench::ReadMeasuredCases(text, "given"); }),
       R"({"cases": [{"name": "operation/ticks_per_s", "value": 210.5, "unit": "1/s"}]})"},
      {"list of tasks",
       {"src/platform/files/src/task_file.cpp ListTasks"},
       OfData("scenes/tasks/given.json", [] { return files::ListTasks(); }),
       "scenes/tasks/peg_transfer.json",
       false,
       60},
      {"outcome for the store",
       {"src/judge/store/src/attempts.cpp CheckOutcome"},
       OpenAdding,
       "{\"task\": {\"phase\": \"x\"}}",
       true},
      {"outcome in the store",
       {"src/judge/store/src/privacy.cpp DescribeOne"},
       OpenExport,
       "{\"task\": {\"phase\": \"x\"}}",
       true},
      {"names of people",
       {"src/judge/store/src/names.cpp ReadNames"},
       OpenNames,
       R"({"format": "trocar-names", "version": 1, "names": {"T-1": "Ada"}})"},
      {"spool",
       {"src/judge/store/src/spool.cpp ReadAttemptJson"},
       OpenSpool,
       store::WriteAttemptJson(MakeAttempt())},
      {"export of a store",
       {"src/judge/store/src/transfer.cpp Import"},
       OpenImport,
       R"({"format": "trocar-store", "version": 1, "tables": {"person": [{"id": 1, "pseudonym": "T-1", "role": "trainee", "added_ms": 0}]}})"},
      {"plan of a study",
       {"src/program/study/src/plan.cpp ReadPlan"},
       OfFile(study::ReadPlan),
       "samples/studies/stiffness.json"},
      {"folder of a study",
       {"src/program/study/src/study_folder.cpp StudyFolder::Begin",
        "src/program/study/src/study_folder.cpp StudyFolder::FindResult",
        "src/program/study/src/study_folder.cpp StudyFolder::FindFailure"},
       OpenStudyFolder,
       R"({"key": "ab0123456789", "outcome": "completed", "state_hash": "0", "numbers": {"a": 1},
                            "plan_sha256": "0", "why": "none"})",
       false,
       20,
       std::size_t{256} << 20,
       false,
       10},
      {"rules of the coach",
       {"src/judge/training/src/coach.cpp ParseCoachRules"},
       OfText([](const string& text) { return training::ParseCoachRules(text, "given"); }),
       "assets/coach/rules.json"},
      {"trace",
       {"src/judge/training/src/trace_file.cpp ParseTraceJson"},
       OfText([](const string& text) { return training::ParseTraceJson(text, "given"); }),
       training::FormatTraceJson(MakeTrace()),
       false,
       150,
       std::size_t{640} << 20},
      {"validity of metrics",
       {"src/judge/training/src/validity.cpp ParseValidity"},
       OfText([](const string& text) { return training::ParseValidity(text, "given"); }),
       "assets/validity.json"},
      {"attempts of a validity study",
       {"src/program/bench/src/validity_study.cpp FromJson"},
       OpenValidityStudy,
       R"({"task": "a", "group": "b", "person": 1, "repeat": 0, "seed": 1, "patient": 0, "phase": "completed",
           "completed": true, "caught": false, "seconds": 1.5, "values": [["m", "left", 0.5]]})",
       false,
       150,
       std::size_t{256} << 20,
       true},
  };
}

}  // namespace

const std::vector<Door>& Doors() {
  static const std::vector<Door> doors = MakeDoors();
  return doors;
}

}  // namespace trocar::json_doors
