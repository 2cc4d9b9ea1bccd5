// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/demonstration.h"

#include <array>

#include "action_layout.h"
#include "episode.h"
#include "state_layout.h"
#include "trocar/base/assert.h"

namespace trocar::environment {
namespace {

EnvironmentSettings SettingsOf(const scene::Scene& scene, ActionKind kind) {
  EnvironmentSettings settings;
  settings.actions = kind;
  settings.moves_camera = IsAboutCamera(scene);
  return settings;
}

}  // namespace

struct Demonstration::Content {
  explicit Content(const simulation::Simulation& simulation)
      : ports{simulation.GetScene().instruments[0].p_world_port,
              simulation.GetScene().instruments[1].p_world_port},
        most_seconds(UsualSeconds(simulation.GetScene())),
        state(simulation, std::span(&simulation.GetScene(), 1)),
        joints(simulation.GetScene(), SettingsOf(simulation.GetScene(), ActionKind::kJoints)),
        tip(simulation.GetScene(), SettingsOf(simulation.GetScene(), ActionKind::kTip)) {}

  const ActionLayout& LayoutOf(ActionKind kind) const {
    TROCAR_ASSERT(kind != ActionKind::kDiscrete);
    return kind == ActionKind::kTip ? tip : joints;
  }

  std::array<math::Vec3, instrument::kHandCount> ports;
  double most_seconds;
  StateLayout state;
  ActionLayout joints, tip;
};

Demonstration::Demonstration(const simulation::Simulation& simulation)
    : content_(std::make_unique<Content>(simulation)) {}
Demonstration::Demonstration(Demonstration&&) noexcept = default;
Demonstration& Demonstration::operator=(Demonstration&&) noexcept = default;
Demonstration::~Demonstration() = default;

std::span<const Field> Demonstration::StateFields() const {
  return content_->state.Fields();
}
std::size_t Demonstration::StateSize() const {
  return content_->state.Size();
}
std::span<const Field> Demonstration::ActionFields(ActionKind kind) const {
  return content_->LayoutOf(kind).Fields();
}
std::size_t Demonstration::ActionSize(ActionKind kind) const {
  return content_->LayoutOf(kind).Size();
}

void Demonstration::Observe(const simulation::Simulation& simulation, std::span<float> state) const {
  content_->state.Write(simulation, simulation.GetSnapshot().time / content_->most_seconds, state);
}

void Demonstration::FindAction(ActionKind kind, const scene::Input& before, const scene::Input& after,
                               double seconds, std::span<double> action) const {
  content_->LayoutOf(kind).Write(content_->ports, before, after, seconds, action);
}

}  // namespace trocar::environment
