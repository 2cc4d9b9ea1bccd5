// SPDX-License-Identifier: Apache-2.0
/// \file hostile_documents.h  Texts that an ill-willed, broken or careless program may hand to a reader of JSON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trocar::json_doors {

struct HostileDocument {
  std::string name, text;
  bool is_json = false;  ///< within all limits: a door may find nothing wrong with it
};

/// At least a hundred, the same each time.
std::vector<HostileDocument> MakeHostileDocuments();

/// A good text of a door with single values replaced, taken away and doubled: all are JSON, hardly one is what the door expects.
/// \param most  documents
std::vector<HostileDocument> MutateSample(std::string_view sample, std::size_t most);

}  // namespace trocar::json_doors
