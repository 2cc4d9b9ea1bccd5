// SPDX-License-Identifier: Apache-2.0
#include "include_rules.h"

#include <algorithm>
#include <array>
#include <regex>
#include <sstream>
#include <utility>

#include "trocar/host/safe_file.h"

namespace trocar::layers {
namespace {

namespace fs = std::filesystem;

/// Beginnings of third-party headers that a public header must not show to those who include it.
constexpr std::array<std::string_view, 18> kPrivateLibraries = {
    "GL/",  "epoxy/", "EGL/",   "gtk",  "glib",   "gst/", "nlohmann/",     "CLI/",     "itk",
    "gdcm", "png.h",  "spdlog", "tbb/", "oneapi", "cuda", "meshoptimizer", "iostream", "Eigen/"};

/// Where an include in quotes leads: beside the file, or below a folder above it, as with a module's private headers.
fs::path FindOwnHeader(const fs::path& source, const fs::path& file, std::string_view include) {
  for (fs::path folder = file.parent_path(); folder != source && folder.has_relative_path();
       folder = folder.parent_path()) {
    if (fs::exists(folder / include)) return fs::relative(folder / include, source);
  }
  return {};
}

/// The word between the quotes or brackets of an include line, or nothing.
std::string_view FindInclude(std::string_view line) {
  const auto skip_blanks = [&] { line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size())); };
  skip_blanks();
  if (!line.starts_with('#')) return {};
  line.remove_prefix(1);
  skip_blanks();
  if (!line.starts_with("include")) return {};
  line.remove_prefix(7);
  skip_blanks();
  if (line.empty() || (line.front() != '"' && line.front() != '<')) return {};
  const std::size_t end = line.find(line.front() == '"' ? '"' : '>', 1);
  return end == std::string_view::npos ? std::string_view{} : line.substr(1, end - 1);
}

