// SPDX-License-Identifier: Apache-2.0
/// \file include_rules.h  Which module may include which, and who breaks it.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/core/result.h"

namespace trocar::layers {

/// For each module, every module it sees: itself, those named in its line, and what those see.
using Layers = std::map<std::string, std::set<std::string>>;

/// Reads lines "module -> module module"; "#" begins a comment; lines that begin with "only" are left out.
/// \return kJsonField with the line when it is malformed, or names a module that no earlier line has (so no
/// cycle passes)
core::Result<Layers> ParseLayers(std::string_view text);

/// A folder whose files see less than their module does.
struct Restriction {
  std::string folder;          ///< relative to the source folder: "session/src/agent"
  std::set<std::string> seen;  ///< modules ("math") and single headers ("tissue/rest_frame.h")
};

/// Reads the lines "only FOLDER : NAME NAME" of the same text.
/// \return kJsonField with the line when it is malformed
core::Result<std::vector<Restriction>> ParseRestrictions(std::string_view text);

/// A line that breaks a rule.
struct Breach {
  std::string file;  ///< relative to the source folder
  int line = 0;
  std::string what;
};

/// Looks at every .h and .cpp below `source`, a folder of modules (src/).
///
/// Rules: a file includes headers of modules it sees only; a folder of `source` is a module of the layers; a
/// public header includes no header of a graphics or window library, device SDK or file format.
std::vector<Breach> FindBreaches(const Layers& layers, const std::filesystem::path& source);
/// The same for one module, the folder `module` of `root`.
/// \param[out] looked_at  how many files there were
std::vector<Breach> FindBreachesOfModule(const Layers& layers, const std::filesystem::path& root,
                                         const std::string& module, int* looked_at = nullptr);

/// Looks at every .h and .cpp below a restricted folder but for its tests: each include of ours is one that the
/// restriction names, or a file of the folder itself. A folder without files is a breach, too.
std::vector<Breach> FindBreaches(const Restriction& restriction, const std::filesystem::path& source);

/// Calls of a function without arguments in every .h and .cpp below `folder`.
std::vector<Breach> FindCalls(const std::string& function, const std::filesystem::path& folder);

}  // namespace trocar::layers
