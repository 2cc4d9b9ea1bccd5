// SPDX-License-Identifier: Apache-2.0
#include <sodium.h>

#include <array>
#include <cstdint>

#include "page_style.h"
#include "shown_text.h"
#include "trocar/base/assert.h"
#include "trocar/host/translate.h"
#include "trocar/report/document.h"

namespace trocar::report {
namespace {

constexpr double kWide = 700;  // drawings wider than this take the whole width [px]

std::string_view ClassOf(Tone tone) {
  constexpr std::string_view kNames[] = {"", "good", "caution", "bad", "muted"};
  return kNames[static_cast<std::size_t>(tone)];
}

std::string ClassAttribute(std::string_view first, Tone tone) {
  std::string names(first);
  if (tone != Tone::kPlain) names += (names.empty() ? "" : " ") + std::string(ClassOf(tone));
  return names.empty() ? "" : " class=\"" + names + "\"";
}

class PageWriter {
 public:
  std::string Take() && { return std::move(html_); }
  void Raw(std::string_view text) { html_ += text; }
  void Text(std::string_view text) { html_ += EscapeShown(text); }
  /// An element with a text in it. \param tag  with attributes: "p class=\"muted\""
  void Element(const std::string& tag, std::string_view text) {
    html_ += "<" + tag + ">";
    Text(text);
    html_ += "</" + tag.substr(0, tag.find(' ')) + ">";
  }

  void Write(const Paragraph& paragraph) {
    Element("p" + ClassAttribute("", paragraph.tone), paragraph.text);
    Raw("\n");
  }

  void Write(const Tiles& tiles) {
    Raw("<ul class=\"tiles\">\n");
    for (const Tiles::Tile& tile : tiles.tiles) {
      Raw("<li" + ClassAttribute("", tile.tone) + ">");
      Element("span class=\"label\"", tile.label);
      Raw(" ");
      Element("span class=\"value\"", tile.value);
      Raw(" ");
      Element("span class=\"note\"", tile.note);
      Raw("</li>\n");
    }
    Raw("</ul>\n");
  }

  void Write(const Facts& facts) { WriteFacts(facts.rows); }

  void WriteFacts(const std::vector<std::pair<std::string, std::string>>& rows) {
    Raw("<dl>\n");
    for (const auto& [name, value] : rows) {
      Element("dt", name);
      Element("dd", value);
      Raw("\n");
    }
    Raw("</dl>\n");
  }

  void Write(const Table& table) {
    // a table that is too wide is scrolled, by the keyboard, too
    Raw("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"");
    Text(table.caption);
    Raw("\"><table>\n");
    Element("caption", table.caption);
    Raw("\n<thead><tr>");
    for (const Table::Column& column : table.columns)
      Element(std::string("th scope=\"col\"") + (column.is_number ? " class=\"number\"" : ""), column.name);
    Raw("</tr></thead>\n<tbody>\n");
    for (const std::vector<Cell>& row : table.rows) {
      Raw("<tr>");
      for (std::size_t i = 0; i < row.size(); ++i) {
        const std::string style = ClassAttribute(table.columns[i].is_number ? "number" : "", row[i].tone);
        Element((i == 0 ? "th scope=\"row\"" : "td") + style, row[i].text);
      }
      Raw("</tr>\n");
    }
    Raw("</tbody></table></div>\n");
  }

  void Write(const Figures& figures) {
    Raw(figures.drawings.size() == 1 ? "<div class=\"figures one\">\n" : "<div class=\"figures\">\n");
    for (const Drawing& drawing : figures.drawings) {
      Raw(drawing.width > kWide ? "<figure class=\"wide\">" : "<figure>");
      Element("figcaption", drawing.title);
      Raw("\n" + FormatSvg(drawing, "plot" + std::to_string(++drawings_)));
      Raw("</figure>\n");
    }
    Raw("</div>\n");
  }

  void Write(const Pictures& pictures) {
    Raw("<div class=\"pictures\">\n");
    for (const Picture& picture : pictures.pictures) {
      Raw("<figure><img alt=\"");
      Text(picture.caption);
      Raw("\" src=\"data:image/png;base64," + EncodeBase64(picture.png) + "\">");
      Element("figcaption", picture.caption);
      Raw("</figure>\n");
    }
    Raw("</div>\n");
  }

  void Write(const Advices& advices) {
    Raw("<ol class=\"advice\">\n");
    for (const Advices::Item& item : advices.items) {
      Raw("<li><p class=\"what\">");
      Text(item.sentence);
      if (!item.moment.empty()) {
        Raw(" ");
        Element("span class=\"moment\"", item.moment);
      }
      Raw("</p>\n");
      if (!item.why.empty()) Element("p", item.why);
      if (!item.practise.empty()) {
        Raw("<p class=\"do\">");
        Element("b", host::Translate("Practise:"));
        Raw(" ");
        Text(item.practise);
        Raw("</p>");
      }
      Raw("</li>\n");
    }
    Raw("</ol>\n");
  }

  void Write(const Film& film) {
    // "./": a name can be no address
    Raw("<figure class=\"film\"><video controls preload=\"metadata\" src=\"./");
    Text(film.file);
    Raw("\"></video><figcaption><a href=\"./");
    Text(film.file);
    Raw("\">");
    Text(film.file);
    Raw("</a></figcaption></figure>\n");
  }

 private:
  std::string html_;
  int drawings_ = 0;
};

bool HasFilm(const Document& document) {
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      if (std::holds_alternative<Film>(block)) return true;
    }
  }
  return false;
}

/// Nothing runs and nothing is fetched: even what got past the escaping could do nothing.
std::string FormatPolicy(const std::string& style, bool has_film) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash;
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(style.data()), style.size());
  const std::string digest(reinterpret_cast<const char*>(hash.data()), hash.size());
  return "default-src 'none'; img-src data:; style-src 'sha256-" + EncodeBase64(digest) + "'" +
         (has_film ? "; media-src 'self' file:" : "") + "; base-uri 'none'; form-action 'none'";
}

}  // namespace

std::string EncodeBase64(std::string_view bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                    bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // its terminating zero
  return text;
}

std::string FormatHtml(const Document& document) {
  const std::string style = FormatPageStyle();
  PageWriter page;
  page.Raw("<!DOCTYPE html>\n<html lang=\"" + host::Translate("en") +
           "\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
           FormatPolicy(style, HasFilm(document)) +
           "\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta name=\"referrer\" content=\"no-referrer\">\n");
  page.Element("title", document.title + " – Trocar");
  page.Raw("\n<style>" + style + "</style>\n</head>\n<body>\n<header><div>");
  page.Element("p", document.subtitle);
  page.Element("h1", document.title);
  page.Raw("</div>\n");
  page.WriteFacts(document.head);
  page.Raw("</header>\n<main>\n");
  for (std::size_t i = 0; i < document.sections.size(); ++i) {
    const std::string id = "section" + std::to_string(i + 1);
    page.Raw("<section aria-labelledby=\"" + id + "\">\n");
    page.Element("h2 id=\"" + id + "\"", document.sections[i].title);
    page.Raw("\n");
    for (const Block& block : document.sections[i].blocks)
      std::visit([&](const auto& one) { page.Write(one); }, block);
    page.Raw("</section>\n");
  }
  page.Raw("</main>\n");
  page.Element("footer", document.footer);
  page.Raw("\n</body>\n</html>\n");
  return std::move(page).Take();
}

}  // namespace trocar::report
