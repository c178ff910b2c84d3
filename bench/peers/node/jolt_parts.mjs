// Shapes and joints of a scene as Jolt has them: what jolt.mjs makes its worlds of.
import { rotationOf, triple } from './scene.mjs';

const kNoTurn = [0, 0, 0, 1];

/** What is on Jolt's heap only while a world is made. */
export class Scratch {
  constructor(jolt) {
    this.jolt = jolt;
    this.things = [];
  }

  keep(thing) {
    this.things.push(thing);
    return thing;
  }

  vector([x, y, z]) {
    return this.keep(new this.jolt.Vec3(x, y, z));
  }

  point([x, y, z]) {
    return this.keep(new this.jolt.RVec3(x, y, z));
  }

  turn([x, y, z, w]) {
    return this.keep(new this.jolt.Quat(x, y, z, w));
  }

  /** The last first: what was made later may refer to what was made before. */
  free() {
    while (this.things.length > 0) this.jolt.destroy(this.things.pop());
  }
}

function rotated([x, y, z, w], v) {
  const cross = (a, b) =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const twice = cross([x, y, z], v).map((value) => 2 * value);
  const further = cross([x, y, z], twice);
  return v.map((value, i) => value + w * twice[i] + further[i]);
}

/** A unit vector across one. */
function across([x, y, z]) {
  const [a, b, c] = Math.abs(x) < 0.6 ? [0, z, -y] : [-z, 0, x];
  const size = Math.hypot(a, b, c);
  return [a / size, b / size, c / size];
}

/** The turn from y to `along`; where they are opposite, about x. */
function turnFromY(along) {
  const length = Math.hypot(...along);
  if (along[1] <= -0.999999 * length) return [1, 0, 0, 0];
  const turn = [along[2], 0, -along[0], length + along[1]];
  const size = Math.hypot(...turn);
  return turn.map((value) => value / size);
}

/** A shape as Jolt has it about its own middle, and where that is in the body. */
function partOf(scratch, shape) {
  const { jolt } = scratch;
  const points = (shape.points ?? []).map(triple);
  const middle = points[0] ?? [0, 0, 0];
  switch (shape.kind ?? 'ball') {
    case 'ball':
      return { settings: new jolt.SphereShapeSettings(shape.radius), at: middle, turn: kNoTurn };
    case 'box': {
      const settings = new jolt.BoxShapeSettings(scratch.vector(shape.half));
      settings.mConvexRadius = Math.min(settings.mConvexRadius, ...shape.half);
      return { settings, at: middle, turn: shape.rotation ?? kNoTurn };
    }
    case 'capsule': {
      const along = points[1].map((value, i) => value - middle[i]);
      return { settings: new jolt.CapsuleShapeSettings(0.5 * Math.hypot(...along), shape.radius),
        at: middle.map((value, i) => value + 0.5 * along[i]), turn: turnFromY(along) };
    }
    case 'hull': {
      const settings = new jolt.ConvexHullShapeSettings();
      for (const point of points) settings.mPoints.push_back(scratch.vector(point));
      return { settings, at: [0, 0, 0], turn: kNoTurn };
    }
    case 'half_space': {
      const normal = scratch.vector(triple(shape.normal));
      const plane = scratch.keep(new jolt.Plane(normal, -(shape.offset ?? 0)));
      return { settings: new jolt.PlaneShapeSettings(plane), at: [0, 0, 0], turn: kNoTurn };
    }
    default:
      throw new Error(`no ${shape.kind} in this adapter for Jolt`);
  }
}

