// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/options.h"

#include <gtest/gtest.h>

#include <vector>

#include "trocar/record/recording.h"

#include <initializer_list>
#include <vector>

namespace trocar::presenter {
namespace {

base::Result<CommandLine> Parse(std::initializer_list<const char*> arguments) {
  std::vector<const char*> argv{"trocar-window"};
  argv.insert(argv.end(), arguments);
  return ParseCommandLine(static_cast<int>(argv.size()), argv.data());
}

TEST(Options, DefaultsOpenTheBuiltInSceneInAWindow) {
  const base::Result<CommandLine> command = Parse({});
  ASSERT_TRUE(command.ok());
  EXPECT_FALSE(command->is_text_only);
  EXPECT_TRUE(command->options.scene.empty());
  EXPECT_TRUE(command->options.run.IsAttended());
  EXPECT_TRUE(command->contours.images.empty());
  EXPECT_TRUE(command->patient_editor.patient.empty());
  EXPECT_FALSE(command->options.is_fullscreen);
}

TEST(Options, ReadsEveryOption) {
  const base::Result<CommandLine> command =
      Parse({"--scene", "a.json", "--threads", "2", "--fullscreen", "--demonstration", "--screenshot",
             "b.png", "--after", "1.5"});
  ASSERT_TRUE(command.ok());
  EXPECT_EQ(command->options.scene, "a.json");
  EXPECT_EQ(command->options.threads, 2);
  EXPECT_TRUE(command->options.is_fullscreen);
  EXPECT_TRUE(command->options.is_demonstration);
  EXPECT_EQ(command->options.run.screenshot, "b.png");
  EXPECT_EQ(command->options.run.screenshot_after, 1.5);
}

TEST(Options, APersonsAttemptsAreKept) {
  const auto recordings = [](std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "trocar-window");
    const auto command = ParseCommandLine(static_cast<int>(arguments.size()), arguments.data());
    EXPECT_TRUE(command.ok());
    return command->options.recordings;
  };
  EXPECT_EQ(recordings({}), record::FindRecordingFolder());
  EXPECT_EQ(recordings({"--recordings", "kept"}), "kept");
  EXPECT_EQ(recordings({"--no-recordings"}), "");
  EXPECT_EQ(recordings({"--screenshot", "window.png"}), "") << "nobody plays";
  EXPECT_EQ(recordings({"--screenshot", "window.png", "--recordings", "kept"}), "kept");
}

TEST(Options, ReadsTasks) {
  const base::Result<CommandLine> command =
      Parse({"--task", "clip_and_cut", "--level", "hard", "--seed", "9"});
  ASSERT_TRUE(command.ok()) << command.error().Text();
  EXPECT_EQ(command->options.task, "clip_and_cut");
  EXPECT_EQ(command->options.level, "hard");
  EXPECT_EQ(command->options.seed, 9u);
  const base::Result<CommandLine> list = Parse({"--tasks"});
  ASSERT_TRUE(list.ok());
  EXPECT_TRUE(list->options.is_task_list);
  EXPECT_FALSE(Parse({"--tasks", "--task", "clip_and_cut"}).ok());
  EXPECT_FALSE(Parse({"--seed", "9"}).ok()) << "of which task?";
}

TEST(Options, ReadsWhatIsReplayed) {
  const base::Result<CommandLine> command =
      Parse({"--replay", "a.trocar", "--beside", "b.trocar", "--recordings", "kept"});
  ASSERT_TRUE(command.ok()) << command.error().Text();
  EXPECT_EQ(command->options.replay, "a.trocar");
  EXPECT_EQ(command->options.replay_beside, "b.trocar");
  EXPECT_EQ(command->options.recordings, "kept") << "for whoever takes over";
  for (const auto& wrong : std::initializer_list<std::initializer_list<const char*>>{
           {"--beside", "b.trocar"},
           {"--replay", "a.trocar", "--task", "peg_transfer"},
           {"--replay", "a.trocar", "--scene", "s.json"},
           {"--replay", "a.trocar", "--screenshot", "p.png"}}) {
    EXPECT_FALSE(Parse(wrong).ok());
  }
}

TEST(Options, ReadsTheContourWindowsOptions) {
  const base::Result<CommandLine> command =
      Parse({"--contours", "slices", "--points", "p.json", "--reference", "l.nii.gz", "--pixel-mm", "0.5",
             "--slice-mm", "2", "--axes", "left,posterior,superior", "--script", "s", "--measure", "--series",
             "2", "--pattern", "s{slice}.png"});
  ASSERT_TRUE(command.ok()) << command.error().Text();
  const editor::ContourOptions& options = command->contours;
  EXPECT_EQ(options.images, "slices");
  EXPECT_EQ(options.points, "p.json");
  EXPECT_EQ(options.reference, "l.nii.gz");
  EXPECT_EQ(options.series.pixel_mm, 0.5);
  EXPECT_EQ(options.series.slice_mm, 2.0);
  EXPECT_EQ((*options.series.axes)[1], "posterior");
  EXPECT_EQ(options.series.series, 2);
  EXPECT_EQ(options.series.pattern, "s{slice}.png");
  EXPECT_EQ(options.script, "s");
  EXPECT_TRUE(options.is_measuring);
  for (const auto& wrong : std::initializer_list<std::initializer_list<const char*>>{
           {"--points", "p.json"},
           {"--contours", "a", "--scene", "b"},
           {"--contours", "a", "--axes", "left,posterior"},
           {"--contours", "a", "--axes", "left,posterior,superior,left"},
           {"--contours", "a", "--pixel-mm", "0"},
           {"--contours", "a", "--series", "0"}}) {
    EXPECT_FALSE(Parse(wrong).ok());
  }
}

TEST(Options, ReadsThePatientEditorsOptions) {
  const base::Result<CommandLine> command =
      Parse({"--edit-patient", "folder", "--tool", "tubes", "--screenshot", "p.png", "--after", "2"});
  ASSERT_TRUE(command.ok()) << command.error().Text();
  EXPECT_EQ(command->patient_editor.patient, "folder");
  EXPECT_EQ(command->patient_editor.tool, editor::EditorTool::kTubes);
  EXPECT_EQ(command->patient_editor.run.screenshot, "p.png");
  EXPECT_EQ(command->patient_editor.run.screenshot_after, 2);
  EXPECT_FALSE(command->contours.IsAttended());
  EXPECT_FALSE(Parse({"--edit-patient", "folder", "--tool", "saw"}).ok());
  EXPECT_FALSE(Parse({"--edit-patient", "folder", "--contours", "slices"}).ok());
  EXPECT_FALSE(Parse({"--tool", "tubes"}).ok()) << "of which patient?";
}

TEST(Options, ReadsTheDevicePagesOptions) {
  const base::Result<CommandLine> command = Parse({"--devices", "--device", "gamepad", "--calibrate", "tip"});
  ASSERT_TRUE(command.ok()) << command.error().Text();
  EXPECT_TRUE(command->options.is_device_page);
  EXPECT_EQ(command->options.calibrate, "tip");
  EXPECT_FALSE(Parse({"--calibrate", "tip"}).ok());
}

TEST(Options, HelpAndVersionArePrinted) {
  const base::Result<CommandLine> help = Parse({"--help"});
  ASSERT_TRUE(help.ok());
  EXPECT_TRUE(help->is_text_only);
  EXPECT_NE(help->text.find("--scene"), std::string::npos);
  const base::Result<CommandLine> version = Parse({"--version"});
  ASSERT_TRUE(version.ok());
  EXPECT_EQ(version->text.find("trocar-window "), 0u);
}

TEST(Options, WrongOnesNameTheRemedy) {
  for (const auto& arguments :
       std::initializer_list<std::initializer_list<const char*>>{{"--nonsense"},
                                                                 {"--threads", "-1"},
                                                                 {"--threads", "many"},
                                                                 {"--after", "nan", "--screenshot", "a.png"},
                                                                 {"--after", "2"},
                                                                 {"--scene"}}) {
    const base::Result<CommandLine> command = Parse(arguments);
    ASSERT_FALSE(command.ok());
    EXPECT_EQ(command.error().code, base::ErrorCode::kUsage);
    EXPECT_NE(command.error().message.find("trocar-window --help"), std::string::npos);
  }
}

TEST(Options, ThreadsLeaveProcessorsForDrawing) {
  EXPECT_EQ(ChooseThreads(0), 1);
  EXPECT_EQ(ChooseThreads(2), 1);
  EXPECT_EQ(ChooseThreads(8), 4);
  EXPECT_EQ(ChooseThreads(64), 4);
}

}  // namespace
}  // namespace trocar::presenter
