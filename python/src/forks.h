// SPDX-License-Identifier: Apache-2.0
/// \file forks.h  How children of fork() end.
#pragma once

namespace trocar::python {

/// Graphics drivers and TBB wait at a process's end for their threads. In a child of fork() those are not there, and the wait is a
/// crash or never ends. From the first call on, a child of this process that ends with exit() writes out what C's streams hold
/// and is gone, without what libraries do at the end. Python has done its own part before that.
/// \note To be called before the first of these threads begins.
void ExpectThreadsOfLibraries();

}  // namespace trocar::python
