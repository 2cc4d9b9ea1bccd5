// SPDX-License-Identifier: Apache-2.0
#include "trocar_test/folders.h"

namespace trocar::test {

const char* SourceFolder() noexcept {
  return TROCAR_TEST_SOURCE_FOLDER;
}
const char* SharedFolder() noexcept {
  return TROCAR_TEST_SOURCE_FOLDER "/../shared";
}

}  // namespace trocar::test
