// SPDX-License-Identifier: Apache-2.0
/// \file access.h  Which store the pages read, and who sits in front of them.
#pragma once

#include <string>

#include "trocar/base/result.h"
#include "trocar/store/people.h"
#include "trocar/store/store.h"

namespace trocar::centre {

struct Access {
  store::Place place;
  store::StoreSettings settings;
  std::string person;  ///< pseudonym of who works here; empty: nobody has said
};

/// A store that is open for one person.
struct Desk {
  store::Store store;
  store::Viewer viewer;
};

/// Where nobody has said who they are, whoever holds the file or the database's account looks: the owner.
/// \return the store's error; kStoreUnknown where it does not know the person
/// \note Blocks for up to StoreSettings::answer_seconds: not on the window's thread.
base::Result<Desk> OpenDesk(const Access& access);

/// Turns what somebody typed into a pseudonym: one that is there, the one behind which a name stands in the names' file, or a new
/// trainee's, whose name is kept in that file and nowhere else.
/// \param text  empty: nobody in particular
/// \return the store's error; kStoreUnknown for what looks like a pseudonym and is none
base::Result<std::string> FindPseudonym(const Access& access, const std::string& text);

/// The name that this computer knows, else the pseudonym; "Nobody in particular" of an empty one.
std::string NameOf(const Access& access, const std::string& pseudonym);

}  // namespace trocar::centre
