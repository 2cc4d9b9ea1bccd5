// SPDX-License-Identifier: Apache-2.0
/// \file xapi_delivery.h  Brings waiting statements to a learning record store over HTTP. For a process of its own: it waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/report/xapi.h"

namespace trocar::report {

/// Where statements go: "https://lrs.hospital.example/xapi"; "/statements" is added.
struct Endpoint {
  bool is_secure = false;
  std::string host, port, path;  ///< path without a slash at its end
};
/// \return kUsage for what is no address; kXapiUnsafe for http to another machine than this, or https where this build has none
base::Result<Endpoint> ParseEndpoint(const std::string& url);

/// "user:password" from a file that nobody else may read.
/// \return kXapiUnsafe where others may; the file's errors; kUsage where it is none
base::Result<std::string> ReadCredentials(const std::filesystem::path& path);

struct DeliverySettings {
  std::string credentials;                             ///< of ReadCredentials; empty: none are sent
  double answer_seconds = 30;                          ///< that connecting, or one answer, may take
  double first_pause = 1;                              ///< after a failure, then twice as long each time [s]
  double most_pause = 300;                             ///< [s]
  double give_up_seconds = 60;                         ///< without any success; 0: one try
  std::function<void(const std::string&)> on_trouble;  ///< told why it waits; may be empty
};

struct DeliveryReport {
  std::size_t delivered = 0;  ///< that the store has now
  std::size_t refused = 0;    ///< that it will never take: set aside
  std::size_t waiting = 0;    ///< still in the queue
  std::optional<base::Error>
      failure;  ///< why they wait: kXapiAway, kXapiRefused (credentials or address), kFileUnwritable
};

/// Sends everything that waits, and waits with growing pauses while the store is away.
/// \return kFileInUse where another program delivers from the same queue
base::Result<DeliveryReport> DeliverQueue(XapiQueue& queue, const Endpoint& endpoint,
                                          const DeliverySettings& settings);

}  // namespace trocar::report
