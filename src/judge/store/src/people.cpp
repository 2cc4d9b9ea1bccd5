// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/people.h"

#include <sodium.h>

#include <utility>

#include "database.h"
#include "sql.h"

namespace trocar::store {
namespace {

constexpr std::string_view kLetters = "23456789ABCDEFGHJKMNPQRSTUVWXYZ";
constexpr std::size_t kPseudonymLetters = 6;
constexpr std::size_t kLongestPseudonym = 200, kLongestName = 200, kLongestGroup = 1000;  // [bytes]

base::Error NoPerson() {
  return Unknown("the store knows no such trainee; trocar store trainee list shows whom it knows");
}
base::Error NoGroup() {
  return Unknown("the store knows no such group; trocar store group list shows which it knows");
}

/// What is wrong with a text that people read in lists, on certificates and in files; empty where nothing is.
std::string ComplainOfText(std::string_view text, std::size_t longest) {
  if (text.empty() || text.size() > longest) return "has 1 to " + std::to_string(longest) + " bytes";
  if (EncodeText(text) != text) return "is UTF-8 without NUL";
  const auto has = [&](std::string_view bytes) { return text.find(bytes) != std::string_view::npos; };
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) return "has no control characters and no line ends";
  }
  for (unsigned char c = 0x80; c < 0xA0; ++c) {
    const char control[] = {'\xC2', static_cast<char>(c)};
    if (has({control, 2})) return "has no control characters and no line ends";
  }
  // U+200B to U+200F, U+2028 to U+202E, U+2060 to U+2069, U+FEFF: not to be seen, or they turn what is read
  const auto has_range = [&](char second, unsigned from, unsigned to) {
    for (unsigned c = from; c <= to; ++c) {
      const char bytes[] = {'\xE2', second, static_cast<char>(c)};
      if (has({bytes, 3})) return true;
    }
    return false;
  };
  if (has_range('\x80', 0x8B, 0x8F) || has_range('\x80', 0xA8, 0xAE) || has_range('\x81', 0xA0, 0xA9) ||
      has("\xEF\xBB\xBF"))
    return "has no characters that are not to be seen or turn the direction of writing";
  if (text.front() == ' ' || text.back() == ' ') return "begins and ends with no space";
  return "";
}

}  // namespace

base::Status CheckPseudonym(std::string_view text) {
  std::string why = ComplainOfText(text, kLongestPseudonym);
  if (why.empty() && (text.find_first_of("/\\") != std::string_view::npos || text == "." || text == ".."))
    why = "is no part of a path: it has no / and no \\";
  if (why.empty() && text.front() == '-') why = "does not begin with -, as options do";
  return why.empty() ? base::Status() : Invalid("a pseudonym " + why + "; choose another, or none");
}

base::Status CheckName(std::string_view text) {
  std::string why = ComplainOfText(text, kLongestName);
  if (why.empty() && (text.find("../") != std::string_view::npos || text.front() == '/')) why = "is no path";
  return why.empty() ? base::Status() : Invalid("a name " + why + "; write it as the person does");
}

base::Status CheckGroupName(std::string_view text) {
  const std::string why = ComplainOfText(text, kLongestGroup);
  return why.empty() ? base::Status() : Invalid("a group's name " + why + "; choose another");
}

std::string MakePseudonym(Role role) {
  static constexpr std::string_view kOfRole = "TIA";
  [[maybe_unused]] const int started = ::sodium_init();  // again does nothing
  TROCAR_ASSERT(started >= 0);
  std::string pseudonym = {kOfRole[static_cast<std::size_t>(role)], '-'};
  for (std::size_t i = 0; i < kPseudonymLetters; ++i)
    pseudonym += kLetters[::randombytes_uniform(static_cast<std::uint32_t>(kLetters.size()))];
  return pseudonym;
}

std::string Put(Parameters& parameters, Value value) {
  parameters.push_back(std::move(value));
  return "$" + std::to_string(parameters.size());
}

