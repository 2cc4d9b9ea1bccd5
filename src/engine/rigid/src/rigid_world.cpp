// SPDX-License-Identifier: Apache-2.0
#include "trocar/rigid/rigid_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "bullet_units.h"
#include "capsule_on_box.h"
#include "hold_constraint.h"
#include "own_motion.h"
#include "reduced_contacts.h"
#include "rigid_shapes.h"
#include "rigid_state.h"
#include "trocar/base/assert.h"
#include "trocar/base/state_archive.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/state_fields.h"

namespace trocar::rigid {

using math::Pose;
using math::Vec3;

namespace {

constexpr int kFewestSubsteps = 4;  // of a tick: pegs are thin
constexpr int kMostSubsteps = 32;
constexpr int kSlipTicks = 3;           // the pull must exceed the hold that many ticks in a row
constexpr double kRestSpeed = 1e-3;     // [m/s]
constexpr double kRestTurn = 0.05;      // [rad/s]
constexpr double kSleepSpeed = 0.3;     // [cm/s]
constexpr double kSleepTurn = 0.3;      // [rad/s]
constexpr double kJawStiffness = 1500;  // of what jaws press [N/m]
constexpr double kJawDamping = 2;       // [N s/m]
// what is held gives way as rubber does: two hands that hold one thing, or a hand and the board, do not tear at it when
// they tremble
constexpr double kHoldStiffness =
    1970;                             // [N/m]; measured with Bullet's error reduction: 2.8 N for a millimetre
constexpr double kHoldDamping = 5.9;  // [N s/m]
constexpr double kWorldRadius = 1.0;  // what is farther away has left the scene and stops [m]
constexpr int kSolverIterations = 30;  // at most: stacks stand
constexpr double kConvergedSpeed =
    1e-5;  // no constraint changes a speed by more in the last iteration [m/s]; a hundredth of kRestSpeed
constexpr int kPooledManifolds = 512;  // more are taken from the heap

/// Bullet's own constructor leaves the numbers as they are in memory.
btJointFeedback NoFeedback() {
  const btVector3 zero(0, 0, 0);
  btJointFeedback feedback;
  feedback.m_appliedForceBodyA = feedback.m_appliedForceBodyB = zero;
  feedback.m_appliedTorqueBodyA = feedback.m_appliedTorqueBodyB = zero;
  return feedback;
}

bool IsFinite(const Pose& X) {
  const double sum = X.rotation.w + X.rotation.x + X.rotation.y + X.rotation.z + X.translation.x +
                     X.translation.y + X.translation.z;
  return std::isfinite(sum);
}

base::Error Refuse(const std::string& why) {
  return {base::ErrorCode::kSceneInvalid, why};
}

/// Keeps the deepest of a tool part's contacts with a body.
struct Deepest : btCollisionWorld::ContactResultCallback {
  explicit Deepest(const btCollisionObject& tool_part) : tool(&tool_part) {}
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    if (point.getDistance() >= distance) return 0;
    distance = point.getDistance();
    const bool is_first = a->getCollisionObject() == tool;
    on_tool = is_first ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
    const btVector3 into_body = (is_first ? -1.0 : 1.0) * point.m_normalWorldOnB;
    into = {into_body.x(), into_body.y(), into_body.z()};
    return 0;
  }
  const btCollisionObject* tool;
  double distance = 1e9;  // [cm]
  btVector3 on_tool{0, 0, 0};
  Vec3 into;
};

}  // namespace

struct RigidWorld::Content {
  struct Tool {
    std::array<ToolCapsule, kToolPartCount> capsules;
    std::array<std::unique_ptr<btCollisionShape>, kToolPartCount> shapes;
    std::array<std::unique_ptr<btRigidBody>, kToolPartCount> parts;
    std::array<btTransform, kToolPartCount> from, to;
    std::unique_ptr<HoldConstraint> hold;
    btJointFeedback feedback = NoFeedback();
    std::int32_t held = -1;
    double hold_force = 0;
    int ticks_over = 0;
    Vec3 force;                                                     // of the last Step
    std::array<std::vector<std::uint8_t>, kToolPartCount> touched;  // by body
  };
  struct Body {
    RigidBody definition;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;  // the last is the whole
    std::unique_ptr<btRigidBody> body;
    double thinnest = 0;        // half of its thinnest part's width [m]
    std::uint64_t touches = 0;  // bits of other bodies, at the end of the last Step
  };

