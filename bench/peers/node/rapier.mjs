// Rapier, as its packages of the plane and of space that keep to one result everywhere, with their
// defaults where nothing else is asked for: four iterations of its solver, which are substeps. The
// limits of a cone-twist joint are left out there.
import { filterOf, materialOf, rotationOf, stepSeconds, triple } from './scene.mjs';

const vector = (spatial, [x, y, z]) => (spatial ? { x, y, z } : { x, y });

function planarShape(rapier, shape) {
  const points = (shape.points ?? []).flatMap((point) => triple(point).slice(0, 2));
  switch (shape.kind ?? 'ball') {
    case 'ball':
      return rapier.ColliderDesc.ball(shape.radius).setTranslation(...(points.length ? points : [0, 0]));
    case 'capsule': {
      const [ax, ay, bx, by] = points;
      const length = Math.hypot(bx - ax, by - ay);
      return rapier.ColliderDesc.capsule(0.5 * length, shape.radius)
        .setTranslation(0.5 * (ax + bx), 0.5 * (ay + by))
        .setRotation(Math.atan2(by - ay, bx - ax) - 0.5 * Math.PI);
    }
    case 'polygon':
      return shape.radius > 0
        ? rapier.ColliderDesc.roundConvexHull(new Float32Array(points), shape.radius)
        : rapier.ColliderDesc.convexHull(new Float32Array(points));
    case 'chain':
      return rapier.ColliderDesc.polyline(
        new Float32Array(shape.loop ? [...points, points[0], points[1]] : points));
    case 'half_space':
      return new rapier.ColliderDesc(new rapier.HalfSpace(vector(false, triple(shape.normal))))
        .setTranslation(...triple(shape.normal).slice(0, 2).map((n) => n * (shape.offset ?? 0)));
    default:
      throw new Error(`no ${shape.kind} in this adapter for Rapier`);
  }
}

function spatialShape(rapier, shape) {
  const points = (shape.points ?? []).map(triple);
  const middle = points[0] ?? [0, 0, 0];
  switch (shape.kind ?? 'ball') {
    case 'ball':
      return rapier.ColliderDesc.ball(shape.radius).setTranslation(...middle);
    case 'box': {
      const [x, y, z, w] = shape.rotation ?? [0, 0, 0, 1];
      return rapier.ColliderDesc.cuboid(...shape.half).setTranslation(...middle)
        .setRotation({ x, y, z, w });
    }
    case 'capsule': {
      const along = points[1].map((value, i) => value - points[0][i]);
      const length = Math.hypot(...along);
      // The turn from y to `along`; where they are opposite, about x.
      const turn = along[1] <= -0.999999 * length ? [1, 0, 0, 0]
        : [along[2], 0, -along[0], length + along[1]];
      const size = Math.hypot(...turn);
      const [x, y, z, w] = turn.map((value) => value / size);
      return rapier.ColliderDesc.capsule(0.5 * length, shape.radius)
        .setTranslation(...points[0].map((value, i) => value + 0.5 * along[i]))
        .setRotation({ x, y, z, w });
    }
    case 'hull':
      return rapier.ColliderDesc.convexHull(new Float32Array(points.flat()));
    case 'half_space':
      return new rapier.ColliderDesc(new rapier.HalfSpace(vector(true, triple(shape.normal))))
        .setTranslation(...triple(shape.normal).map((n) => n * (shape.offset ?? 0)));
    default:
      throw new Error(`no ${shape.kind} in this adapter for Rapier`);
  }
}

function jointData(rapier, spatial, joint) {
  const kind = joint.kind ?? 'revolute';
  const a = vector(spatial, triple(joint.anchor_a));
  const b = vector(spatial, triple(joint.anchor_b));
  if (joint.motor === 'position' || joint.hertz > 0)
    throw new Error('no springs and servos in this adapter for Rapier');
  if (!spatial && kind === 'revolute') return rapier.JointData.revolute(a, b);
  if (spatial && (kind === 'revolute' || kind === 'cone_twist'))
    return rapier.JointData.spherical(a, b);
  if (spatial && kind === 'hinge')
    return rapier.JointData.revolute(a, b, vector(true, triple(joint.axis)));
  throw new Error(`no ${kind} in this adapter for Rapier`);
}

/** The mass that a body says, spread as its shapes spread theirs. */
function setMass(body, colliders, mass) {
  body.recomputeMassPropertiesFromColliders();
  const factor = mass / body.mass();
  for (const collider of colliders) collider.setDensity(collider.density() * factor);
  body.recomputeMassPropertiesFromColliders();
}

