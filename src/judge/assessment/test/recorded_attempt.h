// SPDX-License-Identifier: Apache-2.0
/// \file recorded_attempt.h  Recordings of scripted surgeons, short enough for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/record/recorder.h"

namespace trocar::test {

inline constexpr std::uint64_t kUntilOver = 200000;  // ticks: longer than any task lasts

struct RecordedAttempt {
  std::string surgeon = "expert";
  std::uint64_t surgeon_seed = 1;
  std::uint64_t ticks = kUntilOver;  // at most; it ends with the task
  std::function<void(std::uint64_t tick, record::Recorder&)> after_tick{};
  /// Whoever looks on while it is played: before the first tick, and after each.
  std::function<void(const simulation::Simulation&)> before_first{};
  std::function<void(const simulation::Snapshot&, const scene::Input&)> see{};
};

/// Makes the scene that the description names, lets the surgeon play it, and records that.
inline void RecordAttempt(const std::filesystem::path& path, const record::Description& description,
                          const RecordedAttempt& attempt) {
  auto made = record::MakeScene(description);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*made));
  auto simulation = simulation::Simulation::Make(scene);
  auto surgeon = agent::MakeSurgeon(attempt.surgeon, scene, attempt.surgeon_seed);
  ASSERT_TRUE(simulation.ok() && surgeon.ok());
  record::RecorderSettings settings;
  settings.waits = true;
  auto recorder = record::Recorder::Start(path, description, *simulation, settings);
  ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
  if (attempt.before_first) attempt.before_first(*simulation);
  for (std::uint64_t tick = 0; tick < attempt.ticks && !simulation->GetSnapshot().task.IsOver(); ++tick) {
    const auto input = (*surgeon)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
    if (attempt.see) attempt.see(simulation->GetSnapshot(), input);
    if (attempt.after_tick) attempt.after_tick(tick, **recorder);
  }
  ASSERT_TRUE((*recorder)->Finish(*simulation).ok());
}

inline record::Description DescribeTask(const char* task, const char* level, std::uint64_t seed,
                                        const std::string& player = "mouse and keyboard") {
  record::Description description;
  description.kind = record::Description::Kind::kTask;
  description.name = task, description.level = level, description.seed = seed;
  description.player = player;
  return description;
}

}  // namespace trocar::test
