// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "palette.h"
#include "pdf_canvas.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"
#include "trocar/report/document.h"

namespace trocar::report {
namespace {

constexpr double kMargin = 46, kTop = 50, kBottom = kPageHeight - 56;  // [pt]
constexpr double kWidth = kPageWidth - 2 * kMargin;
constexpr double kColumnGap = 16, kBlockGap = 10;
constexpr double kWide = 700;  // drawings wider than this take the whole width [px]
constexpr double kCellSize = 7.8, kCellRoom = 2.4, kCellGap = 7;
constexpr double kFewestBelowHeading = 90;  // no heading at the foot of a page

std::uint32_t ColourOf(Tone tone) {
  return ColoursOf(InkOf(tone)).light;
}

/// One pass over a document.
class PageFlow {
 public:
  /// \param pages  in all, for the foot; 0 while they are being counted
  PageFlow(const Document& document, int pages)
      : document_(document), canvas_(document.title, document.date), pages_(pages) {}

  void Run() {
    WriteHead();
    for (const Section& section : document_.sections) {
      Break(kFewestBelowHeading);
      y_ += 12;
      canvas_.AddOutline(section.title, page_, y_);
      y_ += canvas_.AddText(section.title, kMargin, y_, kWidth, {12.5, kAccent.light, true}) + 5;
      for (const Block& block : section.blocks) std::visit([&](const auto& one) { Write(one); }, block);
    }
    WriteFoot();
    canvas_.EndPage();
  }
  int Pages() const { return page_; }
  std::string Finish() { return canvas_.Finish(); }

 private:
  /// A new page where less than `height` is left on this.
  bool Break(double height) {
    if (y_ + height <= kBottom || y_ <= kTop + 1) return false;
    WriteFoot();
    canvas_.EndPage();
    ++page_;
    y_ = kTop;
    return true;
  }

  void WriteHead() {
    canvas_.AddRectangle(kMargin, 34, kWidth, 4.5, kAccent.light);
    const double facts = 210, title = kWidth - facts - kColumnGap;
    double left = y_;
    left += canvas_.AddText(document_.subtitle, kMargin, left, title, {8.5, kAccent.light, true});
    left += canvas_.AddText(document_.title, kMargin, left, title, {20, ColoursOf(Ink::kText).light, true});
    const double right = WriteFacts(document_.head, kMargin + title + kColumnGap, y_ + 2, facts, 62);
    y_ = std::max(left, right) + 8;
    canvas_.AddRule(kMargin, y_, kWidth, kRule.light, 0.8);
    y_ += 2;
  }

  void WriteFoot() {
    const double y = kPageHeight - 40;
    canvas_.AddRule(kMargin, y - 5, kWidth, kRule.light, 0.6);
    const TextStyle style{7.2, ColoursOf(Ink::kMuted).light};
    canvas_.AddText(document_.footer, kMargin, y, kWidth - 70, style);
    TextStyle right = style;
    right.anchor = Anchor::kEnd;
    const std::string page =
        pages_ > 0 ? host::TranslateWith("page {1} of {2}", {std::to_string(page_), std::to_string(pages_)})
                   : host::TranslateWith("page {1}", {std::to_string(page_)});
    canvas_.AddText(page, kMargin + kWidth - 70, y, 70, right);
  }

  /// \return the y below it
  double WriteFacts(const std::vector<std::pair<std::string, std::string>>& rows, double left, double top,
                    double width, double name_width) {
    for (const auto& [name, value] : rows) {
      const double a = canvas_.AddText(name, left, top, name_width, {8.2, ColoursOf(Ink::kMuted).light});
      const double b = canvas_.AddText(value, left + name_width, top, width - name_width,
                                       {8.2, ColoursOf(Ink::kText).light, true});
      top += std::max(a, b) + 2;
    }
    return top;
  }

  void Write(const Paragraph& paragraph) {
    const bool has_bar = paragraph.tone != Tone::kPlain && paragraph.tone != Tone::kMuted;
    const TextStyle style{has_bar                          ? 10.2
                          : paragraph.tone == Tone::kMuted ? 7.8
                                                           : 9.0,
                          has_bar ? ColoursOf(Ink::kText).light : ColourOf(paragraph.tone)};
    const double indent = has_bar ? 10 : 0;
    const double height = canvas_.MeasureText(paragraph.text, kWidth - indent, style);
    Break(height);
    if (has_bar) canvas_.AddRectangle(kMargin, y_, 3, height, ColourOf(paragraph.tone));
    canvas_.AddText(paragraph.text, kMargin + indent, y_, kWidth - indent, style);
    y_ += height + 6;
  }

