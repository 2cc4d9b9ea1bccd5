// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/taking_over.h"

#include <utility>

namespace trocar::agent {

base::Result<std::unique_ptr<Surgeon>> MakeSurgeonTakingOver(std::string_view name, const scene::Scene& scene,
                                                             const simulation::Snapshot& seen,
                                                             std::uint64_t seed) {
  auto begun = std::make_shared<scene::Scene>(scene);
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand)
    begun->instruments[hand].home = seen.instruments[hand].joints;
  begun->laparoscope.home = seen.laparoscope;
  auto surgeon = MakeSurgeon(name, std::move(begun), seed);
  if (surgeon.ok()) (*surgeon)->KnowFirstView(scene.laparoscope.home);
  return surgeon;
}

}  // namespace trocar::agent
