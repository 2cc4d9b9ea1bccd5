// SPDX-License-Identifier: Apache-2.0
/// \file taking_over.h  A scripted surgeon who goes on with what somebody else began.
#pragma once

#include "trocar/agent/surgeon.h"

namespace trocar::agent {

/// One whose hands and laparoscope begin where they are, and whose plan begins with what is seen next.
/// \param seen  as the last tick left it
/// \return as MakeSurgeon
base::Result<std::unique_ptr<Surgeon>> MakeSurgeonTakingOver(std::string_view name, const scene::Scene& scene,
                                                             const simulation::Snapshot& seen,
                                                             std::uint64_t seed);

}  // namespace trocar::agent
