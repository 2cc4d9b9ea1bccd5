// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/taking_over.h"

#include <utility>

namespace trocar::agent {

core::Result<std::unique_ptr<Surgeon>> MakeSurgeonTakingOver(std::string_view name, const Scene& scene,
                                                             const Input& now, std::uint64_t seed) {
  if (!scene.patient.organs.empty() || !scene.patient.tubes.empty()) {
    return core::Error{core::ErrorCode::kUsage,
                       "nobody takes over where tissue is worked on; let the surgeon begin with the episode"};
  }
  auto begun = std::make_shared<Scene>(scene);
  for (std::size_t hand = 0; hand < scene::kHandCount; ++hand)
    begun->instruments[hand].home = now.hands[hand];
  begun->laparoscope.home = now.laparoscope;
  return MakeSurgeon(name, std::move(begun), seed);
}

}  // namespace trocar::agent
