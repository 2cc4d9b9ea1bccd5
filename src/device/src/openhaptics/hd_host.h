// SPDX-License-Identifier: Apache-2.0
/// \file hd_host.h  libHD in the supervisor's program: our end of it.
#pragma once

#include <optional>
#include <string_view>

#include "hd_end.h"
#include "trocar/device/companion.h"

namespace trocar::device {

/// Forces and reports go through a mailbox in shared memory, which neither side waits for; opening, starting and stopping
/// through messages.
class HdHost : public HdEnd {
 public:
  core::Status Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) override;
  core::Status Start() override;
  void Stop() noexcept override;
  void Close() noexcept override;
  /// \pre open
  ForceMailbox& Mailbox() noexcept override { return *static_cast<ForceMailbox*>(companion_->Page()); }

 private:
  std::optional<Companion> companion_;
};

}  // namespace trocar::device
