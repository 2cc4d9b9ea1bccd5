// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_document.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "trocar/anatomy/patient_edit.h"
#include "trocar/math/random.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;

const fs::path kBuiltIn = fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient";

/// Everything that an edit can change.
struct Content {
  std::vector<std::vector<patient::Region>> regions;
  std::vector<patient::Attachment> attachments;
  std::vector<patient::Tube> tubes;
  std::vector<patient::Landmark> landmarks;

  explicit Content(const PatientDocument& document)
      : attachments(document.GetPatient().attachments),
        tubes(document.GetPatient().tubes),
        landmarks(document.GetPatient().landmarks) {
    for (const patient::Organ& organ : document.GetPatient().organs) regions.push_back(organ.regions);
  }
  friend bool operator==(const Content&, const Content&) = default;
};

PatientDocument OpenBuiltIn() {
  auto document = PatientDocument::Open(kBuiltIn);
  EXPECT_TRUE(document.ok()) << document.error().Text();
  return std::move(document).value();
}

base::Status MoveFundus(patient::Patient& patient) {
  return PlaceLandmark(patient, "fundus",
                       patient.FindLandmark("fundus")->position + math::Vec3{0.003, 0, 0.002});
}

/// One random edit; many fail, as a person's do.
void EditAtRandom(PatientDocument& document, math::Random& random) {
  const auto below = [&](std::size_t count) {
    return static_cast<std::uint32_t>(random.Uniform(0, static_cast<double>(count) + 1));
  };
  (void)document.Edit("random", [&](patient::Patient& p) -> base::Status {
    const std::uint32_t tube = below(p.tubes.size());
    const std::uint32_t point = tube < p.tubes.size() ? below(p.tubes[tube].line.points.size()) : 0;
    const math::Vec3 place = {random.Uniform(-0.1, 0.1), random.Uniform(0, 0.2), random.Uniform(-0.1, 0.1)};
    switch (random.NextWord() % 9) {
      case 0: {
        const std::uint32_t vertices[] = {below(1700), below(900), below(900)};
        return PaintRegion(p, random.Uniform() < 0.5 ? "liver" : "gallbladder",
                           random.Uniform() < 0.7 ? patient::kGallbladderBed : "extra", vertices,
                           random.Uniform() < 0.5);
      }
      case 1:
        return MoveTubePoint(p, tube, point, place, 0.01);
      case 2:
        return InsertTubePoint(p, tube, point, place);
      case 3:
        return DeleteTubePoint(p, tube, point);
      case 4:
        return ScaleTubeRadius(p, tube, point, random.Uniform(0.5, 2), 0.01);
      case 5:
        return JoinTubeEnd(p, tube, random.Uniform() < 0.5 ? TubeEnd::kFrom : TubeEnd::kTo,
                           random.Uniform() < 0.5 ? "gallbladder" : "common_bile_duct");
      case 6:
        return RemoveTube(p, tube);
      case 7:
        return AddTube(p, {"extra_" + std::to_string(below(5)),
                           patient::TubeKind::kDuct,
                           "",
                           "",
                           {{place, place + math::Vec3{0.01, 0, 0}}, {0.001, 0.001}},
                           true});
      default:
        return PlaceLandmark(p, random.Uniform() < 0.5 ? "fundus" : "mark", place);
    }
  });
}

TEST(PatientDocument, RandomEditsUndoneGiveTheSameBits) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    math::Random random(seed);
    PatientDocument document = OpenBuiltIn();
    std::vector<Content> states = {Content(document)};
    std::vector<std::uint64_t> revisions = {document.Revision()};
    for (int i = 0; i < 40; ++i) {
      const auto before = document.Revision();
      EditAtRandom(document, random);
      if (document.Revision() == before) {
        EXPECT_EQ(Content(document), states.back());  // it failed, or changed nothing
        continue;
      }
      states.emplace_back(document);
      revisions.push_back(document.Revision());
    }
    ASSERT_GT(states.size(), 10u);
    for (std::size_t i = states.size() - 1; i > 0; --i) {
      EXPECT_EQ(Content(document), states[i]);
      ASSERT_TRUE(document.CanUndo());
      document.Undo();
      EXPECT_EQ(document.Revision(), revisions[i - 1]);
    }
    EXPECT_EQ(Content(document), states.front());
    EXPECT_FALSE(document.CanUndo());
    EXPECT_FALSE(document.IsDirty());
    while (document.CanRedo()) document.Redo();
    EXPECT_EQ(Content(document), states.back());
  }
}

TEST(PatientDocument, FailedEditsLeaveNothingBehind) {
  PatientDocument document = OpenBuiltIn();
  const Content before(document);
  const auto status = document.Edit("spoil", [](patient::Patient& p) -> base::Status {
    p.tubes.clear();
    return base::Error{base::ErrorCode::kPatientInvalid, "no"};
  });
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(Content(document), before);
  EXPECT_FALSE(document.CanUndo());
  EXPECT_FALSE(document.IsDirty());
}

