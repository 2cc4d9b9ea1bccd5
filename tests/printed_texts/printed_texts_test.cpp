// SPDX-License-Identifier: Apache-2.0
// Whatever a file, a name or a store holds: what trocar prints cannot steer a terminal, forges no line, and is JSON where JSON was asked for.
// The list of commands is the program's own. A new one gets hostile texts in all its places by itself, and has to say in Recipes() which
// files it reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "command_runs.h"
#include "hostile_places.h"
#include "judge/record/src/chunk.h"
#include "judge/record/src/recording_json.h"
#include "judge/store/src/database.h"
#include "trocar/cli/run_command.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/attempts.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/people.h"
#include "trocar/store/spool.h"
#include "trocar/training/trace_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::printed_texts {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const fs::path kRoot = TROCAR_SOURCE_DIR;

std::string Joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

void Write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(text.data(), static_cast<std::streamsize>(text.size()));
}

Json ReadJson(const fs::path& path) {
  const auto text = host::ReadFile(path, std::size_t{1} << 28);
  return text.ok() ? Json::parse(*text) : Json();
}

/// Where one command is tried: a folder whose name is hostile, too.
class Stage {
 public:
  explicit Stage(Words command) : command_(std::move(command)) {
    fs::create_directory(Folder());
    fs::create_directory(StoreFolder());
    for (const cli::CommandOption& option : cli::ListOptions(command_))
      has_json_ = has_json_ || option.name == "--json";
  }
  ~Stage() { std::printf("%-28s %4zu runs, %zu of them good\n", Joined(command_).c_str(), runs_, good_); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  fs::path Folder() const { return folder_.Path() / MakeHostileText(); }
  std::string Path(const std::string& name) const { return Folder() / name; }
  /// For a store, which lies in no path with a control character.
  fs::path StoreFolder() const { return folder_.Path() / "stores"; }
  /// With an empty folder for each run, so that nothing is there already. \param place  where the hostile text is
  void Run(const Words& arguments, const std::string& place) {
    Once(arguments, place, false);
    if (has_json_) Once(arguments, place, true);
  }
  /// From now on a run that takes long is ended and is no fault: what it has printed is looked at, not what it came to.
  void EndLongRuns() { ends_long_ = true; }
  /// A run of another command, to prepare. \return its output
  std::string Prepare(const Words& words) {
    const CommandRun run = RunInChild(words, folder_.Path());
    EXPECT_EQ(run.status, 0) << Joined(words) << "\n" << run.err;
    return run.out;
  }
  /// Runs `arguments` with the document's file in place of "{}", once for each kind of place in it.
  /// \param most  of the places, evenly; costly commands
  void RunWith(const Words& arguments, const Json& document, std::size_t most = 1000) {
    ASSERT_FALSE(document.is_null()) << Joined(command_);
    const std::string file = Path("given.json");
    const auto run = [&](const std::string& text, const std::string& place) {
      Write(file, text);
      Words words = arguments;
      for (std::string& word : words) {
        if (word == "{}") word = file;
        if (word == "{folder}") word = Folder();
      }
      Run(words, place);
    };
    std::size_t places = 0, at = 0;
    ForEachPlace(document, MakeHostileText(), [&](const Json&, const std::string&) { ++places; });
    const std::size_t step = std::max<std::size_t>(1, places / most);
    ForEachPlace(document, MakeHostileText(), [&](const Json& changed, const std::string& place) {
      if (++at % step == 0 || place == "everywhere" || place.starts_with(".name")) run(changed.dump(), place);
    });
    ForEachPlace(document, MakeLongText(), [&](const Json& changed, const std::string& place) {
      if (place == "everywhere") run(changed.dump(), "long");
    });
    // bytes that no JSON may hold
    ForEachPlace(document, "@broken@", [&](const Json& changed, const std::string& place) {
      if (place != "everywhere") return;
      std::string text = changed.dump();
      for (std::size_t found; (found = text.find("@broken@")) != std::string::npos;)
        text.replace(found, 8, "x\xff\xc0\xed\xa0\x80\x1b[2J\n" + std::string(kForgedLine));
      run(text, "broken");
    });
    run(MakeBrokenText(), "no JSON");
  }

 private:
  void Once(const Words& arguments, const std::string& place, bool is_json) {
    Words words = command_;
    words.insert(words.end(), arguments.begin(), arguments.end());
    if (is_json) words.push_back("--json");
    ++runs_;
    CommandRun run = RunInChild(words, folder_.Path(), ends_long_ ? 2 : 60);
    good_ += run.status == 0 ? 1 : 0;
    const bool is_ended = ends_long_ && run.is_late;
    if (is_ended) run.is_late = false, run.status = 0;
    const std::string fault = FindFault(run, is_json && !is_ended);
    if (!fault.empty())
      ADD_FAILURE() << Joined(command_) << (is_json ? " --json" : "") << ", text in " << place << ": "
                    << fault;
  }

  Words command_;
  test::TemporaryFolder folder_;
  bool has_json_ = false;
  bool ends_long_ = false;
  std::size_t runs_ = 0, good_ = 0;
};

// --- recordings

/// A recording with parts in place of its own. \param change  gets and returns a part's content
std::string Rewritten(const std::string& bytes,
                      const std::function<std::string(record::ChunkKind, const std::string&)>& change,
                      const std::string& mark) {
  record::FileHeader file;
  std::memcpy(&file, bytes.data(), sizeof file);
  std::vector<std::byte> made = record::MakeFileHeader(file.file_id);
  std::uint64_t number = 0;
  for (std::size_t at = sizeof file; at + sizeof(record::ChunkHeader) <= bytes.size();) {
    record::ChunkHeader header;
    std::memcpy(&header, bytes.data() + at, sizeof header);
    const std::string content = bytes.substr(at + sizeof header, header.size);
    if (header.kind == record::ChunkKind::kEnding && !mark.empty())
      record::PutChunk(file.file_id, number++, record::ChunkKind::kMark, header.tick, record::BytesOf(mark),
                       made);
    record::PutChunk(file.file_id, number++, header.kind, header.tick,
                     record::BytesOf(change(header.kind, content)), made);
    at += sizeof header + header.size;
  }
  return {reinterpret_cast<const char*>(made.data()), made.size()};
}

/// The demonstration's scene as a file of any folder.
Json MakeScene() {
  Json scene = ReadJson(kRoot / "scenes/demonstration.json");
  const auto absolute = [](Json& path) {
    path = (kRoot / "scenes" / path.get<std::string>()).lexically_normal();
  };
  absolute(scene["patient"]);
  absolute(scene["script"]);
  for (Json& material : scene["materials"]) absolute(material["file"]);
  return scene;
}

/// Half a second of a scene whose file's name is hostile, recorded.
std::string Record(Stage& stage) {
  const std::string scene = stage.Path(MakeHostileText() + ".json");
  Write(scene, MakeScene().dump());
  stage.Prepare({"simulate", scene, "--ticks", "60", "--record", stage.Path("whole.trocar")});
  const auto bytes = host::ReadFile(stage.Path("whole.trocar"), std::size_t{1} << 28);
  return bytes.ok() ? *bytes : std::string();
}

/// Runs `arguments` with a recording in place of "{}": with hostile texts that leave it as it was played, and, if not `is_slow`, in every
/// place.
void RunWithRecording(Stage& stage, const Words& arguments, bool is_slow) {
  const std::string bytes = Record(stage), text = MakeHostileText();
  ASSERT_FALSE(bytes.empty());
  const auto run = [&](const std::string& recording, const std::string& place) {
    const std::string file = stage.Path("given.trocar");
    Write(file, recording);
    Words words = arguments;
    for (std::string& word : words) {
      if (word == "{}") word = file;
      if (word == "{folder}") word = stage.Folder();
    }
    stage.Run(words, place);
  };
  using record::ChunkKind;
  const auto with = [&](ChunkKind kind, const std::function<void(Json&)>& change, const std::string& mark) {
    return Rewritten(
        bytes,
        [&](ChunkKind one, const std::string& content) {
          if (one != kind) return content;
          Json json = Json::parse(content);
          change(json);
          return json.dump();
        },
        mark);
  };
  run(with(
          ChunkKind::kDescription,
          [&](Json& json) {
            for (const char* key : {"player", "compiler"}) json[key] = text;
            json["started"] = json["started"].get<std::string>();
            json["branched"] = {{"from", text}, {"id", "0000000000000007"}, {"tick", 3}};
          },
          text),
      "player, compiler, mark");
  run(with(
          ChunkKind::kDescription, [&](Json& json) { json["program"] = text; }, ""),
      "program");
  run(with(
          ChunkKind::kEnding,
          [&](Json& json) {
            Json outcome = Json::parse(json["outcome"].get<std::string>());
            outcome[text] = text;
            json["outcome"] = outcome.dump();
          },
          ""),
      "outcome");
  run(with(
          ChunkKind::kEnding, [&](Json& json) { json["outcome"] = text; }, ""),
      "no outcome");
  run(with(
          ChunkKind::kDescription, [&](Json& json) { json["name"] = text; }, ""),
      "name");
  if (is_slow) return;
  for (const ChunkKind kind : {ChunkKind::kDescription, ChunkKind::kEvents, ChunkKind::kEnding}) {
    std::string content = kind == ChunkKind::kEvents
                              ? R"([{"tick": 1, "kind": "grasped", "about": "a", "hand": 1, "error": true}])"
                              : std::string();
    Rewritten(
        bytes,
        [&](ChunkKind one, const std::string& own) {
          if (one == kind && content.empty()) content = own;
          return own;
        },
        "");
    ForEachPlace(Json::parse(content), text, [&](const Json& changed, const std::string& place) {
      bool has_events = false;
      run(Rewritten(
              bytes,
              [&](ChunkKind one, const std::string& own) {
                has_events = has_events || one == ChunkKind::kEvents;
                return one == kind ? changed.dump() : own;
              },
              ""),
          place);
    });
  }
}

std::function<void(Stage&)> OfRecording(Words arguments, bool is_slow = true) {
  return [arguments, is_slow](Stage& stage) { RunWithRecording(stage, arguments, is_slow); };
}

// --- documents

std::function<void(Stage&)> OfFile(const char* file, Words arguments, std::size_t most = 1000) {
  return [=](Stage& stage) { stage.RunWith(arguments, ReadJson(kRoot / file), most); };
}

Json MakeTrace() {
  training::AttemptTrace trace;
  trace.dt = 0.01;
  trace.tool_names = {"grasper"};
  trace.organ_names = {"liver"};
  for (auto& hand : trace.hands) {
    hand.resize(90);
    for (std::size_t i = 0; i < hand.size(); ++i)
      hand[i].tip = {0.001 * static_cast<double>(i), 0.2, 0.3}, hand[i].spin = 1;
  }
  trace.camera.resize(90);
  trace.goals = {{"goal", 1.5, 10}};
  trace.phases = {{"a phase", 0, 0.5}, {"another", 0.5, 0.9}};
  trace.outcome.phase = "completed";
  return Json::parse(training::FormatTraceJson(trace));
}

/// A patient with the meshes of the one that is delivered.
void LayPatient(const fs::path& folder) {
  const fs::path good = kRoot / "assets/patients/visible-human-male/patient";
  for (const fs::directory_entry& entry : fs::directory_iterator(good)) {
    if (entry.path().filename() != "patient.json")
      fs::create_symlink(entry.path(), folder / entry.path().filename());
  }
}

std::function<void(Stage&)> OfPatient(Words arguments, std::size_t most) {
  return [=](Stage& stage) {
    LayPatient(stage.Folder());
    fs::create_symlink("given.json", stage.Folder() / "patient.json");
    stage.RunWith(arguments, ReadJson(kRoot / "assets/patients/visible-human-male/patient/patient.json"),
                  most);
  };
}

// --- stores

store::Attempt MakeAttempt(const std::string& trainee) {
  store::Attempt attempt;
  attempt.recording_id = "0000000000000007";
  attempt.started = "2026-11-24T22:50:20+00:00";
  attempt.trainee = trainee;
  attempt.task = "peg_transfer";
  attempt.level = "normal";
  attempt.patient = "p";
  attempt.program = "0";
  attempt.recording = "/nowhere/a.trocar";
  attempt.outcome = R"({"task": {"phase": "completed"}})";
  attempt.is_completed = true;
  attempt.metrics.push_back({"time", "", "", 12.5, ""});
  return attempt;
}

store::Place MakePlace(const fs::path& folder) {
  store::Place place;
  place.url = folder / "store.sqlite";
  place.folder = folder;
  return place;
}

/// A store with one of everything. \return the person's pseudonym
std::string MakeStore(const fs::path& folder) {
  auto store = store::Store::Open(MakePlace(folder));
  EXPECT_TRUE(store.ok()) << store.error().Text();
  const auto owner = store::Viewer::Owner();
  const auto person = store::AddPerson(*store, owner, store::Role::kTrainee);
  EXPECT_TRUE(store::AddGroup(*store, owner, "evening").ok());
  EXPECT_TRUE(store::JoinGroup(*store, owner, "evening", person->pseudonym).ok());
  EXPECT_TRUE(store::AddAttempt(*store, MakeAttempt(person->pseudonym)).ok());
  return person->pseudonym;
}

/// Runs `arguments` on a store in each of whose columns of text, one after the other, the text stands, as an older version or another
/// program might have left it. "{store}" is its file, "{person}" the one who is there, "{new}" a new file.
std::function<void(Stage&)> OfStore(std::vector<Words> all) {
  return [all = std::move(all)](Stage& stage) {
    const fs::path folder = stage.StoreFolder(), file = folder / "store.sqlite",
                   kept = folder / "kept.sqlite";
    const std::string person = MakeStore(folder);
    fs::copy_file(file, kept);
    std::vector<std::pair<std::string, std::string>> columns = {{"", ""}};
    {
      auto database = store::OpenSqlite(kept.string(), 2);
      ASSERT_TRUE(database.ok());
      const auto found = (*database)->Run(
          "SELECT m.name, p.name FROM sqlite_master m JOIN pragma_table_info(m.name) p WHERE m.type = "
          "'table' "
          "AND UPPER(p.type) = 'TEXT' AND m.name <> 'setting'");
      ASSERT_TRUE(found.ok()) << found.error().Text();
      for (const store::Row& row : found->rows) columns.emplace_back(row.Text(0), row.Text(1));
    }
    ASSERT_GT(columns.size(), 10u);
    for (const auto& [table, column] : columns) {
      for (const std::string& text : {MakeHostileText(), store::EncodeText(MakeBrokenText())}) {
        std::string who = person;
        for (const auto& entry : fs::directory_iterator(folder)) {
          if (entry.path() != kept) fs::remove_all(entry.path());
        }
        fs::copy_file(kept, file);
        if (!table.empty()) {
          auto database = store::OpenSqlite(file.string(), 2);
          ASSERT_TRUE(database.ok());
          // what no row may hold is left
          (void)(*database)->Run("UPDATE " + table + " SET " + column + " = $1", {text});
          if (column == "pseudonym") who = text;
        }
        Json names = {{"format", "trocar-names"},
                      {"version", 1},
                      {"names", {{who.size() > 100 ? person : who, "Ada"}}}};
        if (table.empty()) names["names"][person] = MakeHostileText();
        Write(folder / "names.json", names.dump(-1, ' ', false, Json::error_handler_t::replace));
        fs::permissions(folder / "names.json", fs::perms::owner_read | fs::perms::owner_write);
        for (Words words : all) {
          for (std::string& word : words) {
            if (word == "{store}") word = file;
            if (word == "{person}") word = who;
            if (word == "{new}") word = stage.Path("new.json");
            if (word == "{new.csv}") word = stage.Path("new.csv");
          }
          fs::remove_all(stage.Path("new.json")), fs::remove_all(stage.Path("new.csv"));
          words.insert(words.end(), {"--store", file});
          stage.Run(words, table.empty() ? "names" : table + "." + column);
        }
      }
    }
  };
}

const char* kSpare = "T-7F3K2Q";

/// What each command reads from outside, beside its command line.
std::map<std::string, std::vector<std::function<void(Stage&)>>> Recipes() {
  const std::function<void(Stage&)> nothing = [](Stage&) {};
  const auto of_exam = [](Words arguments) {
    return [arguments](Stage& stage) {
      const std::string exam = stage.Path("exam.json");
      stage.Prepare({"exam", "seal", "--task", "peg_transfer", "--name", MakeHostileText(), "-o", exam});
      Words words = arguments;
      for (std::string& word : words) {
        if (word == "{exam}") word = exam;
        if (word == "{new}") word = stage.Path("new");
      }
      stage.RunWith(words, ReadJson(exam));
    };
  };
  const auto of_queue = [](Words arguments) {
    return [arguments](Stage& stage) {
      fs::create_directories(stage.Folder() / "refused");
      const Json statement = {
          {"id", "given"},
          {"actor", {{"account", {{"homePage", "https://a.example"}, {"name", "nobody"}}}}},
          {"verb", {{"id", "v"}}}};
      std::string name = MakeHostileText() + ".json";
      Write(stage.Folder() / name, statement.dump(2));
      Write(stage.Folder() / "refused" / name, statement.dump());
      Write(stage.Folder() / "broken.json", MakeBrokenText());
      stage.RunWith(arguments, statement);
    };
  };
  const auto of_labels = [](Words arguments, const std::string& text) {
    return [=](Stage& stage) {
      // 8 x 8 x 8 voxels, with names as 3D Slicer writes them
      std::string escaped;
      for (const char c : text)
        escaped += c == '\n' ? std::string("\\n") : c == '\\' ? std::string("\\\\") : std::string(1, c);
      std::string nrrd =
          "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 8 8\nspace "
          "directions: (1,0,0) "
          "(0,1,0) (0,0,1)\nkinds: domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n";
      for (const char* label : {"0", "1"})
        nrrd += "Segment" + std::string(label) + "_Name:=" + escaped + "\nSegment" + label +
                "_LabelValue:=" + std::to_string(label[0] - '0' + 1) + "\nSegment" + label + "_Layer:=0\n";
      nrrd += "content: " + escaped + "\n\n" + std::string(256, '\1') + std::string(256, '\2');
      Write(stage.Path("labels.nrrd"), nrrd);
      Words words = arguments;
      for (std::string& word : words) {
        if (word == "{labels}") word = stage.Path("labels.nrrd");
        if (word == "{new}") word = stage.Path("new");
      }
      stage.RunWith(words, {{"labels", {{"background", 0}, {"liver", 1}, {"gallbladder", "2"}}},
                            {"regions", Json::object()}});
    };
  };
  const auto of_images = [](Words arguments) {
    return [arguments](Stage& stage) {
      fs::create_directory(stage.Folder() / "images");
      for (int i = 0; i < 3; ++i)
        Write(stage.Folder() / "images" / (MakeHostileText() + std::to_string(i) + ".png"), MakeBrokenText());
      Words words = arguments;
      for (std::string& word : words) {
        if (word == "{images}") word = stage.Folder() / "images";
        if (word == "{new}") word = stage.Path("new");
      }
      stage.RunWith(words, ReadJson(kRoot / "assets/patients/visible-human-male/control_points.json"), 12);
    };
  };
  const std::string patient = kRoot / "assets/patients/visible-human-male/patient";
  const auto of_scene = [](Words arguments, std::size_t most) {
    return [=](Stage& stage) { stage.RunWith(arguments, MakeScene(), most); };
  };
  const auto of_attempts = [](Words arguments) {
    return [arguments](Stage& stage) {
      stage.RunWith(arguments, {{"format", "trocar-attempts"},
                                {"version", 1},
                                {"attempts",
                                 {{{"course", "basic-skills"},
                                   {"step", "peg_transfer"},
                                   {"task", "peg_transfer"},
                                   {"level", "normal"},
                                   {"patient", ""},
                                   {"seed", 1},
                                   {"started", "2026-11-24T22:50:20+00:00"},
                                   {"recording", "a"},
                                   {"completed", true},
                                   {"score", 1},
                                   {"metrics", {{{"metric", "time"}, {"value", 1.5}}}}}}}});
    };
  };
  return {
      {"window", {nothing}},  // opens the other program, which needs a display
      {"anatomy contours", {nothing}},
      {"anatomy edit", {nothing}},
      {"demo", {of_scene({"{}", "-o", "/dev/null/x"}, 4)}},
      {"pictures", {nothing}},
      {"bench", {nothing}},
      {"reproduce report-card", {nothing}},
      {"reproduce table1", {nothing}},
      {"reproduce table2", {nothing}},
      {"reproduce fig6", {nothing}},
      {"reproduce fig7", {nothing}},
      {"reproduce fig8", {nothing}},
      {"reproduce fig9", {nothing}},
      {"reproduce equilibrium", {nothing}},
      {"reproduce all", {nothing}},
      {"doctor", {nothing}},
      {"errors", {nothing}},
      {"simulate", {of_scene({"{}", "--ticks", "1"}, 25)}},
      {"play", {OfFile("scenes/tasks/peg_transfer.json", {"nobody", "--task", "{}"})}},
      {"replay", {OfRecording({"{}", "--verify"})}},
      {"metrics",
       {[](Stage& stage) {
          stage.RunWith({"{}", "--parts"}, MakeTrace());
        },
        OfRecording({"{}", "--parts"})}},
      {"coach",
       {OfRecording({"{}"}), OfFile("assets/coach/rules.json", {"/nowhere", "--rules", "{}"}),
        OfFile("assets/validity.json", {"/nowhere", "--validity", "{}"}, 30)}},
      {"report", {OfRecording({"{}", "-o", "report.html"}), OfRecording({"{}", "-o", "/dev/null/x.csv"})}},
      {"study", {OfFile("samples/studies/stiffness.json", {"{}", "-o", "/dev/null/x"})}},
      {"dataset", {nothing}},
      {"dataset verify", {[](Stage& stage) {
         fs::create_symlink("given.json", stage.Folder() / "card.json");
         stage.RunWith({"{folder}"}, {{"format", "trocar-dataset"},
                                      {"plan", {{"layout", "trocar"}, {"height", 8}, {"width", 8}}},
                                      {"videos", {{{"video", "a"}, {"frames", 1}}}}});
       }}},
      {"rating form", {OfFile("assets/rating/goals.json", {"{}"})}},
      {"rating enter",
       {OfFile("assets/rating/goals.json", {"{}", "a=1", "--attempt", "a", "--rater", kSpare})}},
      {"rating agreement", {[](Stage& stage) {
         stage.RunWith({"{}", "{}"}, {{"format", "trocar-rating"},
                                      {"version", 1},
                                      {"form", "goals"},
                                      {"attempt", "a"},
                                      {"rater", kSpare},
                                      {"rated", ""},
                                      {"remarks", ""},
                                      {"points",
                                       {{"depth_perception", 4},
                                        {"bimanual_dexterity", 3},
                                        {"efficiency", 3},
                                        {"tissue_handling", 4},
                                        {"autonomy", 5}}}});
       }}},
      {"xapi queue",
       {OfRecording({"{}", "--person", kSpare, "--home-page", "https://a.example", "--queue", "queue"})}},
      {"xapi list", {of_queue({"--queue", "{folder}"})}},
      {"xapi erase", {of_queue({"nobody", "--queue", "{folder}"})}},
      {"xapi deliver",
       {of_queue({"--endpoint", "http://127.0.0.1:1/", "--give-up", "0", "--queue", "{folder}"})}},
      {"record info", {OfRecording({"{}"}, false)}},
      {"record verify", {OfRecording({"{}"}, false)}},
      {"record repair", {OfRecording({"{}", "-o", "/dev/null/x"}, false)}},
      {"record index", {OfRecording({"{}"})}},
      {"course list", {nothing}},
      {"course show",
       {OfFile("assets/courses/basic-skills.json", {"{}"}),
        OfFile("assets/courses/basic-skills.json", {"{}", "peg_transfer"})}},
      {"course check", {OfFile("assets/courses/basic-skills.json", {"{}"})}},
      {"course start", {OfFile("assets/courses/basic-skills.json", {"{}", "peg_transfer"})}},
      {"course prepare", {OfFile("assets/courses/basic-skills.json", {"{}"})}},
      {"course judge", {OfRecording({"basic-skills", "peg_transfer", "{}"})}},
      {"course progress",
       {OfFile("assets/courses/basic-skills.json", {"{}", "--attempts", "/nowhere"}),
        of_attempts({"basic-skills", "--attempts", "{}"})}},
      {"levels list", {nothing}},
      {"levels show", {OfFile("assets/proficiency/peg_transfer-normal.json", {"{}"})}},
      {"levels from", {OfRecording({"{}", "--source", MakeHostileText(), "-o", "new.json"})}},
      {"exam seal",
       {OfFile("assets/proficiency/peg_transfer-normal.json",
               {"--task", "peg_transfer", "--name", "a", "--thresholds", "{}", "-o", "/dev/null/x"})}},
      {"exam run",
       {of_exam({"{}", "--surgeon", "nobody", "--record", "{new}"}),
        [](Stage& stage) {
          stage.Prepare({"exam", "seal", "--task", "peg_transfer", "--name", MakeHostileText(), "-o",
                         stage.Path("exam.json")});
          stage.Run({stage.Path("exam.json"), "--surgeon", "expert", "--seconds", "1", "--record",
                     stage.Path("a.trocar")},
                    "name of the exam");
        }}},
      {"exam check", {of_exam({"{exam}", "{}"}), of_exam({"{}", "{exam}"})}},
      {"certificate keygen", {nothing}},
      {"certificate issue",
       {of_exam({"{}", "/nowhere", "--examinee", kSpare, "--key", "/nowhere", "-o", "{new}"})}},
      {"certificate verify", {[](Stage& stage) {
         const auto path = [&](const char* name) { return stage.Path(name); };
         stage.Prepare({"exam", "seal", "--task", "peg_transfer", "--name", MakeHostileText(), "-o",
                        path("exam.json")});
         stage.Prepare({"exam", "run", path("exam.json"), "--surgeon", "expert", "--seconds", "1", "--record",
                        path("a.trocar")});
         stage.Prepare({"certificate", "keygen", "-o", path("key")});
         stage.Prepare({"certificate", "issue", path("exam.json"), path("a.trocar"), "--examinee", kSpare,
                        "--key", path("key.key"), "-o", path("certificate.json")});
         stage.Run({path("certificate.json"), path("a.trocar")}, "name of the exam");
         stage.RunWith({"{}", path("a.trocar")}, ReadJson(path("certificate.json")));
       }}},
      {"anatomy images", {of_images({"{images}"}), of_labels({"{labels}"}, MakeHostileText())}},
      {"anatomy build", {of_images({"{}", "--images", "{images}", "-o", "{new}"})}},
      {"anatomy grow",
       {of_images({"{images}", "--organ", "liver", "--at", "1,1,1", "--points", "{}", "-o", "{new}"})}},
      {"anatomy rehearse",
       {of_images({"--images", "{images}", "--reference", "{images}", "--control-points", "{}"})}},
      {"anatomy label-edges",
       {of_images({"--images", "{images}", "--reference", "{images}", "--control-points", "{}"})}},
      {"anatomy from-labels",
       {of_labels({"{labels}", "-o", "{new}"}, MakeHostileText()),
        of_labels({"{labels}", "-o", "{new}"}, MakeBrokenText()),
        of_labels({"{labels}", "--names", "{}", "-o", "{new}"}, "liver")}},
      {"anatomy phantom",
       {of_labels({"--ct", "portal", "--labels", "{labels}", "-o", "{new}"}, MakeHostileText())}},
      {"anatomy generate", {nothing}},
      {"anatomy check", {OfPatient({"{folder}"}, 30)}},
      {"anatomy complete", {OfPatient({"{folder}", "--most-likely", "-o", "/dev/null/x"}, 10)}},
      {"anatomy measure", {OfPatient({"{folder}"}, 10)}},
      {"anatomy view", {OfPatient({"{folder}", "--png", "/dev/null/x.png"}, 6)}},
      {"anatomy export", {OfPatient({"{folder}", "--format", "obj", "-o", "/dev/null/x"}, 10)}},
      {"store info", {OfStore({{}})}},
      {"store trainee add", {nothing}},
      {"store trainee list", {OfStore({{}, {"--limit", "1"}})}},
      {"store trainee rename", {OfStore({{"{person}", "--role", "instructor"}})}},
      {"store trainee export", {OfStore({{"{person}", "-o", "{new}"}})}},
      {"store trainee erase", {OfStore({{"{person}", "--yes"}})}},
      {"store group add", {nothing}},
      {"store group list", {OfStore({{}})}},
      {"store group join", {OfStore({{"evening", "{person}"}})}},
      {"store group leave", {OfStore({{"evening", "{person}"}})}},
      {"store add", {OfRecording({"{}", "--store", "store.sqlite"})}},
      {"store attempts", {OfStore({{}, {"--limit", "1"}})}},
      {"store percentile",
       {OfStore(
           {{"--task", "peg_transfer", "--level", "normal", "--metric", "time", "--trainee", "{person}"}})}},
      {"store deliver", {[](Stage& stage) {
         const fs::path folder = stage.StoreFolder();
         MakeStore(folder);
         fs::create_directories(folder / "spool");
         fs::create_symlink(stage.Path("given.json"), folder / "spool" / "given.json");
         stage.RunWith({"--held", "--store", folder / "store.sqlite"},
                       Json::parse(store::WriteAttemptJson(MakeAttempt("T-1"))));
       }}},
      {"store export", {OfStore({{"{new}"}, {"{new.csv}"}})}},
      {"store import", {[](Stage& stage) {
         const fs::path folder = stage.StoreFolder(), all = folder / "all.json";
         MakeStore(folder);
         stage.Prepare({"store", "export", all, "--store", folder / "store.sqlite"});
         stage.RunWith({"{}", "--store", folder / "new.sqlite"}, ReadJson(all));
       }}},
      {"store backup", {OfStore({{"{new}"}})}},
      {"store verify", {OfStore({{"{store}"}, {"--attempts"}, {}})}},
      {"store migrate", {OfStore({{}})}},
      {"store retain", {OfStore({{"--days", "3"}})}},
      {"store tidy", {OfStore({{}})}},
      {"devices list", {[](Stage& stage) {
         const fs::path settings = stage.Folder().parent_path() / "trocar";
         fs::create_directories(settings);
         fs::create_symlink(stage.Path("given.json"), settings / "devices.json");
         stage.RunWith(
             {}, {{"format", "trocar-devices"}, {"version", 1}, {"hands", {{"left", {{"device", "a"}}}}}});
       }}},
      {"devices test", {nothing}},
      {"devices record", {nothing}},
      {"devices play", {[](Stage& stage) {
         for (const std::string& text : {MakeHostileText(), MakeBrokenText(), MakeLongText()}) {
           for (const std::string& before : {std::string(), std::string("time,")}) {
             Write(stage.Path("a.csv"), before + text + "\n1,2,3\n" + text);
             stage.Run({stage.Path("a.csv")}, "file");
           }
         }
       }}},
      {"devices calibrate tip", {nothing}},
      {"devices calibrate trocar", {nothing}},
      {"devices calibrate jaw", {nothing}},
      {"devices emulate", {nothing}},
  };
}

/// The commands that do something: those below which there is none, and those that take values themselves.
std::vector<Words> ListLeaves() {
  std::vector<Words> leaves;
  const std::vector<Words> all = cli::ListCommands();
  for (const Words& words : all) {
    const bool has_below = std::any_of(all.begin(), all.end(), [&](const Words& other) {
      return other.size() > words.size() && std::equal(words.begin(), words.end(), other.begin());
    });
    if (!words.empty() && (!has_below || cli::ListOptions(words).size() > 1)) leaves.push_back(words);
  }
  return leaves;
}

class PrintedTexts : public testing::TestWithParam<std::string> {};

Words FindWords(const std::string& joined) {
  for (const Words& words : cli::ListCommands()) {
    if (Joined(words) == joined) return words;
  }
  return {};
}

// Every value of a command line, of whichever command.
TEST_P(PrintedTexts, StayHarmlessInEveryOption) {
  const Words words = FindWords(GetParam());
  const auto options = cli::ListOptions(words);
  Stage stage(words);
  stage.EndLongRuns();
  for (const cli::CommandOption& hostile : options) {
    if (hostile.type.empty()) continue;
    for (const std::string& text : {MakeHostileText(), MakeBrokenText(), MakeLongText()}) {
      Words named, positional;
      for (const cli::CommandOption& option : options) {
        const bool is_hostile = option.name == hostile.name;
        if (option.type.empty() || (!option.is_required && !is_hostile)) continue;
        const bool is_number = option.type == "INT" || option.type == "N" || option.type == "UINT";
        const std::string value = is_hostile                   ? text
                                  : option.type == "PSEUDONYM" ? kSpare
                                  : is_number                  ? "1"
                                  : option.type == "URL"       ? "http://127.0.0.1:1/"
                                                               : "/dev/null/nowhere";
        if (option.is_positional)
          positional.push_back(value);
        else
          named.push_back(option.name + (option.name.starts_with("--") ? "=" : "") + value);
      }
      positional.insert(positional.begin(), named.begin(), named.end());
      stage.Run(positional, hostile.name);
    }
  }
}

// What the command reads.
TEST_P(PrintedTexts, StayHarmlessInEveryFile) {
  const auto recipes = Recipes();
  const auto found = recipes.find(GetParam());
  ASSERT_NE(found, recipes.end()) << "a new command: Recipes() has to know which files it reads";
  for (const auto& recipe : found->second) {
    Stage stage(FindWords(GetParam()));
    recipe(stage);
  }
}

std::vector<std::string> ListNames() {
  std::vector<std::string> names;
  for (const Words& words : ListLeaves()) names.push_back(Joined(words));
  return names;
}

INSTANTIATE_TEST_SUITE_P(OfCommands, PrintedTexts, testing::ValuesIn(ListNames()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
});

TEST(PrintedTextsRecipes, AreOfNoOtherCommand) {
  const auto names = ListNames();
  for (const auto& [command, recipe] : Recipes())
    EXPECT_NE(std::find(names.begin(), names.end(), command), names.end())
        << command << " is no command any more";
}

// The check sees what it is there for.
TEST(FindFault, SeesEachKind) {
  const std::string forged(kForgedLine);
  EXPECT_EQ(FindFault({0, false, "good\nlines\t1\n", ""}, false), "");
  EXPECT_NE(FindFault({0, false, "a\x1b[2J", ""}, false), "");
  EXPECT_NE(FindFault({0, false, "", "a\rb"}, false), "");
  EXPECT_NE(FindFault({0, false, "a\xff", ""}, false), "");
  EXPECT_NE(FindFault({0, false, "\xe2\x80\xae", ""}, false), "");
  EXPECT_NE(FindFault({0, false, "x\n  " + forged, ""}, false), "");
  EXPECT_NE(FindFault({0, false, "{", ""}, true), "");
  EXPECT_NE(FindFault({0, true, "", ""}, false), "");
  EXPECT_NE(FindFault({134, false, "", ""}, false), "");
  EXPECT_NE(FindFault({1, false, "", "trocar: stopped by an unexpected exception: x"}, false), "");
}

}  // namespace
}  // namespace trocar::printed_texts
