// SPDX-License-Identifier: Apache-2.0
/// \file recorded_attempt.h  Recordings of scripted people, short enough for tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/record/recorder.h"
#include "trocar/scene/task.h"

namespace trocar::centre {

inline constexpr std::uint64_t kUntilOver = 200000;

/// Plays a task and records it: until the task is over, or for so many ticks.
inline void RecordTask(const std::filesystem::path& path, const char* surgeon_name, const char* task,
                       const char* level, std::uint64_t ticks,
                       const std::string& player = "mouse and keyboard") {
  auto scene = scene::ReadTask(*scene::FindTask(task), {level, 3, {}});
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  const auto shared = std::make_shared<const scene::Scene>(std::move(*scene));
  auto simulation = simulation::Simulation::Make(shared, 1);
  auto surgeon = agent::MakeSurgeon(surgeon_name, shared, 3);
  ASSERT_TRUE(simulation.ok() && surgeon.ok());
  record::Description description;
  description.kind = record::Description::Kind::kTask;
  description.name = task, description.level = level, description.seed = 3;
  description.player = player;
  record::RecorderSettings settings;
  settings.waits = true;
  auto recorder = record::Recorder::Start(path, description, *simulation, settings);
  ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
  for (std::uint64_t tick = 0; tick < ticks && !simulation->GetSnapshot().task.IsOver(); ++tick) {
    const auto input = (*surgeon)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
  }
  ASSERT_TRUE((*recorder)->Finish(*simulation).ok());
}

}  // namespace trocar::centre