TEST(PatientDocument, GroupIsOneStep) {
  PatientDocument document = OpenBuiltIn();
  const Content before(document);
  document.BeginGroup("stroke");
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(document.Edit("dab", MoveFundus).ok());
  document.EndGroup();
  EXPECT_EQ(document.UndoName(), "stroke");
  document.Undo();
  EXPECT_EQ(Content(document), before);
  EXPECT_FALSE(document.CanUndo());
  EXPECT_EQ(document.RedoName(), "stroke");
  // a group that changes nothing is no step and leaves nothing to save
  document.BeginGroup("nothing");
  ASSERT_TRUE(document.Edit("there", MoveFundus).ok());
  ASSERT_TRUE(document
                  .Edit("and back",
                        [&](patient::Patient& p) -> base::Status {
                          p.landmarks = before.landmarks;
                          return {};
                        })
                  .ok());
  document.EndGroup();
  EXPECT_FALSE(document.CanUndo());
  EXPECT_FALSE(document.IsDirty());
}

TEST(PatientDocument, NewEditForgetsWhatWasUndoneAndTheOldestSteps) {
  PatientDocument document = OpenBuiltIn();
  ASSERT_TRUE(document.Edit("one", MoveFundus).ok());
  document.Undo();
  ASSERT_TRUE(document.Edit("two", MoveFundus).ok());
  EXPECT_FALSE(document.CanRedo());
  for (std::size_t i = 0; i < PatientDocument::kMaxSteps + 10; ++i) {
    ASSERT_TRUE(document
                    .Edit("many",
                          [&](patient::Patient& p) {
                            return PlaceLandmark(p, "mark", {0.001 * static_cast<double>(i), 0, 0});
                          })
                    .ok());
  }
  std::size_t steps = 0;
  for (; document.CanUndo(); ++steps) document.Undo();
  EXPECT_EQ(steps, PatientDocument::kMaxSteps);
}

class PatientDocumentFolder : public testing::Test {
 protected:
  void SetUp() override { fs::copy(kBuiltIn, base_.Path() / "patient", fs::copy_options::recursive); }
  PatientDocument Open(bool is_recovered = false) {
    auto document = PatientDocument::Open(base_.Path() / "patient", is_recovered);
    EXPECT_TRUE(document.ok()) << document.error().Text();
    return std::move(document).value();
  }
  test::TemporaryFolder base_;
};

TEST_F(PatientDocumentFolder, AutosaveIsFoundRecoveredAndRemovedBySaving) {
  const fs::path folder = base_.Path() / "patient";
  Content edited = [&] {
    PatientDocument document = Open();
    EXPECT_FALSE(PatientDocument::HasAutosave(folder));
    EXPECT_FALSE(*document.Autosave());  // nothing has changed
    EXPECT_TRUE(document.Edit("fundus", MoveFundus).ok());
    EXPECT_TRUE(*document.Autosave());
    EXPECT_FALSE(*document.Autosave());  // nothing since
    return Content(document);
    // the program dies here
  }();
  ASSERT_TRUE(PatientDocument::HasAutosave(folder));
  EXPECT_NE(Content(Open()), edited);  // the patient itself was not touched
  PatientDocument recovered = Open(true);
  EXPECT_TRUE(recovered.IsDirty());
  EXPECT_NEAR(Distance(recovered.GetPatient().FindLandmark("fundus")->position, edited.landmarks[0].position),
              0, 1e-9);
  ASSERT_TRUE(recovered.Save(folder).ok());
  EXPECT_FALSE(recovered.IsDirty());
  EXPECT_FALSE(PatientDocument::HasAutosave(folder));
  EXPECT_FALSE(fs::exists(PatientDocument::AutosaveFolder(folder)));
  EXPECT_NEAR(Distance(Open().GetPatient().FindLandmark("fundus")->position, edited.landmarks[0].position), 0,
              1e-9);
}

TEST_F(PatientDocumentFolder, SavingElsewhereLeavesTheFirstPatient) {
  PatientDocument document = Open();
  ASSERT_TRUE(document.Edit("fundus", MoveFundus).ok());
  const Content original(Open());
  ASSERT_TRUE(document.Save(base_.Path() / "other").ok());
  EXPECT_EQ(document.Folder(), base_.Path() / "other");
  EXPECT_EQ(Content(Open()), original);
  // undo after saving makes it dirty again
  document.Undo();
  EXPECT_TRUE(document.IsDirty());
  document.Redo();
  EXPECT_FALSE(document.IsDirty());
}

TEST_F(PatientDocumentFolder, FailedSaveStaysDirty) {
  PatientDocument document = Open();
  ASSERT_TRUE(document.Edit("fundus", MoveFundus).ok());
  fs::create_directories(base_.Path() / "mine");
  {
    std::FILE* file = std::fopen((base_.Path() / "mine/notes.txt").c_str(), "w");
    std::fclose(file);
  }
  const auto status = document.Save(base_.Path() / "mine");  // somebody's folder
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_TRUE(document.IsDirty());
  EXPECT_EQ(document.Folder(), base_.Path() / "patient");
}

TEST(PatientDocument, MissingFolderIsAnError) {
  EXPECT_FALSE(PatientDocument::Open("/nowhere/at/all").ok());
}

}  // namespace
}  // namespace trocar::anatomy
