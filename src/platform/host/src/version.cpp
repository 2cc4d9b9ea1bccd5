// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/version.h"

#include "version_config.h"

namespace trocar::host {

std::string_view VersionText() noexcept {
  return TROCAR_VERSION;
}

}  // namespace trocar::host
