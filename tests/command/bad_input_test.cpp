// SPDX-License-Identifier: Apache-2.0
// Bad input: a code, a remedy, an exit status that is not 0, and nothing half-written.
#include <map>

#include "command_fixture.h"
#include "trocar/render/image.h"

namespace trocar {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Nine slices of a bright ball, and control points around it.
class BadImages : public Command {
 protected:
  static constexpr int kSize = 48;

  void SetUp() override {
    for (int slice = 1; slice <= 9; ++slice) WriteSlice(slice, kSize);
    Write("points.json", PointsText("[34, 24]"));
  }
  void WriteSlice(int slice, int size) const {
    render::Image image{size, size, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * size * size), 30)};
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const bool is_inside =
            (x - 24) * (x - 24) + (y - 24) * (y - 24) + 9 * (slice - 5) * (slice - 5) <= 144;
        if (is_inside) image.pixels[static_cast<std::size_t>(3 * (y * size + x))] = 200;
      }
    }
    ASSERT_TRUE(render::WritePng(Path("images/slice-" + std::to_string(slice) + ".png"), image).ok());
  }
  /// Control points whose first contour has this point.
  static std::string PointsText(const std::string& point) {
    std::string slices;
    for (int slice = 2; slice <= 8; ++slice) {
      slices += std::string(slice == 2 ? "" : ",") + "{\"slice\": " + std::to_string(slice) +
                ", \"contours\": [[" + (slice == 2 ? point : "[34, 24]") +
                ", [31, 31], [24, 34], [17, 31], [14, 24], [17, 17], [24, 14], [31, 17]]]}";
    }
    return R"({"format": "trocar-control-points", "version": 1, "name": "Ball", "provenance": "made by a test",
      "images": {"pattern": "slice-{slice}.png", "first_slice": 1, "last_slice": 9, "width": 48, "height": 48,
        "pixel_mm": 1.0, "slice_mm": 3.0, "axes": {"column": "left", "row": "anterior", "slice": "inferior"}},
      "structures": [{"name": "liver", "triangle_budget": 500, "slices": [)" +
           slices + R"(]}], "tubes": [], "landmarks": []})";
  }
  test::ProcessResult Build() {
    return Run({"anatomy", "build", Path("points.json"), "--images", Path("images"), "-o", Path("patient"),
                "--overlays", Path("overlays")});
  }
  /// The code and a place in the message, and no output.
  void ExpectRefused(const std::string& code, const std::string& place) {
    const auto result = Build();
    ExpectError(result, code);
    EXPECT_THAT(result.err, HasSubstr(place));
    EXPECT_FALSE(std::filesystem::exists(Path("patient")));
    EXPECT_FALSE(std::filesystem::exists(Path("overlays")));
  }
};

TEST_F(BadImages, MissingFolder) {
  std::filesystem::remove_all(Path("images"));
  ExpectRefused("E-IMG-001", "images");
}

TEST_F(BadImages, MissingSlice) {
  std::filesystem::remove(Path("images/slice-4.png"));
  ExpectRefused("E-IMG-002", "slice-4.png");
}

TEST_F(BadImages, SliceOfAnotherSize) {
  WriteSlice(4, 40);
  ExpectRefused("E-IMG-003", "slice-4.png");
}

TEST_F(BadImages, SliceThatIsNoPicture) {
  Write("images/slice-4.png", "not a picture");
  ExpectRefused("E-IMG-004", "slice-4.png");
}

TEST_F(BadImages, ControlPointOutsideItsImage) {
  Write("points.json", PointsText("[48, 24]"));
  ExpectRefused("E-ANA-001", "points.json");
}

TEST_F(BadImages, BrokenJson) {
  Write("points.json", PointsText("[34, 24").substr(0, 400));
  ExpectRefused("E-IO-004", "points.json");
}

TEST_F(BadImages, MissingControlPoints) {
  std::filesystem::remove(Path("points.json"));
  ExpectRefused("E-IO-001", "points.json");
}

/// A copy of the built-in scene whose files can be spoilt.
class BadScene : public Command {
 protected:
  void SetUp() override {
    std::filesystem::copy(Source("scenes"), Path("scenes"), std::filesystem::copy_options::recursive);
    std::filesystem::create_directory_symlink(Source("assets"), Path("assets"));
  }
  void Replace(const std::string& file, const std::string& what, const std::string& with) {
    std::string text = Read(Path(file));
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what << " is not in " << file;
    Write(file, text.replace(at, what.size(), with));
  }
  test::ProcessResult Simulate() {
    return Run({"simulate", Path("scenes/demonstration.json"), "--ticks", "2", "--json"});
  }
  test::ProcessResult Demo(const std::vector<std::string>& environment = {}) {
    return Run({"demo", Path("scenes/demonstration.json"), "-o", Path("out/demo"), "--size", "160x90",
                "--seconds", "0.1"},
               environment);
  }
};

TEST_F(BadScene, IsReadableBeforeItIsSpoilt) {
  EXPECT_EQ(Simulate().status, 0) << Simulate().err;
}

TEST_F(BadScene, MissingScene) {
  ExpectError(Run({"simulate", Path("nowhere.json"), "--ticks", "1"}), "E-IO-001");
}

TEST_F(BadScene, SceneThatIsAFolder) {
  ExpectError(Run({"simulate", Path("scenes"), "--ticks", "1"}), "E-IO-002");
}

TEST_F(BadScene, BrokenJson) {
  Write("scenes/demonstration.json", "{\"format\": \"trocar-scene\",");
  ExpectError(Simulate(), "E-IO-004");
}

TEST_F(BadScene, MissingPatient) {
  Replace("scenes/demonstration.json", "assets/patients", "assets/nobody");
  ExpectError(Simulate(), "E-IO-001");
}

TEST_F(BadScene, MisspeltSetting) {
  Replace("scenes/demonstration.json", "\"stiffness_scale\"", "\"stifness_scale\"");
  const auto result = Simulate();
  ExpectError(result, "E-IO-005");
  EXPECT_THAT(result.err, HasSubstr("stifness_scale"));
}

TEST_F(BadScene, NanInTheScript) {
  for (const char* bad : {"NaN", "nan", "Infinity", "1e999", "\"NaN\"", "null"}) {
    SCOPED_TRACE(bad);
    std::filesystem::remove_all(Path("scenes"));
    std::filesystem::copy(Source("scenes"), Path("scenes"), std::filesystem::copy_options::recursive);
    Replace("scenes/demonstration.script.json",
            "\"time_s\": ", std::string("\"time_s\": ") + bad + ", \"unused\": ");
    const auto result = Simulate();
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, AnyOf(StartsWith("trocar: E-IO-004 "), StartsWith("trocar: E-IO-005 "),
                                  StartsWith("trocar: E-IO-006 ")));
    EXPECT_THAT(result.err, HasSubstr("demonstration.script.json"));
  }
}

TEST_F(BadScene, NoOpenGlLeavesNothingBehind) {
  Write("empty.json", "{}");
  const auto result = Demo({"__EGL_VENDOR_LIBRARY_FILENAMES=" + Path("empty.json")});
  ExpectError(result, "E-GL-001");
  EXPECT_FALSE(std::filesystem::exists(Path("out/demo")));
  if (std::filesystem::exists(Path("out"))) {
    EXPECT_TRUE(std::filesystem::is_empty(Path("out")));
  }
}

TEST_F(BadScene, FolderThatCannotBeWritten) {
  Write("out", "a file where the folder should be");
  const auto result = Demo();
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("trocar: E-"));
  EXPECT_EQ(Read(Path("out")), "a file where the folder should be");
}

}  // namespace
}  // namespace trocar
