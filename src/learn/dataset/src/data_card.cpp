// SPDX-License-Identifier: Apache-2.0
#include "data_card.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "trocar/base/state_hash.h"
#include "trocar/host/json_text.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/sha256.h"
#include "trocar/host/version.h"

namespace trocar::dataset {
namespace {

using nlohmann::ordered_json;

constexpr int kCardVersion = 1;
constexpr const char* kLicence = "Apache-2.0";
/// Of every layout.
constexpr std::array<const char*, 3> kCommonGaps = {
    "Everything is simulated: what was learnt here has to be shown on real pictures before it means anything "
    "there.",
    "Tools do not wear, and lenses do not fog or get dirty.",
    "Colon, stomach, duodenum, omentum and abdominal wall are decoration: they do not deform."};
constexpr const char* kScriptedGap = "The surgeon is a program; people move otherwise.";

/// Options of the command that are not of every plan.
std::string FormatSource(const Plan& plan) {
  if (!plan.recordings.empty()) {
    std::string text;
    for (std::size_t i = 1; i <= plan.recordings.size(); ++i)
      text += " --recording " + std::to_string(i) + ".trocar";
    return text;
  }
  std::string text = " --task " + plan.task + " --surgeon " + plan.surgeon + " --seeds " +
                     std::to_string(plan.first_seed) + ":" + std::to_string(plan.last_seed);
  if (plan.level != Plan{}.level) text += " --level " + plan.level;
  for (const auto& patient : plan.patients) text += " --patient " + patient.filename().string();
  return text;
}

ordered_json DescribePlan(const Plan& plan) {
  ordered_json text = {{"layout", NameOf(plan.layout)}};
  if (plan.recordings.empty()) {
    text["task"] = plan.task;
    text["level"] = plan.level;
    text["surgeon"] = plan.surgeon;
    text["patients"] = ordered_json::array();
    for (const auto& patient : plan.patients) text["patients"].push_back(patient.filename().string());
    text["seeds"] = {plan.first_seed, plan.last_seed};
  } else {
    text["recordings"] = plan.recordings.size();
  }
  text["width"] = plan.width;
  text["height"] = plan.height;
  text["every_seconds"] = plan.every;
  text["most_seconds"] = plan.most_seconds;
  text["has_variation"] = plan.has_variation;
  text["has_pictures"] = plan.has_pictures;
  return text;
}

std::string DescribeSource(const Plan& plan) {
  if (!plan.recordings.empty())
    return "Simulated: " + std::to_string(plan.recordings.size()) +
           " recordings, computed again; their SHA-256 stand in card.json";
  return "Simulated, not recorded: scripted surgeon \"" + plan.surgeon + "\" in \"" + plan.task +
         "\", seeds " + std::to_string(plan.first_seed) + " to " + std::to_string(plan.last_seed);
}

std::string FormatReadme(const Plan& plan, const ordered_json& card) {
  std::string text =
      "# A data set made by Trocar\n\nLayout: " + std::string(NameOf(plan.layout)) +
      ". Licence: " + kLicence + ". Program: trocar " + std::string(host::VersionText()) + ".\n\n" +
      DescribeSource(plan) + ", " +
      (plan.has_pictures ? std::to_string(plan.width) + " x " + std::to_string(plan.height) + " pixels"
                         : std::string("without pictures")) +
      ". The same plan gives the same bytes, with the same program and graphics driver:\n\n    " +
      card["command"].get<std::string>() +
      "\n\nCheck it: trocar dataset verify DIR, or sha256sum -c SHA256SUMS.\n\n"
      "| seed | patient | frames | seconds | came to | state |\n|---|---|---|---|---|---|\n";
  for (const auto& video : card["videos"]) {
    text += "| " + host::FormatJson(video["seed"]) + " | " +
            host::PrintableLine(video["patient"].get<std::string>()) + " | " +
            host::FormatJson(video["frames"]) + " | " + host::FormatJson(video["seconds"]) + " | " +
            video["outcome"].get<std::string>() + " | `" + video["state_hash"].get<std::string>() + "` |\n";
  }
  text += "\n## Known gaps\n\n";
  for (const auto& gap : card["known_gaps"]) text += "- " + gap.get<std::string>() + "\n";
  text += "\nClasses, variation of each video and everything else: card.json.\n";
  return text;
}

std::string FormatCommand(const Plan& plan) {
  ordered_json number = plan.every;
  std::string text = "trocar dataset --layout " + std::string(NameOf(plan.layout)) + FormatSource(plan) +
                     " --size " + std::to_string(plan.width) + "x" + std::to_string(plan.height) +
                     " --every " + host::FormatJson(number) + " --most-seconds ";
  number = plan.most_seconds;
  text += host::FormatJson(number);
  if (!plan.has_variation) text += " --no-variation";
  if (!plan.has_pictures) text += " --no-pictures";
  return text + " -o DIR";
}

}  // namespace

base::Result<CardSummary> WriteCard(const std::filesystem::path& folder, const Plan& plan,
                                    const LayoutSet& layout, std::span<const VideoResult> videos) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).generic_string());
  std::sort(names.begin(), names.end());
  std::string sums;
  for (const std::string& name : names) {
    const auto hash = host::CalcSha256OfFile(folder / name);
    if (!hash) return hash.error();
    sums += *hash + "  " + name + "\n";
  }
  if (auto s = host::WriteFile(folder / "SHA256SUMS", sums); !s) return s.error();
  const auto hash = host::CalcSha256OfFile(folder / "SHA256SUMS");
  if (!hash) return hash.error();

  ordered_json card = {{"format", "trocar-dataset"},
                       {"version", kCardVersion},
                       {"program", "trocar " + std::string(host::VersionText())},
                       {"licence", kLicence},
                       {"command", FormatCommand(plan)},
                       {"plan", DescribePlan(plan)},
                       {"videos", ordered_json::array()},
                       {"classes", layout.Classes()},
                       {"known_gaps", ordered_json::array()},
                       {"files", names.size()},
                       {"sha256sums", *hash}};
  for (const VideoResult& video : videos) {
    ordered_json entry = {{"seed", video.seed},
                          {"patient", video.patient},
                          {"frames", video.frames},
                          {"seconds", video.seconds},
                          {"outcome", video.outcome},
                          {"state_hash", base::HashText(video.hash)},
                          {"variation", ToJson(video.variation)}};
    if (!video.recording.empty()) entry["recording_sha256"] = video.recording;
    card["videos"].push_back(std::move(entry));
  }
  for (const std::string& gap : layout.Gaps()) card["known_gaps"].push_back(gap);
  for (const char* gap : kCommonGaps) card["known_gaps"].push_back(gap);
  if (plan.recordings.empty()) card["known_gaps"].push_back(kScriptedGap);
  if (auto s = host::WriteFile(folder / "README.md", FormatReadme(plan, card)); !s) return s.error();
  if (auto s = host::WriteFile(folder / "card.json", host::FormatJson(card, 2) + "\n"); !s) return s.error();
  return CardSummary{*hash, names.size()};
}

}  // namespace trocar::dataset
