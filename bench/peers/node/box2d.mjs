// Box2D v3 as the package box2d3-wasm, with its defaults: four substeps, one thread.
import Box2DFactory from 'box2d3-wasm';
import { filterOf, materialOf, stepSeconds, triple } from './scene.mjs';

const kSubsteps = 4;
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
  def.filter.categoryBits = filter.category;
  def.filter.maskBits = filter.mask;
  def.filter.groupIndex = filter.group;
  return def;
}

function addBody(b2, world, scene, body) {
  const def = b2.b2DefaultBodyDef();
  const angle = body.angle ?? 0;
  def.type = b2.b2BodyType[kKinds[body.kind ?? 'dynamic']];
  def.position = new b2.b2Vec2(...triple(body.position).slice(0, 2));
  def.rotation = b2.b2MakeRot(angle);
  def.linearVelocity = new b2.b2Vec2(...triple(body.velocity).slice(0, 2));
  def.angularVelocity = triple(body.spin)[0];
  const made = b2.b2CreateBody(world, def);
  for (const shape of body.shapes ?? []) addShape(b2, made, shape, shapeDef(b2, scene, shape));
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
  constructor(b2, scene) {
    this.b2 = b2;
    this.tick_s = stepSeconds(scene);
    const def = b2.b2DefaultWorldDef();
    def.gravity = new b2.b2Vec2(...triple(scene.gravity).slice(0, 2));
    def.enableSleep = false;
    this.world = b2.b2CreateWorld(def);
    this.bodies = scene.bodies.map((body) => addBody(b2, this.world, scene, body));
    const byName = new Map(scene.bodies.map((body, i) => [body.name, this.bodies[i]]));
    for (const joint of scene.joints ?? [])
      addPin(b2, this.world, joint, byName.get(joint.body_a), byName.get(joint.body_b));
  }

  step() {
    this.b2.b2World_Step(this.world, this.tick_s, kSubsteps);
  }

  poses() {
    return this.bodies.flatMap((body) => {
      const at = this.b2.b2Body_GetPosition(body);
      const turn = this.b2.b2Body_GetRotation(body);
      const half = 0.5 * Math.atan2(turn.s, turn.c);
      return [at.x, at.y, 0, 0, 0, Math.sin(half), Math.cos(half)];
    });
  }

  free() {
    this.b2.b2DestroyWorld(this.world);
  }
}

export async function box2dEngine() {
  const b2 = await Box2DFactory();
  return { name: 'box2d3-wasm', dimensions: [2], make: (scene) => new Box2dWorld(b2, scene) };
}