  Vec3 gravity;
  double tick_seconds;
  // order matters: the world goes before what it is made of
  CapsuleOnBox::CreateFunc capsule_on_box;
  std::unique_ptr<btDefaultCollisionConfiguration> configuration;
  std::unique_ptr<btCollisionDispatcher> dispatcher;
  std::unique_ptr<btDbvtBroadphase> broadphase;
  std::unique_ptr<OwnMotionSolver> solver;
  std::vector<Body> bodies;
  std::vector<Tool> tools;
  std::unique_ptr<ReducedContactWorld> world;

  ~Content() { Clear(); }

  void Clear() {
    for (Tool& tool : tools) {
      if (tool.hold && world) world->removeConstraint(tool.hold.get());
      tool.hold.reset();
      for (auto& part : tool.parts) {
        if (part && world) world->removeRigidBody(part.get());
        part.reset();
      }
    }
    for (Body& body : bodies) {
      if (body.body && world) world->removeRigidBody(body.body.get());
      body.body.reset();
    }
    world.reset();
  }

  /// A new world with everything as it was added.
  void Build() {
    Clear();
    if (!configuration) {
      btDefaultCollisionConstructionInfo sizes;
      sizes.m_defaultMaxPersistentManifoldPoolSize = kPooledManifolds;
      sizes.m_defaultMaxCollisionAlgorithmPoolSize = kPooledManifolds;
      sizes.m_customCollisionAlgorithmMaxElementSize = sizeof(CapsuleOnBox);
      configuration = std::make_unique<btDefaultCollisionConfiguration>(sizes);
      // it fills two tables of 36 x 36; without bodies it remembers nothing, so one does for all worlds
      dispatcher = std::make_unique<btCollisionDispatcher>(configuration.get());
      dispatcher->registerCollisionCreateFunc(CAPSULE_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE, &capsule_on_box);
      dispatcher->registerCollisionCreateFunc(BOX_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE, &capsule_on_box);
      // as any two polyhedra: what Bullet has for boxes sorts contacts by angles from the C library
      dispatcher->registerCollisionCreateFunc(BOX_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE,
                                              configuration->getCollisionAlgorithmCreateFunc(
                                                  CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE));
    }
    TROCAR_ASSERT(dispatcher->getNumManifolds() == 0);
    solver = std::make_unique<OwnMotionSolver>();
    broadphase = std::make_unique<btDbvtBroadphase>();
    world = std::make_unique<ReducedContactWorld>(dispatcher.get(), broadphase.get(), solver.get(),
                                                  configuration.get());
    world->setGravity(ToBullet(gravity));
    world->getSolverInfo().m_numIterations = kSolverIterations;
    world->getSolverInfo().m_leastSquaresResidualThreshold =
        kConvergedSpeed * kScale * (kConvergedSpeed * kScale);
    world->getSolverInfo().m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
    for (std::size_t i = 0; i < bodies.size(); ++i) Add(i);
    for (std::size_t i = 0; i < tools.size(); ++i) AddToolParts(i);
  }