class RapierWorld {
  constructor(rapier, scene, settings) {
    this.spatial = scene.dimension === 3;
    this.world = new rapier.World(vector(this.spatial, triple(scene.gravity)));
    this.world.timestep = stepSeconds(scene);
    if (settings.substeps !== undefined) this.world.numSolverIterations = settings.substeps;
    // Of groups that must not meet themselves, each takes one of Rapier's 16 bits in turn.
    this.bodies = scene.bodies.map((body) => this.#addBody(rapier, scene, body));
    const byName = new Map(scene.bodies.map((body, i) => [body.name, this.bodies[i]]));
    for (const joint of scene.joints ?? []) this.#addJoint(rapier, joint, byName);
  }

  #addBody(rapier, scene, body) {
    const kind = { static: 'fixed', kinematic: 'kinematicVelocityBased' }[body.kind] ?? 'dynamic';
    const [x, y, z, w] = rotationOf(body);
    const spin = triple(body.spin);
    const desc = rapier.RigidBodyDesc[kind]().setCanSleep(false)
      .setTranslation(...triple(body.position).slice(0, this.spatial ? 3 : 2))
      .setLinvel(...triple(body.velocity).slice(0, this.spatial ? 3 : 2))
      .setRotation(this.spatial ? { x, y, z, w } : (body.angle ?? 0))
      .setAngvel(this.spatial ? vector(true, spin) : spin[0]);
    desc.setLinearDamping(body.linear_damping ?? 0).setAngularDamping(body.angular_damping ?? 0)
      .setGravityScale(body.gravity_scale ?? 1);
    if (body.fixed_rotation) desc.lockRotations();
    const made = this.world.createRigidBody(desc);
    const colliders = (body.shapes ?? []).map(
      (shape) => this.#addShape(rapier, scene, shape, made));
    if (body.mass !== undefined) setMass(made, colliders, body.mass);
    return made;
  }

  #addShape(rapier, scene, shape, body) {
    const material = materialOf(scene, shape);
    const filter = filterOf(shape);
    const bit = filter.group < 0 ? 1 << ((-filter.group - 1) % 15 + 1) : filter.category & 0xffff;
    const meets = filter.group < 0 ? 0xffff & ~bit : filter.mask & 0xffff;
    const desc = (this.spatial ? spatialShape : planarShape)(rapier, shape)
      .setDensity(shape.density ?? 1)
      .setFriction(Math.sqrt(material.friction * material.friction))
      .setRestitution(material.restitution)
      .setRestitutionCombineRule(rapier.CoefficientCombineRule.Max)
      .setCollisionGroups(((bit << 16) | meets) >>> 0);
    return this.world.createCollider(desc, body);
  }

  #addJoint(rapier, joint, byName) {
    const data = jointData(rapier, this.spatial, joint);
    const made = this.world.createImpulseJoint(
      data, byName.get(joint.body_a), byName.get(joint.body_b), true);
    made.setContactsEnabled(joint.collide_connected ?? false);
    if (made.setLimits === undefined) return;
    if (joint.limit_enabled) made.setLimits(joint.lower ?? 0, joint.upper ?? 0);
    if (joint.motor !== 'speed') return;
    made.configureMotorModel(rapier.MotorModel.ForceBased);
    made.configureMotorVelocity(joint.motor_speed ?? 0, joint.motor_max ?? 0);
  }

  step() {
    this.world.step();
  }

  poses() {
    return this.bodies.flatMap((body) => {
      const at = body.translation();
      const turn = body.rotation();
      if (this.spatial) return [at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w];
      return [at.x, at.y, 0, 0, 0, Math.sin(0.5 * turn), Math.cos(0.5 * turn)];
    });
  }

  /** A pose, velocity and spin of each body: thirteen numbers. */
  motions() {
    const poses = this.poses();
    return this.bodies.flatMap((body, i) => {
      const velocity = body.linvel();
      const spin = body.angvel();
      const turning = this.spatial ? [spin.x, spin.y, spin.z] : [0, 0, spin];
      return [...poses.slice(7 * i, 7 * i + 7), velocity.x, velocity.y, velocity.z ?? 0,
        ...turning];
    });
  }

  free() {
    this.world.free();
  }
}

/** Of the plane or of space. */
export async function rapierEngine(dimension) {
  const name = `rapier${dimension}d`;
  const { default: rapier } = await import(`@dimforge/${name}-deterministic-compat`);
  await rapier.init();
  return { name, dimensions: [dimension], 
    make: (scene, settings = {}) => new RapierWorld(rapier, scene, settings) };
}