std::string OnlyVisible(const Viewer& viewer, const std::string& column, Parameters& parameters) {
  if (viewer.role == Role::kAdministrator) return "";
  const std::string person = Put(parameters, viewer.person);
  if (viewer.role == Role::kTrainee) return " AND " + column + " = " + person;
  return " AND (" + column + " = " + person + " OR " + column +
         " IN (SELECT theirs.person_id FROM membership own JOIN membership theirs ON theirs.group_id = "
         "own.group_id "
         "WHERE own.person_id = " +
         person + "))";
}

base::Status MayManage(const Viewer& viewer) {
  if (viewer.role == Role::kAdministrator) return {};
  return Refused("only an administrator may do this");
}

base::Status MaySee(Store& store, const Viewer& viewer, std::int64_t person) {
  if (viewer.role == Role::kAdministrator || (viewer.person != 0 && viewer.person == person)) return {};
  if (viewer.role == Role::kTrainee) return Refused("a trainee sees only what is their own");
  const auto common = store.GetDatabase().Run(
      "SELECT 1 FROM membership own JOIN membership theirs ON theirs.group_id = own.group_id "
      "WHERE own.person_id = $1 AND theirs.person_id = $2 LIMIT 1",
      {viewer.person, person});
  if (!common.ok()) return common.error();
  if (common->rows.empty()) return Refused("an instructor sees only members of groups that they belong to");
  return {};
}

base::Result<Person> AddPerson(Store& store, const Viewer& viewer, Role role, std::string pseudonym) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  const bool is_given = !pseudonym.empty();
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    if (!is_given) pseudonym = MakePseudonym(role);
    if (auto sound = CheckPseudonym(pseudonym); !sound.ok()) return sound.error();
    const auto added = store.GetDatabase().Run(
        "INSERT INTO person (pseudonym, role, added_ms) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING RETURNING "
        "id",
        {pseudonym, std::string(RoleName(role)), NowMilliseconds()});
    if (!added.ok()) return added.error();
    if (!added->rows.empty()) return Person{added->rows[0].Int(0), std::move(pseudonym), role, {}};
    if (is_given) break;
  }
  return Invalid("this pseudonym is taken; choose another, or none");
}

base::Result<Person> FindPerson(Store& store, std::string_view pseudonym) {
  const auto found = store.GetDatabase().Run("SELECT id, pseudonym, role FROM person WHERE pseudonym = $1",
                                             {std::string(pseudonym)});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return NoPerson();
  const Row& row = found->rows[0];
  const auto role = ParseRole(row.Text(2));
  if (!role.ok()) return role.error();
  return Person{row.Int(0), row.Text(1), *role, {}};
}

base::Result<Viewer> FindViewer(Store& store, std::string_view pseudonym) {
  const auto person = FindPerson(store, pseudonym);
  if (!person.ok()) return person.error();
  return Viewer{person->id, person->role};
}

base::Status RenamePerson(Store& store, const Viewer& viewer, std::string_view pseudonym,
                          std::string_view to) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  if (auto sound = CheckPseudonym(to); !sound.ok()) return sound;
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const auto person = FindPerson(store, pseudonym);
    if (!person.ok()) return person.error();
    if (FindPerson(store, to).ok()) return Invalid("this pseudonym is taken; choose another");
    const auto changed =
        database.Run("UPDATE person SET pseudonym = $1 WHERE id = $2", {std::string(to), person->id});
    return changed.ok() ? base::Status() : changed.error();
  });
}

base::Status SetRole(Store& store, const Viewer& viewer, std::string_view pseudonym, Role role) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  const auto changed = store.GetDatabase().Run("UPDATE person SET role = $1 WHERE pseudonym = $2",
                                               {std::string(RoleName(role)), std::string(pseudonym)});
  if (!changed.ok()) return changed.error();
  if (changed->changed == 0) return NoPerson();
  return {};
}

