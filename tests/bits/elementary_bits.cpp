// SPDX-License-Identifier: Apache-2.0
/// \file elementary_bits.cpp  Prints a fingerprint of each elementary function's results, for check_bits.sh to compare.
#include <cstdio>

#include "elementary_samples.h"

int main() {
  using namespace trocar;
  for (const math::ElementaryFunction& function : math::kElementaryFunctions)
    std::printf("%s %s\n", function.name,
                base::HashText(math::HashValues(function, math::kHashedArguments)).c_str());
  return 0;
}
