// SPDX-License-Identifier: Apache-2.0
#include "trocar/environment/pool.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "trocar/math/random.h"

namespace trocar::environment {
namespace {

class PoolTest : public testing::Test {
 protected:
  static std::shared_ptr<EnvironmentModel> MakeModel(double most_seconds = 0) {
    auto made =
        EnvironmentModel::Make({.task = "lift_and_grasp", .layouts = 2, .most_seconds = most_seconds});
    EXPECT_TRUE(made.ok());
    return *made;
  }
  std::unique_ptr<Pool> MakePool(const PoolSettings& settings, double most_seconds = 0) {
    auto made = Pool::Make(MakeModel(most_seconds), settings);
    EXPECT_TRUE(made.ok());
    return std::move(*made);
  }
  static void ResetAll(Pool& pool, std::uint64_t seed) {
    std::vector<std::int32_t> ids;
    ASSERT_TRUE(pool.Reset({}, seed).ok());
    ASSERT_TRUE(pool.Receive(static_cast<std::size_t>(pool.Count()), ids).ok());
  }
  static std::vector<double> DrawActions(const Pool& pool, math::Random& random) {
    std::vector<double> actions(static_cast<std::size_t>(pool.Count()) * pool.Model().ActionSize());
    for (double& value : actions) value = random.Uniform(-1, 1);
    return actions;
  }
};

TEST_F(PoolTest, GivesTheSameBitsWithAnyNumberOfThreads) {
  std::array<std::vector<float>, 2> states;
  for (const int threads : {1, 3}) {
    const auto pool = MakePool({.count = 3, .threads = threads});
    ResetAll(*pool, 4);
    math::Random random(1);
    std::vector<std::int32_t> ids;
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(pool->Send(DrawActions(*pool, random), {}).ok());
      ASSERT_TRUE(pool->Receive(3, ids).ok());
    }
    states[threads / 2] = pool->Rows().state;
  }
  EXPECT_EQ(states[0], states[1]);
}

TEST_F(PoolTest, IsAsManyEnvironments) {
  const auto pool = MakePool({.count = 2});
  ResetAll(*pool, 4);
  math::Random random(1);
  std::vector<std::int32_t> ids;
  auto model = MakeModel();
  auto alone = std::move(*Environment::Make(model));
  ASSERT_TRUE(alone.Reset(5).ok());  // environment 1 begins with seed 4 + 1
  const std::size_t size = model->ActionSize();
  for (int i = 0; i < 10; ++i) {
    const auto actions = DrawActions(*pool, random);
    ASSERT_TRUE(pool->Send(actions, {}).ok());
    ASSERT_TRUE(pool->Receive(2, ids).ok());
    const auto outcome = alone.Step(std::span(actions).subspan(size, size));
    ASSERT_TRUE(outcome.ok());
    EXPECT_EQ(outcome->reward, pool->Rows().reward[1]);
  }
  std::vector<float> state(model->StateSize());
  alone.Observe(state);
  EXPECT_TRUE(std::equal(state.begin(), state.end(),
                         pool->Rows().state.begin() + static_cast<std::ptrdiff_t>(state.size())));
}

TEST_F(PoolTest, TakesASeedForEach) {
  const auto pool = MakePool({.count = 3}), same = MakePool({.count = 3});
  ResetAll(*pool, 4);
  ResetAll(*same, 4);
  std::vector<std::int32_t> ids;
  // the second goes on with its row of episodes
  const std::vector<std::optional<std::uint64_t>> seeds = {9, {}, 5}, few = {1, 2};
  ASSERT_TRUE(pool->ResetEach({}, seeds).ok());
  ASSERT_TRUE(pool->Receive(3, ids).ok());
  EXPECT_EQ(pool->ResetEach({}, few).error().code, base::ErrorCode::kUsage);
  EXPECT_EQ(pool->AtWork(), 0u);
  const std::vector<std::int32_t> first = {0}, second = {1}, third = {2};
  ASSERT_TRUE(same->Reset(first, 9).ok());
  ASSERT_TRUE(same->Reset(second, {}).ok());
  ASSERT_TRUE(same->Reset(third, 3).ok());  // and its own number
  ASSERT_TRUE(same->Receive(3, ids).ok());
  EXPECT_EQ(pool->Rows().state, same->Rows().state);
}

TEST_F(PoolTest, WorksOnSomeWhileOthersWait) {
  const auto pool = MakePool({.count = 3, .threads = 2});
  ResetAll(*pool, 1);
  std::vector<double> action(pool->Model().ActionSize());
  const std::vector<std::int32_t> one = {2};
  ASSERT_TRUE(pool->Send(action, one).ok());
  EXPECT_EQ(pool->AtWork(), 1u);
  EXPECT_EQ(pool->Send(action, one).error().code, base::ErrorCode::kEnvironmentState);
  std::vector<std::int32_t> ids;
  EXPECT_EQ(pool->Receive(2, ids).error().code, base::ErrorCode::kEnvironmentState);
  ASSERT_TRUE(pool->Receive(1, ids).ok());
  EXPECT_EQ(ids, one);
}

TEST_F(PoolTest, ResetsAsItDeclares) {
  for (const Autoreset mode : {Autoreset::kNextStep, Autoreset::kSameStep, Autoreset::kDisabled}) {
    SCOPED_TRACE(static_cast<int>(mode));
    const auto pool = MakePool({.count = 1, .autoreset = mode}, 0.2);
    ResetAll(*pool, 1);
    const std::vector<float> first = pool->Rows().state;
    const std::vector<double> still(pool->Model().ActionSize());
    std::vector<std::int32_t> ids;
    for (int i = 0; i < 2; ++i) {
      ASSERT_TRUE(pool->Send(still, {}).ok());
      ASSERT_TRUE(pool->Receive(1, ids).ok());
    }
    EXPECT_TRUE(pool->Rows().truncated[0]);
    EXPECT_EQ(pool->Rows().was_reset[0] != 0, mode == Autoreset::kSameStep);
    const float time = pool->Rows().state.back();
    EXPECT_EQ(time == 0, mode == Autoreset::kSameStep);
    if (mode == Autoreset::kSameStep) {
      EXPECT_NEAR(pool->Rows().final_state.back(), 1, 1e-6);
    }
    const auto sent = pool->Send(still, {});
    if (mode == Autoreset::kDisabled) {
      EXPECT_EQ(sent.error().code, base::ErrorCode::kEnvironmentState);
      continue;
    }
    ASSERT_TRUE(sent.ok());
    ASSERT_TRUE(pool->Receive(1, ids).ok());
    EXPECT_FALSE(pool->Rows().truncated[0]);
    if (mode == Autoreset::kNextStep) {
      EXPECT_TRUE(pool->Rows().was_reset[0]);
      EXPECT_EQ(pool->Rows().reward[0], 0);
      EXPECT_EQ(pool->Rows().state.back(), 0);
    }
  }
}

TEST_F(PoolTest, HandsNothingOverWhereOneActionIsWrong) {
  const auto pool = MakePool({.count = 2});
  std::vector<double> actions(2 * pool->Model().ActionSize());
  EXPECT_EQ(pool->Send(actions, {}).error().code, base::ErrorCode::kEnvironmentState);  // not reset
  ResetAll(*pool, 1);
  actions.back() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(pool->Send(actions, {}).error().code, base::ErrorCode::kActionInvalid);
  EXPECT_EQ(pool->AtWork(), 0u);
  actions.pop_back();
  EXPECT_EQ(pool->Send(actions, {}).error().code, base::ErrorCode::kActionInvalid);
  const std::vector<std::int32_t> beyond = {2}, twice = {0, 0};
  EXPECT_EQ(pool->Reset(beyond, {}).error().code, base::ErrorCode::kUsage);
  EXPECT_EQ(pool->Reset(twice, {}).error().code, base::ErrorCode::kUsage);
}

TEST_F(PoolTest, SaysAfterAForkThatItsThreadsStayedBehind) {
  auto pool = MakePool({.count = 1});
  ResetAll(*pool, 1);
  const pid_t child = fork();
  if (child == 0) {
    const std::vector<double> still(pool->Model().ActionSize());
    std::vector<std::int32_t> ids;
    const auto is_refused = [](const base::Status& status) {
      return !status.ok() && status.error().code == base::ErrorCode::kEnvironmentState &&
             status.error().message.find("fork") != std::string::npos;
    };
    const bool holds = is_refused(pool->Send(still, {})) && is_refused(pool->Receive(1, ids)) &&
                       is_refused(pool->Reset({}, 1)) && pool->AtWork() == 0;
    pool.reset();
    _exit(holds ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace trocar::environment
