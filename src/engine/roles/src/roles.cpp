// SPDX-License-Identifier: Apache-2.0
#include "trocar/roles/roles.h"

#include <algorithm>

namespace trocar::roles {

std::string SpokenName(std::string_view name) {
  std::string spoken(name);
  std::replace(spoken.begin(), spoken.end(), '_', ' ');
  return spoken;
}

}  // namespace trocar::roles
