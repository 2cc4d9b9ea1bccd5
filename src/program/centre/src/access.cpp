// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/access.h"

#include <utility>

#include "trocar/host/translate.h"
#include "trocar/store/names.h"

namespace trocar::centre {
namespace {

using store::Viewer;

/// "T-7F3K2Q": a letter of a role and a hyphen.
bool LooksLikePseudonym(const std::string& text) {
  return text.size() > 2 && text[1] == '-' && (text[0] == 'T' || text[0] == 'I' || text[0] == 'A') &&
         text.find(' ') == std::string::npos;
}

}  // namespace

base::Result<Desk> OpenDesk(const Access& access) {
  auto opened = store::Store::Open(access.place, access.settings);
  if (!opened.ok()) return opened.error();
  if (access.person.empty()) return Desk{std::move(*opened), Viewer::Owner()};
  const auto viewer = store::FindViewer(*opened, access.person);
  if (!viewer.ok()) return viewer.error();
  return Desk{std::move(*opened), *viewer};
}

base::Result<std::string> FindPseudonym(const Access& access, const std::string& text) {
  if (text.empty()) return text;
  const auto names = store::ReadNames(access.place.NamesFile());
  if (!names.ok()) return names.error();
  if (names->contains(text)) return text;
  for (const auto& [pseudonym, name] : *names) {
    if (name == text) return pseudonym;
  }
  auto opened = store::Store::Open(access.place, access.settings);
  if (!opened.ok()) return opened.error();
  const auto known = store::FindPerson(*opened, text);
  if (known.ok()) return known->pseudonym;
  if (known.error().code != base::ErrorCode::kStoreUnknown || LooksLikePseudonym(text)) return known.error();
  if (const auto sound = store::CheckName(text); !sound.ok()) return sound.error();
  const auto added = store::AddPerson(*opened, Viewer::Owner(), store::Role::kTrainee);
  if (!added.ok()) return added.error();
  if (const auto named = store::SetName(access.place.NamesFile(), added->pseudonym, text); !named.ok())
    return named.error();
  return added->pseudonym;
}

std::string NameOf(const Access& access, const std::string& pseudonym) {
  if (pseudonym.empty()) return host::Translate("Nobody in particular");
  const auto names = store::ReadNames(access.place.NamesFile());
  if (!names.ok()) return pseudonym;
  const auto found = names->find(pseudonym);
  return found == names->end() ? pseudonym : found->second;
}

}  // namespace trocar::centre
