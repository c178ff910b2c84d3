// Rapier, as its packages of the plane and of space that keep to one result everywhere, with their
// defaults where nothing else is asked for: four iterations of its solver, which are substeps. The
// limits and the friction of a cone-twist joint are left out there.
import { addJoint, shapeOf, vector } from './rapier_parts.mjs';
import { filterOf, filtersMeet, materialOf, rotationOf, stepSeconds, triple } from './scene.mjs';

/** The next larger number that has as many bits set. */
function nextOfAsManyBits(number) {
  const lowest = number & -number;
  const carried = number + lowest;
  return carried | (((number ^ carried) / lowest) >> 2);
}

/** For filters that each meet all, or all but themselves: half of the bits, in no other half. */
function halvesOf(filters) {
  let half = 0xff;
  return filters.map((filter) => {
    const apart = filters.filter((other) => !filtersMeet(filter, other));
    if (apart.length === 0) return { is: 0xffff, meets: 0xffff };
    if (apart.length > 1 || apart[0] !== filter || half > 0xffff)
      throw new Error('no filters such as these in this adapter for Rapier');
    const taken = { is: half, meets: 0xffff & ~half };
    half = nextOfAsManyBits(half);
    return taken;
  });
}

/** By filter, groups of Rapier, of 16 bits: exactly those meet whose filters do. */
function groupsOf(scene) {
  const shapes = scene.bodies.flatMap((body) => body.shapes ?? []);
  const names = [...new Set(shapes.map((shape) => JSON.stringify(filterOf(shape))))];
  const filters = names.map((name) => JSON.parse(name));
  const bitsOf = (filter) => filters.reduce(
    (bits, other, i) => bits | (filtersMeet(filter, other) ? 1 << i : 0), 0);
  const groups = filters.length > 16 ? halvesOf(filters)
    : filters.map((filter, i) => ({ is: 1 << i, meets: bitsOf(filter) }));
  return new Map(groups.map(({ is, meets }, i) => [names[i], ((is << 16) | meets) >>> 0]));
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
    this.groups = groupsOf(scene);
    this.bodies = scene.bodies.map((body) => this.#addBody(rapier, scene, body));
    const byName = new Map(scene.bodies.map(
      (body, i) => [body.name, { scene: body, made: this.bodies[i] }]));
    for (const joint of scene.joints ?? [])
      addJoint(rapier, this.world, this.spatial, joint, byName.get(joint.body_a),
        byName.get(joint.body_b));
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
    const desc = shapeOf(rapier, this.spatial, shape)
      .setDensity(shape.density ?? 1)
      .setFriction(Math.sqrt(material.friction))
      .setFrictionCombineRule(rapier.CoefficientCombineRule.Multiply)
      .setRestitution(material.restitution)
      .setRestitutionCombineRule(rapier.CoefficientCombineRule.Max)
      .setCollisionGroups(this.groups.get(JSON.stringify(filterOf(shape))));
    return this.world.createCollider(desc, body);
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
