// SPDX-License-Identifier: Apache-2.0
/// \file people.h  Trainees, instructors and administrators by pseudonym, groups, and who belongs to which. Names lie elsewhere:
/// names.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/store/store.h"

namespace trocar::store {

struct Person {
  std::int64_t id = 0;
  std::string pseudonym;  ///< "T-7F3K2Q"
  Role role = Role::kTrainee;
  std::vector<std::string> groups;  ///< of ListPeople, in alphabetical order
};

/// Check a pseudonym, a name or a group's name: not empty, bounded, UTF-8, without control characters, line ends, or characters
/// that are invisible or turn the direction of writing. A pseudonym is no part of a path and no option; a name is no path.
/// \return kStoreInvalid
base::Status CheckPseudonym(std::string_view text);
base::Status CheckName(std::string_view text);
base::Status CheckGroupName(std::string_view text);

/// Letters and digits that are not mistaken for one another, at random, behind the role's letter: "T-7F3K2Q".
std::string MakePseudonym(Role role);

/// \param pseudonym  empty: one that is free
/// \return kStoreInvalid where it is taken, or longer than 200 bytes
base::Result<Person> AddPerson(Store& store, const Viewer& viewer, Role role, std::string pseudonym = {});
/// \return kStoreUnknown
base::Result<Person> FindPerson(Store& store, std::string_view pseudonym);
/// Another pseudonym for the same person.
base::Status RenamePerson(Store& store, const Viewer& viewer, std::string_view pseudonym,
                          std::string_view to);
base::Status SetRole(Store& store, const Viewer& viewer, std::string_view pseudonym, Role role);
/// People whom the viewer may see, by pseudonym. \param after  the last one of the page before; empty: from the first
base::Result<std::vector<Person>> ListPeople(Store& store, const Viewer& viewer, std::string_view after,
                                             int limit);
/// The viewer that a person is. \return kStoreUnknown
base::Result<Viewer> FindViewer(Store& store, std::string_view pseudonym);

struct Group {
  std::int64_t id = 0;
  std::string name;
  std::int64_t members = 0;
};

/// \return kStoreInvalid where there is one, or the name is empty or longer than 1000 bytes
base::Result<Group> AddGroup(Store& store, const Viewer& viewer, std::string_view name);
/// \return kStoreUnknown
base::Result<Group> FindGroup(Store& store, std::string_view name);
base::Status JoinGroup(Store& store, const Viewer& viewer, std::string_view group,
                       std::string_view pseudonym);
base::Status LeaveGroup(Store& store, const Viewer& viewer, std::string_view group,
                        std::string_view pseudonym);
/// Groups that the viewer belongs to; all groups for an administrator.
base::Result<std::vector<Group>> ListGroups(Store& store, const Viewer& viewer);

/// Whether the viewer may see what belongs to this person: it is the person, or an instructor of one of their groups.
/// \return kStoreRefused where not
base::Status MaySee(Store& store, const Viewer& viewer, std::int64_t person);
/// \return kStoreRefused unless an administrator
base::Status MayManage(const Viewer& viewer);

}  // namespace trocar::store