  void Add(std::size_t index) {
    Body& body = bodies[index];
    if (body.shapes.empty()) MakeShapes(body.definition, body.shapes);
    btCollisionShape* whole = body.shapes.back().get();
    btVector3 inertia(0, 0, 0);
    if (body.definition.mass > 0) whole->calculateLocalInertia(body.definition.mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(body.definition.mass, nullptr, whole, inertia);
    info.m_startWorldTransform = ToBullet(body.definition.X_world_body);
    info.m_friction = body.definition.friction;
    info.m_rollingFriction = 0.002;  // rubber and wood: a ring does not roll for ever
    info.m_spinningFriction = 0.002;
    info.m_linearSleepingThreshold = kSleepSpeed;
    info.m_angularSleepingThreshold = kSleepTurn;
    info.m_linearDamping = 0.01;
    info.m_angularDamping = 0.05;
    body.body = std::make_unique<btRigidBody>(info);
    body.body->setUserIndex(static_cast<int>(index));
    body.body->setUserIndex2(-1);
    world->addRigidBody(body.body.get());
  }

  void AddToolParts(std::size_t index) {
    Tool& tool = tools[index];
    for (int part = 0; part < kToolPartCount; ++part) {
      const ToolCapsule& capsule = tool.capsules[part];
      if (!tool.shapes[part]) {
        tool.shapes[part] =
            std::make_unique<btCapsuleShapeZ>(capsule.radius * kScale, 2 * capsule.half_length * kScale);
      }
      btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, tool.shapes[part].get());
      info.m_startWorldTransform = tool.to[part];
      info.m_friction = 1;
      tool.parts[part] = std::make_unique<btRigidBody>(info);
      btRigidBody& body = *tool.parts[part];
      body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
      body.setActivationState(DISABLE_DEACTIVATION);
      // jaws are profiled and things are of rubber: what one hand holds is not torn out of it by the other's jaws
      if (part != kShaftPart) body.setContactStiffnessAndDamping(kJawStiffness, kJawDamping);
      body.setUserIndex(static_cast<int>(index));
      body.setUserIndex2(part);
      world->addRigidBody(&body);
      tool.touched[part].assign(bodies.size(), 0);
    }
    tool.from = tool.to;
    tool.held = -1;
    tool.ticks_over = 0;
    tool.force = {};
  }

  /// So many that no body goes further in one than half of its thinnest part: nothing falls through a board.
  int CountSubsteps() const {
    double most = kFewestSubsteps;
    for (const Body& body : bodies) {
      if (!(body.definition.mass > 0)) continue;
      const double way = math::Norm(FromBullet(body.body->getLinearVelocity())) * tick_seconds;
      most = std::max(most, std::ceil(way / (0.5 * body.thinnest)));
    }
    return base::TruncateTo<int>(std::min(most, static_cast<double>(kMostSubsteps)));
  }

