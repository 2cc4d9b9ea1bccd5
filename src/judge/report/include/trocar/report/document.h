// SPDX-License-Identifier: Apache-2.0
/// \file document.h  A report as sections of text, tables and drawings, made once and then written as a page or as PDF.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "trocar/report/drawing.h"

namespace trocar::report {

/// How good or bad something is; shown by a word or shape as well as by colour.
enum class Tone : std::uint8_t { kPlain, kGood, kCaution, kBad, kMuted };

struct Paragraph {
  std::string text;
  Tone tone = Tone::kPlain;  ///< kMuted: smaller; kCaution, kBad: with a bar at its side
};

/// Few numbers, large.
struct Tiles {
  struct Tile {
    std::string label, value, note;
    Tone tone = Tone::kPlain;
  };
  std::vector<Tile> tiles;
};

/// Pairs of a name and a value.
struct Facts {
  std::vector<std::pair<std::string, std::string>> rows;
};

struct Cell {
  std::string text;
  Tone tone = Tone::kPlain;
};

struct Table {
  struct Column {
    std::string name;
    bool is_number = false;  ///< at the right
    double share = 1;        ///< of the width, relative to the other columns
  };
  std::string caption;
  std::vector<Column> columns;  ///< the first names its row
  std::vector<std::vector<Cell>> rows;
};

/// Drawings side by side where there is room.
struct Figures {
  std::vector<Drawing> drawings;
};

struct Picture {
  std::string png;      ///< the file's bytes
  std::string caption;  ///< also what is said in its place
};
struct Pictures {
  std::vector<Picture> pictures;
};

/// One thing to work on.
struct Advices {
  struct Item {
    std::string sentence, moment, why, practise;
  };
  std::vector<Item> items;
};

/// A film beside the page. PDF names it only.
struct Film {
  std::string file;  ///< name, without a folder
};

using Block = std::variant<Paragraph, Tiles, Facts, Table, Figures, Pictures, Advices, Film>;

struct Section {
  std::string title;
  std::vector<Block> blocks;
};

struct Document {
  std::string title, subtitle;
  std::vector<std::pair<std::string, std::string>> head;  ///< facts beside the title
  std::vector<Section> sections;
  std::string footer;  ///< on every page
  std::string date;    ///< of what is reported, RFC 3339; empty: not known
};

/// One HTML file: no script, nothing from elsewhere, light and dark, fit for print. Every text is escaped.
/// \pre no film lies in another folder
std::string FormatHtml(const Document& document);

/// PDF, A4. The same document gives the same bytes on the same machine: its only date is the document's own.
/// \return the bytes
std::string FormatPdf(const Document& document);

/// RFC 4648, with padding.
std::string EncodeBase64(std::string_view bytes);

}  // namespace trocar::report