  void Write(const Tiles& tiles) {
    if (tiles.tiles.empty()) return;
    constexpr std::size_t kInARow = 6;
    for (std::size_t first = 0; first < tiles.tiles.size(); first += kInARow) {
      const std::size_t last = std::min(first + kInARow, tiles.tiles.size());
      const double gap = 7, height = 58;
      const auto count = static_cast<double>(std::max<std::size_t>(last - first, 3));
      const double width = (kWidth - gap * (count - 1)) / count;
      Break(height);
      for (std::size_t i = first; i < last; ++i) {
        const Tiles::Tile& tile = tiles.tiles[i];
        const double left = kMargin + static_cast<double>(i - first) * (width + gap), inner = width - 14;
        canvas_.AddRectangle(left, y_, width, height, kSoft.light, 3);
        canvas_.AddRectangle(left, y_, width, 2.2,
                             tile.tone == Tone::kPlain ? kRule.light : ColourOf(tile.tone));
        double at = y_ + 7;
        at += canvas_.AddText(tile.label, left + 7, at, inner, {7.2, ColoursOf(Ink::kMuted).light});
        const double size = tile.value.size() > 9 ? 10 : 14;
        at += canvas_.AddText(tile.value, left + 7, at, inner, {size, ColourOf(tile.tone), true});
        canvas_.AddText(tile.note, left + 7, at, inner, {6.6, ColoursOf(Ink::kMuted).light});
      }
      y_ += height + gap;
    }
    y_ += 3;
  }

  void Write(const Facts& facts) {
    for (const auto& row : facts.rows) {
      Break(14);
      y_ = WriteFacts({row}, kMargin, y_, kWidth, 100);
    }
    y_ += kBlockGap;
  }

  // --- tables

  std::vector<double> MeasureColumns(const Table& table) const {
    double shares = 0;
    for (const Table::Column& column : table.columns) shares += column.share;
    std::vector<double> widths;
    for (const Table::Column& column : table.columns)
      widths.push_back((kWidth - kCellGap * static_cast<double>(table.columns.size() - 1)) * column.share /
                       shares);
    return widths;
  }

  TextStyle CellStyle(const Table& table, std::size_t column, Tone tone) const {
    TextStyle style{tone == Tone::kMuted ? 7.0 : kCellSize, ColourOf(tone),
                    tone == Tone::kBad || tone == Tone::kCaution};
    if (table.columns[column].is_number) style.anchor = Anchor::kEnd;
    return style;
  }

  /// A row is not parted: of a text that would be longer than a page the middle is left out.
  static std::string CellText(const Cell& cell, double width) {
    constexpr double kLine = 1.6 * kCellSize;  // with room for letters that are higher
    const double letters = std::floor(width / kCellSize) * std::floor((kBottom - kTop) / kLine);
    return host::Printable(cell.text, static_cast<std::size_t>(std::max(letters, 16.0)));
  }

  double MeasureRow(const Table& table, const std::vector<Cell>& row, const std::vector<double>& widths) {
    double height = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      height = std::max(height, canvas_.MeasureText(CellText(row[i], widths[i]), widths[i],
                                                    CellStyle(table, i, row[i].tone)));
    return height;
  }

  /// Of a short table, which is not parted; 0 of a long one.
  double MeasureWhole(const Table& table, const std::vector<double>& widths) {
    constexpr std::size_t kMostRows = 16;
    if (table.rows.size() > kMostRows) return 0;
    double height = 40;  // caption and heading
    for (const std::vector<Cell>& row : table.rows) height += MeasureRow(table, row, widths) + 2 * kCellRoom;
    return std::min(height, kBottom - kTop);
  }

  void WriteRow(const Table& table, const std::vector<Cell>& row, const std::vector<double>& widths,
                double height) {
    double left = kMargin;
    for (std::size_t i = 0; i < row.size(); ++i) {
      canvas_.AddText(CellText(row[i], widths[i]), left, y_ + kCellRoom, widths[i],
                      CellStyle(table, i, row[i].tone));
      left += widths[i] + kCellGap;
    }
    y_ += height + 2 * kCellRoom;
    canvas_.AddRule(kMargin, y_, kWidth, kRule.light, 0.5);
  }

  void WriteTableHead(const Table& table, const std::vector<double>& widths) {
    double left = kMargin, height = 0;
    const auto style = [&](std::size_t i) {
      return TextStyle{7.2, ColoursOf(Ink::kMuted).light, true,
                       table.columns[i].is_number ? Anchor::kEnd : Anchor::kStart};
    };
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      height = std::max(height, canvas_.MeasureText(table.columns[i].name, widths[i], style(i)));
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      // at the foot of the heading's lines
      const double own = canvas_.MeasureText(table.columns[i].name, widths[i], style(i));
      canvas_.AddText(table.columns[i].name, left, y_ + kCellRoom + height - own, widths[i], style(i));
      left += widths[i] + kCellGap;
    }
    y_ += height + 2 * kCellRoom;
    canvas_.AddRule(kMargin, y_, kWidth, ColoursOf(Ink::kMuted).light, 0.9);
  }

