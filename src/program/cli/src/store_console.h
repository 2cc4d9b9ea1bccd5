// SPDX-License-Identifier: Apache-2.0
// Functions that the commands below `trocar store` share.
#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "command.h"
#include "trocar/host/printable.h"
#include "trocar/record/recording.h"
#include "trocar/store/attempts.h"
#include "trocar/store/people.h"
#include "trocar/store/store.h"

namespace trocar::cli {

/// Options that each command of `trocar store` takes.
struct StoreOptions {
  std::string url, viewer;  // empty: the default store, its owner
  bool is_json = false;
};

using SharedStoreOptions = std::shared_ptr<StoreOptions>;

/// The open store and who asks.
struct StoreSession {
  store::Store store;
  store::Viewer viewer;
};

/// Opens the store, and says what was done to it where it was damaged.
base::Result<StoreSession> OpenSession(const StoreOptions& options, store::StoreSettings settings = {});

void AddStoreOptions(CLI::App& command, const SharedStoreOptions& options);

/// A command that works on an open store, with the options above.
using StoreWork = std::function<base::Status(StoreSession&)>;
void OnStore(CLI::App& command, const SharedStoreOptions& options, Outcome& outcome, StoreWork work);

/// `trainee` and `group`.
void AddStorePeopleCommands(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome);

/// How `trocar store verify --attempts` goes about it.
struct ReplayArguments {
  bool is_wanted = false, accepts = false;
  int threads = 1;
};
base::Status ReplayAttempts(StoreSession& session, const ReplayArguments& arguments, bool is_json,
                            Outcome& outcome);
/// A recording as an attempt, replayed with a progress bar.
base::Result<store::Attempt> ReplayHere(record::Recording recording, const std::string& file, int threads,
                                        const char* label);

void PrintStoreJson(const nlohmann::ordered_json& json);

/// Text of somebody else for the terminal.
inline std::string Shown(const std::string& text) {
  return host::Printable(text, 60);
}
/// Text of somebody else for JSON, which holds UTF-8 alone.
inline nlohmann::ordered_json JsonText(const std::string& text) {
  return text;  // printed with the error handler that replaces what is no UTF-8
}

}  // namespace trocar::cli
