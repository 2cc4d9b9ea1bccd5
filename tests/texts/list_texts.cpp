// SPDX-License-Identifier: Apache-2.0
// list_texts REPOSITORY: prints, as a template for gettext, the texts that stand in tables of the program (errors, commands with their
// help, options of the command line, settings, home, tutorial, metrics, mistakes, names of anatomy) and in its data (tasks, courses, levels, forms, the coach's
// rules). xgettext finds those that stand in calls.
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/anatomy/patient_parameters.h"
#include "trocar/assessment/course.h"
#include "trocar/assessment/learning.h"
#include "trocar/assessment/milestone.h"
#include "trocar/base/error_codes.h"
#include "trocar/bench/benchmark.h"
#include "trocar/centre/centre_commands.h"
#include "trocar/cli/run_command.h"
#include "trocar/contours/contour_fit.h"
#include "trocar/device/device_spec.h"
#include "trocar/doctor/doctor_checks.h"
#include "trocar/editor/contour_commands.h"
#include "trocar/editor/patient_commands.h"
#include "trocar/editor/series_form.h"
#include "trocar/haptics/fault.h"
#include "trocar/haptics/force_gate.h"
#include "trocar/instrument/tool.h"
#include "trocar/presenter/home.h"
#include "trocar/presenter/key_bindings.h"
#include "trocar/presenter/operation_guide.h"
#include "trocar/presenter/replay_commands.h"
#include "trocar/presenter/settings_form.h"
#include "trocar/presenter/simulator_commands.h"
#include "trocar/presenter/tutorial.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/report/agreement.h"
#include "trocar/scene/event.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/training/metric_definition.h"
#include "trocar/view/picture_series.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::set<std::string> printed;

void Print(std::string_view text) {
  if (text.empty() || !printed.insert(std::string(text)).second) return;
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  std::printf("\nmsgid \"%s\"\nmsgstr \"\"\n", quoted.c_str());
}

/// One that is translated in a context.
void PrintIn(const char* context, std::string_view text) {
  std::printf("\nmsgctxt \"%s\"\nmsgid \"%.*s\"\nmsgstr \"\"\n", context, static_cast<int>(text.size()),
              text.data());
}

/// A key of a file as the window shows it: "cystic duct" of "cystic_duct".
void PrintWords(std::string name) {
  for (char& c : name) {
    if (c == '_' || c == '-') c = ' ';
  }
  Print(name);
}

/// "ring {1}" of "ring_3": names that only count have one text.
void PrintCounted(std::string name) {
  std::string counted;
  for (const char c : name) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) {
      counted += c == '_' ? ' ' : c;
    } else if (!counted.ends_with("{1}")) {
      counted += "{1}";
    }
  }
  Print(counted);
}

template <typename Commands>
void PrintCommands(const Commands& commands) {
  for (const auto& command : commands) {
    for (const char* text : {command.help.group, command.help.gesture, command.help.meaning,
                             command.button.label, command.button.tip})
      Print(text);
    for (trocar::gui::KeyStroke stroke : command.keys) {
      stroke.control = stroke.shift = false;
      // letters and signs are themselves in every language
      if (stroke.key != 0 && KeyText(stroke).size() > 3) Print(KeyText(stroke));
    }
  }
}

json ReadJson(const fs::path& path) {
  std::ifstream file(path);
  json document = json::parse(file, nullptr, false);
  if (document.is_discarded()) {
    std::fprintf(stderr, "%s cannot be read\n", path.c_str());
    std::exit(1);
  }
  return document;
}

void PrintField(const json& object, const char* key) {
  if (object.is_object() && object.contains(key) && object[key].is_string())
    Print(object[key].get<std::string>());
}

void PrintFields(const json& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) PrintField(object, key);
}

std::vector<fs::path> ListJson(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.insert(entry.path());
  }
  return {files.begin(), files.end()};
}

