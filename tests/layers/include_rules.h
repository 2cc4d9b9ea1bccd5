// SPDX-License-Identifier: Apache-2.0
/// \file include_rules.h  Which wing and which module may include which, and who breaks it.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::layers {

/// For each name, every name that it sees: itself, those in its line, and what those see.
using Layers = std::map<std::string, std::set<std::string>>;

/// A folder whose files see less than their module does.
struct Restriction {
  std::string folder;          ///< relative to src/: "procedure/agent"
  std::set<std::string> seen;  ///< modules ("math") and single headers ("tissue/rest_frame.h")
};

/// A file that reaches through the wall of its wing, and the header that it reaches for.
using Debt = std::pair<std::string, std::string>;

struct Rules {
  Layers wings, modules;
  std::map<std::string, std::set<std::string>> tests;  ///< modules that a module's tests see besides
  std::vector<Restriction> restrictions;
  std::set<Debt> debts;
};

/// Reads lines; "#" begins a comment:
///   wing NAME -> NAMES               a folder of src/, and the wings that it sees
///   NAME -> NAMES                    a module, and the modules that it sees
///   tests NAME : NAMES               modules that the module's tests see besides
///   only FOLDER : NAMES              modules and headers that a folder sees at most
///   owes FILE : HEADERS              headers of wings that the file's wing does not see
/// \return kJsonField with the line when it is malformed, or names what no earlier line has (so no cycle passes)
base::Result<Rules> ParseRules(std::string_view text);

/// A line that breaks a rule.
struct Breach {
  std::string file;  ///< relative to the source folder
  int line = 0;
  std::string what;
};

/// Looks at every .h and .cpp below `source`, a folder of wings with modules in them (src/).
///
/// A file includes headers of modules that its module sees, and of those only such as stand in wings that its wing sees, or that it
/// owes; each debt is one that is still owed; a folder of a folder of `source` is a module; a public header includes no header
/// of a graphics or window library, device SDK or file format.
std::vector<Breach> FindBreaches(const Rules& rules, const std::filesystem::path& source);

/// The same for a module outside of `source`, the folder `module` of `root`, as one of the wing.
/// \param[out] looked_at  how many files there were
std::vector<Breach> FindBreachesOfModule(const Rules& rules, const std::filesystem::path& source,
                                         const std::filesystem::path& root, const std::string& module,
                                         const std::string& wing, int* looked_at = nullptr);

/// Looks at every .h and .cpp below a restricted folder but for its tests: each include of ours is one that the
/// restriction names, or a file of the folder itself. A folder without files is a breach, too.
std::vector<Breach> FindBreaches(const Restriction& restriction, const std::filesystem::path& source);

/// Includes that begin with one of the prefixes, in every .h and .cpp below `folder` but for tests; Breach::what is the include.
std::vector<Breach> FindIncludes(const std::vector<std::string>& prefixes,
                                 const std::filesystem::path& folder);

/// Calls of a function without arguments in every .h and .cpp below `folder`.
std::vector<Breach> FindCalls(const std::string& function, const std::filesystem::path& folder);

/// Names of other namespaces that a header puts into its own, "using math::Vec3;" in the first column, in every .h below `folder`
/// but for headers named *_lanes.h, whose overload sets the kernels of one source file complete.
std::vector<Breach> FindReExports(const std::filesystem::path& folder);

}  // namespace trocar::layers
