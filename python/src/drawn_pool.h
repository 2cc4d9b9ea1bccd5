// SPDX-License-Identifier: Apache-2.0
/// \file drawn_pool.h  A pool with what is seen of its environments beside their states.
#pragma once

#include <memory>

#include "camera.h"
#include "trocar/environment/pool.h"

namespace trocar::python {

struct DrawnPool {
  std::shared_ptr<PoolPictures> pictures;  ///< also of the pool's observer; empty where states are enough
  std::unique_ptr<environment::Pool> pool;
};

}  // namespace trocar::python
