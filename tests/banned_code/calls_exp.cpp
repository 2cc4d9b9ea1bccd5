// SPDX-License-Identifier: Apache-2.0
/// \file calls_exp.cpp  A shared library that calls the C library's exponential, as Bullet's call its sine.
#include <cmath>

extern "C" __attribute__((visibility("default"))) double CallExp(double x) {
  return std::exp(x);
}
