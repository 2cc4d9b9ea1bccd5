// SPDX-License-Identifier: Apache-2.0
/// \file input_sources.h  Programs that move the hands: a scene's script and scripted surgeons.
#pragma once

#include <memory>

#include "trocar/agent/surgeon.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/input_source.h"

namespace trocar::session {

/// The scene's script; it ends with its last key. Without a script the hands stay at home.
class ScriptSource final : public simulation::InputSource {
 public:
  /// \param scene  outlives the source
  explicit ScriptSource(const scene::Scene& scene) : scene_(&scene) {}
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  void Reset() override { is_at_end_ = false; }
  bool IsAtEnd() const override { return is_at_end_; }

 private:
  const scene::Scene* scene_;
  bool is_at_end_ = false;
};

/// A surgeon whom somebody else made and keeps.
class SurgeonSource final : public simulation::InputSource {
 public:
  /// \param surgeon  outlives the source
  explicit SurgeonSource(agent::Surgeon& surgeon) : surgeon_(&surgeon) {}
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  bool IsAtEnd() const override { return surgeon_->HasFinished(); }

 private:
  agent::Surgeon* surgeon_;
};

/// The scripted expert, who takes over from the state that comes first, and after each Reset() anew.
class ExpertSource final : public simulation::InputSource {
 public:
  /// \param scene  outlives the source
  explicit ExpertSource(const scene::Scene& scene) : scene_(&scene) {}
  /// Whether there is an expert for that scene.
  static bool Suits(const scene::Scene& scene);

  /// Where no expert can be made, which the log says once, the hands stay where they are and the source is at its end.
  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  void Reset() override;
  bool IsAtEnd() const override { return has_failed_ || (surgeon_ != nullptr && surgeon_->HasFinished()); }

 private:
  const scene::Scene* scene_;
  std::unique_ptr<agent::Surgeon> surgeon_;  // null before the first tick
  bool has_failed_ = false;
};

}  // namespace trocar::session
