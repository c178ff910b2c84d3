// Jolt as the package jolt-physics, in its build for one thread, which has no vectors; with its
// defaults where nothing else is asked for: one collision step a tick, of ten velocity and two
// position iterations. Gyroscopic forces, which Jolt leaves out by default, are on, as in all other
// engines here, and no body is kept from the spin that the scene gives it. Each world has a module
// to itself, since the memory of one is 128 MiB and does not grow; a world that is freed leaves its
// module to the next.
import initJolt from 'jolt-physics';
import { constraintOf, Scratch, shapeOf } from './jolt_parts.mjs';
import { filterOf, filtersMeet, materialOf, rotationOf, stepSeconds, triple } from './scene.mjs';

const kLayers = { fixed: 0, moving: 1 };  // Of bodies, and of the broad phase.
const kKinds = { static: 'EMotionType_Static', kinematic: 'EMotionType_Kinematic',
  dynamic: 'EMotionType_Dynamic' };

/** What all shapes of a body have: Jolt has it of bodies alone. */
function sharedOf(body, what, of) {
  const all = (body.shapes ?? []).map(of);
  if (new Set(all.map((each) => JSON.stringify(each))).size !== 1)
    throw new Error(`no body with other than one ${what} in this adapter for Jolt`);
  return all[0];
}

/** The pairs of bodies, by number, that never meet: because of their filters, or of a joint. */
function pairsApart(scene) {
  const filters = scene.bodies.map((body) => sharedOf(body, 'filter', filterOf));
  const numbers = new Map(scene.bodies.map((body, i) => [body.name, i]));
  const byFilter = filters.flatMap((filter, i) => filters.slice(0, i).flatMap(
    (other, j) => (filtersMeet(filter, other) ? [] : [[j, i]])));
  const byJoint = (scene.joints ?? []).filter((joint) => !joint.collide_connected).map(
    (joint) => [numbers.get(joint.body_a), numbers.get(joint.body_b)]);
  return [...byFilter, ...byJoint];
}

/** Null where all bodies may meet. */
function groupFilterOf(jolt, scene) {
  const pairs = pairsApart(scene);
  if (pairs.length === 0) return null;
  const filter = new jolt.GroupFilterTable(scene.bodies.length);
  for (const [a, b] of pairs) filter.DisableCollision(a, b);
  return filter;
}

/** A world without bodies; it owns the tables of its layers. */
function emptyWorld(jolt, scratch) {
  const count = Object.keys(kLayers).length;
  const pairs = new jolt.ObjectLayerPairFilterTable(count);
  pairs.EnableCollision(kLayers.fixed, kLayers.moving);
  pairs.EnableCollision(kLayers.moving, kLayers.moving);
  const layers = new jolt.BroadPhaseLayerInterfaceTable(count, count);
  for (const layer of Object.values(kLayers))
    layers.MapObjectToBroadPhaseLayer(layer, scratch.keep(new jolt.BroadPhaseLayer(layer)));
  const settings = scratch.keep(new jolt.JoltSettings());
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter =
    new jolt.ObjectVsBroadPhaseLayerFilterTable(layers, count, pairs, count);
  return new jolt.JoltInterface(settings);
}

class JoltWorld {
  constructor(jolt, scene, settings) {
    const scratch = new Scratch(jolt);
    this.jolt = jolt;
    this.tick_s = stepSeconds(scene);
    this.collisionSteps = settings.substeps ?? 1;
    this.world = emptyWorld(jolt, scratch);
    this.system = this.world.GetPhysicsSystem();
    this.system.SetGravity(scratch.vector(triple(scene.gravity)));
    const physics = this.system.GetPhysicsSettings();
    physics.mMinVelocityForRestitution =
      scene.tuning?.restitution_threshold ?? physics.mMinVelocityForRestitution;
    this.system.SetPhysicsSettings(physics);
    const filter = groupFilterOf(jolt, scene);
    this.bodies = scene.bodies.map((body, i) => this.#addBody(scratch, scene, body,
      filter === null ? null : scratch.keep(new jolt.CollisionGroup(filter, 0, i))));
    const byName = new Map(scene.bodies.map(
      (body, i) => [body.name, { scene: body, made: this.bodies[i] }]));
    this.joints = (scene.joints ?? []).map((joint) => this.#addJoint(scratch, joint, byName));
    this.system.OptimizeBroadPhase();
    scratch.free();
  }

