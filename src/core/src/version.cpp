// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/version.h"

#include "version_config.h"

namespace trocar::core {

std::string_view VersionText() noexcept {
  return TROCAR_VERSION;
}

}  // namespace trocar::core
