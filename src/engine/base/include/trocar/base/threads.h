// SPDX-License-Identifier: Apache-2.0
/// \file threads.h  Threads that a program lends: the engine starts none of its own.
#pragma once

#include <memory>

namespace trocar::base {

/// Threads that help a caller, each with a number from 1 on; the caller itself is number 0.
class Crew {
 public:
  using Serve = void (*)(void* context, int member);
  virtual ~Crew() = default;

  /// Lets each member call serve(context, member) once, as soon as a processor is free for it; does not wait for that.
  virtual void Begin(Serve serve, void* context) noexcept = 0;
  /// Returns when no member is in `serve`, or will still call it.
  virtual void End() noexcept = 0;
};

/// How many threads share the work, and where they come from. What they compute does not depend on it.
struct Threads {
  int count = 1;  ///< >= 1, with the caller
  /// \param count  > 1, with the caller. Must be there where `count` is more than 1 (TROCAR_ASSERT).
  std::unique_ptr<Crew> (*make_crew)(int count) = nullptr;
};

}  // namespace trocar::base
