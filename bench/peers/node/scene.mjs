// What all engines read of a scene as JSON: scenes/json_writer.cpp leaves out what has its default.

export const triple = (value) => [value?.[0] ?? 0, value?.[1] ?? 0, value?.[2] ?? 0];

/** Friction, restitution, rolling resistance of a shape: the scene's first material where it names none. */
export function materialOf(scene, shape) {
  const all = scene.materials ?? [{}];
  const named = all.find((material) => material.name === shape.material) ?? all[0];
  return { friction: named.friction ?? 0.6, restitution: named.restitution ?? 0,
    rolling_resistance: named.rolling_resistance ?? 0 };
}

export function filterOf(shape) {
  const filter = shape.filter ?? {};
  return { category: filter.category ?? 1, mask: filter.mask ?? 0xffffffff, group: filter.group ?? 0 };
}

export function filtersMeet(a, b) {
  if (a.group !== 0 && a.group === b.group) return a.group > 0;
  return (a.category & b.mask) !== 0 && (b.category & a.mask) !== 0;
}

/** A quaternion, whichever the dimension. */
export function rotationOf(body) {
  if (body.rotation !== undefined) return body.rotation;
  const half = 0.5 * (body.angle ?? 0);
  return [0, 0, Math.sin(half), Math.cos(half)];
}

export function stepSeconds(scene) {
  return 1 / (scene.tick_hz ?? 60);
}

/** The scene without what only a player or our own solver brings. */
export function withoutSeats(scene) {
  const { seats: _seats, prefabs: _prefabs, ...rest } = scene;
  return rest;
}
