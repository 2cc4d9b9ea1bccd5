// SPDX-License-Identifier: Apache-2.0
/// \file fault_campaign.h  Every fault that concerns force, injected into a haptic channel, and what must hold. Built
/// once with every guard, and once for each guard without it: then the row that the guard stands for must fail.
#pragma once

#include <span>
#include <string>

namespace trocar::haptics {

struct CampaignRow {
  const char* name;        ///< "D8 not finite"
  std::string (*check)();  ///< what was wrong, or empty
};
std::span<const CampaignRow> CampaignRows();

}  // namespace trocar::haptics