/** All shapes of a body as one of Jolt's; it lives as long as something has it. */
export function shapeOf(scratch, body) {
  const { jolt } = scratch;
  const parts = (body.shapes ?? []).map((shape) => {
    const part = partOf(scratch, shape);
    if (part.settings.mDensity !== undefined) part.settings.mDensity = shape.density ?? 1;
    return part;
  });
  if (parts.length === 0) throw new Error('no body without shapes in this adapter for Jolt');
  let { settings } = parts[0];
  if (parts.length > 1) {
    settings = new jolt.StaticCompoundShapeSettings();
    for (const { settings: part, at, turn } of parts)
      settings.AddShapeShapeSettings(scratch.vector(at), scratch.turn(turn), part, 0);
  } else if (parts[0].at.some((value) => value !== 0) || Math.abs(parts[0].turn[3]) !== 1) {
    settings = new jolt.RotatedTranslatedShapeSettings(
      scratch.vector(parts[0].at), scratch.turn(parts[0].turn), settings);
  }
  const made = scratch.keep(settings).Create();
  if (made.HasError()) throw new Error(`Jolt: ${made.GetError().c_str()}`);
  return made.Get();
}

/** Of the turn of b relative to a at creation; Jolt's have 0 between them. */
function turnsOf(joint) {
  if (!joint.limit_enabled) return [-Math.PI, Math.PI];
  const [lower, upper] = [joint.lower ?? 0, joint.upper ?? 0];
  if (lower > 0 || upper < 0) throw new Error('no limits beside 0 in this adapter for Jolt');
  return [Math.max(lower, -Math.PI), Math.min(upper, Math.PI)];
}

function hingeSettings(jolt, joint) {
  const settings = new jolt.HingeConstraintSettings();
  [settings.mLimitsMin, settings.mLimitsMax] = turnsOf(joint);
  settings.mMotorSettings.mMinTorqueLimit = -(joint.motor_max ?? 0);
  settings.mMotorSettings.mMaxTorqueLimit = joint.motor_max ?? 0;
  return { settings, point: 'mPoint', axis: 'mHingeAxis', normal: 'mNormalAxis' };
}

function coneTwistSettings(jolt, joint) {
  const settings = new jolt.SwingTwistConstraintSettings();
  const cone = joint.limit_enabled ? (joint.cone ?? 0) : Math.PI;
  [settings.mTwistMinAngle, settings.mTwistMaxAngle] = turnsOf(joint);
  settings.mNormalHalfConeAngle = cone;
  settings.mPlaneHalfConeAngle = cone;
  settings.mMaxFrictionTorque = joint.torque_max ?? 0;
  return { settings, point: 'mPosition', axis: 'mTwistAxis', normal: 'mPlaneAxis' };
}

/** The settings of a joint, and how they call the points and axes that they have of both bodies. */
function jointSettings(jolt, joint) {
  const kind = joint.kind ?? 'revolute';
  if (joint.motor === 'position' || joint.hertz > 0 || joint.angular_hertz > 0)
    throw new Error('no springs and servos in this adapter for Jolt');
  if (kind === 'hinge') return hingeSettings(jolt, joint);
  if (kind === 'cone_twist' && (joint.limit_enabled || joint.torque_max > 0))
    return coneTwistSettings(jolt, joint);
  if (kind === 'cone_twist' || kind === 'revolute')
    return { settings: new jolt.PointConstraintSettings(), point: 'mPoint' };
  throw new Error(`no ${kind} in this adapter for Jolt`);
}

/** The joint between bodies at their places in the scene; Jolt is told of them in the world. */
export function constraintOf(scratch, joint, a, b) {
  const { settings, point, axis, normal } = jointSettings(scratch.jolt, joint);
  scratch.keep(settings);
  const place = (body, anchor) => rotated(rotationOf(body.scene), triple(anchor)).map(
    (value, i) => value + triple(body.scene.position)[i]);
  settings[`${point}1`] = scratch.point(place(a, joint.anchor_a));
  settings[`${point}2`] = scratch.point(place(b, joint.anchor_b));
  if (axis !== undefined) {
    const along = rotated(rotationOf(a.scene), triple(joint.axis));
    for (const end of [1, 2]) {
      settings[axis + end] = scratch.vector(along);
      settings[normal + end] = scratch.vector(across(along));
    }
  }
  return settings.Create(a.made, b.made);
}
