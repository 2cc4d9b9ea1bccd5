// SPDX-License-Identifier: Apache-2.0
/// \file elementary.h  Elementary functions whose results are the same bits on every processor, compiler and platform.
///
/// The C library's sine, exponential and power differ in their last bit from one version to the next, and by which
/// instructions the processor has. These here are fixed sequences of IEEE 754's additions, multiplications, divisions
/// and square roots of doubles, rounded to nearest and compiled without contraction. They are at most 1 ulp off, and
/// have the special values of C's Annex F; where the result is no number, it is the one quiet NaN. They neither set errno
/// nor promise anything about the flags of exceptions.
///
/// Functions that IEEE 754 or integer arithmetic defines completely stay with the standard library: std::sqrt, fabs, copysign,
/// floor, ceil, trunc, round, lround, rint, nearbyint, fmod, remainder, ldexp, frexp. The sign of a zero from fmin and fmax is
/// not defined: vector.h has Min and Max. For squares and cubes write products.
#pragma once

namespace trocar::math {

struct SineCosine {
  double sine, cosine;
};

/// \param x  [rad], any finite number; infinities give NaN
double Sin(double x) noexcept;
/// \param x  [rad], any finite number; infinities give NaN
double Cos(double x) noexcept;
/// Both, to the same bits as one by one, in less time.
///
/// \param x  [rad], any finite number; infinities give NaN
SineCosine SinCos(double x) noexcept;
/// \param x  [rad], any finite number; infinities give NaN
double Tan(double x) noexcept;

/// \param x  -1 to 1; others give NaN
/// \return  -pi/2 to pi/2 [rad]
double Asin(double x) noexcept;
/// \param x  -1 to 1; others give NaN
/// \return  0 to pi [rad]
double Acos(double x) noexcept;
/// Angle of the vector (x, y) with the x axis; zeros count with their signs.
///
/// \return  -pi to pi [rad]
double Atan2(double y, double x) noexcept;

double Exp(double x) noexcept;
/// \param x  0 gives -infinity, less NaN
double Log(double x) noexcept;
/// log(1 + x), as near for small x as for others.
///
/// \param x  -1 gives -infinity, less NaN
double Log1p(double x) noexcept;
/// x to the power y; of a negative x only to integers.
double Pow(double x, double y) noexcept;

double Cbrt(double x) noexcept;
/// sqrt(x^2 + y^2), without overflow in between.
double Hypot(double x, double y) noexcept;

}  // namespace trocar::math
