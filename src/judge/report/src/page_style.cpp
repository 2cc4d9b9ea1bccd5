// SPDX-License-Identifier: Apache-2.0
#include "page_style.h"

#include <cstdio>

#include "palette.h"

namespace trocar::report {
namespace {

constexpr const char* kRules = R"(
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { font: 15px/1.5 Inter, "Source Sans 3", "Segoe UI", system-ui, "DejaVu Sans", sans-serif; color: var(--text);
  background: var(--paper); margin: 0 auto; max-width: 66rem; padding: 2.2rem 1.6rem 3rem; font-variant-numeric: tabular-nums; }
header { border-top: .38rem solid var(--accent); padding-top: 1rem; display: grid; gap: .4rem 2rem; margin-bottom: 1.4rem;
  grid-template-columns: minmax(16rem, 1fr) auto; align-items: end; border-bottom: 1px solid var(--rule); padding-bottom: 1rem; }
header p { margin: 0; color: var(--accent); font-weight: 600; font-size: .82rem; letter-spacing: .05em; text-transform: uppercase; }
h1 { font-size: 1.9rem; line-height: 1.15; margin: .15rem 0 0; letter-spacing: -.015em; overflow-wrap: anywhere; }
h2 { font-size: 1.16rem; margin: 2.3rem 0 .7rem; color: var(--accent); letter-spacing: -.005em; }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: .15rem 1.1rem; margin: 0; }
dt { color: var(--muted); } dd { margin: 0; overflow-wrap: anywhere; } header dl { font-size: .9rem; } header dd { font-weight: 600; }
p { margin: .5rem 0; max-width: 48rem; }
p.muted { color: var(--muted); font-size: .86rem; }
p.good, p.caution, p.bad { font-size: 1.06rem; border-left: .28rem solid; padding: .1rem 0 .1rem .8rem; color: var(--text); }
p.good { border-color: var(--good); } p.caution { border-color: var(--major); } p.bad { border-color: var(--critical); }
ul.tiles { list-style: none; display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .7rem; margin: 1rem 0; padding: 0; }
ul.tiles li { background: var(--soft); border-radius: .45rem; padding: .7rem .9rem; border-top: .18rem solid var(--rule); }
ul.tiles .label { display: block; color: var(--muted); font-size: .8rem; }
ul.tiles .value { display: block; font-size: 1.5rem; font-weight: 650; line-height: 1.25; letter-spacing: -.01em; }
ul.tiles .note { display: block; color: var(--muted); font-size: .78rem; }
li.good .value { color: var(--good); } li.caution .value { color: var(--major); } li.bad .value { color: var(--critical); }
li.good { border-color: var(--good) !important; } li.caution { border-color: var(--major) !important; } li.bad { border-color: var(--critical) !important; }
ol.advice { margin: 0; padding: 0; list-style: none; counter-reset: advice; display: grid; gap: .7rem; }
ol.advice li { counter-increment: advice; display: grid; grid-template-columns: 2.1rem 1fr; background: var(--soft); border-radius: .45rem; padding: .8rem 1rem .8rem .8rem; }
ol.advice li::before { content: counter(advice); font-size: 1.25rem; font-weight: 650; color: var(--accent); grid-row: 1 / span 3; }
ol.advice p { margin: 0 0 .2rem; grid-column: 2; } ol.advice .what { font-weight: 600; }
ol.advice .moment { font-weight: 600; color: var(--accent); white-space: nowrap; }
ol.advice .do b { color: var(--good); }
.scroll { overflow-x: auto; margin: .9rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; }
caption { text-align: left; font-weight: 600; padding: .2rem 0 .35rem; }
thead th { color: var(--muted); font-weight: 600; font-size: .8rem; border-bottom: 1.5px solid var(--muted); vertical-align: bottom; }
th, td { text-align: left; padding: .3rem .7rem .3rem 0; border-bottom: 1px solid var(--rule); vertical-align: top; }
th:last-child, td:last-child { padding-right: 0; }
tbody th { font-weight: 500; }
.number { text-align: right; white-space: nowrap; }
td.good, th.good { color: var(--good); } td.caution, th.caution { color: var(--major); font-weight: 600; } td.bad, th.bad { color: var(--critical); font-weight: 650; }
td.muted, th.muted { color: var(--muted); font-size: .93em; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1.2rem 1.6rem; margin: .9rem 0; }
figure { margin: 0; min-width: 0; } .figures.one figure:not(.wide) { max-width: 32rem; }
.figures figure.wide { grid-column: 1 / -1; }
figcaption { font-weight: 600; font-size: .9rem; padding-bottom: .3rem; }
.pictures figcaption, .film figcaption { font-weight: 400; color: var(--muted); padding: .3rem 0 0; font-size: .85rem; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 18rem), 1fr)); gap: 1rem; margin: .9rem 0; }
.pictures img, video { width: 100%; display: block; border-radius: .3rem; background: #000; }
svg { display: block; width: 100%; height: auto; font-family: inherit; }
figure.wide { overflow-x: auto; } figure.wide svg { min-width: 40rem; }
svg path[class^="l-"] { fill: none; stroke-linejoin: round; stroke-linecap: round; }
svg [class^="m-"] { stroke: var(--paper); stroke-width: 1; }
footer { margin-top: 2.6rem; border-top: 1px solid var(--rule); padding-top: .6rem; color: var(--muted); font-size: .8rem; }
@media (max-width: 40rem) { header { grid-template-columns: 1fr; } body { padding: 1.2rem 1rem; } h1 { font-size: 1.5rem; } }
)";

// paper is white whatever the screen is
constexpr const char* kPrint = R"(
@page { size: A4; margin: 14mm 15mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 9.6pt; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  h2 { break-after: avoid; } figure, li, tr { break-inside: avoid; } .scroll, figure.wide { overflow: visible; }
  thead { display: table-header-group; }
  .figures { grid-template-columns: 1fr 1fr; } .figures.one { grid-template-columns: 1fr; }
}
)";

std::string Hex(std::uint32_t colour) {
  char text[16];
  std::snprintf(text, sizeof text, "#%06x", static_cast<unsigned>(colour));
  return text;
}

std::string Variables(bool is_dark) {
  const auto pick = [&](TwoColours colours) { return Hex(is_dark ? colours.dark : colours.light); };
  std::string css = ":root { color-scheme: " + std::string(is_dark ? "dark" : "light") +
                    "; --paper: " + pick(kPaper) + "; --accent: " + pick(kAccent) +
                    "; --soft: " + pick(kSoft) + "; --rule: " + pick(kRule) + ";";
  for (int i = 1; i < static_cast<int>(Ink::kCount); ++i) {
    const auto ink = static_cast<Ink>(i);
    css += " --" + std::string(NameOf(ink)) + ": " + pick(ColoursOf(ink)) + ";";
  }
  return css + " }\n";
}

}  // namespace

std::string FormatPageStyle() {
  std::string css = "\n" + Variables(false) + "@media screen and (prefers-color-scheme: dark) {\n" +
                    Variables(true) + "}\n";
  for (int i = 1; i < static_cast<int>(Ink::kCount); ++i) {
    const std::string name(NameOf(static_cast<Ink>(i)));
    css += ".l-" + name + " { stroke: var(--" + name + "); } .a-" + name + ", .m-" + name + ", .t-" + name +
           " { fill: var(--" + name + "); }\n";
  }
  return css + kRules + kPrint;
}

}  // namespace trocar::report
