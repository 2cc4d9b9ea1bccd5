// SPDX-License-Identifier: Apache-2.0
/// \file http_client.h  One request to a learning record store, over a connection of its own.
#pragma once

#include <string>

#include "trocar/report/xapi_delivery.h"

namespace trocar::report {

struct HttpAnswer {
  int status = 0;
  double retry_after = 0;  ///< that the store asked for [s]; 0: nothing
  std::string body;
};

/// POSTs a statement. The answer must be whole.
/// \param credentials  "user:password", or empty
/// \param seconds      for connecting, and then for the whole answer
/// \return kXapiAway with what failed; kXapiUnsafe where the name leads to another machine without TLS, or its certificate is not trusted
base::Result<HttpAnswer> PostStatement(const Endpoint& endpoint, const std::string& statement,
                                       const std::string& credentials, double seconds);

}  // namespace trocar::report
