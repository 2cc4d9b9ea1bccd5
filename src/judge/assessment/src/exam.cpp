// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/exam.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <system_error>

#include "exam_json.h"
#include "owner_file.h"
#include "signing.h"
#include "trocar/assessment/preparation.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/json_choice.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/procedures/find_procedure.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using host::JsonView;
using nlohmann::json;

constexpr std::size_t kNonceBytes = 32;
/// Of a seed: so many whole numbers are exact in every JSON reader.
constexpr std::uint64_t kSeedMask = (std::uint64_t{1} << 52) - 1;
constexpr const char* kFormat = "trocar-exam";

std::string CommitmentText(const ExamSettings& settings) {
  return DumpCanonical(ExamJson(settings, ExamPart::kSealed));
}

std::uint64_t ReadSeed(const JsonView& view) {
  const std::string text = view.Text("seed");
  std::uint64_t seed = 0;
  for (const char digit : text)
    seed = digit >= '0' && digit <= '9' ? 10 * seed + static_cast<std::uint64_t>(digit - '0')
                                        : ~std::uint64_t{0};
  if (text.empty() || text.size() > 16 || seed > kSeedMask || std::to_string(seed) != text)
    view.Complain("seed is a whole number below 2^52, as text", ErrorCode::kExamInvalid);
  return seed;
}

std::string ReadDigest(const JsonView& view, const char* key) {
  std::string text = view.Text(key);
  std::array<std::uint8_t, kHashBytes> bytes{};
  if (!ParseHex(text, bytes))
    view.Complain(std::string(key) + " is 64 hexadecimal digits, small letters", ErrorCode::kExamInvalid);
  return text;
}

Threshold ReadPass(const JsonView& view) {
  view.AllowOnly({"metric", "hand", "phase", "better", "value", "purpose", "undefined"});
  Threshold threshold;
  threshold.of = {view.Text("metric"), view.Text("hand"), view.Text("phase")};
  host::OneOf<bool>(view, "hand", {{"", true}, {"left", true}, {"right", true}, {"camera", true}},
                    ErrorCode::kExamInvalid);
  threshold.better = host::OneOf<Better>(
      view, "better", {{"lower", Better::kLower}, {"higher", Better::kHigher}}, ErrorCode::kExamInvalid);
  const auto value = ParseExact(view.Text("value"));
  if (!value)
    view.Complain("value is a number as text, with as many digits as it needs", ErrorCode::kExamInvalid);
  threshold.value = value.value_or(0);
  threshold.purpose = host::OneOf<Purpose>(view, "purpose",
                                           {{NameOf(Purpose::kSafety), Purpose::kSafety},
                                            {NameOf(Purpose::kTime), Purpose::kTime},
                                            {NameOf(Purpose::kEconomy), Purpose::kEconomy},
                                            {NameOf(Purpose::kQuality), Purpose::kQuality}},
                                           ErrorCode::kExamInvalid);
  threshold.passes_undefined =
      host::OneOf<bool>(view, "undefined", {{"fails", false}, {"passes", true}}, ErrorCode::kExamInvalid);
  return threshold;
}

base::Status CheckNames(const ExamSettings& settings) {
  if (settings.task.empty() == settings.operation.empty()) {
    return Error{ErrorCode::kExamInvalid, "an exam is of a task or of an operation; name one of them"};
  }
  if (settings.IsOperation()) {
    auto operation = files::FindOperation(settings.operation, {}, 0);
    if (!operation.ok()) return operation.error();
    if (*operation) return {};
    return Error{ErrorCode::kExamInvalid, "there is no operation \"" + settings.operation +
                                              "\"; delivered is " + std::string(procedures::kUsualProcedure)};
  }
  const auto tasks = files::ListTasks();
  if (!tasks.ok()) return tasks.error();
  const auto task =
      std::find_if(tasks->begin(), tasks->end(), [&](const auto& one) { return one.key == settings.task; });
  if (task == tasks->end()) {
    return Error{ErrorCode::kExamInvalid,
                 "there is no task \"" + settings.task + "\" among those delivered; see trocar play --list"};
  }
  if (std::find(task->levels.begin(), task->levels.end(), settings.level) == task->levels.end()) {
    return Error{ErrorCode::kExamInvalid, "the task \"" + settings.task + "\" has no level \"" +
                                              settings.level + "\"; see trocar play --list"};
  }
  return {};
}

}  // namespace

std::string NowText() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::string DumpCanonical(const json& value) {
  return host::FormatJson(value) + "\n";
}

json ExamJson(const ExamSettings& settings, ExamPart part) {
  json passes = json::array();
  for (const Threshold& threshold : settings.passes) {
    passes.push_back({{"metric", threshold.of.metric},
                      {"hand", threshold.of.hand},
                      {"phase", threshold.of.phase},
                      {"better", threshold.better == Better::kLower ? "lower" : "higher"},
                      {"value", FormatExact(threshold.value)},
                      {"purpose", NameOf(threshold.purpose)},
                      {"undefined", threshold.passes_undefined ? "passes" : "fails"}});
  }
  json value = {{"format", kFormat},        {"version", 1},
                {"name", settings.name},    {"task", settings.task},
                {"level", settings.level},  {"operation", settings.operation},
                {"guidance", false},        {"passes", std::move(passes)},
                {"sealed", settings.sealed}};
  if (part != ExamPart::kPublished) {
    value["seed"] = std::to_string(settings.seed);
    value["nonce"] = settings.nonce;
  }
  if (part != ExamPart::kSealed) value["commitment"] = settings.commitment;
  return value;
}

