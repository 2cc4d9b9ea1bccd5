// SPDX-License-Identifier: Apache-2.0
// People, groups, roles and names.
#include "trocar/store/people.h"

#include <sys/stat.h>

#include <regex>

#include "store_test.h"
#include "trocar/store/courses.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/names.h"

namespace trocar::store {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class People : public StoreTest {};
INSTANTIATE_OVER_DATABASES(People);

/// What people and programs write where a name is asked for.
const std::vector<std::string> kNastyTexts = {"../../etc/passwd",
                                              std::string("nul\0inside", 10),
                                              "two\nlines\r\n",
                                              "\xE2\x80\xAEright to left",
                                              "\xFF\xFE no utf-8 \xC3",
                                              "\xED\xA0\x80 a lone surrogate",
                                              std::string("\x01 begins with the mark \\5c", 25),
                                              "'); DROP TABLE person; --",
                                              "<script>alert(1)</script>",
                                              " "};
/// Odd, and somebody's all the same.
const std::vector<std::string> kGoodNames = {"\xD7\xA9\xD7\x9C\xD7\x95\xD7\x9D",
                                             std::string(190, 'x') + "\xC3\xA9",
                                             "O'Brien \"quoted\" `tick`",
                                             "'); DROP TABLE person; --",
                                             "$1 ? :name @x {id} %s",
                                             "<b>",
                                             "trainee-7",
                                             "NULL"};
/// No door takes them, for whatever they name.
const std::vector<std::string> kBadNames = {std::string("nul\0inside", 10),
                                            "two\nlines",
                                            "returned\r",
                                            "escape\x1B[31m",
                                            "deleted\x7F",
                                            "next line\xC2\x85",
                                            "\xE2\x80\xAEright to left",
                                            "line\xE2\x80\xA8separator",
                                            "\xE2\x81\xA6isolated",
                                            "nothing\xE2\x80\x8Bto see",
                                            "\xFF\xFE no utf-8 \xC3",
                                            "\xED\xA0\x80 a lone surrogate",
                                            "\x01 begins with the mark",
                                            " ",
                                            " before",
                                            "behind ",
                                            std::string(10'000, 'x')};
const std::vector<std::string> kPaths = {"../../x", "..", ".", "a/b", "/etc/passwd", "a\\b", "-h", "--yes"};

TEST_P(People, AreKnownByPseudonymsThatAreNotMistaken) {
  const std::string one = Add(Role::kTrainee), other = Add(Role::kInstructor);
  EXPECT_TRUE(std::regex_match(one, std::regex("T-[2-9A-HJKMNP-Z]{6}"))) << one;
  EXPECT_TRUE(std::regex_match(other, std::regex("I-[2-9A-HJKMNP-Z]{6}"))) << other;
  EXPECT_CODE(AddPerson(Open(), kOwner, Role::kTrainee, one), kStoreInvalid);
  EXPECT_CODE(AddPerson(Open(), kOwner, Role::kTrainee, std::string(201, 'x')), kStoreInvalid);
  EXPECT_CODE(FindPerson(Open(), "T-NOBODY"), kStoreUnknown);
  EXPECT_GOOD(RenamePerson(Open(), kOwner, one, "T-OTHER"));
  EXPECT_CODE(FindPerson(Open(), one), kStoreUnknown);
  EXPECT_CODE(RenamePerson(Open(), kOwner, "T-OTHER", other), kStoreInvalid);
}

TEST_P(People, KeepAnyTextAsData) {
  const std::string who = Add(Role::kTrainee);
  for (const std::string& text : kNastyTexts) {
    SCOPED_TRACE(text);
    Attempt attempt = MakeAttempt(static_cast<int>(&text - kNastyTexts.data()), who, text);
    attempt.patient = attempt.recording = attempt.outcome = text;
    attempt.metrics = {{text, text, text, 1, text}};
    EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  }
  Reopen();
  for (const std::string& text : kNastyTexts) {
    SCOPED_TRACE(text);
    const AttemptPage page = Get(ListAttempts(Open(), kOwner, {who, "", text}));
    ASSERT_THAT(page.attempts, SizeIs(1));
    const Attempt attempt = Get(FindAttempt(Open(), kOwner, page.attempts[0].id)).attempt;
    EXPECT_EQ(attempt.patient, text);
    EXPECT_EQ(attempt.recording, text);
    EXPECT_EQ(attempt.outcome, text);
    EXPECT_THAT(attempt.metrics, testing::Contains(training::MetricValue{text, text, text, 1, text}));
  }
}

TEST_P(People, AreNamedAsPeopleAre) {
  const std::string who = Add(Role::kTrainee);
  for (const std::string& text : kGoodNames) {
    SCOPED_TRACE(text);
    EXPECT_EQ(Add(Role::kTrainee, text), text);
    EXPECT_EQ(Get(AddGroup(Open(), kOwner, text)).name, text);
    EXPECT_GOOD(JoinGroup(Open(), kOwner, text, text));
    EXPECT_GOOD(SetName(place_.NamesFile(), text, text));
  }
  Reopen();
  const auto names = Get(ReadNames(place_.NamesFile()));
  for (const std::string& text : kGoodNames) {
    EXPECT_EQ(Get(FindPerson(Open(), text)).pseudonym, text);
    EXPECT_EQ(names.at(text), text);
  }
  const auto people = Count("person"), groups = Count("training_group");
  for (const std::string& text : kBadNames) {
    SCOPED_TRACE(text.substr(0, 40));
    EXPECT_CODE(AddPerson(Open(), kOwner, Role::kTrainee, text), kStoreInvalid);
    EXPECT_CODE(RenamePerson(Open(), kOwner, who, text), kStoreInvalid);
    EXPECT_CODE(AddGroup(Open(), kOwner, text), kStoreInvalid);
    EXPECT_CODE(SetName(place_.NamesFile(), who, text), kStoreInvalid);
  }
  for (const std::string& text : kPaths) {
    SCOPED_TRACE(text);
    EXPECT_CODE(AddPerson(Open(), kOwner, Role::kTrainee, text), kStoreInvalid);
    EXPECT_CODE(RenamePerson(Open(), kOwner, who, text), kStoreInvalid);
  }
  EXPECT_EQ(Count("person"), people);
  EXPECT_EQ(Count("training_group"), groups);
  EXPECT_EQ(Get(ReadNames(place_.NamesFile())).count(who), 0u);
}

TEST_P(People, ArePagedByPseudonym) {
  for (int i = 0; i < 25; ++i) Add(Role::kTrainee);
  std::vector<std::string> seen;
  while (true) {
    const auto page = Get(ListPeople(Open(), kOwner, seen.empty() ? "" : seen.back(), 7));
    if (page.empty()) break;
    for (const Person& person : page) seen.push_back(person.pseudonym);
  }
  EXPECT_THAT(seen, SizeIs(25));
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
}

/// Two groups: in the first a trainee and an instructor, in the second another trainee.
class Roles : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    if (!store_) return;
    for (const char* group : {"first", "second"}) EXPECT_GOOD(AddGroup(Open(), kOwner, group));
    for (auto* name : {&own_, &other_}) *name = Add(Role::kTrainee);
    teacher_ = Add(Role::kInstructor), boss_ = Add(Role::kAdministrator);
    EXPECT_GOOD(JoinGroup(Open(), kOwner, "first", own_));
    EXPECT_GOOD(JoinGroup(Open(), kOwner, "first", teacher_));
    EXPECT_GOOD(JoinGroup(Open(), kOwner, "second", other_));
    EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(1, own_))));
    EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(2, other_))));
    EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(3, ""))));
    trainee_ = Get(FindViewer(Open(), own_)), instructor_ = Get(FindViewer(Open(), teacher_));
    administrator_ = Get(FindViewer(Open(), boss_));
    own_id_ = Get(ListAttempts(Open(), kOwner, {own_, "", ""})).attempts.at(0).id;
    other_id_ = Get(ListAttempts(Open(), kOwner, {other_, "", ""})).attempts.at(0).id;
  }
  std::vector<std::string> Seen(const Viewer& viewer) {
    std::vector<std::string> trainees;
    for (const auto& stored : Get(ListAttempts(Open(), viewer, {})).attempts)
      trainees.push_back(stored.attempt.trainee);
    return trainees;
  }

  std::string own_, other_, teacher_, boss_;
  Viewer trainee_, instructor_, administrator_;
  std::int64_t own_id_ = 0, other_id_ = 0;
};
INSTANTIATE_OVER_DATABASES(Roles);

