// Box2D v3 as the package box2d3-wasm, with its defaults where nothing else is asked for: four
// substeps, contacts of 30 Hz, one thread.
import Box2DFactory from 'box2d3-wasm';
import { filterOf, materialOf, stepSeconds, triple } from './scene.mjs';

const kDefaults = { substeps: 4 };
const kHalfSpaceReach = 2000;  // m
const kKinds = { static: 'b2_staticBody', kinematic: 'b2_kinematicBody', dynamic: 'b2_dynamicBody' };

function hullOf(b2, points) {
  return b2.b2ComputeHull(points.map(([x, y]) => new b2.b2Vec2(x, y)));
}

function addShape(b2, body, shape, def) {
  const at = (point) => new b2.b2Vec2(...triple(point).slice(0, 2));
  const kind = shape.kind ?? 'ball';
  if (kind === 'ball') {
    const circle = new b2.b2Circle();
    circle.center = at(shape.points?.[0]);
    circle.radius = shape.radius;
    b2.b2CreateCircleShape(body, def, circle);
  } else if (kind === 'capsule') {
    const capsule = new b2.b2Capsule();
    capsule.center1 = at(shape.points[0]);
    capsule.center2 = at(shape.points[1]);
    capsule.radius = shape.radius;
    b2.b2CreateCapsuleShape(body, def, capsule);
  } else if (kind === 'polygon') {
    b2.b2CreatePolygonShape(body, def, b2.b2MakePolygon(hullOf(b2, shape.points), shape.radius ?? 0));
  } else if (kind === 'chain') {
    // As segments, which collide on both sides: the package's chain takes no array.
    const count = shape.points.length;
    for (let i = 0; i < (shape.loop ? count : count - 1); ++i) {
      const segment = new b2.b2Segment();
      segment.point1 = at(shape.points[i]);
      segment.point2 = at(shape.points[(i + 1) % count]);
      b2.b2CreateSegmentShape(body, def, segment);
    }
  } else if (kind === 'half_space') {
    // A segment along its surface, as in bench/peers/box2d_parts.cpp.
    const [x, y] = triple(shape.normal);
    const offset = shape.offset ?? 0;
    const segment = new b2.b2Segment();
    segment.point1 = new b2.b2Vec2(x * offset - y * kHalfSpaceReach, y * offset + x * kHalfSpaceReach);
    segment.point2 = new b2.b2Vec2(x * offset + y * kHalfSpaceReach, y * offset - x * kHalfSpaceReach);
    b2.b2CreateSegmentShape(body, def, segment);
  } else {
    throw new Error(`no ${kind} in box2d3-wasm`);
  }
}

function shapeDef(b2, scene, shape) {
  const def = b2.b2DefaultShapeDef();
  const material = materialOf(scene, shape);
  const filter = filterOf(shape);
  def.density = shape.density ?? 1;
  def.material.friction = material.friction;
  def.material.restitution = material.restitution;
  def.material.rollingResistance = material.rolling_resistance;
  def.filter.categoryBits = filter.category;
  def.filter.maskBits = filter.mask;
  def.filter.groupIndex = filter.group;
  return def;
}

/** The mass that a body says, spread as its shapes spread theirs. */
function setMass(b2, body, mass) {
  const data = b2.b2Body_GetMassData(body);
  data.rotationalInertia *= mass / data.mass;
  data.mass = mass;
  b2.b2Body_SetMassData(body, data);
}

