// SPDX-License-Identifier: Apache-2.0
/// \file drawing.h  A chart as plain shapes. The page writes it as SVG, the PDF draws it with Cairo: both show the same.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/math/vector.h"

namespace trocar::report {

/// Meaning of a shape's colour; the back-ends choose the colour itself, for a light or a dark page.
enum class Ink : std::uint8_t {
  kNone,
  kText,
  kMuted,
  kGrid,
  kPanel,  ///< a plot's ground
  kLeft,   ///< the left hand
  kRight,  ///< the right hand
  kThis,   ///< this attempt or trainee
  kExpert,
  kGroup,
  kGood,
  kMinor,
  kMajor,
  kCritical,
  kPhaseEven,  ///< phases, in turn
  kPhaseOdd,
  kCount
};
/// "left": as in the names of the page's style.
std::string_view NameOf(Ink ink) noexcept;

enum class Dash : std::uint8_t { kSolid, kDashed, kDotted };

struct Line {
  std::vector<math::Vec2> points;  ///< [px]; a point that is not finite breaks the line
  Ink ink = Ink::kText;
  double width = 1;  ///< [px]
  Dash dash = Dash::kSolid;
};

struct Area {
  std::vector<math::Vec2> points;  ///< of its outline [px]
  Ink ink = Ink::kPanel;
  double opacity = 1;  ///< 0 to 1
  std::string tip;     ///< shown when the pointer rests on it; may be empty
};

/// Told apart by shape as well as by colour.
enum class MarkKind : std::uint8_t { kDot, kSquare, kTriangle, kDiamond };

struct Mark {
  math::Vec2 at;
  MarkKind kind = MarkKind::kDot;
  Ink ink = Ink::kText;
  double radius = 4;  ///< [px]
  std::string tip;    ///< may be empty
};

enum class Anchor : std::uint8_t { kStart, kMiddle, kEnd };

struct Label {
  math::Vec2 at;  ///< of the base line [px]
  std::string text;
  Ink ink = Ink::kText;
  Anchor anchor = Anchor::kStart;
  double size = 11;  ///< [px]
  bool is_bold = false;
  bool is_upward = false;  ///< turned by a quarter, read from below
};

using Shape = std::variant<Line, Area, Mark, Label>;

/// Shapes in the order in which they are drawn.
struct Drawing {
  std::string title;             ///< what it is
  std::string description;       ///< what it shows, for who cannot see it
  double width = 0, height = 0;  ///< [px]
  std::vector<Shape> shapes;
};

/// The outline of a rectangle.
std::vector<math::Vec2> MakeRectangle(double left, double top, double width, double height);
/// Corners of a mark other than a dot.
std::vector<math::Vec2> MakeMarkOutline(const Mark& mark);
/// About how wide a text is [px]: what is too wide for its place is cut.
double GuessTextWidth(std::string_view text, double size);
/// `text`, or its beginning with "…" where it is wider than `width` [px]; empty where not even that fits.
std::string CutToWidth(std::string_view text, double size, double width);

/// A length or place in SVG, to a tenth [px].
std::string FormatPixels(double value);
/// Commands of an SVG path through the points [px]; a gap where a point is not finite.
std::string FormatPath(const std::vector<math::Vec2>& points);

/// SVG element with title and description; colours by class, see html_page.h.
/// \param id  unique in the page
std::string FormatSvg(const Drawing& drawing, std::string_view id);

}  // namespace trocar::report
