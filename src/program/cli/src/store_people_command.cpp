// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <utility>
#include <vector>

#include "command.h"
#include "console.h"
#include "store_console.h"
#include "trocar/report/xapi.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/names.h"

namespace trocar::cli {

using host::Say;

namespace {

using nlohmann::ordered_json;

void SayDone(const StoreOptions& options) {
  options.is_json ? PrintStoreJson({{"done", true}}) : Say("done\n");
}

void AddAddTrainee(CLI::App& trainee, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command = trainee.add_subcommand("add", "Add a person under a pseudonym");
  struct Arguments {
    std::string name, pseudonym, role = "trainee";
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--name", arguments->name,
                      "Kept in a file on this computer alone, that only you can read");
  command->add_option("--pseudonym", arguments->pseudonym, "Else one is made, such as T-7F3K2Q");
  command->add_option("--role", arguments->role, "trainee, instructor or administrator")
      ->capture_default_str();
  OnStore(*command, options, outcome, [options, arguments](StoreSession& session) -> base::Status {
    const auto role = store::ParseRole(arguments->role);
    if (!role.ok()) return role.error();
    if (!arguments->name.empty()) {
      if (auto sound = store::CheckName(arguments->name); !sound.ok()) return sound;
    }
    const auto person = AddPerson(session.store, session.viewer, *role, arguments->pseudonym);
    if (!person.ok()) return person.error();
    if (!arguments->name.empty()) {
      if (auto kept =
              store::SetName(session.store.GetPlace().NamesFile(), person->pseudonym, arguments->name);
          !kept.ok())
        return kept;
    }
    options->is_json ? PrintStoreJson({{"pseudonym", JsonText(person->pseudonym)}, {"role", arguments->role}})
                     : host::PrintLine(Shown(person->pseudonym));
    return {};
  });
}

void AddList(CLI::App& trainee, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* command =
      trainee.add_subcommand("list", "List people, with their names where this computer knows them");
  struct Arguments {
    int limit = 100;
    std::string after;
  };
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--limit", arguments->limit, "How many")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--after", arguments->after, "Go on behind this one")->type_name("PSEUDONYM");
  OnStore(*command, options, outcome, [options, arguments](StoreSession& session) -> base::Status {
    const auto people = ListPeople(session.store, session.viewer, arguments->after, arguments->limit);
    if (!people.ok()) return people.error();
    // whoever asks under a role is shown pseudonyms
    store::Names names;
    if (options->viewer.empty()) {
      auto read = store::ReadNames(session.store.GetPlace().NamesFile());
      if (!read.ok()) return read.error();
      names = std::move(*read);
    }
    const auto name_of = [&](const store::Person& person) {
      const auto found = names.find(person.pseudonym);
      return found == names.end() ? std::string() : found->second;
    };
    if (options->is_json) {
      ordered_json json = ordered_json::array();
      for (const store::Person& person : *people) {
        const std::string name = name_of(person);
        ordered_json groups = ordered_json::array();
        for (const std::string& group : person.groups) groups.push_back(JsonText(group));
        json.push_back({{"pseudonym", JsonText(person.pseudonym)},
                        {"name", name.empty() ? ordered_json() : JsonText(name)},
                        {"role", store::RoleName(person.role)},
                        {"groups", std::move(groups)}});
      }
      PrintStoreJson(json);
      return {};
    }
    std::vector<std::vector<std::string>> rows = {{"pseudonym", "role", "groups", "name"}};
    for (const store::Person& person : *people) {
      std::string groups;
      for (const std::string& group : person.groups) groups += (groups.empty() ? "" : ", ") + Shown(group);
      rows.push_back({Shown(person.pseudonym), host::Translate(store::RoleName(person.role)),
                      groups.empty() ? "-" : groups, Shown(name_of(person))});
    }
    people->empty() ? Say("nobody\n") : host::PrintTable(rows);
    if (people->size() == static_cast<std::size_t>(arguments->limit))
      Say("more: --after {1}\n", Shown(people->back().pseudonym));
    return {};
  });
}

void AddChange(CLI::App& trainee, const SharedStoreOptions& options, Outcome& outcome) {
  struct Arguments {
    std::string pseudonym, to, name, role;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* rename = trainee.add_subcommand("rename", "Give another pseudonym, name or role");
  rename->add_option("pseudonym", arguments->pseudonym, "Who")->required()->type_name("PSEUDONYM");
  rename->add_option("--to", arguments->to, "New pseudonym")->type_name("PSEUDONYM");
  rename->add_option("--name", arguments->name, "New name, on this computer alone");
  rename->add_option("--role", arguments->role, "trainee, instructor or administrator");
  OnStore(*rename, options, outcome, [arguments, options](StoreSession& session) -> base::Status {
    const auto names = session.store.GetPlace().NamesFile();
    if (auto may = MayManage(session.viewer); !may.ok()) return may;
    if (!arguments->name.empty()) {
      if (auto sound = store::CheckName(arguments->name); !sound.ok()) return sound;
    }
    if (!arguments->to.empty()) {
      if (auto sound = store::CheckPseudonym(arguments->to); !sound.ok()) return sound;
    }
    if (const auto person = FindPerson(session.store, arguments->pseudonym); !person.ok())
      return person.error();
    if (!arguments->role.empty()) {
      const auto role = store::ParseRole(arguments->role);
      if (!role.ok()) return role.error();
      if (auto set = SetRole(session.store, session.viewer, arguments->pseudonym, *role); !set.ok())
        return set;
    }
    if (!arguments->name.empty()) {
      if (auto set = store::SetName(names, arguments->pseudonym, arguments->name); !set.ok()) return set;
    }
    if (!arguments->to.empty()) {
      if (auto renamed = RenamePerson(session.store, session.viewer, arguments->pseudonym, arguments->to);
          !renamed.ok())
        return renamed;
      if (auto moved = store::MoveName(names, arguments->pseudonym, arguments->to); !moved.ok()) return moved;
    }
    SayDone(*options);
    return {};
  });
}

void AddErase(CLI::App& trainee, const SharedStoreOptions& options, Outcome& outcome) {
  struct Arguments {
    std::string pseudonym, folder;
    bool is_sure = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* exporting = trainee.add_subcommand(
      "export", "Write all that is known of a person, with their recordings, to a new folder");
  exporting->add_option("pseudonym", arguments->pseudonym, "Who")->required()->type_name("PSEUDONYM");
  exporting->add_option("-o,--output", arguments->folder, "New folder")->required()->type_name("DIR");
  OnStore(*exporting, options, outcome, [arguments, options](StoreSession& session) -> base::Status {
    const auto copied = ExportPerson(session.store, session.viewer, arguments->pseudonym, arguments->folder);
    if (!copied.ok()) return copied.error();
    options->is_json ? PrintStoreJson({{"folder", arguments->folder}, {"recordings", *copied}})
                     : Say("{1} holds person.json and {2} recordings\n", arguments->folder, *copied);
    return {};
  });
  CLI::App* erase = trainee.add_subcommand(
      "erase",
      "Remove a person for ever: rows, recordings, waiting attempts, name, and the bytes they leave behind");
  erase->add_option("pseudonym", arguments->pseudonym, "Who")->required()->type_name("PSEUDONYM");
  erase->add_flag("--yes", arguments->is_sure, "Do it: nothing brings them back");
  OnStore(*erase, options, outcome, [arguments, options](StoreSession& session) -> base::Status {
    if (!arguments->is_sure)
      return base::Error{base::ErrorCode::kUsage, "this removes a person for ever; add --yes to do it"};
    auto report = ErasePerson(session.store, session.viewer, arguments->pseudonym);
    if (!report.ok()) return report.error();
    // statements for a learning record store that have not been delivered
    const auto queue = report::XapiQueue(report::XapiQueue::FindFolder()).Erase(arguments->pseudonym);
    report->left.insert(report->left.end(), queue.left.begin(), queue.left.end());
    if (options->is_json) {
      PrintStoreJson({{"attempts", report->attempts},
                      {"recordings", report->recordings},
                      {"waiting", report->spooled},
                      {"statements", queue.statements},
                      {"left", report->left},
                      {"backups", report->backups}});
      return {};
    }
    Say("erased: {1} attempts, {2} recordings, {3} waiting attempts, {4} waiting statements\n",
        report->attempts, report->recordings, report->spooled, queue.statements);
    for (const std::string& left : report->left) Say("not erased here: {1}\n", left);
    for (const std::string& backup : report->backups)
      Say("this backup still holds them; delete it and make a new one: {1}\n", backup);
    return {};
  });
}

void AddGroups(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* group = parent.add_subcommand("group", "Groups of people, such as a course's participants");
  group->require_subcommand(1);
  auto name = std::make_shared<std::string>(), person = std::make_shared<std::string>();
  CLI::App* add = group->add_subcommand("add", "Make a group");
  add->add_option("group", *name, "Its name")->required();
  OnStore(*add, options, outcome, [name, options](StoreSession& session) -> base::Status {
    const auto added = AddGroup(session.store, session.viewer, *name);
    if (!added.ok()) return added.error();
    SayDone(*options);
    return {};
  });
  CLI::App* list = group->add_subcommand("list", "List groups");
  OnStore(*list, options, outcome, [options](StoreSession& session) -> base::Status {
    const auto groups = ListGroups(session.store, session.viewer);
    if (!groups.ok()) return groups.error();
    ordered_json json = ordered_json::array();
    std::vector<std::vector<std::string>> rows = {{"group", "members"}};
    for (const store::Group& entry : *groups) {
      json.push_back({{"group", JsonText(entry.name)}, {"members", entry.members}});
      rows.push_back({Shown(entry.name), std::to_string(entry.members)});
    }
    if (options->is_json)
      PrintStoreJson(json);
    else
      groups->empty() ? Say("no groups\n") : host::PrintTable(rows);
    return {};
  });
  const auto add_membership = [&](const char* word, const char* help, auto change) {
    CLI::App* command = group->add_subcommand(word, help);
    command->add_option("group", *name, "Which group")->required();
    command->add_option("pseudonym", *person, "Who")->required();
    OnStore(*command, options, outcome,
            [name, person, change, options](StoreSession& session) -> base::Status {
              auto done = change(session.store, session.viewer, *name, *person);
              if (done.ok()) SayDone(*options);
              return done;
            });
  };
  add_membership("join", "Put a person into a group", store::JoinGroup);
  add_membership("leave", "Take a person out of a group", store::LeaveGroup);
}

}  // namespace

void AddStorePeopleCommands(CLI::App& parent, const SharedStoreOptions& options, Outcome& outcome) {
  CLI::App* trainee =
      parent.add_subcommand("trainee", "People: trainees, and instructors and administrators, too");
  trainee->require_subcommand(1);
  AddAddTrainee(*trainee, options, outcome);
  AddList(*trainee, options, outcome);
  AddChange(*trainee, options, outcome);
  AddErase(*trainee, options, outcome);
  AddGroups(parent, options, outcome);
}

}  // namespace trocar::cli
