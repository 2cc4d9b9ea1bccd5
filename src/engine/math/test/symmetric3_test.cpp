// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/symmetric3.h"

#include <gtest/gtest.h>

namespace trocar::math {
namespace {

TEST(Symmetric3, ItsInverseUndoesIt) {
  Symmetric3 m{};
  AddIsotropic(m, 0.3);
  AddDirection(m, {1.0, -2.0, 0.5}, 2.0);
  AddDirection(m, {0.2, 0.4, 3.0}, 0.7);
  const Vec3 v{0.7, -1.1, 2.3};
  const Vec3 back = Multiply(Invert(m), Multiply(m, v));
  EXPECT_NEAR(Norm(back - v), 0.0, 1e-13);
  // a (a . v) k + 0.3 v, by hand
  Symmetric3 one{};
  AddIsotropic(one, 0.3);
  AddDirection(one, {1.0, -2.0, 0.5}, 2.0);
  const double along = 2.0 * (0.7 + 2.2 + 1.15);
  EXPECT_NEAR(Norm(Multiply(one, v) - Vec3{0.21 + along, -0.33 - 2.0 * along, 0.69 + 0.5 * along}), 0.0,
              1e-13);
}

TEST(Symmetric3, ASingularOneHasNoInverse) {
  Symmetric3 flat{};
  AddDirection(flat, {1.0, 0.0, 0.0}, 2.0);
  EXPECT_EQ(Invert(flat), Symmetric3{});
}

}  // namespace
}  // namespace trocar::math
