// SPDX-License-Identifier: Apache-2.0
/// \file fault_campaign_main.cpp  The negative control: succeeds if the named row of the campaign fails.
#include <cstdio>
#include <string_view>

#include "fault_campaign.h"

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 2;
  for (const auto& row : trocar::haptics::CampaignRows()) {
    if (std::string_view(row.name) != arguments[1]) continue;
    const std::string wrong = row.check();
    std::printf("%s: %s\n", row.name, wrong.empty() ? "nothing noticed" : wrong.c_str());
    return wrong.empty() ? 1 : 0;
  }
  std::printf("no row \"%s\"\n", arguments[1]);
  return 2;
}