  static bool IsTouching(const btPersistentManifold& manifold) {
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      if (manifold.getContactPoint(p).getDistance() <= kMargin) return true;
    }
    return false;
  }

  void RecordTouch(const btPersistentManifold& manifold) {
    const int a = manifold.getBody0()->getUserIndex(), b = manifold.getBody1()->getUserIndex();
    if (a >= 64 || b >= 64 || !IsTouching(manifold)) return;
    bodies[static_cast<std::size_t>(a)].touches |= std::uint64_t{1} << b;
    bodies[static_cast<std::size_t>(b)].touches |= std::uint64_t{1} << a;
  }

  /// Impulses of one substep on the tools, and who touched whom.
  void GatherContacts() {
    for (Body& body : bodies) body.touches = 0;
    for (int m = 0; m < dispatcher->getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(m);
      if (manifold.getBody0()->getUserIndex2() < 0 && manifold.getBody1()->getUserIndex2() < 0) {
        RecordTouch(manifold);
        continue;
      }
      for (const bool is_first : {true, false}) {
        const btCollisionObject* own = is_first ? manifold.getBody0() : manifold.getBody1();
        const btCollisionObject* other = is_first ? manifold.getBody1() : manifold.getBody0();
        if (own->getUserIndex2() < 0 || other->getUserIndex2() >= 0) continue;
        Tool& tool = tools[static_cast<std::size_t>(own->getUserIndex())];
        auto& touched = tool.touched[static_cast<std::size_t>(own->getUserIndex2())];
        btVector3 impulse(0, 0, 0);
        for (int p = 0; p < manifold.getNumContacts(); ++p) {
          const btManifoldPoint& point = manifold.getContactPoint(p);
          if (point.getDistance() <= kMargin) touched[static_cast<std::size_t>(other->getUserIndex())] = 1;
          impulse += point.m_appliedImpulse * point.m_normalWorldOnB +
                     point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                     point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
        }
        tool.force = tool.force + (is_first ? 1.0 : -1.0) / tick_seconds * FromBullet(impulse);
      }
    }
  }

  /// Springs and dampers of the holds, for steps of dt. Source: Smith, Open Dynamics Engine manual, section 3.8.
  void SoftenHolds(double dt) {
    const double sum = dt * kHoldStiffness + kHoldDamping;
    for (Tool& tool : tools) {
      if (tool.hold) tool.hold->Soften(1 / sum, dt * kHoldStiffness / sum);
    }
  }

  /// What has fallen off the table does not fall for ever, faster and faster.
  void StopWhatHasLeft() {
    for (Body& body : bodies) {
      btRigidBody& rigid = *body.body;
      if (!(rigid.getWorldTransform().getOrigin().length() > kWorldRadius * kScale)) continue;
      rigid.setLinearVelocity({0, 0, 0});
      rigid.setAngularVelocity({0, 0, 0});
      rigid.forceActivationState(DISABLE_SIMULATION);
    }
  }

  RigidState Save() const {
    RigidState state;
    state.gravity = gravity;
    for (const Body& body : bodies) {
      const btRigidBody& rigid = *body.body;
      state.bodies.push_back({SaveTransform(rigid.getWorldTransform()), Numbers(rigid.getLinearVelocity()),
                              Numbers(rigid.getAngularVelocity()), rigid.getDeactivationTime(),
                              rigid.getActivationState(), body.touches});
    }
    for (const Tool& tool : tools) {
      ToolState& saved = state.tools.emplace_back();
      for (std::size_t part = 0; part < kToolPartCount; ++part) {
        saved.parts[part] = SaveTransform(tool.parts[part]->getWorldTransform());
        saved.from[part] = SaveTransform(tool.from[part]);
        state.touched.push_back(tool.touched[part]);
      }
      if (tool.hold) saved.X_carrier_body = SaveTransform(tool.hold->PlaceInCarrier());
      saved.hold_force = tool.hold_force;
      saved.held = tool.held;
      saved.ticks_over = tool.ticks_over;
      saved.force = tool.force;
    }
    for (int m = 0; m < dispatcher->getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(m);
      for (int p = 0; p < manifold.getNumContacts(); ++p)
        state.contacts.push_back(SavePoint(manifold, manifold.getContactPoint(p)));
    }
    // stable: the points of one manifold stay in their order
    std::stable_sort(state.contacts.begin(), state.contacts.end(),
                     [](const ContactPointState& a, const ContactPointState& b) {
                       return std::tie(a.pair, a.children) < std::tie(b.pair, b.children);
                     });
    return state;
  }

  /// A new world in which everything is as in `state`. Of its contacts those stay that Bullet finds again.
  /// \pre state.Fits(bodies, tools)
  void Load(const RigidState& state) {
    gravity = state.gravity;
    // Bullet's trees depend on where their leaves begin
    for (std::size_t t = 0; t < tools.size(); ++t) {
      for (std::size_t part = 0; part < kToolPartCount; ++part)
        tools[t].to[part] = LoadTransform(state.tools[t].parts[part]);
    }
    Build();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const BodyState& saved = state.bodies[i];
      btRigidBody& rigid = *bodies[i].body;
      rigid.setCenterOfMassTransform(LoadTransform(saved.X_world_body));
      rigid.setLinearVelocity(Vector(saved.velocity));
      rigid.setAngularVelocity(Vector(saved.turn));
      rigid.forceActivationState(static_cast<int>(saved.activation));
      rigid.setDeactivationTime(saved.deactivation_seconds);
      bodies[i].touches = saved.touches;
    }
    for (std::size_t t = 0; t < tools.size(); ++t) {
      Tool& tool = tools[t];
      const ToolState& saved = state.tools[t];
      for (std::size_t part = 0; part < kToolPartCount; ++part) {
        tool.from[part] = tool.to[part] = LoadTransform(saved.from[part]);
        tool.parts[part]->setWorldTransform(LoadTransform(saved.parts[part]));
        tool.touched[part] = state.touched[t * kToolPartCount + part];
      }
      tool.force = saved.force;
      tool.hold_force = saved.hold_force;
      if (saved.held >= 0) AddHold(tool, saved.held, LoadTransform(saved.X_carrier_body));
      tool.ticks_over = saved.ticks_over;
    }
    world->FindAllContacts();
    LoadContacts(state.contacts, *dispatcher);
  }

  /// Drops what Bullet remembers beyond the state: the order of its lists and trees, which comes of all that ever touched.
  /// So the next tick has the same bits where a state has been restored. At the end of whatever changes pairs.
  void Renew() { Load(Save()); }

  void AddHold(Tool& tool, std::int32_t body_index, const btTransform& X_carrier_body) {
    btRigidBody& body = *bodies[static_cast<std::size_t>(body_index)].body;
    for (auto& part : tool.parts) {
      part->setIgnoreCollisionCheck(&body, true);
      body.setIgnoreCollisionCheck(part.get(), true);
    }
    tool.hold = std::make_unique<HoldConstraint>(*tool.parts[kShaftPart], body, X_carrier_body);
    tool.hold->setJointFeedback(&tool.feedback);
    tool.feedback = NoFeedback();
    world->addConstraint(tool.hold.get());
    tool.held = body_index;
  }

  void Release(Tool& tool) {
    if (!tool.hold) return;
    btRigidBody& body = *bodies[static_cast<std::size_t>(tool.held)].body;
    world->removeConstraint(tool.hold.get());
    tool.hold.reset();
    for (auto& part : tool.parts) {
      part->setIgnoreCollisionCheck(&body, false);
      body.setIgnoreCollisionCheck(part.get(), false);
    }
    tool.held = -1;
    body.activate(true);
  }
};

