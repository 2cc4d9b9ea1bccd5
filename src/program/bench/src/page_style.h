// SPDX-License-Identifier: Apache-2.0
/// \file page_style.h  How the pages of `trocar reproduce` look.
#pragma once

namespace trocar::bench {

inline constexpr const char* kPageStyle = R"(
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1d2327; background: #fff; margin: 0 auto;
  max-width: 60rem; padding: 1.5rem; }
h1 { font-size: 1.7rem; margin: 0; } h2 { font-size: 1.2rem; margin: 2.2rem 0 .3rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; margin: .5rem 0; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #dcdcde; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.pass { color: #00693e; } .fail { color: #a4161a; font-weight: 600; } .limit { color: #8a5a00; }
svg { width: 100%; height: auto; background: #fafafa; border: 1px solid #dcdcde; }
)";

/// Of a plot, on a page or in a file of its own.
inline constexpr const char* kPlotStyle = R"(
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: #1d2327; }
svg .title { font-size: 14px; font-weight: 600; } svg .mark { font-size: 11px; fill: #50575e; }
svg .grid { stroke: #dcdcde; } svg .line { fill: none; stroke-width: 1.8; }
)";

}  // namespace trocar::bench
