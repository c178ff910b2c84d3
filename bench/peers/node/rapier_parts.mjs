// Shapes and joints of a scene as Rapier has them: what rapier.mjs makes its worlds of.
import { rotationOf, triple } from './scene.mjs';

// N m s: what a motor lacks of its speed times this is its torque, up to its greatest.
const kMotorDamping = 1e9;

export const vector = (spatial, [x, y, z]) => (spatial ? { x, y, z } : { x, y });

function planarShape(rapier, shape) {
  const points = (shape.points ?? []).flatMap((point) => triple(point).slice(0, 2));
  switch (shape.kind ?? 'ball') {
    case 'ball':
      return rapier.ColliderDesc.ball(shape.radius)
        .setTranslation(...(points.length ? points : [0, 0]));
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

/** A shape where it is in its body. */
export function shapeOf(rapier, spatial, shape) {
  return (spatial ? spatialShape : planarShape)(rapier, shape);
}

function jointData(rapier, spatial, joint) {
  const kind = joint.kind ?? 'revolute';
  const a = vector(spatial, triple(joint.anchor_a));
  const b = vector(spatial, triple(joint.anchor_b));
  if (joint.motor === 'position' || joint.hertz > 0 || joint.angular_hertz > 0)
    throw new Error('no springs and servos in this adapter for Rapier');
  if (!spatial && kind === 'revolute') return rapier.JointData.revolute(a, b);
  if (spatial && (kind === 'revolute' || kind === 'cone_twist'))
    return rapier.JointData.spherical(a, b);
  if (spatial && kind === 'hinge')
    return rapier.JointData.revolute(a, b, vector(true, triple(joint.axis)));
  throw new Error(`no ${kind} in this adapter for Rapier`);
}

/** Of two quaternions: the turn of the second, and then of the first. */
function product([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
}

/** How body b is turned from body a at creation, where the angle of a joint is 0. */
function turnBetween(a, b) {
  const [x, y, z, w] = rotationOf(a);
  return product([-x, -y, -z, w], rotationOf(b));
}

/** In the plane Rapier's angles are of the bodies, ours since creation: they differ by `since`. */
function setLimits(made, joint, since) {
  const limits = [since + (joint.lower ?? 0), since + (joint.upper ?? 0)];
  if (limits.some((limit) => Math.abs(limit) > Math.PI + 1e-6))
    throw new Error('no limits beyond half a turn in this adapter for Rapier');
  made.setLimits(...limits);
}

function setMotor(rapier, made, joint) {
  made.configureMotorModel(rapier.MotorModel.ForceBased);
  made.configureMotorVelocity(joint.motor_speed ?? 0, kMotorDamping);
  made.setMotorMaxForce(joint.motor_max ?? 0);
}

/** A hinge has its axis in the frame of each body, and there its angle is 0 at creation. */
function setFrames(made, turn) {
  const { x, y, z, w } = made.frameX1();
  const [bx, by, bz, bw] = product([-turn[0], -turn[1], -turn[2], turn[3]], [x, y, z, w]);
  made.setFrameX2({ x: bx, y: by, z: bz, w: bw });
}

/** The joint between bodies at their places in the scene. */
export function addJoint(rapier, world, spatial, joint, a, b) {
  const made = world.createImpulseJoint(jointData(rapier, spatial, joint), a.made, b.made, true);
  made.setContactsEnabled(joint.collide_connected ?? false);
  if (made.setLimits === undefined) return;
  const turn = turnBetween(a.scene, b.scene);
  if (spatial) setFrames(made, turn);
  if (joint.limit_enabled) setLimits(made, joint, spatial ? 0 : 2 * Math.atan(turn[2] / turn[3]));
  if (joint.motor === 'speed') setMotor(rapier, made, joint);
}