void PrintTasks(const fs::path& scenes) {
  for (const fs::path& file : ListJson(scenes / "tasks")) {
    const json task = ReadJson(file);
    PrintWords(file.stem().string());
    PrintFields(task, {"name", "about"});
    for (const json& level : task.value("levels", json::array()))
      Print(level.is_string() ? level.get<std::string>() : level.value("key", ""));
    const json rules = task.value("rules", json::object());
    for (const json& goal : rules.value("goals", json::array())) PrintField(goal, "name");
    for (const json& error : rules.value("errors", json::array())) PrintField(error, "about");
    for (const json& object : task["scene"].value("objects", json::array()))
      PrintCounted(object.value("name", ""));
  }
  PrintField(ReadJson(scenes / "cholecystectomy.json"), "name");
  PrintFields(ReadJson(scenes / "demonstration.json"), {"name", "about"});
}

void PrintAssets(const fs::path& assets) {
  for (const fs::path& file : ListJson(assets / "courses")) {
    const json course = ReadJson(file);
    PrintFields(course, {"name", "about"});
    for (const json& step : course["steps"]) {
      PrintWords(step.value("key", ""));
      PrintFields(step, {"name", "goal", "briefing", "after_pass", "after_fail"});
    }
  }
  // held: of what a temporary lends, a loop over it reads after its end
  const json levels = ReadJson(assets / "operation" / "levels.json"),
             rules = ReadJson(assets / "coach" / "rules.json");
  for (const json& level : levels["levels"]) PrintFields(level, {"key", "about"});
  for (const json& rule : rules["rules"])
    PrintFields(rule, {"sentence", "sentence_alone", "why", "practise"});
  for (const fs::path& file : ListJson(assets / "rating")) {
    const json form = ReadJson(file);
    PrintFields(form, {"name", "about"});
    for (const json& item : form["items"]) PrintFields(item, {"name", "1", "3", "5"});
  }
  for (const auto& folder : fs::directory_iterator(assets / "patients")) {
    const json patient = ReadJson(folder.path() / "patient" / "patient.json");
    for (const char* list : {"organs", "tubes", "landmarks"}) {
      for (const json& one : patient[list]) {
        PrintWords(one.value("name", ""));
        for (const json& region : one.value("regions", json::array())) PrintWords(region.value("name", ""));
      }
    }
  }
}

void PrintMedicine() {
  using namespace trocar;
  for (const training::MetricDefinition& metric : training::MetricDefinitions()) {
    Print(metric.name);
    Print(metric.about);
  }
  Print(training::MetricsDisclaimer());
  for (const scene::Procedure* procedure : procedures::ListProcedures()) {
    for (const surgery::ErrorRow& error : procedure->errors) {
      Print(error.explanation);
      PrintWords(std::string(error.name));
    }
    for (const scene::PhaseRow& phase : procedure->phases) Print(phase.about);
    for (const scene::PartRow& part : procedure->parts.subspan(1)) Print(part.until);
  }
  for (const surgery::Severity severity :
       {surgery::Severity::kMinor, surgery::Severity::kMajor, surgery::Severity::kCritical})
    Print(surgery::NameOf(severity));
  for (const instrument::Tool& tool : instrument::AllTools()) PrintWords(tool.name);
  for (int kind = 0; kind <= static_cast<int>(surgery::FactKind::kVerdict); ++kind)
    PrintWords(std::string(surgery::FactName(static_cast<surgery::FactKind>(kind))));
  for (int stage = 0; stage < static_cast<int>(simulation::Stage::kCount); ++stage)
    PrintWords(std::string(simulation::StageName(static_cast<simulation::Stage>(stage))));
  // what a generated patient may have; ducts and regions beyond those of the built-in one
  for (const char* name :
       {"double_cystic_artery", "moynihan_hump", "subvesical_duct", "phrygian_cap", "hydrops",
        "acute_cholecystitis", "scleroatrophy", "steatosis", "cirrhosis", "adhesions", "right_hepatic_duct",
        "left_hepatic_duct", "proper_hepatic_artery", "left_hepatic_artery", "cystic_artery_2",
        "common_hepatic_artery", "gallbladder bed"})
    PrintWords(name);
}