/// Lines of a file; none and a breach where it cannot be read.
std::vector<std::string> ReadLines(const fs::path& file, const std::string& name,
                                   std::vector<Breach>& breaches) {
  std::vector<std::string> lines;
  const base::Result<std::string> text = host::ReadFile(file);
  if (!text) breaches.push_back({name, 0, text.error().Text()});
  std::istringstream stream(text ? *text : std::string());
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<fs::path> FindSources(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Wing of each module: the folder of `source` in which it stands.
std::map<std::string, std::string> FindWings(const fs::path& source) {
  std::map<std::string, std::string> wings;
  if (!fs::exists(source)) return wings;
  for (const fs::directory_entry& wing : fs::directory_iterator(source)) {
    if (!wing.is_directory()) continue;
    for (const fs::directory_entry& module : fs::directory_iterator(wing.path())) {
      if (module.is_directory()) wings[module.path().filename().string()] = wing.path().filename().string();
    }
  }
  return wings;
}

/// Includes of one file, held against the rules of its module and wing.
class FileCheck {
 public:
  FileCheck(const Rules& rules, std::map<std::string, std::string> wings)
      : rules_(rules), wings_(std::move(wings)) {}

  /// \param name  of the file in complaints and debts
  void Check(const fs::path& path, const std::string& name, const std::string& wing,
             const std::string& module, std::vector<Breach>& breaches) {
    const auto seen = rules_.modules.find(module);
    const auto seen_wings = rules_.wings.find(wing);
    if (seen == rules_.modules.end())
      return breaches.push_back({name, 0, "\"" + module + "\" is no module of the layers"});
    if (seen_wings == rules_.wings.end())
      return breaches.push_back({name, 0, "\"" + wing + "\" is no wing of the layers"});
    const bool is_public = name.find("/include/") != std::string::npos;
    const bool is_test = name.find("/test/") != std::string::npos;
    int number = 0;
    for (const std::string& line : ReadLines(path, name, breaches)) {
      ++number;
      const std::string_view include = FindInclude(line);
      if (include.starts_with("trocar/")) {
        const std::string header(include.substr(7));
        const std::string other = header.substr(0, header.find('/'));
        const bool is_tested = is_test && Sees(rules_.tests, module, other);
        if (!seen->second.contains(other) && !is_tested) {
          breaches.push_back({name, number, module + " must not see " + other});
          continue;
        }
        const auto other_wing = wings_.find(other);
        if (is_tested || other_wing == wings_.end() || seen_wings->second.contains(other_wing->second))
          continue;
        if (rules_.debts.contains({name, header})) {
          paid_.insert({name, header});
        } else {
          breaches.push_back(
              {name, number,
               "the wing " + wing + " must not see " + other_wing->second + " (" + header + ")"});
        }
      } else if (include.find("../") != std::string_view::npos) {
        breaches.push_back({name, number, "an include that climbs out of its folder"});
      } else if (is_public) {
        const bool is_private =
            std::any_of(kPrivateLibraries.begin(), kPrivateLibraries.end(),
                        [&](std::string_view prefix) { return include.starts_with(prefix); });
        if (is_private)
          breaches.push_back({name, number, "a public header must not show " + std::string(include)});
      }
    }
  }

  /// Debts that were met, so that those that are not are found.
  const std::set<Debt>& Paid() const { return paid_; }

 private:
  /// Tests see what is named for them, and what that sees.
  bool Sees(const std::map<std::string, std::set<std::string>>& tests, const std::string& module,
            const std::string& other) const {
    const auto named = tests.find(module);
    if (named == tests.end()) return false;
    return std::any_of(named->second.begin(), named->second.end(),
                       [&](const std::string& one) { return rules_.modules.at(one).contains(other); });
  }

  const Rules& rules_;
  std::map<std::string, std::string> wings_;
  std::set<Debt> paid_;
};

}  // namespace

base::Result<Rules> ParseRules(std::string_view text) {
  Rules rules;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    const auto complain = [&](const std::string& what) {
      return base::Error{base::ErrorCode::kJsonField, "layers, line " + std::to_string(number) + ": " + what};
    };
    std::string kind, name, arrow;
    if (!(words >> kind)) continue;
    const bool has_kind = kind == "wing" || kind == "tests" || kind == "only" || kind == "owes";
    if (!has_kind) name = std::exchange(kind, "module");
    const bool is_layer = kind == "wing" || kind == "module";
    if ((has_kind && !(words >> name)) || !(words >> arrow) || arrow != (is_layer ? "->" : ":"))
      return complain(is_layer ? "expected NAME -> NAMES" : "expected " + kind + " NAME : NAMES");
    std::vector<std::string> others;
    for (std::string other; words >> other;) others.push_back(other);
    if (is_layer) {
      Layers& layers = kind == "wing" ? rules.wings : rules.modules;
      if (layers.contains(name)) return complain(name + " has a line already");
      std::set<std::string> seen = {name};
      for (const std::string& other : others) {
        const auto found = layers.find(other);
        if (found == layers.end()) return complain(other + " has no line above this one");
        seen.insert(found->second.begin(), found->second.end());
      }
      layers[name] = std::move(seen);
    } else if (kind == "tests") {
      for (const std::string& other : others) {
        if (!rules.modules.contains(other)) return complain(other + " is no module");
        rules.tests[name].insert(other);
      }
    } else if (kind == "only") {
      rules.restrictions.push_back({name, {others.begin(), others.end()}});
    } else {
      for (const std::string& other : others) rules.debts.insert({name, other});
    }
  }
  return rules;
}

std::vector<Breach> FindBreaches(const Rules& rules, const fs::path& source) {
  std::vector<Breach> breaches;
  FileCheck check(rules, FindWings(source));
  for (const fs::path& file : FindSources(source)) {
    const fs::path name = fs::relative(file, source);
    auto part = name.begin();
    const std::string wing = (part++)->string(), module = part->string();
    check.Check(file, name.generic_string(), wing, module, breaches);
  }
  for (const Debt& debt : rules.debts) {
    if (!check.Paid().contains(debt))
      breaches.push_back({debt.first, 0, "owes " + debt.second + " no more; take it off the list"});
  }
  return breaches;
}

