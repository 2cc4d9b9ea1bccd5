// SPDX-License-Identifier: Apache-2.0
#include "look.h"

#include <gtkmm.h>

namespace trocar::app {
namespace {

constexpr const char* kStyle = R"css(
window.trocar { background: #14171a; color: #dfe5ea; }
.trocar headerbar { background: #1b1f24; border-bottom: 1px solid #2b3138; box-shadow: none; min-height: 44px; }
.trocar headerbar .title { font-weight: 700; }
.trocar headerbar button { padding: 4px 12px; min-height: 26px; }
.trocar button { background: #2a3038; color: #dfe5ea; border: 1px solid #39414b; box-shadow: none; text-shadow: none; }
.trocar button:hover { background: #343c46; }
.trocar button:checked { background: #1f5a66; border-color: #2f8696; color: #eafcff; }
.trocar button.small { padding: 0 8px; min-height: 20px; font-size: 12px; }
.trocar button:disabled { color: #6d7680; background: #20252b; }
.trocar button.primary { background: #1d7a8c; border-color: #2b9cb1; color: #ffffff; font-weight: 700; }
.trocar button.primary:hover { background: #238fa3; }
.trocar button.primary:disabled { background: #20252b; border-color: #39414b; color: #6d7680; }
.trocar windowcontrols button { background: transparent; border: none; padding: 4px; min-width: 24px; }
.trocar .panel { background: #14171a; }
.trocar .card { background: #1d2228; border: 1px solid #2a3037; border-radius: 8px; padding: 7px 12px 8px 12px; }
.trocar .card-title { color: #7fd0de; font-weight: 700; font-size: 12px; letter-spacing: 0.5px; }
.trocar .name { color: #a9b3bd; font-size: 13px; }
.trocar .value { color: #f1f5f8; font-size: 13px; font-feature-settings: "tnum"; }
.trocar .fine { color: #8d98a3; font-size: 12px; }
.trocar .hand { font-weight: 700; font-size: 13px; color: #dfe5ea; }
.trocar .hand.chosen { color: #7fe3f2; }
.trocar .force { font-weight: 700; font-size: 20px; font-feature-settings: "tnum"; color: #8fe0a8; }
.trocar .force.warning { color: #ffc24d; }
.trocar .force.danger { color: #ff6b5e; }
.trocar .stage { font-size: 12px; font-feature-settings: "tnum"; }
.trocar scale { padding: 0 8px; min-height: 18px; }
.trocar scale trough { background: #343b44; min-height: 4px; border: none; }
.trocar scale highlight { background: #2b9cb1; border: none; min-height: 4px; margin: 0; }
.trocar scale slider { background: #dfe5ea; min-width: 14px; min-height: 14px; margin: -5px;
  border: none; box-shadow: none; }
.trocar dropdown button { padding: 2px 8px; min-height: 24px; font-size: 13px; }
.trocar list { background: #171b20; border-radius: 6px; }
.trocar list row { padding: 3px 8px; border-radius: 6px; }
.trocar list row:selected { background: #1f5a66; }
.trocar .picture { background: #000000; }
.trocar .keys { color: #9aa5b0; font-size: 12px; padding: 5px 10px; background: #191d21; border-top: 1px solid #262c32; }
.trocar .status { background: #1b1f24; border-top: 1px solid #2b3138; padding: 5px 12px; font-size: 13px; }
.trocar .status .warning { color: #ffc24d; }
.trocar .status .numbers { color: #a9b3bd; font-feature-settings: "tnum"; }
.trocar .hint { background: rgba(12, 15, 18, 0.78); color: #eef3f6; border-radius: 14px; padding: 6px 16px;
  font-size: 13px; margin-bottom: 14px; }
.trocar .badge { background: rgba(12, 15, 18, 0.72); color: #eef3f6; border-radius: 10px; padding: 4px 12px;
  font-size: 13px; margin: 12px; }
.trocar .help { background: rgba(18, 22, 26, 0.95); border: 1px solid #36404a; border-radius: 12px; padding: 16px 22px; }
.trocar .help .card-title { font-size: 13px; margin-top: 6px; }
.trocar .help .key { color: #ffffff; font-weight: 700; font-size: 13px; }
.trocar .help .meaning { color: #c3ccd4; font-size: 13px; }
.trocar .failure { background: #24191a; border: 1px solid #7a3b38; border-radius: 12px; padding: 20px 26px; }
.trocar .failure .code { color: #ff8a7e; font-weight: 700; font-size: 16px; }
.trocar .failure .text { color: #f3e6e5; font-size: 14px; }
.trocar .hint.warning { color: #ffd48a; }
.trocar .note { color: #ffb45c; font-size: 12px; }
.trocar button.organ { padding: 3px 10px; min-height: 24px; background: #20262d; border-color: #2a3037; }
.trocar button.organ:checked { background: #234049; border-color: #2f8696; }
.trocar .bar { padding: 7px 14px; border-bottom: 1px solid #3b3032; font-size: 13px; }
.trocar .bar.error { background: #3a2022; color: #f6e4e2; }
.trocar .bar.error .code { color: #ff8a7e; font-weight: 700; }
.trocar .bar.notice { background: #1d3136; color: #e4f4f6; }
.trocar .bar.question { background: #33301f; color: #f6f0dc; }
.trocar progressbar trough { background: #343b44; min-height: 4px; border: none; }
.trocar progressbar progress { background: #2b9cb1; min-height: 4px; min-width: 2px; border: none; margin: 0; }
tooltip { background: #2a3038; color: #f1f5f8; border: 1px solid #434c57; }
)css";

}  // namespace

void ApplyLook() {
  Gtk::Settings::get_default()->property_gtk_application_prefer_dark_theme() = true;
  const auto style = Gtk::CssProvider::create();
  style->load_from_data(kStyle);
  Gtk::StyleContext::add_provider_for_display(Gdk::Display::get_default(), style,
                                              GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
}

}  // namespace trocar::app