RigidWorld::RigidWorld(const Vec3& gravity, double tick_seconds) : content_(std::make_unique<Content>()) {
  TROCAR_ASSERT(tick_seconds > 0);
  content_->gravity = gravity;
  content_->tick_seconds = tick_seconds;
  content_->Build();
}
RigidWorld::~RigidWorld() = default;
RigidWorld::RigidWorld(RigidWorld&&) noexcept = default;
RigidWorld& RigidWorld::operator=(RigidWorld&&) noexcept = default;

base::Result<std::uint32_t> RigidWorld::AddBody(const RigidBody& body) {
  if (body.shapes.empty() || !std::all_of(body.shapes.begin(), body.shapes.end(), HasSize))
    return Refuse("a rigid body has no shape, or one without a size");
  if (!(body.mass >= 0) || !std::isfinite(body.mass) || !(body.friction >= 0) ||
      !std::isfinite(body.friction) || !IsFinite(body.X_world_body))
    return Refuse("mass, friction or pose of a rigid body is negative or not finite");
  double thinnest = 1;
  for (const RigidShape& shape : body.shapes) thinnest = std::min(thinnest, HalfWidth(shape));
  content_->bodies.push_back({body, {}, nullptr, thinnest, 0});
  content_->Add(content_->bodies.size() - 1);
  for (auto& tool : content_->tools) {
    for (auto& touched : tool.touched) touched.assign(content_->bodies.size(), 0);
  }
  return static_cast<std::uint32_t>(content_->bodies.size() - 1);
}

base::Result<std::uint32_t> RigidWorld::AddTool(const ToolCapsule (&parts)[kToolPartCount],
                                                const Pose (&X_world_parts)[kToolPartCount]) {
  Content::Tool tool;
  for (int part = 0; part < kToolPartCount; ++part) {
    if (!IsPositive(parts[part].radius) || !(parts[part].half_length >= 0) ||
        !std::isfinite(parts[part].half_length) || !IsFinite(X_world_parts[part]))
      return Refuse("a part of a tool has no size or place");
    tool.capsules[static_cast<std::size_t>(part)] = parts[part];
    tool.from[static_cast<std::size_t>(part)] = tool.to[static_cast<std::size_t>(part)] =
        ToBullet(X_world_parts[part]);
  }
  content_->tools.push_back(std::move(tool));
  content_->AddToolParts(content_->tools.size() - 1);
  return static_cast<std::uint32_t>(content_->tools.size() - 1);
}

void RigidWorld::MoveTool(std::uint32_t tool, const Pose (&X_world_parts)[kToolPartCount]) {
  for (int part = 0; part < kToolPartCount; ++part) {
    TROCAR_ASSERT(IsFinite(X_world_parts[part]));
    content_->tools[tool].to[static_cast<std::size_t>(part)] = ToBullet(X_world_parts[part]);
  }
  // what jaws have held still falls asleep, and a tool that moves again does not wake it by itself
  const std::int32_t held = HeldBy(tool);
  if (held < 0) return;
  btRigidBody& body = *content_->bodies[static_cast<std::size_t>(held)].body;
  if (!body.isActive()) body.activate(true);
}

void RigidWorld::SetGravity(const Vec3& gravity) {
  if (gravity == content_->gravity) return;
  content_->gravity = gravity;
  content_->world->setGravity(ToBullet(gravity));
  for (auto& body : content_->bodies) body.body->activate(true);
}