std::vector<Breach> FindBreachesOfModule(const Rules& rules, const fs::path& source, const fs::path& root,
                                         const std::string& module, const std::string& wing, int* looked_at) {
  const std::vector<fs::path> files = FindSources(root / module);
  if (looked_at != nullptr) *looked_at = static_cast<int>(files.size());
  std::vector<Breach> breaches;
  FileCheck check(rules, FindWings(source));
  for (const fs::path& file : files)
    check.Check(file, fs::relative(file, root).generic_string(), wing, module, breaches);
  return breaches;
}

std::vector<Breach> FindBreaches(const Restriction& restriction, const fs::path& source) {
  const fs::path folder = source / restriction.folder;
  const auto files = fs::exists(folder) ? FindSources(folder) : std::vector<fs::path>{};
  std::vector<Breach> breaches;
  if (files.empty()) breaches.push_back({restriction.folder, 0, "no source is there"});
  for (const fs::path& file : files) {
    const std::string name = fs::relative(file, source).generic_string();
    if (name.find("/test/") != std::string::npos) continue;
    int number = 0;
    for (const std::string& line : ReadLines(file, name, breaches)) {
      ++number;
      const std::string_view include = FindInclude(line);
      const bool is_quoted = line.find('"') != std::string::npos;
      if (include.empty() || (!include.starts_with("trocar/") && !is_quoted)) continue;
      const std::string header(include.starts_with("trocar/") ? include.substr(7) : include);
      const bool is_named =
          restriction.seen.contains(header) || restriction.seen.contains(header.substr(0, header.find('/')));
      const std::string own = FindOwnHeader(source, file, include).generic_string();
      const bool is_own = own.starts_with(restriction.folder + "/");
      if (include.starts_with("trocar/") ? !is_named : !is_own)
        breaches.push_back({name, number, restriction.folder + " must not see " + std::string(include)});
    }
  }
  return breaches;
}

std::vector<Breach> FindIncludes(const std::vector<std::string>& prefixes, const fs::path& folder) {
  std::vector<Breach> breaches;
  for (const fs::path& file : FindSources(folder)) {
    const std::string name = fs::relative(file, folder).generic_string();
    if (name.find("/test/") != std::string::npos) continue;
    int number = 0;
    for (const std::string& line : ReadLines(file, name, breaches)) {
      ++number;
      const std::string_view include = FindInclude(line);
      const bool is_meant = std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
        return prefix.ends_with('/') ? include.starts_with(prefix) : include == prefix;
      });
      if (is_meant) breaches.push_back({name, number, std::string(include)});
    }
  }
  return breaches;
}

std::vector<Breach> FindCalls(const std::string& function, const fs::path& folder) {
  std::vector<Breach> breaches;
  for (const fs::path& file : FindSources(folder)) {
    const std::string name = fs::relative(file, folder).generic_string();
    int number = 0;
    for (const std::string& line : ReadLines(file, name, breaches)) {
      ++number;
      if (line.find(function + "()") != std::string::npos)
        breaches.push_back({name, number, "calls " + function});
    }
  }
  return breaches;
}

std::vector<Breach> FindReExports(const fs::path& folder) {
  static const std::regex kDeclaration(R"(using (\w+::)+\w+;.*)");
  std::vector<Breach> breaches;
  for (const fs::path& file : FindSources(folder)) {
    const std::string stem = file.stem().string();
    if (file.extension() != ".h" || stem.ends_with("_lanes")) continue;
    const std::string name = fs::relative(file, folder).generic_string();
    int number = 0;
    for (const std::string& line : ReadLines(file, name, breaches)) {
      ++number;
      if (std::regex_match(line, kDeclaration)) breaches.push_back({name, number, line});
    }
  }
  return breaches;
}

}  // namespace trocar::layers