/// What commands print of tables.
void PrintTablesOfCommands() {
  using namespace trocar;
  for (const agent::SurgeonEntry& entry : agent::ListSurgeons()) Print(entry.about);
  for (const anatomy::ParameterRule& rule : anatomy::ParameterRules()) {
    Print(rule.about);
  }
  for (const bench::BenchmarkSuite& suite : bench::BenchmarkSuites()) Print(suite.description);
  for (const device::DeviceKind& kind : device::DeviceKinds()) {
    Print(kind.text);
    if (kind.address.find(' ') != std::string_view::npos) Print(kind.address);
  }
  for (const view::SeriesSitting& sitting : view::ListPictureSeries()) {
    for (const view::SeriesShot& shot : sitting.shots) Print(shot.about);
  }
  for (const doctor::Health health :
       {doctor::Health::kGood, doctor::Health::kLimited, doctor::Health::kMissing})
    PrintIn("health", doctor::HealthName(health));
  for (const assessment::StepState state :
       {assessment::StepState::kLocked, assessment::StepState::kOpen, assessment::StepState::kDone})
    PrintIn("step", NameOf(state));
  for (const double icc : {0.4, 0.6, 0.8, 0.95}) Print(report::DescribeAgreement(icc));
  for (const training::BetterWhen better : {training::BetterWhen::kHigher, training::BetterWhen::kLower})
    Print(NameOf(better));
  for (std::size_t i = 0; i < training::kEvidenceCount; ++i)
    Print(NameOf(static_cast<training::Evidence>(i)));
  for (const char* text : {"yes",
                           "no",
                           "NO",
                           "unlimited",
                           "not a number",
                           "trainee",
                           "instructor",
                           "administrator",
                           "time_over",
                           "laparoscope",
                           "safety",
                           "economy",
                           "quality",
                           "divided",
                           "free",
                           "names",
                           "file",
                           "script",
                           "; tissue is computed on the processor",
                           "{1}, taking over from {2}"})
    Print(text);
}

/// The help of all commands. Placeholders of one letter stay.
void PrintHelpOfCommands() {
  trocar::cli::ListHelpTexts([](const std::string& text) {
    bool has_word = false;
    for (std::size_t i = 1; i < text.size() && !has_word; ++i)
      has_word = std::isalpha(static_cast<unsigned char>(text[i - 1])) != 0 &&
                 std::isalpha(static_cast<unsigned char>(text[i])) != 0;
    if (has_word) Print(text);
    return text;
  });
  // CLI11's complaints about a command line, and how the command completes them
  for (const char* complaint :
       {"{1}; see {2} --help", "there is no subcommand \"{1}\"", "{1} is required", "A subcommand",
        "The following argument was not expected: {1}", "The following arguments were not expected: {1}",
        "Could not convert: {1} = {2}", "{1}: Value {2} not in range {3} to {4}", "{1}: {2} not in {3}",
        "{1}: {2} required {3} missing", "{1}: At least {2} required but received {3}",
        "{1}: At Most {2} required but received {3}", "Expected exactly {1} arguments to {2}, got {3}",
        "{1} requires {2}", "{1} excludes {2}"})
    Print(complaint);
}

}  // namespace

