// SPDX-License-Identifier: Apache-2.0
/// \file home.h  The page that the program opens with: who you are, and what you can train.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "trocar/base/result.h"
#include "trocar/presenter/window_settings.h"

namespace trocar::presenter {

enum class HomeChoice {
  kContinue,
  kNextStep,    ///< of the person's course
  kLastResult,  ///< of the person
  kTutorial,
  kBasicSkills,
  kOperation,  ///< and its parts
  kPatients,
  kResults,
  kRecordings,
  kKeys
};

/// What leads a person on, with a picture.
struct HomeLead {
  std::string title, about;
  std::filesystem::path picture;  ///< empty: none
};

struct HomePage {
  std::string who;              ///< "Anna Berg", "Nobody in particular"
  std::string patient;          ///< who is operated on: "the built-in patient"
  std::string last_title = "";  ///< "Go on" where something is open, else "Once more": it begins anew
  std::string last;             ///< of it: "Peg transfer, normal"; empty: nothing was trained
  std::string tutorial;         ///< "Start", "Go on: 3 of 10", "Again"
  std::optional<HomeLead> next, result;  ///< of kNextStep and kLastResult; nothing where there is none
  bool is_tutorial_suggested = false;    ///< nothing has been trained here yet
  std::optional<base::Error> problem;    ///< what could not be opened; the page leads on
};

struct HomeEntry {
  HomeChoice choice;
  const char *title, *about;
};
/// In the order of the page.
std::span<const HomeEntry> HomeEntries() noexcept;

HomePage MakeHomePage(const WindowSettings& settings, const std::string& who,
                      const std::optional<base::Error>& problem);

}  // namespace trocar::presenter
