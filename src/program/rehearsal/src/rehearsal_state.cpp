// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_state.h"

#include <array>
#include <nlohmann/json.hpp>
#include <system_error>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"

namespace trocar::rehearsal {
namespace {

constexpr const char* kFormat = "trocar-rehearsal";
constexpr int kVersion = 1;
constexpr std::array<const char*, kRehearsalSteps> kSteps = {"images", "organs", "patient", "ports",
                                                             "operate"};
constexpr std::array<const char*, 3> kSources = {"none", "labels", "contours"};

template <std::size_t n>
std::size_t FindWord(const host::JsonView& root, const char* key, const std::array<const char*, n>& words) {
  const std::string word = root.TextOr(key, words[0]);
  for (std::size_t i = 0; i < n; ++i) {
    if (word == words[i]) return i;
  }
  root.Complain(std::string(key) + " is none of the known words");
  return 0;
}

PortPlan ReadPlan(const host::JsonView& view) {
  view.AllowOnly({"ports", "table"});
  PortPlan plan;
  for (const host::JsonView& one : view.Array("ports")) {
    one.AllowOnly({"use", "position", "reason"});
    patient::Port port;
    const std::string use = one.Text("use");
    bool is_known = false;
    for (std::size_t i = 0; i < patient::kPortUseCount; ++i) {
      if (use != NameOf(static_cast<patient::PortUse>(i))) continue;
      port.use = static_cast<patient::PortUse>(i);
      is_known = true;
    }
    if (!is_known) one.Complain("use is no port's");
    const std::vector<double> p = one.Numbers("position", 3, {-1, 1});
    port.position = {p[0], p[1], p[2]};
    port.reason = one.TextOr("reason", "");
    plan.ports.push_back(std::move(port));
  }
  if (view.Has("table")) {
    const host::JsonView table = view.Object("table");
    table.AllowOnly({"head_up", "right_up", "reason"});
    constexpr host::NumberRange kTilt{-0.53, 0.53};  // kMostTiltDeg, and a little [rad]
    plan.table = patient::Table{table.Number("head_up", kTilt), table.Number("right_up", kTilt),
                                table.TextOr("reason", "")};
  }
  return plan;
}

RehearsalState Read(const host::JsonView& root) {
  root.AllowOnly({"format", "version", "step", "images", "series", "dicom_series", "pattern", "pixel_mm",
                  "slice_mm", "axes", "source", "labels", "liver_label", "gallbladder_label", "built_from",
                  "notes", "plan", "kept"});
  if (root.Text("format") != kFormat) root.Complain("is no file of a rehearsal");
  root.Integer("version", {kVersion, kVersion});
  RehearsalState state;
  state.step = static_cast<RehearsalStep>(FindWord(root, "step", kSteps));
  state.images = root.TextOr("images", "");
  state.series = root.TextOr("series", "");
  state.options.series = root.IntegerOr("dicom_series", 0, {0, 100000});
  state.options.pattern = root.TextOr("pattern", "");
  if (root.Has("pixel_mm")) state.options.pixel_mm = root.Number("pixel_mm", {0.01, 20});
  if (root.Has("slice_mm")) state.options.slice_mm = root.Number("slice_mm", {0.01, 50});
  if (root.Has("axes")) {
    const auto axes = root.Array("axes");
    if (axes.size() == 3) {
      state.options.axes = {axes[0].AsText(), axes[1].AsText(), axes[2].AsText()};
    } else {
      root.Complain("axes are three");
    }
  }
  state.source = static_cast<OrganSource>(FindWord(root, "source", kSources));
  state.labels = root.TextOr("labels", "");
  state.liver = root.IntegerOr("liver_label", 0, {0, 2147483647});
  state.gallbladder = root.IntegerOr("gallbladder_label", 0, {0, 2147483647});
  state.built_from = root.TextOr("built_from", "");
  if (root.Has("notes")) {
    for (const host::JsonView& note : root.Array("notes")) state.notes.push_back(note.AsText());
  }
  if (root.Has("plan")) state.plan = ReadPlan(root.Object("plan"));
  state.kept = root.TextOr("kept", "");
  return state;
}

nlohmann::ordered_json WritePlan(const PortPlan& plan) {
  nlohmann::ordered_json ports = nlohmann::ordered_json::array();
  for (const patient::Port& port : plan.ports) {
    ports.push_back({{"use", NameOf(port.use)},
                     {"position", {port.position.x, port.position.y, port.position.z}},
                     {"reason", port.reason}});
  }
  nlohmann::ordered_json json;
  json["ports"] = std::move(ports);
  if (plan.table) {
    json["table"] = {
        {"head_up", plan.table->head_up}, {"right_up", plan.table->right_up}, {"reason", plan.table->reason}};
  }
  return json;
}

}  // namespace

const char* NameOf(RehearsalStep step) noexcept {
  return kSteps[static_cast<std::size_t>(step)];
}

base::Result<RehearsalState> LoadRehearsal(const std::filesystem::path& file) {
  const auto document = host::JsonDocument::Read(file);
  if (!document && document.error().code == base::ErrorCode::kFileMissing) return RehearsalState{};
  if (!document) return document.error();
  RehearsalState state = Read(document->Root());
  if (const base::Status good = document->Check(); !good) return good.error();
  return state;
}

base::Status SaveRehearsal(const std::filesystem::path& file, const RehearsalState& state) {
  nlohmann::ordered_json json = {{"format", kFormat},
                                 {"version", kVersion},
                                 {"step", NameOf(state.step)},
                                 {"source", kSources[static_cast<std::size_t>(state.source)]}};
  const auto add = [&json](const char* key, const std::string& text) {
    if (!text.empty()) json[key] = text;
  };
  add("images", state.images.string());
  add("series", state.series.string());
  add("pattern", state.options.pattern);
  add("labels", state.labels.string());
  add("built_from", state.built_from);
  add("kept", state.kept.string());
  if (state.options.series != 0) json["dicom_series"] = state.options.series;
  if (state.options.pixel_mm) json["pixel_mm"] = *state.options.pixel_mm;
  if (state.options.slice_mm) json["slice_mm"] = *state.options.slice_mm;
  if (state.options.axes) json["axes"] = *state.options.axes;
  if (state.liver != 0) json["liver_label"] = state.liver;
  if (state.gallbladder != 0) json["gallbladder_label"] = state.gallbladder;
  if (!state.notes.empty()) json["notes"] = state.notes;
  if (state.plan) json["plan"] = WritePlan(*state.plan);
  // paths of images often name a person: nobody else may look into the folder, from before it is written
  namespace fs = std::filesystem;
  std::error_code failure;
  fs::create_directories(file.parent_path(), failure);
  if (!failure) fs::permissions(file.parent_path(), fs::perms::owner_all, failure);
  if (failure) {
    return base::Error{
        base::ErrorCode::kFileUnwritable,
        file.parent_path().string() + ": " + failure.message() + "; check the folder and its rights"};
  }
  auto written = host::WriteFile(file, host::FormatJson(json, 2) + "\n");
  if (written) fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write, failure);
  return written;
}

}  // namespace trocar::rehearsal
