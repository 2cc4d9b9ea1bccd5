// SPDX-License-Identifier: Apache-2.0
/// \file layout_window_check.cpp  Reads what --check-layout wrote: every page was there, nothing is cut off or off the window, and no
/// Spanish page has English words.
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace {

constexpr std::size_t kFewestPages = 16, kFewestWidgets = 12;

/// Words of English that are no Spanish ones, in lower case.
const std::set<std::string> kEnglish = {
    "the",   "of",   "and",  "with",  "you",   "your", "what",   "this",   "that",  "which", "from",    "for",
    "click", "hold", "hand", "task",  "press", "none", "no-one", "until",  "is",    "are",   "where",   "who",
    "open",  "save", "new",  "level", "seed",  "time", "score",  "errors", "start", "close", "patient", "to"};

/// Names that are English in every language: of people, programs, files and commands.
bool IsName(const std::string& text) {
  // rating forms keep their published titles, which the Spanish explains
  for (const char* title : {"Global Operative Assessment of", "Objective Structured Assessment of"}) {
    if (text.find(title) == 0) return true;
  }
  for (const char* name : {"Visible Human", "3D Slicer", ".trocar", "trocar ", "DICOM"}) {
    if (text.find(name) != std::string::npos) return true;
  }
  return false;
}

/// Words of a text that are English; short texts need one, so that "No" and "a" of both languages do not count.
std::vector<std::string> FindEnglish(const std::string& text) {
  std::vector<std::string> found;
  std::string word;
  for (const char c : text + " ") {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else {
      if (kEnglish.contains(word)) found.push_back(word);
      word.clear();
    }
  }
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  int faults = 0, pages = 0, widgets = 0, english_in_english = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    std::ifstream file(name);
    const auto report = nlohmann::json::parse(file, nullptr, false);
    if (!report.is_object()) {
      std::printf("%s is no report\n", argv[i]);
      return 1;
    }
    const bool is_spanish = name.ends_with("_es.json");
    const std::string where = name.substr(name.find_last_of('/') + 1);
    if (report["pages"].size() < kFewestPages) {
      std::printf("%s: only %zu pages\n", where.c_str(), report["pages"].size());
      ++faults;
    }
    for (const auto& page : report["pages"]) {
      const std::string title = where + ", " + page["page"].get<std::string>();
      ++pages;
      widgets += page["widgets"].get<int>();
      if (!page["there"].get<bool>() || page["widgets"].get<std::size_t>() < kFewestWidgets) {
        std::printf("%s: was not seen\n", title.c_str());
        ++faults;
      }
      for (const auto& misfit : page["misfits"]) {
        ++faults;
        std::printf("%s: %s, %d pixels: \"%s\" %s\n", title.c_str(),
                    misfit["what"].get<std::string>().c_str(), misfit["pixels"].get<int>(),
                    misfit["text"].get<std::string>().c_str(), misfit["widget"].get<std::string>().c_str());
      }
      for (const auto& text : page["texts"]) {
        const auto words = FindEnglish(text.get<std::string>());
        if (!is_spanish) {
          english_in_english += static_cast<int>(words.size());
          continue;
        }
        if (words.empty() || IsName(text.get<std::string>())) continue;
        ++faults;
        std::printf("%s: English (%s): \"%s\"\n", title.c_str(), words[0].c_str(),
                    text.get<std::string>().c_str());
      }
    }
  }
  std::printf("%d reports, %d pages, %d widgets: %d faults\n", argc - 1, pages, widgets, faults);
  // a control: the words are found where they are
  if (english_in_english < 100) {
    std::printf("the English pages have hardly an English word: nothing was looked at\n");
    return 1;
  }
  return faults == 0 ? 0 : 1;
}