TEST_P(Roles, DecideWhatIsSeen) {
  EXPECT_THAT(Seen(trainee_), ElementsAre(own_));
  EXPECT_THAT(Seen(instructor_), ElementsAre(own_));
  EXPECT_THAT(Seen(administrator_), SizeIs(3));
  EXPECT_THAT(Seen(Viewer{}), IsEmpty());
  EXPECT_THAT(Get(ListPeople(Open(), trainee_, "", 10)), SizeIs(1));
  EXPECT_THAT(Get(ListPeople(Open(), instructor_, "", 10)), SizeIs(2));
  EXPECT_THAT(Get(ListPeople(Open(), administrator_, "", 10)), SizeIs(4));
  EXPECT_THAT(Get(ListGroups(Open(), trainee_)), SizeIs(1));
  EXPECT_THAT(Get(ListGroups(Open(), administrator_)), SizeIs(2));
  for (const Viewer& viewer : {trainee_, instructor_}) {
    EXPECT_GOOD(FindAttempt(Open(), viewer, own_id_));
    EXPECT_CODE(FindAttempt(Open(), viewer, other_id_), kStoreRefused);
    EXPECT_CODE(ListAttempts(Open(), viewer, {other_, "", ""}), kStoreRefused);
    EXPECT_CODE(ListRemarks(Open(), viewer, other_id_), kStoreRefused);
    EXPECT_CODE(ListRatings(Open(), viewer, other_id_), kStoreRefused);
    EXPECT_CODE(ListCertificates(Open(), viewer, other_), kStoreRefused);
    EXPECT_CODE(ListAssignments(Open(), viewer, other_), kStoreRefused);
    EXPECT_CODE(FindStanding(Open(), viewer, other_, {"peg_transfer", "easy", "score", "", "", ""}),
                kStoreRefused);
    EXPECT_CODE(CalcPercentile(Open(), viewer, "second", {"peg_transfer", "easy", "score", "", "", ""}, 1),
                kStoreRefused);
    EXPECT_CODE(CalcPercentile(Open(), viewer, "", {"peg_transfer", "easy", "score", "", "", ""}, 1),
                kStoreRefused);
  }
}