function addBody(b2, world, scene, body) {
  const def = b2.b2DefaultBodyDef();
  const angle = body.angle ?? 0;
  def.type = b2.b2BodyType[kKinds[body.kind ?? 'dynamic']];
  def.position = new b2.b2Vec2(...triple(body.position).slice(0, 2));
  def.rotation = b2.b2MakeRot(angle);
  def.linearVelocity = new b2.b2Vec2(...triple(body.velocity).slice(0, 2));
  def.angularVelocity = triple(body.spin)[0];
  def.linearDamping = body.linear_damping ?? 0;
  def.angularDamping = body.angular_damping ?? 0;
  def.gravityScale = body.gravity_scale ?? 1;
  if (body.fixed_rotation) throw new Error('no fixed rotation in this adapter for box2d3-wasm');
  const made = b2.b2CreateBody(world, def);
  for (const shape of body.shapes ?? []) addShape(b2, made, shape, shapeDef(b2, scene, shape));
  if (body.mass !== undefined) setMass(b2, made, body.mass);
  return made;
}

function addPin(b2, world, joint, a, b) {
  if ((joint.kind ?? 'revolute') !== 'revolute' || joint.motor === 'position' || joint.hertz > 0)
    throw new Error(`no ${joint.kind ?? 'such pin'} in this adapter for box2d3-wasm`);
  const def = b2.b2DefaultRevoluteJointDef();
  const anchors = [triple(joint.anchor_a), triple(joint.anchor_b)].map(
    ([x, y]) => new b2.b2Vec2(x, y));
  def.base.bodyIdA = a;
  def.base.bodyIdB = b;
  def.base.localFrameA.p = anchors[0];
  def.base.localFrameB.p = anchors[1];
  def.base.collideConnected = joint.collide_connected ?? false;
  def.enableLimit = joint.limit_enabled ?? false;
  def.lowerAngle = joint.lower ?? 0;
  def.upperAngle = joint.upper ?? 0;
  def.enableMotor = joint.motor === 'speed';
  def.motorSpeed = joint.motor_speed ?? 0;
  def.maxMotorTorque = joint.motor_max ?? 0;
  b2.b2CreateRevoluteJoint(world, def);
}

class Box2dWorld {
  constructor(b2, scene, settings) {
    this.b2 = b2;
    this.substeps = settings.substeps;
    this.tick_s = stepSeconds(scene);
    const def = b2.b2DefaultWorldDef();
    def.gravity = new b2.b2Vec2(...triple(scene.gravity).slice(0, 2));
    def.enableSleep = false;
    def.restitutionThreshold = scene.tuning?.restitution_threshold ?? def.restitutionThreshold;
    if (settings.contact_hertz !== undefined) def.contactHertz = settings.contact_hertz;
    this.world = b2.b2CreateWorld(def);
    this.bodies = scene.bodies.map((body) => addBody(b2, this.world, scene, body));
    const byName = new Map(scene.bodies.map((body, i) => [body.name, this.bodies[i]]));
    for (const joint of scene.joints ?? [])
      addPin(b2, this.world, joint, byName.get(joint.body_a), byName.get(joint.body_b));
  }

  step() {
    this.b2.b2World_Step(this.world, this.tick_s, this.substeps);
  }

  poses() {
    return this.bodies.flatMap((body) => {
      const at = this.b2.b2Body_GetPosition(body);
      const turn = this.b2.b2Body_GetRotation(body);
      const half = 0.5 * Math.atan2(turn.s, turn.c);
      return [at.x, at.y, 0, 0, 0, Math.sin(half), Math.cos(half)];
    });
  }

  /** A pose, velocity and spin of each body: thirteen numbers. */
  motions() {
    const poses = this.poses();
    return this.bodies.flatMap((body, i) => {
      const velocity = this.b2.b2Body_GetLinearVelocity(body);
      const spin = this.b2.b2Body_GetAngularVelocity(body);
      return [...poses.slice(7 * i, 7 * i + 7), velocity.x, velocity.y, 0, 0, 0, spin];
    });
  }

  free() {
    this.b2.b2DestroyWorld(this.world);
  }
}

export async function box2dEngine() {
  const b2 = await Box2DFactory();
  return { name: 'box2d3-wasm', dimensions: [2],
    make: (scene, settings) => new Box2dWorld(b2, scene, { ...kDefaults, ...settings }) };
}
