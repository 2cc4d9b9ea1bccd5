// SPDX-License-Identifier: Apache-2.0
#include "layout_check.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::app {
namespace {

constexpr unsigned kPause = 250;  // between two looks [ms]
constexpr int kSettled = 3;       // looks after which a page is laid out
constexpr int kLongest = 240;     // looks in which a page has to be there

}  // namespace

LayoutCheck::LayoutCheck(std::vector<Page> pages, int width, int height, std::filesystem::path report)
    : pages_(std::move(pages)), width_(width), height_(height), report_(std::move(report)) {}

void LayoutCheck::Start(std::function<void(const base::Status&)> on_done) {
  on_done_ = std::move(on_done);
  Next();
}

void LayoutCheck::Next() {
  if (at_ == pages_.size()) return on_done_(Write());
  looks_ = 0;
  pages_[at_].open();
  Glib::signal_timeout().connect(sigc::mem_fun(*this, &LayoutCheck::Look), kPause);
}

bool LayoutCheck::Look() {
  const Page& page = pages_[at_];
  const bool is_there = !page.is_there || page.is_there();
  ++looks_;
  if (!is_there && looks_ < kLongest) return true;
  if (is_there && looks_ < kSettled) return true;
  Finding finding;
  finding.page = page.name;
  finding.is_there = is_there;
  if (Gtk::Window* window = page.window(); window != nullptr) {
    finding.width = window->get_width(), finding.height = window->get_height();
    finding.seen = gui::CountSeen(*window);
    finding.misfits = gui::FindMisfits(*window, width_, height_);
    finding.texts = gui::ListTexts(*window);
  }
  findings_.push_back(std::move(finding));
  ++at_;
  Next();
  return false;
}

base::Status LayoutCheck::Write() const {
  nlohmann::ordered_json pages = nlohmann::ordered_json::array();
  for (const Finding& finding : findings_) {
    nlohmann::ordered_json misfits = nlohmann::ordered_json::array();
    for (const gui::Misfit& one : finding.misfits)
      misfits.push_back(
          {{"what", one.what}, {"text", one.text}, {"pixels", one.excess}, {"widget", one.widget}});
    pages.push_back({{"page", finding.page},
                     {"there", finding.is_there},
                     {"width", finding.width},
                     {"height", finding.height},
                     {"widgets", finding.seen},
                     {"misfits", std::move(misfits)},
                     {"texts", finding.texts}});
  }
  const nlohmann::ordered_json json = {{"format", "trocar-layout"},
                                       {"version", 1},
                                       {"screen", {width_, height_}},
                                       {"pages", std::move(pages)}};
  return host::WriteFile(report_, host::FormatJson(json, 1) + "\n");
}

}  // namespace trocar::app
