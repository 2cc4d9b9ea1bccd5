// SPDX-License-Identifier: Apache-2.0
/// \file hd_end.h  Where libHD is: in this process, or in another that outlives it.
#pragma once

#include <vector>

#include "hands/force_mailbox.h"
#include "trocar/device/open_haptics.h"

namespace trocar::device {

class HdEnd {
 public:
  virtual ~HdEnd() = default;
  /// Loads the library and opens the devices.
  virtual base::Status Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) = 0;
  /// Forces and reports go through the mailbox from now on.
  virtual base::Status Start() = 0;
  /// Zero force, then the scheduler ends.
  virtual void Stop() noexcept = 0;
  virtual void Close() noexcept = 0;
  /// The library's process died or stands still. Real-time safe.
  virtual bool HasFailed() const noexcept { return false; }
  virtual ForceMailbox& Mailbox() noexcept = 0;
  /// For the supervisor; nothing where the library is in this process.
  virtual SupervisedLibrary Supervised() const { return {}; }
};

}  // namespace trocar::device
