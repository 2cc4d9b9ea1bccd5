// SPDX-License-Identifier: Apache-2.0
/// \file palette.h  The colours of the reports, on light and on dark ground. Left and right hand, good and bad can be told apart with
/// any kind of colour vision, and stand out from their ground as WCAG 2.1 asks (1.4.3, 1.4.11); a test measures it.
#pragma once

#include <cstdint>

#include "trocar/report/document.h"
#include "trocar/report/drawing.h"

namespace trocar::report {

/// 0xRRGGBB
struct TwoColours {
  std::uint32_t light = 0, dark = 0;
};

inline constexpr TwoColours kPaper = {0xffffff, 0x10181e};
inline constexpr TwoColours kAccent = {0x0b5566, 0x7cc7d8};
inline constexpr TwoColours kSoft = {0xf1f5f7, 0x1a252d};  // ground of tiles and tables' heads
inline constexpr TwoColours kRule = {0xc9d3d9, 0x3a4a55};  // lines between rows

/// \pre ink is not kNone
constexpr TwoColours ColoursOf(Ink ink) noexcept {
  switch (ink) {
    case Ink::kNone:
    case Ink::kCount:
      break;
    case Ink::kText:
      return {0x14232e, 0xe6edf1};
    case Ink::kMuted:
      return {0x4b5b67, 0xa9b8c2};
    case Ink::kGrid:
      return {0xdde4e8, 0x2c3a44};
    case Ink::kPanel:
      return {0xf6f9fa, 0x172128};
    case Ink::kLeft:
      return {0x0068a8, 0x5bb5ee};
    case Ink::kRight:
      return {0xb8500a, 0xf0955a};
    case Ink::kThis:
      return kAccent;
    case Ink::kExpert:
      return {0x6a3f9c, 0xc2a2ee};
    case Ink::kGroup:
      return {0x74828c, 0x93a3ae};
    case Ink::kGood:
      return {0x17713f, 0x6ccb95};
    case Ink::kMinor:
      return {0x6f6000, 0xd6c24f};
    case Ink::kMajor:
      return {0xa84a00, 0xf2a03d};
    case Ink::kCritical:
      return {0xb0122b, 0xff8a94};
    case Ink::kPhaseEven:
      return {0xcfe0e6, 0x28434e};
    case Ink::kPhaseOdd:
      return {0xe4ecef, 0x1f323b};
  }
  return {};
}

constexpr Ink InkOf(Tone tone) noexcept {
  switch (tone) {
    case Tone::kPlain:
      return Ink::kText;
    case Tone::kGood:
      return Ink::kGood;
    case Tone::kCaution:
      return Ink::kMajor;
    case Tone::kBad:
      return Ink::kCritical;
    case Tone::kMuted:
      return Ink::kMuted;
  }
  return Ink::kText;
}

}  // namespace trocar::report
