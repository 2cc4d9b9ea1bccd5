// SPDX-License-Identifier: Apache-2.0
#include "validity_note.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "trocar/host/data_folder.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/scene/scene.h"
#include "trocar/training/metric_definition.h"

namespace trocar::cli {

namespace {

/// A file of assets/, or the one that was named in its place. \param parse  (text, source)
template <typename Parse>
auto ReadAsset(const std::string& path, const char* name, const Parse& parse) -> decltype(parse("", "")) {
  std::filesystem::path file = path;
  if (path.empty()) {
    const auto data = host::FindDataFolder();
    if (!data.ok()) return data.error();
    file = *data / "assets" / name;
  }
  const auto text = host::ReadFile(file);
  if (!text.ok()) return text.error();
  return parse(*text, file.string());
}

}  // namespace

base::Result<training::Validity> ReadValidity(const std::string& path) {
  return ReadAsset(path, training::kValidityFile, training::ParseValidity);
}

base::Result<training::CoachRules> ReadCoachRules(const std::string& path) {
  return ReadAsset(path, training::kCoachRulesFile, training::ParseCoachRules);
}

std::string TaskKey(const std::string& description_name) {
  return std::filesystem::path(description_name).stem().string();
}

std::string FormatValidityNote(const training::AttemptMetrics& metrics, const std::string& task,
                               const training::TaskValidity* validity) {
  if (validity == nullptr)
    return host::TranslateWith(
               "Which of these numbers tell novices from experts in \"{1}\" has not been studied (trocar "
               "study).",
               {host::PrintableLine(task)}) +
           "\n";
  std::vector<std::string> weak, unknown;
  for (const training::MetricValue& value : metrics.values) {
    if (!value.phase.empty() || !value.tool.empty()) continue;
    const training::MetricDefinition* definition = training::FindMetric(value.metric);
    std::string name = definition != nullptr ? host::Translate(definition->name) : value.metric;
    if (!value.hand.empty()) name += " (" + host::Translate(value.hand) + ")";
    const training::MeasureValidity* found = validity->Find(value.metric, value.hand);
    if (found == nullptr) {
      unknown.push_back(name);
    } else if (!found->separates) {
      weak.push_back(name);
    }
  }
  const auto list = [](const char* heading, const std::vector<std::string>& names) {
    if (names.empty()) return std::string();
    std::string text = host::Translate(heading);
    for (std::size_t i = 0; i < names.size(); ++i) text += (i > 0 ? "; " : " ") + names[i];
    return text + ".\n";
  };
  return list(host::Mark("These do not separate scripted novices and experts in this task:"), weak) +
         list(host::Mark("Not studied in this task:"), unknown);
}

}  // namespace trocar::cli
