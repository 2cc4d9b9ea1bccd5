// SPDX-License-Identifier: Apache-2.0
#include "command_list.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <string>

#include "command.h"
#include "trocar/base/assert.h"

namespace trocar::cli {
namespace {

constexpr const char* kSimulator = "trocar";
constexpr const char* kTraining = "trocar-training";
constexpr const char* kAnatomy = "trocar-anatomy";
constexpr const char* kResearch = "trocar-research";

// in the order of the help
constexpr auto kListed = std::to_array<ListedCommand>(
    {{"window", kSimulator, "Open the simulator: two instruments, mouse and keyboard"},
     {"demo", kSimulator, "Play a scene's script into pictures, a video, metrics and a report"},
     {"play", kTraining, "Let a scripted surgeon do a task, and judge it"},
     {"pictures", kSimulator, "Draw twenty-three pictures of the operation and of the training tasks"},
     {"simulate", kSimulator, "Run a scene's script without pictures; print hash and times"},
     {"replay", kSimulator,
      "Play a recording again: verify it to the bit, draw it, or go on from any moment of it"},
     {"coach", kSimulator, "Say what cost most in a recorded attempt, where to look, and what to practise"},
     {"dataset", kResearch,
      "Make a labelled data set from scripted or recorded attempts, in a layout that loaders read"},
     {"study", kResearch,
      "Run a plan of parameters, patients, surgeons and seeds, here or on a cluster; without a plan, find "
      "out which metrics separate scripted novices from experts"},
     {"metrics", kSimulator, "Measure a recorded attempt: motion, force, view, clips, errors"},
     {"report", kTraining, "Write what a recorded attempt came to, for people or for other programs"},
     {"rating", kTraining,
      "What people think of an attempt: GOALS and OSATS forms, and how well raters agree"},
     {"xapi", kTraining, "Tell a learning record store about attempts (xAPI 1.0.3)"},
     {"record", kSimulator, "Look at a recording, check it, repair it, or make seeking in it quick"},
     {"course", kTraining, "Courses: steps with goals, thresholds, and words before and after"},
     {"levels", kTraining, "Thresholds of proficiency: those delivered, and a site's own"},
     {"exam", kTraining, "Exams whose settings nobody knows before, and nobody changes after"},
     {"certificate", kTraining, "Signed certificates of exams: make keys, issue, verify offline"},
     {"store", kTraining, "Trainees, groups and attempts: list, compare, back up, export, erase"},
     {"anatomy", kAnatomy, "A patient from cross-sections, or from none"},
     {"devices", kSimulator, "Trackers, jaw sensors and other hands: find, try, calibrate, record"},
     {"bench", kResearch, "Measure how fast this computer is; a wrong result is an error, and gets no time"},
     {"reproduce", kResearch, "Repeat the paper's experiments, its figures beside ours"},
     {"doctor", kSimulator,
      "Check graphics, GPU, display, real-time permission, devices, sound and data; say how to mend them"},
     {"errors", kSimulator, "List every error code and what it means"}});

}  // namespace

std::span<const ListedCommand> ListedCommands() {
  return kListed;
}

const ListedCommand* FindListed(std::string_view name) {
  const auto found = std::find_if(kListed.begin(), kListed.end(),
                                  [&](const ListedCommand& each) { return each.name == name; });
  return found == kListed.end() ? nullptr : &*found;
}

CLI::App* AddListed(CLI::App& app, std::string_view name) {
  const ListedCommand* const listed = FindListed(name);
  TROCAR_ASSERT(listed != nullptr);
  return app.add_subcommand(std::string(name), listed->description);
}

}  // namespace trocar::cli
