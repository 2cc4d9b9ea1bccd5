// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/film_maker.h"

#include <algorithm>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/render/image.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/render/video_writer.h"

namespace trocar::view {
namespace {

constexpr int kGap = 4;  // between two pictures [pixels]

}  // namespace

struct FilmMaker::Content {
  render::OffscreenContext context;  // outlives what was made in it
  struct Pane {
    render::OffscreenTarget target;
    LaparoscopeView view;
    int left = 0;  // of it in the whole picture [pixels]
  };
  std::vector<Pane> panes;
  render::VideoWriter video;
  render::Image whole, part;
  std::uint64_t frames = 0;
};

FilmMaker::FilmMaker(std::unique_ptr<Content> content) : content_(std::move(content)) {}
FilmMaker::FilmMaker(FilmMaker&&) noexcept = default;
FilmMaker& FilmMaker::operator=(FilmMaker&&) noexcept = default;
FilmMaker::~FilmMaker() = default;

base::Result<FilmMaker> FilmMaker::Make(const FilmSettings& settings,
                                        std::span<const simulation::Simulation* const> simulations) {
  const int count = static_cast<int>(simulations.size());
  TROCAR_ASSERT(count > 0);
  if (settings.width < 16 * count + kGap * (count - 1) || settings.width > 4096 || settings.height < 16 ||
      settings.height > 4096)
    return base::Error{base::ErrorCode::kUsage, "a picture must have 16 to 4096 pixels a side"};
  auto context = render::OffscreenContext::Make();
  if (!context) return context.error();
  std::vector<Content::Pane> panes;
  const int pane_width = (settings.width - kGap * (count - 1)) / count;
  for (int i = 0; i < count; ++i) {
    auto target = render::OffscreenTarget::Make(pane_width, settings.height);
    if (!target) return target.error();
    const simulation::Simulation& simulation = *simulations[static_cast<std::size_t>(i)];
    auto view = LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(), simulation.GetSnapshot(),
                                      simulation.Strands());
    if (!view) return view.error();
    view->SetOptions(settings.view);
    panes.push_back({std::move(*target), std::move(*view), i * (pane_width + kGap)});
  }
  auto video = render::VideoWriter::Make(settings.video,
                                         {settings.width, settings.height, settings.frames_per_second});
  if (!video) return video.error();
  render::Image whole;
  whole.width = settings.width, whole.height = settings.height;
  whole.pixels.resize(3 * static_cast<std::size_t>(settings.width) *
                      static_cast<std::size_t>(settings.height));
  return FilmMaker(std::unique_ptr<Content>(
      new Content{std::move(*context), std::move(panes), std::move(*video), std::move(whole), {}, 0}));
}

base::Status FilmMaker::AddFrame(std::span<const Side> sides) {
  Content& c = *content_;
  TROCAR_ASSERT(sides.size() == c.panes.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    Content::Pane& pane = c.panes[i];
    pane.view.SetOverlay(sides[i].overlay);
    pane.view.Update(*sides[i].snapshot);
    pane.target.Bind();
    pane.view.Draw(pane.target.Width(), pane.target.Height());
    pane.target.Read(c.part);
    const auto row = static_cast<std::ptrdiff_t>(3 * c.part.width);
    for (int y = 0; y < c.part.height; ++y) {
      std::copy_n(c.part.pixels.begin() + y * row, row,
                  c.whole.pixels.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * c.whole.width + pane.left));
    }
  }
  ++c.frames;
  return c.video.AddFrame(c.whole);
}

std::uint64_t FilmMaker::FrameCount() const {
  return content_->frames;
}

base::Status FilmMaker::SavePicture(const std::filesystem::path& path) const {
  return render::WritePng(path, content_->whole);
}

base::Status FilmMaker::Finish() {
  return content_->video.Finish();
}

}  // namespace trocar::view
