// SPDX-License-Identifier: Apache-2.0
/// \file write_a_course.cpp  Reads a course, judges three attempts by it, and says what comes next.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "trocar/assessment/course.h"

namespace {

using namespace trocar;

constexpr const char* kCourse = R"({
  "format": "trocar-course", "version": 1,
  "name": "First evening", "about": "The ring, then the pegs.",
  "steps": [
    {"key": "wire", "name": "The ring along the wire", "goal": "Touch nothing.",
     "briefing": "Turn the wrist first, then go on.", "after_pass": "Now the pegs.", "after_fail": "See where it touched.",
     "task": "wire_run", "level": "easy", "consecutive_passes": 2, "due_days": 1,
     "own_thresholds": [
       {"metric": "rules_broken", "at_most": 0, "purpose": "safety", "source": "our house rule"},
       {"metric": "task_time", "at_most": 60, "purpose": "time", "source": "mean of our residents"}]},
    {"key": "pegs", "name": "Peg transfer", "goal": "All rings there and back.",
     "briefing": "Be exact first.", "after_pass": "Well done.", "after_fail": "Again.",
     "task": "peg_transfer", "prerequisites": ["wire"]}
  ]
})";

/// As trocar course judge would make it of a recording.
assessment::Attempt MakeAttempt(double seconds, double touches) {
  assessment::Attempt attempt;
  attempt.task = "wire_run";
  attempt.level = "easy";
  attempt.result.is_completed = true;
  attempt.result.metrics.values = {{"task_time", "", "", seconds}, {"rules_broken", "", "", touches}};
  return attempt;
}

}  // namespace

int main() {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("trocar-sample-" + std::to_string(::getpid()) + ".json");
  std::ofstream(file) << kCourse;
  const auto course = assessment::ReadCourse(file);
  std::filesystem::remove(file);
  if (!course.ok()) {
    std::fprintf(stderr, "%s\n", course.error().Text().c_str());
    return 1;
  }
  std::vector<assessment::Attempt> attempts;
  for (const auto& [seconds, touches] : {std::pair{50.0, 1.0}, std::pair{55.0, 0.0}, std::pair{48.0, 0.0}}) {
    attempts.push_back(MakeAttempt(seconds, touches));
    const auto verdict = assessment::Judge(course->steps[0].proficiency, attempts.back().result);
    const auto progress = assessment::CalcProgress(*course, attempts);
    std::printf("%.0f s, %.0f touches: %s; next is %s\n", seconds, touches,
                verdict.is_passed ? "passed" : "not passed",
                progress.next ? progress.steps[*progress.next].key.c_str() : "nothing");
  }
}
