// SPDX-License-Identifier: Apache-2.0
/// \file elementary_samples.h  The elementary functions as a list, each with arguments to try it on: over all exponents,
/// over what a tick asks for, and where it is hard. No libm draws them, so that they are the same everywhere.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "trocar/base/state_hash.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::math {

/// Of a function of one argument x alone counts; of Atan2 y is the first.
struct Arguments {
  double x = 0, y = 0;
};

struct ElementaryFunction {
  const char* name;
  double (*value)(const Arguments&);
  Arguments (*draw)(Random&);
};

/// Any finite number with an exponent of that range, evenly over the exponents.
inline double DrawExponent(Random& random, int low, int high) {
  const std::uint64_t word = random.NextWord(), mantissa = word & 0xfffffffffffffULL;
  const auto count = static_cast<std::uint64_t>(high - low + 1);
  const int exponent = low + static_cast<int>(random.NextWord() % count);
  // below -1022 as subnormal numbers
  std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52 | mantissa;
  if (exponent < -1022) bits = mantissa >> (random.NextWord() % 52);
  return std::bit_cast<double>(bits | (word & 0x8000000000000000ULL));
}

inline double DrawAny(Random& random) {
  return DrawExponent(random, -1023, 1023);
}

/// x, up to so many units of the last place further on or back.
inline double Shake(Random& random, double x, std::uint64_t units) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) + random.NextWord() % (2 * units + 1) - units);
}

inline Arguments DrawAngle(Random& random) {
  switch (random.NextWord() % 5) {
    case 0:
      return {DrawAny(random)};
    case 1:
      return {random.Uniform(-1e5, 1e5)};
    case 2: {
      // multiples of the table's steps and of halves of them, as near as doubles come
      const auto n = static_cast<double>(1 + (random.NextWord() >> (20 + random.NextWord() % 44)));
      return {Shake(random, n * (std::numbers::pi / 64.0), 4)};
    }
    case 3: {
      // multiples of pi/2
      const auto n = static_cast<double>(1 + (random.NextWord() >> (30 + random.NextWord() % 34)));
      return {Shake(random, n * (std::numbers::pi / 2.0), 3)};
    }
    default:
      return {random.Uniform(-7.0, 7.0)};
  }
}

inline Arguments DrawSine(Random& random) {
  switch (random.NextWord() % 4) {
    case 0:
      return {DrawExponent(random, -1023, -1)};
    case 1:
      return {1.0 - std::fabs(DrawExponent(random, -53, -2))};
    case 2:
      return {Shake(random, random.NextWord() % 2 == 0 ? 0.5 : -0.5, 1u << 20)};
    default:
      return {random.Uniform(-1.0, 1.0)};
  }
}

/// Two sides of a triangle, in any direction.
inline Arguments DrawSides(Random& random) {
  switch (random.NextWord() % 5) {
    case 0:
      return {DrawAny(random), DrawAny(random)};
    case 1: {
      const int exponent = static_cast<int>(random.NextWord() % 2000) - 1010;
      const int low = exponent < -1015 ? -1023 : exponent - 8, high = exponent > 1015 ? 1023 : exponent + 8;
      return {DrawExponent(random, low, high), DrawExponent(random, low, high)};
    }
    case 2: {
      // quotients about the middle and the ends of the table's cells
      const double x = random.Uniform(-2.0, 2.0);
      return {x, Shake(random, x * static_cast<double>(random.NextWord() % 257) / 128.0, 8)};
    }
    case 3:
      return {random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2)};
    default:
      return {DrawExponent(random, -60, 60), DrawExponent(random, -60, 60)};
  }
}

inline Arguments DrawExponential(Random& random) {
  switch (random.NextWord() % 5) {
    case 0:
      return {DrawExponent(random, -1023, 10)};
    case 1:
      return {random.Uniform(-750.0, 712.0)};
    case 2:
      return {Shake(random, random.NextWord() % 2 == 0 ? 709.782712893384 : -745.1332191019411, 1u << 16)};
    case 3:
      return {random.Uniform(-746.0, -707.0)};
    default:
      return {random.Uniform(-40.0, 10.0)};
  }
}

inline Arguments DrawPositive(Random& random) {
  switch (random.NextWord() % 4) {
    case 0:
      return {std::fabs(DrawAny(random))};
    case 1:
      return {1.0 + DrawExponent(random, -52, -2)};
    case 2:
      return {random.Uniform(0.6, 1.5)};
    default:
      return {random.Uniform(0.0, 100.0)};
  }
}

