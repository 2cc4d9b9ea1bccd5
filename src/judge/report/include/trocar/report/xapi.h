// SPDX-License-Identifier: Apache-2.0
/// \file xapi.h  An attempt as statements for a learning record store, and the queue in which they wait on the disk.
/// Source: Experience API (xAPI) 1.0.3, adlnet/xAPI-Spec.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/report/attempt_report.h"

namespace trocar::report {

struct XapiSettings {
  /// Of the accounts, an address of the training centre: "https://training.hospital.example". Nobody needs to answer there.
  std::string home_page;
  std::optional<bool> is_passed;  ///< by the centre's thresholds; nothing: neither passed nor failed is said
};

struct XapiStatement {
  std::string id;    ///< UUID; the same attempt gives the same, so that what is sent twice arrives once
  std::string json;  ///< one object in one line
};

/// "attempted", then "completed" or "terminated", "scored" where there is a score, "passed" or "failed" where it is known. The actor is
/// an account of the pseudonym; there is no name, no address and no path of a file.
/// \return kUsage where there is no pseudonym, or home_page is no http or https address
base::Result<std::vector<XapiStatement>> MakeStatements(const AttemptReport& report,
                                                        const XapiSettings& settings);

/// Result of erasing one person's statements.
struct XapiErasure {
  std::size_t statements = 0;  ///< that were taken away
  /// Files and folders that could not be read or removed, and may hold statements of that person; texts for a person.
  std::vector<std::string> left;
};

/// Statements that wait, one file each: ID.json. What Add returned for survives a power cut.
class XapiQueue {
 public:
  explicit XapiQueue(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// "xapi" in the user's data folder.
  static std::filesystem::path FindFolder();

  const std::filesystem::path& Folder() const { return folder_; }
  /// One that waits already is left as it is.
  /// \return kFileUnwritable
  base::Status Add(const XapiStatement& statement);
  /// Waiting statements, the oldest first; files that are none are left out.
  std::vector<XapiStatement> List() const;
  /// Files of statements that a store refused for good, each with its reason beside it (ID.json, ID.txt).
  std::vector<std::filesystem::path> ListRefused() const;
  base::Status Remove(const std::string& id);
  base::Status Refuse(const XapiStatement& statement, const std::string& reason);
  /// Takes away everything of one person, waiting, refused or half written. What it cannot read or remove stops it nowhere, and is
  /// named.
  XapiErasure Erase(const std::string& pseudonym);

 private:
  std::filesystem::path folder_;
};

}  // namespace trocar::report
