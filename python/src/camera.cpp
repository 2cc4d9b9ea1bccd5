// SPDX-License-Identifier: Apache-2.0
#include "camera.h"

#include <algorithm>
#include <utility>

#include "contact_rows.h"
#include "forks.h"
#include "trocar/view/labels.h"

namespace trocar::python {

base::Result<std::unique_ptr<Camera>> Camera::Make(int width, int height) {
  if (width < 8 || width > 4096 || height < 8 || height > 4096)
    return base::Error{base::ErrorCode::kUsage, "a picture has 8 to 4096 pixels a side"};
  ExpectThreadsOfLibraries();
  auto context = render::OffscreenContext::Make();
  if (!context) return context.error();
  auto target = render::OffscreenTarget::Make(width, height);
  if (!target) return target.error();
  context->Release();
  return std::unique_ptr<Camera>(new Camera(
      std::make_unique<Graphics>(Graphics{std::move(*context), std::move(*target), std::nullopt})));
}

Camera::~Camera() {
  // without a context nothing of it can be taken down, in a fork for example: its memory is left
  if (!graphics_->context.MakeCurrent().ok()) static_cast<void>(graphics_.release());
}

template <typename Work>
base::Status Camera::InContext(const Work& work) {
  if (const auto current = graphics_->context.MakeCurrent(); !current) return current;
  const base::Status done = work();
  graphics_->context.Release();
  return done;
}

base::Status Camera::Show(const simulation::Simulation& simulation) {
  std::optional<view::LaparoscopeView>& view = graphics_->view;
  if (!view || scene_ != &simulation.GetScene() || model_ != simulation.ModelFingerprint()) {
    view.reset();
    auto made = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                            simulation.GetSnapshot(), simulation.Strands());
    if (!made) return made.error();
    view.emplace(std::move(*made));
    // exposure control remembers earlier pictures: here a picture is a function of the state alone
    view->SetOptions({.has_force_arrows = false, .has_automatic_exposure = false});
    scene_ = &simulation.GetScene();
    model_ = simulation.ModelFingerprint();
  }
  view->Update(simulation.GetSnapshot());
  focal_length_ = view->FocalLength(graphics_->target.Height());
  return {};
}

base::Status Camera::Draw(const simulation::Simulation& simulation, double light, render::Image& image) {
  return InContext([&]() -> base::Status {
    if (const auto shown = Show(simulation); !shown) return shown;
    view::ViewOptions options = graphics_->view->GetOptions();
    options.light_power = light;
    graphics_->view->SetOptions(options);
    render::OffscreenTarget& target = graphics_->target;
    target.Bind();
    graphics_->view->Draw(target.Width(), target.Height());
    target.Read(image);
    return {};
  });
}

base::Status Camera::LookAt(const simulation::Simulation& simulation, bool has_flow,
                            render::GeometryPicture& picture) {
  return InContext([&]() -> base::Status {
    if (const auto shown = Show(simulation); !shown) return shown;
    const int width = graphics_->target.Width(), height = graphics_->target.Height();
    return has_flow ? graphics_->view->DrawGeometryAndFlow(width, height, picture)
                    : graphics_->view->DrawGeometry(width, height, picture);
  });
}

PoolPictures::PoolPictures(int count, int width, int height, const Parts& parts)
    : width_(width), height_(height), parts_(parts), eyes_(static_cast<std::size_t>(count)) {
  const std::size_t pixels =
      static_cast<std::size_t>(count) * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (Rows* rows : {&now_, &final_}) {
    if (parts.has_picture) rows->picture.resize(3 * pixels);
    if (parts.has_depth) rows->depth.resize(pixels);
    if (parts.has_masks) rows->masks.resize(pixels);
    if (parts.has_normals) rows->normals.resize(3 * pixels);
    if (parts.has_contacts)
      rows->contacts.resize(static_cast<std::size_t>(count) * kContactRows * kContactNumbers);
  }
}

base::Status PoolPictures::Observe(std::int32_t id, const environment::Environment& environment,
                                   bool is_final) {
  Rows& rows = is_final ? final_ : now_;
  if (parts_.has_contacts) {
    constexpr std::size_t kNumbers = kContactRows * kContactNumbers;
    WriteContacts(environment.GetSimulation(),
                  std::span(rows.contacts).subspan(static_cast<std::size_t>(id) * kNumbers, kNumbers));
  }
  if (!parts_.IsDrawn()) return {};
  Eye& eye = eyes_[static_cast<std::size_t>(id)];
  if (eye.camera == nullptr) {
    auto made = Camera::Make(width_, height_);
    if (!made) return made.error();
    eye.camera = std::move(*made);
  }
  const auto first = static_cast<std::ptrdiff_t>(id) * width_ * height_;
  if (parts_.has_picture) {
    const double light = environment.Drawn()[static_cast<std::size_t>(environment::Varied::kLight)];
    if (const auto drawn = eye.camera->Draw(environment.GetSimulation(), light, eye.image); !drawn)
      return drawn;
    std::copy(eye.image.pixels.begin(), eye.image.pixels.end(), rows.picture.begin() + 3 * first);
  }
  if (!parts_.HasGeometry()) return {};
  if (const auto seen = eye.camera->LookAt(environment.GetSimulation(), false, eye.geometry); !seen)
    return seen;
  if (parts_.has_depth)
    std::copy(eye.geometry.depth.begin(), eye.geometry.depth.end(), rows.depth.begin() + first);
  if (parts_.has_masks) {
    std::transform(eye.geometry.labels.begin(), eye.geometry.labels.end(), rows.masks.begin() + first,
                   [](std::uint16_t label) { return static_cast<std::uint8_t>(view::ClassOf(label)); });
  }
  if (parts_.has_normals) {
    // single precision rounds the unit vectors' components beyond 1 at times
    std::transform(eye.geometry.normals.begin(), eye.geometry.normals.end(), rows.normals.begin() + 3 * first,
                   [](float v) { return std::clamp(v, -1.0F, 1.0F); });
  }
  return {};
}

}  // namespace trocar::python
