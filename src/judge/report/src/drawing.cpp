// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/drawing.h"

#include <cmath>
#include <cstdio>

#include "shown_text.h"
#include "trocar/base/assert.h"

namespace trocar::report {

using math::Vec2;

namespace {

// of the letters of a sans-serif face, relative to their size
constexpr double kLetter = 0.53;

std::string DashAttribute(Dash dash) {
  switch (dash) {
    case Dash::kDashed:
      return " stroke-dasharray=\"6 4\"";
    case Dash::kDotted:
      return " stroke-dasharray=\"1.5 3\"";
    case Dash::kSolid:
      return "";
  }
  return "";
}

/// A shape's end: with its tip inside, or none.
std::string Close(std::string_view element, const std::string& tip) {
  if (tip.empty()) return "/>\n";
  return "><title>" + EscapeShown(tip) + "</title></" + std::string(element) + ">\n";
}

std::string Format(const Line& line) {
  return "<path class=\"l-" + std::string(NameOf(line.ink)) + "\" stroke-width=\"" +
         FormatPixels(line.width) + "\"" + DashAttribute(line.dash) + " d=\"" + FormatPath(line.points) +
         "\"/>\n";
}

std::string Format(const Area& area) {
  std::string svg = "<path class=\"a-" + std::string(NameOf(area.ink)) + "\"";
  if (area.opacity < 1) svg += " fill-opacity=\"" + FormatPixels(area.opacity) + "\"";
  return svg + " d=\"" + FormatPath(area.points) + "Z\"" + Close("path", area.tip);
}

std::string Format(const Mark& mark) {
  const std::string style = " class=\"m-" + std::string(NameOf(mark.ink)) + "\"";
  if (mark.kind != MarkKind::kDot) {
    return "<path" + style + " d=\"" + FormatPath(MakeMarkOutline(mark)) + "Z\"" + Close("path", mark.tip);
  }
  return "<circle" + style + " cx=\"" + FormatPixels(mark.at.x) + "\" cy=\"" + FormatPixels(mark.at.y) +
         "\" r=\"" + FormatPixels(mark.radius) + "\"" + Close("circle", mark.tip);
}

std::string Format(const Label& label) {
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  std::string svg = "<text class=\"t-" + std::string(NameOf(label.ink)) + "\" x=\"" +
                    FormatPixels(label.at.x) + "\" y=\"" + FormatPixels(label.at.y) + "\" font-size=\"" +
                    FormatPixels(label.size) + "\" text-anchor=\"" +
                    kAnchors[static_cast<int>(label.anchor)] + "\"";
  if (label.is_bold) svg += " font-weight=\"600\"";
  if (label.is_upward)
    svg += " transform=\"rotate(-90 " + FormatPixels(label.at.x) + " " + FormatPixels(label.at.y) + ")\"";
  return svg + ">" + EscapeShown(label.text) + "</text>\n";
}

}  // namespace

std::string_view NameOf(Ink ink) noexcept {
  constexpr std::string_view kNames[] = {"none",  "text",     "muted",      "grid",     "panel", "left",
                                         "right", "this",     "expert",     "group",    "good",  "minor",
                                         "major", "critical", "phase-even", "phase-odd"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(Ink::kCount));
  return kNames[static_cast<std::size_t>(ink)];
}

std::vector<Vec2> MakeRectangle(double left, double top, double width, double height) {
  return {{left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}};
}

std::vector<Vec2> MakeMarkOutline(const Mark& mark) {
  const auto [x, y] = mark.at;
  const double r = mark.radius;
  switch (mark.kind) {
    case MarkKind::kSquare:
      return MakeRectangle(x - 0.85 * r, y - 0.85 * r, 1.7 * r, 1.7 * r);
    case MarkKind::kTriangle:
      return {{x, y - 1.15 * r}, {x + 1.05 * r, y + 0.8 * r}, {x - 1.05 * r, y + 0.8 * r}};
    case MarkKind::kDiamond:
      return {{x, y - 1.3 * r}, {x + 1.3 * r, y}, {x, y + 1.3 * r}, {x - 1.3 * r, y}};
    case MarkKind::kDot:
      break;
  }
  return {};
}

double GuessTextWidth(std::string_view text, double size) {
  std::size_t letters = 0;
  for (const char c : text) letters += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return kLetter * size * static_cast<double>(letters);
}

std::string CutToWidth(std::string_view text, double size, double width) {
  if (GuessTextWidth(text, size) <= width) return std::string(text);
  const double room = width / (kLetter * size) - 1;
  if (room < 3) return "";
  std::string cut;
  double letters = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xc0) != 0x80 && ++letters > room) break;
    cut += c;
  }
  while (!cut.empty() && cut.back() == ' ') cut.pop_back();
  return cut + "…";
}

std::string FormatPixels(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string FormatPath(const std::vector<Vec2>& points) {
  std::string commands;
  bool is_down = false;
  for (const Vec2& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      is_down = false;
      continue;
    }
    commands += (is_down ? "L" : "M") + FormatPixels(point.x) + " " + FormatPixels(point.y);
    is_down = true;
  }
  return commands;
}

std::string FormatSvg(const Drawing& drawing, std::string_view id) {
  const std::string name(id);
  std::string svg = "<svg role=\"img\" viewBox=\"0 0 " + FormatPixels(drawing.width) + " " +
                    FormatPixels(drawing.height) + "\" aria-labelledby=\"" + name + "-t " + name +
                    "-d\">\n<title id=\"" + name + "-t\">" + EscapeShown(drawing.title) +
                    "</title>\n<desc id=\"" + name + "-d\">" + EscapeShown(drawing.description) + "</desc>\n";
  for (const Shape& shape : drawing.shapes)
    svg += std::visit([](const auto& one) { return Format(one); }, shape);
  return svg + "</svg>\n";
}

}  // namespace trocar::report
