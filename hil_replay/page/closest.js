// SPDX-License-Identifier: Apache-2.0
// The closest points of two triangles, for the line that is drawn between them: the least over all
// pairs of edges, and of each corner against the other triangle. Pure; mm.
// Source: C. Ericson, Real-Time Collision Detection, 2005, sections 5.1.5 and 5.1.9.
"use strict";

/** The point of triangle [a, b, c] that is nearest to p. */
function closestOnTriangle(p, [a, b, c]) {
  const ab = b.clone().sub(a), ac = c.clone().sub(a), ap = p.clone().sub(a);
  const d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a.clone();
  const bp = p.clone().sub(b), d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b.clone();
  const cp = p.clone().sub(c), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c.clone();
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a.clone().addScaledVector(ab, d1 / (d1 - d3));
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a.clone().addScaledVector(ac, d2 / (d2 - d6));
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const along = (d4 - d3) / (d4 - d3 + (d5 - d6));
    return b.clone().addScaledVector(c.clone().sub(b), along);
  }
  const all = va + vb + vc;
  return a.clone().addScaledVector(ab, vb / all).addScaledVector(ac, vc / all);
}

/** The closest points [on pq, on rs] of two edges. */
function closestOnEdges(p, q, r, s) {
  const share = (value) => Math.min(1, Math.max(0, value));
  const d1 = q.clone().sub(p), d2 = s.clone().sub(r), between = p.clone().sub(r);
  const a = d1.dot(d1), e = d2.dot(d2), f = d2.dot(between), c = d1.dot(between), b = d1.dot(d2);
  const across = a * e - b * b;
  let along1 = across > 0 ? share((b * f - c * e) / across) : 0;
  let along2 = e > 0 ? (b * along1 + f) / e : 0;
  if (along2 !== share(along2)) {
    along2 = share(along2);
    along1 = a > 0 ? share((b * along2 - c) / a) : 0;
  }
  return [p.clone().addScaledVector(d1, along1), r.clone().addScaledVector(d2, along2)];
}

/** The closest points [on the first, on the second] of two triangles of three points each. */
function closestPoints(first, second) {
  let best = null, least = Infinity;
  const take = (one, other) => {
    const distance = one.distanceToSquared(other);
    if (distance < least) {
      least = distance;
      best = [one, other];
    }
  };
  for (let i = 0; i < 3; ++i) {
    take(first[i], closestOnTriangle(first[i], second));
    take(closestOnTriangle(second[i], first), second[i]);
    for (let j = 0; j < 3; ++j) {
      take(...closestOnEdges(first[i], first[(i + 1) % 3], second[j], second[(j + 1) % 3]));
    }
  }
  return best;
}
