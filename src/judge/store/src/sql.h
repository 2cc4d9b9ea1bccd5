// SPDX-License-Identifier: Apache-2.0
// Small helpers for statements that are put together.
#pragma once

#include <chrono>
#include <string>
#include <utility>

#include "database.h"
#include "trocar/store/store.h"

namespace trocar::store {

inline std::int64_t NowMilliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Adds a parameter. \return its place: "$3"
std::string Put(Parameters& parameters, Value value);

/// " AND ..." that leaves only people whom the viewer may see. \param column  that holds a person's id
std::string OnlyVisible(const Viewer& viewer, const std::string& column, Parameters& parameters);

inline base::Error Conflict() {
  return {
      base::ErrorCode::kStoreInvalid,
      "this recording is in the store already, as the attempt of somebody else or of nobody in particular, "
      "and "
      "stays that; an administrator who knows whose it is gives it to them: trocar store add FILE --trainee "
      "PSEUDONYM --move"};
}
inline base::Error Unknown(const std::string& what) {
  return {base::ErrorCode::kStoreUnknown, what};
}
inline base::Error Invalid(const std::string& what) {
  return {base::ErrorCode::kStoreInvalid, what};
}
inline base::Error Refused(const std::string& what) {
  return {base::ErrorCode::kStoreRefused, what};
}

}  // namespace trocar::store
