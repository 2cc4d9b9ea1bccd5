// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/home.h"

#include <algorithm>

#include "trocar/host/translate.h"
#include "trocar/presenter/tutorial.h"
#include "trocar/scene/scene.h"

namespace trocar::presenter {
namespace {

constexpr HomeEntry kEntries[] = {
    {HomeChoice::kContinue, "Once more", "What you trained last"},
    {HomeChoice::kNextStep, "Next in the course", "The step that comes next"},
    {HomeChoice::kLastResult, "Last result", "What the last attempt came to"},
    {HomeChoice::kTutorial, "Tutorial", "Learn each control by doing it: five minutes"},
    {HomeChoice::kBasicSkills, "Basic skills", "Rings, pegs, threads, clips: each task with its levels"},
    {HomeChoice::kOperation, "The operation and its parts",
     "Cholecystectomy: the whole, the critical view, clip and cut, or the bed; the expert brings you there"},
    {HomeChoice::kPatients, "Patients", "Who is operated on; make a new one, or import one"},
    {HomeChoice::kResults, "Results", "What was measured of you, courses, groups, exams"},
    {HomeChoice::kRecordings, "Recordings", "Watch an attempt again, and take over where you like"},
    {HomeChoice::kKeys, "Keys and buttons", "What each of them does, and how to change it"},
};

/// "peg transfer" of "peg_transfer"
std::string InWords(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  std::replace(key.begin(), key.end(), '-', ' ');
  return key;
}

}  // namespace

std::span<const HomeEntry> HomeEntries() noexcept {
  return kEntries;
}

HomePage MakeHomePage(const WindowSettings& settings, const std::string& who,
                      const std::optional<base::Error>& problem) {
  HomePage page;
  page.who = who;
  page.problem = problem;
  page.last_title = host::Translate("Once more");
  if (!settings.last_task.empty()) {
    page.last = host::Translate(InWords(settings.last_task));
    if (!settings.last_part.empty()) page.last += ", " + host::Translate(InWords(settings.last_part));
    if (settings.last_level != scene::kNormalLevel) page.last += ", " + host::Translate(settings.last_level);
  }
  const int step = settings.tutorial_step;
  page.tutorial = step == 0 ? host::Translate("Start")
                  : step >= kTutorialSteps
                      ? host::Translate("Again")
                      : host::TranslateWith("Go on: {1} of {2}",
                                            {std::to_string(step + 1), std::to_string(kTutorialSteps)});
  page.is_tutorial_suggested = settings.last_task.empty() && step < kTutorialSteps;
  return page;
}

}  // namespace trocar::presenter