  void Write(const Table& table) {
    const std::vector<double> widths = MeasureColumns(table);
    Break(std::max(70.0, MeasureWhole(table, widths)));
    y_ += canvas_.AddText(table.caption, kMargin, y_, kWidth, {8.6, ColoursOf(Ink::kText).light, true}) + 2;
    WriteTableHead(table, widths);
    for (const std::vector<Cell>& row : table.rows) {
      const double height = MeasureRow(table, row, widths);
      if (Break(height + 2 * kCellRoom)) WriteTableHead(table, widths);
      WriteRow(table, row, widths, height);
    }
    y_ += kBlockGap;
  }

  // --- drawings and pictures

  void Write(const Figures& figures) {
    const double half = (kWidth - kColumnGap) / 2;
    std::size_t i = 0;
    while (i < figures.drawings.size()) {
      const bool is_wide = figures.drawings[i].width > kWide;
      const bool is_pair =
          !is_wide && i + 1 < figures.drawings.size() && figures.drawings[i + 1].width <= kWide;
      const double width = is_wide ? kWidth : half;
      const auto height_of = [&](const Drawing& drawing) { return drawing.height * width / drawing.width; };
      const double height =
          std::max(height_of(figures.drawings[i]), is_pair ? height_of(figures.drawings[i + 1]) : 0);
      Break(height + 16);
      for (std::size_t n = 0; n < (is_pair ? 2u : 1u); ++n) {
        const double left = kMargin + static_cast<double>(n) * (half + kColumnGap);
        const double caption = canvas_.AddText(figures.drawings[i + n].title, left, y_, width,
                                               {8.6, ColoursOf(Ink::kText).light, true});
        canvas_.AddDrawing(figures.drawings[i + n], left, y_ + caption + 3, width);
      }
      y_ += height + 16 + kBlockGap;
      i += is_pair ? 2 : 1;
    }
  }

  void Write(const Pictures& pictures) {
    const double half = (kWidth - kColumnGap) / 2;
    const TextStyle style{7.6, ColoursOf(Ink::kMuted).light};
    for (std::size_t i = 0; i < pictures.pictures.size(); i += 2) {
      const std::size_t last = std::min(i + 2, pictures.pictures.size());
      double height = 0;
      for (std::size_t n = i; n < last; ++n)
        height = std::max(height, canvas_.MeasurePicture(pictures.pictures[n].png, half));
      Break(height + 14);
      for (std::size_t n = i; n < last; ++n) {
        const double left = kMargin + static_cast<double>(n - i) * (half + kColumnGap);
        const double drawn = canvas_.AddPicture(pictures.pictures[n].png, left, y_, half);
        const std::string& caption = pictures.pictures[n].caption;
        canvas_.AddText(
            drawn > 0 ? caption : host::TranslateWith("{1} (the picture cannot be read)", {caption}), left,
            y_ + drawn + 2, half, style);
      }
      y_ += height + 14 + 6;
    }
  }

  void Write(const Film& film) {
    Write(Paragraph{host::TranslateWith("Film: {1}", {film.file}), Tone::kMuted});
  }

  void Write(const Advices& advices) {
    const TextStyle what{9.4, ColoursOf(Ink::kText).light, true}, why{8.4, ColoursOf(Ink::kMuted).light},
        practise{8.4, ColoursOf(Ink::kGood).light};
    const double left = kMargin + 30, width = kWidth - 40;
    int number = 0;
    for (const Advices::Item& item : advices.items) {
      const std::string sentence =
          item.moment.empty() ? item.sentence : item.sentence + " " + item.moment + ".";
      const std::string todo =
          item.practise.empty() ? "" : host::TranslateWith("Practise: {1}", {item.practise});
      double height = 14 + canvas_.MeasureText(sentence, width, what);
      if (!item.why.empty()) height += 2 + canvas_.MeasureText(item.why, width, why);
      if (!todo.empty()) height += 2 + canvas_.MeasureText(todo, width, practise);
      Break(height);
      canvas_.AddRectangle(kMargin, y_, kWidth, height, kSoft.light, 3);
      canvas_.AddText(std::to_string(++number), kMargin + 10, y_ + 5, 20, {14, kAccent.light, true});
      double at = y_ + 7;
      at += canvas_.AddText(sentence, left, at, width, what) + 2;
      if (!item.why.empty()) at += canvas_.AddText(item.why, left, at, width, why) + 2;
      if (!todo.empty()) canvas_.AddText(todo, left, at, width, practise);
      y_ += height + 6;
    }
    y_ += 4;
  }

  const Document& document_;
  PdfCanvas canvas_;
  int pages_;
  int page_ = 1;
  double y_ = kTop;
};

}  // namespace

std::string FormatPdf(const Document& document) {
  PageFlow counted(document, 0);
  counted.Run();
  PageFlow flow(document, counted.Pages());
  flow.Run();
  return flow.Finish();
}

}  // namespace trocar::report