  #addBody(scratch, scene, body, group) {
    const { jolt } = scratch;
    const kind = body.kind ?? 'dynamic';
    const material = sharedOf(body, 'material', (shape) => materialOf(scene, shape));
    const def = scratch.keep(new jolt.BodyCreationSettings(
      shapeOf(scratch, body), scratch.point(triple(body.position)), scratch.turn(rotationOf(body)),
      jolt[kKinds[kind]], kind === 'static' ? kLayers.fixed : kLayers.moving));
    def.mLinearVelocity = scratch.vector(triple(body.velocity));
    def.mAngularVelocity = scratch.vector(triple(body.spin));
    def.mLinearDamping = body.linear_damping ?? 0;
    def.mAngularDamping = body.angular_damping ?? 0;
    def.mGravityFactor = body.gravity_scale ?? 1;
    def.mFriction = material.friction;
    def.mRestitution = material.restitution;
    def.mAllowSleeping = false;
    def.mApplyGyroscopicForce = true;
    def.mMaxAngularVelocity = Math.max(def.mMaxAngularVelocity, Math.hypot(...triple(body.spin)));
    if (body.fixed_rotation)
      def.mAllowedDOFs = jolt.EAllowedDOFs_TranslationX | jolt.EAllowedDOFs_TranslationY |
        jolt.EAllowedDOFs_TranslationZ;
    if (body.mass !== undefined) {
      def.mOverrideMassProperties = jolt.EOverrideMassProperties_CalculateInertia;
      def.mMassPropertiesOverride.mMass = body.mass;
    }
    if (group !== null) def.mCollisionGroup = group;
    const all = this.system.GetBodyInterface();
    const made = all.CreateBody(def);
    all.AddBody(made.GetID(), jolt.EActivation_Activate);
    return made;
  }

  #addJoint(scratch, joint, byName) {
    const made = constraintOf(scratch, joint, byName.get(joint.body_a), byName.get(joint.body_b));
    this.system.AddConstraint(made);
    if (joint.motor !== 'speed') return made;
    const hinge = this.jolt.castObject(made, this.jolt.HingeConstraint);
    hinge.SetMotorState(this.jolt.EMotorState_Velocity);
    hinge.SetTargetAngularVelocity(joint.motor_speed ?? 0);
    return made;
  }

  step() {
    this.world.Step(this.tick_s, this.collisionSteps);
  }

  poses() {
    return this.bodies.flatMap((body) => {
      const at = body.GetPosition();
      const turn = body.GetRotation();
      return [at.GetX(), at.GetY(), at.GetZ(), turn.GetX(), turn.GetY(), turn.GetZ(), turn.GetW()];
    });
  }

  /** A pose, velocity and spin of each body: thirteen numbers. */
  motions() {
    const poses = this.poses();
    return this.bodies.flatMap((body, i) => {
      const pose = poses.slice(7 * i, 7 * i + 7);
      if (body.IsStatic()) return [...pose, 0, 0, 0, 0, 0, 0];
      const velocity = body.GetLinearVelocity();
      const spin = body.GetAngularVelocity();
      return [...pose, velocity.GetX(), velocity.GetY(), velocity.GetZ(), spin.GetX(), spin.GetY(),
        spin.GetZ()];
    });
  }

  /** Leaves nothing of itself in the module. */
  destroy() {
    const all = this.system.GetBodyInterface();
    for (const joint of this.joints) this.system.RemoveConstraint(joint);
    for (const body of this.bodies) {
      const id = body.GetID();
      all.RemoveBody(id);
      all.DestroyBody(id);
    }
    this.jolt.destroy(this.world);
  }
}

export async function joltEngine() {
  const idle = [];
  return {
    name: 'jolt',
    dimensions: [3],
    /** One in which a scene was refused is not used again. */
    async make(scene, settings = {}) {
      const jolt = idle.pop() ?? await initJolt();
      const world = new JoltWorld(jolt, scene, settings);
      world.free = () => {
        world.destroy();
        idle.push(jolt);
      };
      return world;
    },
  };
}
