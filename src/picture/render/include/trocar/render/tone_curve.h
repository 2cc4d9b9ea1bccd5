// SPDX-License-Identifier: Apache-2.0
/// \file tone_curve.h  From light to what the screen shows: the film curve of `Finish` in the shaders, and back.
#pragma once

namespace trocar::render {

/// Constants of the curve y = x (x + a) / (x (x + b) + c), shown as its square root. As a <= b and c >= 0 it rises
/// everywhere, and it never reaches 1: no light can turn a picture's white grey or black.
inline constexpr double kFilmA = 0.60, kFilmB = 1.01, kFilmC = 0.53;
/// Light beyond this is cut off, so that its square is a number [-].
inline constexpr double kMostLight = 1e4;
/// Light at which a colour has lost half of its way to white [-].
inline constexpr double kWhitening = 6.0;

/// \param light  of one channel, after exposure; 1 is bright tissue [-]
/// \return  0 to below 1, what the screen's byte is in its 255
double CalcShown(double light) noexcept;
/// The light that is shown so.
/// \param shown  0 to 1; what would need more than kMostLight gives kMostLight
double CalcLightShown(double shown) noexcept;

}  // namespace trocar::render
