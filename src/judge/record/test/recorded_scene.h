// SPDX-License-Identifier: Apache-2.0
/// \file recorded_scene.h  A small scene in a folder of the test's own, and recordings of it.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "small_scene.h"
#include "trocar/host/threads.h"
#include "trocar/record/recorder.h"
#include "wandering_input.h"

namespace trocar::record {

class RecordedScene : public scene::SmallScene {
 protected:
  void SetUp() override {
    SmallScene::SetUp();
    auto read = Read();
    ASSERT_TRUE(read.ok()) << read.error().Text();
    scene_ = std::make_shared<const scene::Scene>(std::move(*read));
  }
  simulation::Simulation Make(int threads = 1) {
    auto made = simulation::Simulation::Make(scene_, {.threads = host::UseThreads(threads)});
    EXPECT_TRUE(made.ok()) << made.error().Text();
    return std::move(*made);
  }
  Description Describe() const {
    Description description;
    description.name = (folder_ / "scene.json").string();
    description.seed = scene_->seed;
    description.player = "a test";
    return description;
  }
  scene::Input InputOf(std::uint64_t tick) const {
    return MakeWanderingInput(scene::CalcScriptInput(*scene_, 0), tick);
  }
  static RecorderSettings Settings() {
    RecorderSettings settings;
    settings.keyframe_seconds = 0.5;
    settings.hash_seconds = 0.25;
    settings.waits = true;
    return settings;
  }
  std::filesystem::path File() const { return folder_ / "attempt.trocar"; }
  /// Plays and records; ends it as a whole.
  void Record(std::uint64_t ticks, RecorderSettings settings = Settings()) {
    auto simulation = Make();
    auto recorder = Recorder::Start(File(), Describe(), simulation, std::move(settings));
    ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      const scene::Input input = InputOf(tick);
      simulation.Step(input);
      (*recorder)->Add(input, simulation);
    }
    (*recorder)->Mark("the end");
    const base::Status finished = (*recorder)->Finish(simulation);
    ASSERT_TRUE(finished.ok()) << finished.error().Text();
    hash_ = simulation.Hash();
  }

  std::shared_ptr<const scene::Scene> scene_;
  std::uint64_t hash_ = 0;  // at the end of Record
};

}  // namespace trocar::record