base::Result<std::vector<Person>> ListPeople(Store& store, const Viewer& viewer, std::string_view after,
                                             int limit) {
  Parameters parameters{std::string(after), std::int64_t{limit}};
  const std::string visible = OnlyVisible(viewer, "person.id", parameters);
  const auto found = store.GetDatabase().Run(
      "SELECT page.id, page.pseudonym, page.role, training_group.name FROM (SELECT id, pseudonym, role FROM "
      "person "
      "WHERE pseudonym > $1" +
          visible +
          " ORDER BY pseudonym LIMIT $2) page LEFT JOIN membership ON membership.person_id = page.id "
          "LEFT JOIN training_group ON training_group.id = membership.group_id "
          "ORDER BY page.pseudonym, training_group.name",
      parameters);
  if (!found.ok()) return found.error();
  std::vector<Person> people;
  for (const Row& row : found->rows) {
    if (people.empty() || people.back().id != row.Int(0)) {
      const auto role = ParseRole(row.Text(2));
      if (!role.ok()) return role.error();
      people.push_back({row.Int(0), row.Text(1), *role, {}});
    }
    if (!row.IsNull(3)) people.back().groups.push_back(row.Text(3));
  }
  return people;
}

base::Result<Group> AddGroup(Store& store, const Viewer& viewer, std::string_view name) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  if (auto sound = CheckGroupName(name); !sound.ok()) return sound.error();
  const auto added = store.GetDatabase().Run(
      "INSERT INTO training_group (name, added_ms) VALUES ($1, $2) ON CONFLICT DO NOTHING RETURNING id",
      {std::string(name), NowMilliseconds()});
  if (!added.ok()) return added.error();
  if (added->rows.empty()) return Invalid("there is such a group already");
  return Group{added->rows[0].Int(0), std::string(name), 0};
}

base::Result<Group> FindGroup(Store& store, std::string_view name) {
  const auto found =
      store.GetDatabase().Run("SELECT id FROM training_group WHERE name = $1", {std::string(name)});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return NoGroup();
  return Group{found->rows[0].Int(0), std::string(name), 0};
}

base::Status JoinGroup(Store& store, const Viewer& viewer, std::string_view group,
                       std::string_view pseudonym) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const auto person = FindPerson(store, pseudonym);
    if (!person.ok()) return person.error();
    const auto found = FindGroup(store, group);
    if (!found.ok()) return found.error();
    const auto joined =
        database.Run("INSERT INTO membership (group_id, person_id) VALUES ($1, $2) ON CONFLICT DO NOTHING",
                     {found->id, person->id});
    return joined.ok() ? base::Status() : joined.error();
  });
}

base::Status LeaveGroup(Store& store, const Viewer& viewer, std::string_view group,
                        std::string_view pseudonym) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  const auto person = FindPerson(store, pseudonym);
  if (!person.ok()) return person.error();
  const auto found = FindGroup(store, group);
  if (!found.ok()) return found.error();
  const auto left = store.GetDatabase().Run("DELETE FROM membership WHERE group_id = $1 AND person_id = $2",
                                            {found->id, person->id});
  if (!left.ok()) return left.error();
  if (left->changed == 0) return Unknown("this person is not in that group");
  return {};
}

base::Result<std::vector<Group>> ListGroups(Store& store, const Viewer& viewer) {
  Parameters parameters;
  std::string only;
  if (viewer.role != Role::kAdministrator)
    only = " WHERE training_group.id IN (SELECT group_id FROM membership WHERE person_id = " +
           Put(parameters, viewer.person) + ")";
  const auto found = store.GetDatabase().Run(
      "SELECT training_group.id, training_group.name, COUNT(membership.person_id) FROM training_group LEFT "
      "JOIN "
      "membership ON membership.group_id = training_group.id" +
          only + " GROUP BY training_group.id, training_group.name ORDER BY training_group.name",
      parameters);
  if (!found.ok()) return found.error();
  std::vector<Group> groups;
  for (const Row& row : found->rows) groups.push_back({row.Int(0), row.Text(1), row.Int(2)});
  return groups;
}

}  // namespace trocar::store
