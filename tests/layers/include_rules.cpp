// SPDX-License-Identifier: Apache-2.0
#include "include_rules.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "trocar/core/safe_file.h"

namespace trocar::layers {
namespace {

namespace fs = std::filesystem;

/// Beginnings of third-party headers that a public header must not show to those who include it.
constexpr std::array<std::string_view, 18> kPrivateLibraries = {
    "GL/",  "epoxy/", "EGL/",   "gtk",  "glib",   "gst/", "nlohmann/",     "CLI/",     "itk",
    "gdcm", "png.h",  "spdlog", "tbb/", "oneapi", "cuda", "meshoptimizer", "iostream", "Eigen/"};

constexpr std::string_view kOnly = "only";

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
  const core::Result<std::string> text = core::ReadFile(file);
  if (!text) breaches.push_back({name, 0, text.error().Text()});
  std::istringstream stream(text ? *text : std::string());
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void CheckFile(const Layers& layers, const fs::path& source, const fs::path& path,
               std::vector<Breach>& breaches) {
  const std::string name = fs::relative(path, source).generic_string();
  const std::string module = name.substr(0, name.find('/'));
  const auto seen = layers.find(module);
  if (seen == layers.end()) {
    breaches.push_back({name, 0, "\"" + module + "\" is no module of the layers"});
    return;
  }
  const bool is_public = name.find("/include/") != std::string::npos;
  int number = 0;
  for (const std::string& line : ReadLines(path, name, breaches)) {
    ++number;
    const std::string_view include = FindInclude(line);
    if (include.empty()) continue;
    if (include.starts_with("trocar/")) {
      const std::string other(include.substr(7, include.find('/', 7) - 7));
      if (!seen->second.contains(other))
        breaches.push_back({name, number, module + " must not see " + other});
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

std::vector<fs::path> FindSources(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cpp")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

core::Result<Layers> ParseLayers(std::string_view text) {
  Layers layers;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string module, arrow, other;
    if (!(words >> module) || module == kOnly) continue;
    const auto complain = [&](const std::string& what) {
      return core::Error{core::ErrorCode::kJsonField, "layers, line " + std::to_string(number) + ": " + what};
    };
    if (!(words >> arrow) || arrow != "->") return complain("expected MODULE -> MODULES");
    if (layers.contains(module)) return complain(module + " has a line already");
    std::set<std::string> seen = {module};
    while (words >> other) {
      const auto found = layers.find(other);
      if (found == layers.end()) return complain(other + " has no line above this one");
      seen.insert(found->second.begin(), found->second.end());
    }
    layers[module] = std::move(seen);
  }
  return layers;
}

core::Result<std::vector<Restriction>> ParseRestrictions(std::string_view text) {
  std::vector<Restriction> restrictions;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string only, colon, name;
    Restriction restriction;
    if (!(words >> only) || only != kOnly) continue;
    if (!(words >> restriction.folder >> colon) || colon != ":") {
      return core::Error{core::ErrorCode::kJsonField,
                         "layers, line " + std::to_string(number) + ": expected only FOLDER : NAMES"};
    }
    while (words >> name) restriction.seen.insert(name);
    restrictions.push_back(std::move(restriction));
  }
  return restrictions;
}

std::vector<Breach> FindBreaches(const Layers& layers, const fs::path& source) {
  std::vector<Breach> breaches;
  for (const fs::path& file : FindSources(source)) CheckFile(layers, source, file, breaches);
  return breaches;
}

std::vector<Breach> FindBreachesOfModule(const Layers& layers, const fs::path& root,
                                         const std::string& module, int* looked_at) {
  const std::vector<fs::path> files = FindSources(root / module);
  if (looked_at != nullptr) *looked_at = static_cast<int>(files.size());
  std::vector<Breach> breaches;
  for (const fs::path& file : files) CheckFile(layers, root, file, breaches);
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

}  // namespace trocar::layers