TEST_P(Roles, DecideWhatIsChanged) {
  const Course course{"basic", 1, "{}", {{"pegs", "peg_transfer", "easy"}}};
  const Threshold threshold{{"peg_transfer", "easy", "score", "", "", ""}, 50, true, "a test"};
  EXPECT_CODE(AddRemark(Open(), trainee_, own_id_, 1, "well done"), kStoreRefused);
  EXPECT_CODE(AddRating(Open(), trainee_, own_id_, {"GOALS", "efficiency", 3, ""}), kStoreRefused);
  EXPECT_CODE(AddCourse(Open(), trainee_, course), kStoreRefused);
  EXPECT_CODE(SetThreshold(Open(), trainee_, threshold), kStoreRefused);
  EXPECT_CODE(AddAssignment(Open(), trainee_, {"basic", 1, own_, "", {}, {}}), kStoreRefused);
  EXPECT_GOOD(AddRemark(Open(), instructor_, own_id_, 1, "well done"));
  EXPECT_GOOD(AddRating(Open(), instructor_, own_id_, {"GOALS", "efficiency", 3, ""}));
  EXPECT_CODE(AddRemark(Open(), instructor_, other_id_, 1, "well done"), kStoreRefused);
  EXPECT_CODE(AddRating(Open(), instructor_, other_id_, {"GOALS", "efficiency", 3, ""}), kStoreRefused);
  EXPECT_GOOD(AddCourse(Open(), instructor_, course));
  EXPECT_GOOD(SetThreshold(Open(), instructor_, threshold));
  EXPECT_GOOD(AddAssignment(Open(), instructor_, {"basic", 1, "", "first", {}, {}}));
  EXPECT_CODE(AddAssignment(Open(), instructor_, {"basic", 1, "", "second", {}, {}}), kStoreRefused);
  EXPECT_CODE(AddAssignment(Open(), instructor_, {"basic", 1, other_, "", {}, {}}), kStoreRefused);
  for (const Viewer& viewer : {trainee_, instructor_}) {
    EXPECT_CODE(AddPerson(Open(), viewer, Role::kTrainee), kStoreRefused);
    EXPECT_CODE(RenamePerson(Open(), viewer, own_, "T-X"), kStoreRefused);
    EXPECT_CODE(SetRole(Open(), viewer, own_, Role::kAdministrator), kStoreRefused);
    EXPECT_CODE(AddGroup(Open(), viewer, "third"), kStoreRefused);
    EXPECT_CODE(JoinGroup(Open(), viewer, "second", own_), kStoreRefused);
    EXPECT_CODE(LeaveGroup(Open(), viewer, "first", own_), kStoreRefused);
    EXPECT_CODE(ErasePerson(Open(), viewer, other_), kStoreRefused);
    EXPECT_CODE(ExportPerson(Open(), viewer, other_, folder_.Path() / "x"), kStoreRefused);
    EXPECT_CODE(BackUp(Open(), viewer), kStoreRefused);
    EXPECT_CODE(ExportJson(Open(), viewer, folder_.Path() / "x.json"), kStoreRefused);
    EXPECT_CODE(ExportCsv(Open(), viewer, folder_.Path() / "x.csv"), kStoreRefused);
    EXPECT_CODE(Import(Open(), viewer, folder_.Path() / "x.json"), kStoreRefused);
    EXPECT_CODE(SetRetention(Open(), viewer, 1), kStoreRefused);
    EXPECT_CODE(Tidy(Open(), viewer, 0), kStoreRefused);
    EXPECT_CODE(CountAll(Open(), viewer), kStoreRefused);
  }
  EXPECT_CODE(ExportPerson(Open(), instructor_, own_, folder_.Path() / "x"), kStoreRefused);
  EXPECT_GOOD(ExportPerson(Open(), trainee_, own_, folder_.Path() / "own"));
  EXPECT_GOOD(SetRole(Open(), administrator_, own_, Role::kInstructor));
}

TEST(NamesFile, IsReadByItsOwnerAlone) {
  test::TemporaryFolder folder;
  const auto path = folder.Path() / "names.json";
  EXPECT_THAT(Get(ReadNames(path)), IsEmpty());
  EXPECT_GOOD(SetName(path, "T-1", "Ada Lovelace"));
  EXPECT_GOOD(SetName(path, "T-2", "Grace Hopper"));
  EXPECT_GOOD(MoveName(path, "T-2", "T-3"));
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
  EXPECT_EQ(Get(ReadNames(path)), (Names{{"T-1", "Ada Lovelace"}, {"T-3", "Grace Hopper"}}));
  EXPECT_GOOD(SetName(path, "T-1", ""));
  EXPECT_THAT(FilesWith(folder.Path(), "Lovelace"), IsEmpty());
  ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  EXPECT_CODE(ReadNames(path), kStoreRefused);
  EXPECT_CODE(SetName(path, "T-1", "Ada Lovelace"), kStoreRefused);
}

}  // namespace
}  // namespace trocar::store