inline Arguments DrawAboveMinusOne(Random& random) {
  switch (random.NextWord() % 4) {
    case 0: {
      const double x = DrawAny(random);
      return {x <= -1.0 ? -x : x};
    }
    case 1:
      return {DrawExponent(random, -60, -1)};
    case 2:
      return {std::fabs(DrawExponent(random, -53, 0)) - 1.0};
    default:
      return {random.Uniform(-1.0, 3.0)};
  }
}

inline Arguments DrawPower(Random& random) {
  switch (random.NextWord() % 6) {
    case 0:
      return {std::fabs(DrawAny(random)), DrawExponent(random, -60, 12)};
    case 1: {
      // near 1, to powers that bring it far away; half of them where results are subnormal
      const double by = DrawExponent(random, -52, -3);
      const bool is_small = random.NextWord() % 2 == 0;
      return {1.0 + by, (is_small ? random.Uniform(-746.0, -707.0) : random.Uniform(-1000.0, 1000.0)) / by};
    }
    case 2:
      return {DrawAny(random), static_cast<double>(random.NextWord() % 41) - 20.0};
    case 3:
      return {random.Uniform(0.0, 20.0), random.Uniform(-260.0, 260.0)};
    case 4:
      return {std::fabs(DrawAny(random)), random.Uniform(-1.5, 1.5)};
    default:
      return {random.Uniform(0.0, 1.0), random.Uniform(0.0, 5.0)};
  }
}

inline Arguments DrawFinite(Random& random) {
  if (random.NextWord() % 2 == 0) return {DrawAny(random)};
  return {random.Uniform(-10.0, 10.0)};
}

inline constexpr ElementaryFunction kElementaryFunctions[] = {
    {"Sin", [](const Arguments& a) { return Sin(a.x); }, DrawAngle},
    {"Cos", [](const Arguments& a) { return Cos(a.x); }, DrawAngle},
    {"Tan", [](const Arguments& a) { return Tan(a.x); }, DrawAngle},
    {"Asin", [](const Arguments& a) { return Asin(a.x); }, DrawSine},
    {"Acos", [](const Arguments& a) { return Acos(a.x); }, DrawSine},
    {"Atan2", [](const Arguments& a) { return Atan2(a.y, a.x); }, DrawSides},
    {"Exp", [](const Arguments& a) { return Exp(a.x); }, DrawExponential},
    {"Log", [](const Arguments& a) { return Log(a.x); }, DrawPositive},
    {"Log1p", [](const Arguments& a) { return Log1p(a.x); }, DrawAboveMinusOne},
    {"Pow", [](const Arguments& a) { return Pow(a.x, a.y); }, DrawPower},
    {"Cbrt", [](const Arguments& a) { return Cbrt(a.x); }, DrawFinite},
    {"Hypot", [](const Arguments& a) { return Hypot(a.x, a.y); }, DrawSides},
};

/// Zeros, infinities, NaN, subnormal numbers and the ends of what is normal, in pairs; with both signs.
inline constexpr double kSpecialNumbers[] = {
    0.0,
    1.0,
    0.5,
    2.0,
    3.0,
    4.0,
    0x1p-1074,
    0x0.fffffffffffffp-1022,
    0x1p-1022,
    0x1p-500,
    0x1p-54,
    0x1p-27,
    0x1.fffffffffffffp-1,
    0x1.0000000000001p0,
    1.5,
    0x1p53,
    0x1.fffffffffffffp52,
    0x1p500,
    0x1.6ac5b262ca1ffp849,  // among all doubles the nearest to a multiple of pi/2
    0x1.fffffffffffffp1023,
    0x1.62e42fefa39efp9,
    0x1.74910d52d3051p9,
    0x1.921fb54442d18p0,
    0x1.921fb54442d18p1,
    std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::quiet_NaN(),
};

inline constexpr int kHashedArguments = 20'000;

/// A fingerprint of what a function gives for so many fixed arguments and for all pairs of special numbers.
inline std::uint64_t HashValues(const ElementaryFunction& function, int count) {
  base::StateHash hash;
  Random random(44);
  for (int i = 0; i < count; ++i) hash.Add(function.value(function.draw(random)));
  for (const double x : kSpecialNumbers) {
    for (const double y : kSpecialNumbers) {
      for (const int signs : {0, 1, 2, 3}) hash.Add(function.value({signs & 1 ? -x : x, signs & 2 ? -y : y}));
    }
  }
  return hash.Value();
}

}  // namespace trocar::math