void RigidWorld::Step() {
  Content& content = *content_;
  std::vector<Vec3> pulls(content.tools.size());
  for (auto& tool : content.tools) {
    tool.force = {};
    for (auto& touched : tool.touched) std::fill(touched.begin(), touched.end(), std::uint8_t{0});
  }
  const int substeps = content.CountSubsteps();
  const double dt = content.tick_seconds / substeps;
  content.SoftenHolds(dt);
  for (int step = 1; step <= substeps; ++step) {
    const double share = static_cast<double>(step) / substeps;
    for (auto& tool : content.tools) {
      for (std::size_t part = 0; part < kToolPartCount; ++part) {
        const btTransform& from = tool.from[part];
        const btTransform& to = tool.to[part];
        tool.parts[part]->setWorldTransform(
            step == substeps ? to
                             : btTransform(TurnPart(from.getRotation(), to.getRotation(), share),
                                           from.getOrigin().lerp(to.getOrigin(), share)));
      }
    }
    content.world->stepSimulation(dt, 0);
    content.GatherContacts();
    for (std::size_t t = 0; t < content.tools.size(); ++t) {
      auto& tool = content.tools[t];
      if (tool.hold) pulls[t] = pulls[t] + 1.0 / substeps * FromBullet(tool.feedback.m_appliedForceBodyA);
    }
  }
  content.StopWhatHasLeft();
  for (std::size_t t = 0; t < content.tools.size(); ++t) {
    auto& tool = content.tools[t];
    tool.from = tool.to;
    if (!tool.hold) continue;
    tool.force = tool.force + pulls[t];
    tool.ticks_over = math::Norm(pulls[t]) > tool.hold_force ? tool.ticks_over + 1 : 0;
    if (tool.ticks_over >= kSlipTicks) content.Release(tool);
  }
  content.Renew();
}

std::int32_t RigidWorld::FindBodyInJaws(std::uint32_t tool) const {
  const auto& touched = content_->tools[tool].touched;
  for (std::size_t body = 0; body < content_->bodies.size(); ++body) {
    if (content_->bodies[body].definition.mass > 0 && touched[kUpperJawPart][body] != 0 &&
        touched[kLowerJawPart][body] != 0)
      return static_cast<std::int32_t>(body);
  }
  return -1;
}

void RigidWorld::Hold(std::uint32_t tool_index, std::uint32_t body_index, double hold_force) {
  TROCAR_ASSERT(tool_index < content_->tools.size() && body_index < content_->bodies.size());
  Content::Tool& tool = content_->tools[tool_index];
  content_->Release(tool);
  btRigidBody& body = *content_->bodies[body_index].body;
  content_->AddHold(tool, static_cast<std::int32_t>(body_index),
                    tool.parts[kShaftPart]->getWorldTransform().inverse() * body.getWorldTransform());
  // contacts that are there already would go on pushing
  content_->world->getPairCache()->cleanProxyFromPairs(body.getBroadphaseHandle(),
                                                       content_->dispatcher.get());
  body.activate(true);
  tool.hold_force = hold_force;
  tool.ticks_over = 0;
  content_->Renew();
}

void RigidWorld::SetHoldForce(std::uint32_t tool, double hold_force) {
  content_->tools[tool].hold_force = hold_force;
}

void RigidWorld::Release(std::uint32_t tool) {
  if (!content_->tools[tool].hold) return;
  content_->Release(content_->tools[tool]);
  content_->Renew();
}

std::int32_t RigidWorld::HeldBy(std::uint32_t tool) const {
  return content_->tools[tool].held;
}

Vec3 RigidWorld::ForceOn(std::uint32_t tool) const {
  return content_->tools[tool].force;
}

bool RigidWorld::Touches(std::uint32_t tool, std::uint32_t body) const {
  const auto& touched = content_->tools[tool].touched;
  return std::any_of(touched.begin(), touched.end(), [&](const auto& part) { return part[body] != 0; });
}