int main(int count, char** arguments) {
  using namespace trocar;
  if (count != 2) return 2;
  const fs::path repository = arguments[1];
  std::puts("msgid \"\"\nmsgstr \"\"\n\"Content-Type: text/plain; charset=UTF-8\\n\"");
  for (const base::ErrorEntry& entry : base::ErrorTable()) Print(entry.meaning);
  PrintCommands(presenter::SimulatorCommands());
  for (const presenter::SimulatorCommand& command : presenter::SimulatorCommands()) {
    if (presenter::KeyBindings::CanChange(command) && *command.help.meaning == '\0') PrintWords(command.id);
  }
  for (const presenter::MouseButton button :
       {presenter::MouseButton::kLeft, presenter::MouseButton::kMiddle, presenter::MouseButton::kRight})
    PrintIn("mouse button", presenter::NameOf(button));
  PrintCommands(presenter::ReplayCommands());
  PrintCommands(centre::CentreCommands());
  PrintCommands(editor::ContourCommands());
  PrintCommands(editor::PatientCommands());
  // what a button says in its other state
  Print("Pause");
  for (const presenter::SettingRow& row : presenter::SettingRows()) {
    for (const char* text : {row.group, row.label, row.tooltip}) Print(text);
  }
  for (const presenter::SolverChoice& choice : presenter::SolverChoices()) Print(choice.label);
  for (const presenter::HomeEntry& entry : presenter::HomeEntries()) {
    Print(entry.title);
    Print(entry.about);
  }
  for (const std::string_view text : presenter::TutorialTexts()) Print(text);
  for (const std::string_view text : presenter::OperationStepTexts()) Print(text);
  for (const char* direction : editor::PatientDirections()) Print(direction);
  // what a long work is doing
  for (const char* what : {"Reading", "Seeking", "Drawing", "reading labels", "looking at the labels",
                           "meshing the neighbours", "placing ports", "assembling the patient", "done"})
    Print(what);
  // who held the hands, what came of it, and who was operated on, as recordings say it
  for (const char* text :
       {"once", "twice", "Generated patient, seed {1}", "Patient from a label map", "mouse and keyboard",
        "mouse and keyboard, {1}", "the demonstration", "exam, {1}", "expert, seed {1}", "novice, seed {1}",
        "completed, score {1}", "completed, critical view, {1} mL of blood", "completed, {1} mL of blood",
        "not completed, critical view, {1} mL of blood", "not completed, {1} mL of blood", "time over",
        "ended", "running", "ready"})
    Print(text);
  // what is undone in the editor of contours
  for (const char* step :
       {"add a point", "follow an edge", "close a hole", "close a contour",
        "drop the points of an open contour", "remove the last point", "move a point", "insert a point",
        "delete a point", "delete a hole", "delete a contour", "make a hole a contour",
        "make a contour a hole", "clear the slice", "add {1}", "rename an organ", "delete {1}",
        "change the edge search", "carry the contours to slice {1}"})
    Print(step);
  // what the expert does who brings the operation to where a part begins
  for (const char* doing : {"reach",
                            "look",
                            "wait",
                            "ease",
                            "draw",
                            "burn",
                            "lift",
                            "turn the neck",
                            "choose a hold",
                            "fundus first",
                            "close the bag",
                            "look from aside",
                            "look past the shaft",
                            "look at the triangle",
                            "look at the bed",
                            "look at the stumps",
                            "look at the hold",
                            "look for what is missing",
                            "count what enters",
                            "assistant: retract",
                            "assistant: release",
                            "the hepatocystic triangle",
                            "the lower third of the bed",
                            "the gallbladder from its bed",
                            "the gallbladder from the fundus on"})
    Print(doing);
  for (const haptics::FaultEntry& fault : haptics::FaultTable()) {
    Print(fault.what);
    Print(fault.remedy);
  }
  for (const haptics::ArmState state : {haptics::ArmState::kRamping, haptics::ArmState::kArmed})
    Print(haptics::ArmStateName(state));
  for (const contours::FitProblem problem :
       {contours::FitProblem::kNoEdge, contours::FitProblem::kTooIrregular,
        contours::FitProblem::kCrossesItself})
    Print(contours::FitProblemText(problem));
  for (const assessment::CusumVerdict verdict :
       {assessment::CusumVerdict::kAcceptable, assessment::CusumVerdict::kUnacceptable,
        assessment::CusumVerdict::kUndecided})
    Print(assessment::VerdictSentence(verdict));
  PrintHelpOfCommands();
  PrintTablesOfCommands();
  PrintMedicine();
  PrintTasks(repository / "scenes");
  PrintAssets(repository / "assets");
}
