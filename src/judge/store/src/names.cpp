// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/names.h"

#include <sys/stat.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "database.h"
#include "private_file.h"
#include "trocar/host/file_lock.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/people.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

base::Status Change(const fs::path& path, const std::function<void(Names&)>& change) {
  if (auto made = MakePrivateFolder(path.parent_path()); !made.ok()) return made;
  const auto lock = host::FileLock::Take(path.string() + ".lock");
  if (!lock.ok()) return lock.error();
  auto names = ReadNames(path);
  if (!names.ok()) return names.error();
  change(*names);
  nlohmann::ordered_json json = {
      {"format", "trocar-names"}, {"version", 1}, {"names", nlohmann::ordered_json::object()}};
  for (const auto& [pseudonym, name] : *names) json["names"][EncodeText(pseudonym)] = EncodeText(name);
  std::error_code failure;
  if (names->empty() && !fs::exists(path, failure)) return {};
  // the new file takes another place on the disk: what stood in the old one is overwritten first
  const std::string text = host::FormatJson(json, 1) + "\n";
  if (fs::exists(path, failure)) {
    const fs::path old = path.string() + ".old";
    fs::remove(old, failure);
    fs::create_hard_link(path, old, failure);
    const bool has_old = !failure;
    if (auto written = WritePrivateFile(path, text); !written.ok()) {
      if (has_old) fs::remove(old, failure);
      return written;
    }
    return has_old ? EraseFile(old) : base::Status();
  }
  return WritePrivateFile(path, text);
}

}  // namespace

base::Result<Names> ReadNames(const fs::path& path) {
  Names names;
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return names;
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return base::Error{
        base::ErrorCode::kStoreRefused,
        path.string() + ": others may read the names; put that right with: chmod 600 " + path.string()};
  const auto text = host::ReadFile(path);
  if (!text.ok()) return text.error();
  const auto json = host::JsonDocument::Parse(*text, path.string());
  if (!json.ok()) return json.error();
  const host::JsonView root = json->Root();
  root.AllowOnly({"format", "version", "names"});
  const host::JsonView all = root.Object("names");
  for (const std::string& key : all.Keys()) names[DecodeText(key)] = DecodeText(all.Text(key));
  if (auto sound = json->Check(); !sound.ok()) return sound.error();
  return names;
}

base::Status SetName(const fs::path& path, std::string_view pseudonym, std::string_view name) {
  if (!name.empty()) {
    if (auto sound = CheckName(name); !sound.ok()) return sound;
  }
  return Change(path, [&](Names& names) {
    if (name.empty())
      names.erase(std::string(pseudonym));
    else
      names[std::string(pseudonym)] = name;
  });
}

base::Status MoveName(const fs::path& path, std::string_view from, std::string_view to) {
  return Change(path, [&](Names& names) {
    const auto found = names.find(from);
    if (found == names.end()) return;
    std::string name = std::move(found->second);
    names.erase(found);
    names[std::string(to)] = std::move(name);
  });
}

}  // namespace trocar::store