void RigidWorld::FindTouches(std::uint32_t tool_index, std::vector<ToolTouch>& touches) const {
  const Content& content = *content_;
  const double substep_seconds = content.tick_seconds / content.CountSubsteps();
  struct Found {
    int part;
    ToolTouch touch;
  };
  std::vector<Found> found;
  for (int m = 0; m < content.dispatcher->getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *content.dispatcher->getManifoldByIndexInternal(m);
    for (const bool is_first : {true, false}) {
      const btCollisionObject* own = is_first ? manifold.getBody0() : manifold.getBody1();
      const btCollisionObject* other = is_first ? manifold.getBody1() : manifold.getBody0();
      if (own->getUserIndex2() < 0 || other->getUserIndex2() >= 0 ||
          own->getUserIndex() != static_cast<int>(tool_index))
        continue;
      for (int p = 0; p < manifold.getNumContacts(); ++p) {
        const btManifoldPoint& point = manifold.getContactPoint(p);
        if (!(point.getDistance() <= kMargin)) continue;
        const double sign = is_first ? 1.0 : -1.0;
        const btVector3 impulse = point.m_appliedImpulse * point.m_normalWorldOnB +
                                  point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                                  point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
        const btVector3& normal = point.m_normalWorldOnB;
        found.push_back({own->getUserIndex2(),
                         {static_cast<std::uint32_t>(other->getUserIndex()),
                          FromBullet(is_first ? point.getPositionWorldOnB() : point.getPositionWorldOnA()),
                          sign * Vec3{normal.x(), normal.y(), normal.z()},
                          sign / substep_seconds * FromBullet(impulse)}});
      }
    }
  }
  // Bullet's order of pairs comes of all that ever touched; the points of one pair stay in theirs
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return std::tie(a.touch.body, a.part) < std::tie(b.touch.body, b.part);
  });
  for (const Found& one : found) touches.push_back(one.touch);
}

std::uint64_t RigidWorld::TouchedBodies(std::uint32_t body) const {
  return content_->bodies[body].touches;
}

void RigidWorld::FindObstacles(std::uint32_t tool_index, const Pose (&X_world_parts)[kToolPartCount],
                               double reach, std::vector<ToolObstacle>& obstacles) {
  obstacles.clear();
  Content& content = *content_;
  Content::Tool& tool = content.tools[tool_index];
  for (std::size_t part = 0; part < kToolPartCount; ++part) {
    btRigidBody& capsule = *tool.parts[part];
    const btTransform here = capsule.getWorldTransform();
    capsule.setWorldTransform(ToBullet(X_world_parts[part]));
    for (std::size_t i = 0; i < content.bodies.size(); ++i) {
      if (content.bodies[i].definition.mass > 0) continue;
      Deepest deepest(capsule);
      deepest.m_closestDistanceThreshold = reach * kScale;
      content.world->contactPairTest(&capsule, content.bodies[i].body.get(), deepest);
      if (deepest.distance > reach * kScale) continue;
      // the surface's point lies a radius out on the side of the body
      obstacles.push_back({static_cast<std::uint32_t>(i),
                           FromBullet(deepest.on_tool) - tool.capsules[part].radius * deepest.into,
                           deepest.into, -deepest.distance / kScale});
    }
    capsule.setWorldTransform(here);
  }
}

Pose RigidWorld::PoseOf(std::uint32_t body) const {
  return FromBullet(content_->bodies[body].body->getWorldTransform());
}

Vec3 RigidWorld::VelocityOf(std::uint32_t body) const {
  return FromBullet(content_->bodies[body].body->getLinearVelocity());
}

bool RigidWorld::IsAtRest(std::uint32_t body) const {
  const btRigidBody& rigid = *content_->bodies[body].body;
  return !rigid.isActive() || rigid.isStaticObject() ||
         (math::Norm(FromBullet(rigid.getLinearVelocity())) < kRestSpeed &&
          rigid.getAngularVelocity().length() < kRestTurn);
}

std::size_t RigidWorld::BodyCount() const {
  return content_->bodies.size();
}

void RigidWorld::Reset() {
  content_->Build();
}

void RigidWorld::VisitState(base::StateArchive& archive) {
  RigidState state = content_->Save();
  state.VisitState(archive);
  if (!archive.IsRestoring() || !archive.ok()) return;
  if (!state.Fits(content_->bodies.size(), content_->tools.size())) {
    archive.Fail("is of other bodies or tools");
    return;
  }
  content_->Load(state);
}

}  // namespace trocar::rigid
