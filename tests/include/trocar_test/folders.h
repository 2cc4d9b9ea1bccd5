// SPDX-License-Identifier: Apache-2.0
/// \file folders.h  Where the repository lies, for tests. The build includes it in every test (-include): as definitions on
/// the command line the two folders would make each test's objects differ from clone to clone, and no cache could find them.
#pragma once

namespace trocar::test {

/// The repository, without a slash at the end.
const char* SourceFolder() noexcept;
/// The folder of shared data beside the repository; it need not exist.
const char* SharedFolder() noexcept;

}  // namespace trocar::test

#define TROCAR_SOURCE_DIR ::trocar::test::SourceFolder()
#define TROCAR_SHARED_DIR ::trocar::test::SharedFolder()
