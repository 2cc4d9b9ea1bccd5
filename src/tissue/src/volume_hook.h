// SPDX-License-Identifier: Apache-2.0
/// \file volume_hook.h  What a solver calls to keep the volumes.
#pragma once

#include "trocar/tissue/conservation.h"

namespace trocar::tissue {

/// What the hook works on.
struct VolumeHookContext {
  Conservation* conservation;
  ConservationState* state;
};

/// \param context  must outlive the hook
inline SolveHook MakeVolumeHook(VolumeHookContext& context) noexcept {
  using Context = VolumeHookContext;
  SolveHook hook{[](void* self, TissueState& moved, std::span<Vec3> before) noexcept {
                   const Context& kept = *static_cast<Context*>(self);
                   kept.conservation->KeepVolumes(moved, before, *kept.state);
                 },
                 &context, kProjectionInterval};
  hook.constraints = context.conservation->Constraints();
  hook.gradient = context.conservation->VolumeGradient();
  hook.is_active = [](void* self, std::size_t organ) noexcept {
    return Conservation::IsSealed(static_cast<Context*>(self)->state->organs[organ]);
  };
  hook.surface = [](void* self, std::size_t organ) noexcept {
    return std::span(static_cast<Context*>(self)->conservation->Settings().organs[organ].triangles);
  };
  hook.multiplier = [](void* self, std::size_t organ) noexcept {
    return static_cast<Context*>(self)->state->organs[organ].pressure;
  };
  hook.add_multiplier = [](void* self, std::size_t organ, double change) noexcept {
    const Context& kept = *static_cast<Context*>(self);
    kept.conservation->AddPressure(organ, change, *kept.state);
  };
  hook.is_in_reach = [](void* self, const TissueState& moved) noexcept {
    const Context& kept = *static_cast<Context*>(self);
    return kept.conservation->AreVolumesInReach(moved, *kept.state);
  };
  return hook;
}

}  // namespace trocar::tissue