ExamSettings ReadExamFields(const JsonView& view, ExamPart part) {
  view.AllowOnly({"format", "version", "name", "task", "level", "operation", "guidance", "passes", "sealed",
                  "seed", "nonce", "commitment"});
  if (view.Text("format") != kFormat)
    view.Complain("format must be \"" + std::string(kFormat) + "\"", ErrorCode::kExamInvalid);
  if (view.Integer("version") != 1) view.Complain("version must be 1", ErrorCode::kExamInvalid);
  if (view.BooleanOr("guidance", true))
    view.Complain("guidance must be false: an exam shows none", ErrorCode::kExamInvalid);
  ExamSettings settings;
  settings.name = view.Text("name");
  settings.task = view.Text("task");
  settings.level = view.Text("level");
  settings.operation = view.Text("operation");
  settings.sealed = view.Text("sealed");
  for (const JsonView& pass : view.Array("passes")) settings.passes.push_back(ReadPass(pass));
  if (part == ExamPart::kAll) {
    settings.seed = ReadSeed(view);
    settings.nonce = ReadDigest(view, "nonce");
  }
  settings.commitment = ReadDigest(view, "commitment");
  return settings;
}

std::string CalcCommitment(const ExamSettings& settings) {
  return HashText(CommitmentText(settings));
}

base::Result<ExamSettings> SealExam(ExamSettings settings) {
  if (const auto status = CheckNames(settings); !status.ok()) return status.error();
  if (settings.IsOperation()) settings.level.clear();
  std::array<std::uint8_t, 8> seed{};
  DrawRandom(seed);
  settings.seed = 0;
  for (const std::uint8_t byte : seed) settings.seed = settings.seed << 8 | byte;
  settings.seed &= kSeedMask;
  std::array<std::uint8_t, kNonceBytes> nonce{};
  DrawRandom(nonce);
  settings.nonce = FormatHex(nonce);
  settings.sealed = NowText();
  settings.commitment = CalcCommitment(settings);
  return settings;
}

std::string FormatExam(const ExamSettings& settings) {
  return host::FormatJson(ExamJson(settings, ExamPart::kAll), 2) + "\n";
}

std::string FormatPublishedExam(const ExamSettings& settings) {
  return host::FormatJson(ExamJson(settings, ExamPart::kPublished), 2) + "\n";
}

base::Result<fs::path> WriteExam(const fs::path& path, const ExamSettings& settings) {
  fs::path published = path;
  published.replace_extension(".published.json");
  std::error_code ignored;
  if (fs::exists(published, ignored)) {
    return Error{ErrorCode::kFileUnwritable,
                 published.string() + " is there already, and a seal is not replaced; choose another name"};
  }
  if (const auto status = WriteOwnerFile(path, FormatExam(settings)); !status.ok()) return status.error();
  if (const auto status = host::WriteFile(published, FormatPublishedExam(settings)); !status.ok())
    return status.error();
  return published;
}

base::Result<ExamSettings> ReadExam(const fs::path& path) {
  const auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  ExamSettings settings = ReadExamFields(document->Root(), ExamPart::kAll);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  if (CalcCommitment(settings) != settings.commitment) {
    return Error{ErrorCode::kExamSealBroken,
                 path.string() +
                     ": the settings are not those that were sealed; take the file as "
                     "trocar exam seal wrote it, or seal a new exam"};
  }
  if (const auto status = CheckNames(settings); !status.ok()) return status.error();
  return settings;
}

base::Status CheckPublished(const fs::path& published, const ExamSettings& settings) {
  const auto document = host::JsonDocument::Read(published);
  if (!document.ok()) return document.error();
  const ExamSettings before = ReadExamFields(document->Root(), ExamPart::kPublished);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  if (ExamJson(before, ExamPart::kPublished) == ExamJson(settings, ExamPart::kPublished)) return {};
  return Error{
      ErrorCode::kExamSealBroken,
      published.string() +
          ": another exam was published before; its commitment or settings differ, so this exam does not "
          "count as the announced one"};
}

base::Result<record::Description> DescribeExam(const ExamSettings& settings, const fs::path& cache) {
  record::Description description;
  description.seed = settings.seed;
  if (!settings.IsOperation()) {
    description.kind = record::Description::Kind::kTask;
    description.name = settings.task;
    description.level = settings.level;
    return description;
  }
  description.kind = record::Description::Kind::kOperation;
  description.name = settings.operation;
  PatientChoice patient;
  patient.seed = settings.seed;
  auto folder = PreparePatient(patient, cache);
  if (!folder.ok()) return folder.error();
  description.patient = folder->string();
  return description;
}

}  // namespace trocar::assessment
