// SPDX-License-Identifier: Apache-2.0
// The machine in three dimensions: forward kinematics as core/machine/kinematics.hpp has them, surfaces,
// the pair of least clearance. Positions of axes in mm and degrees.
"use strict";

const BODY_COLOURS = [0x6b7689, 0x3f76a3, 0x3f8050, 0xa86a1c, 0x8f5f8f, 0xb3574c, 0x2f7f76,
                      0x77774f, 0x7a64a0, 0x94706a];
const REACH_COLOUR = 0x1a4fd6, REACH_OPACITY = 0.14;
const TOUCH_COLOUR = 0xd00000, NEAR_COLOUR = 0xff7b00, POINT_COLOUR = 0x000000;
const AXIS_COLOUR = 0x1a4fd6, GUESS_COLOUR = 0xc05a00;
const CONTACT_MM = 12, CONTACT_VIEW = 5;  // the least that is looked at, from so many times as far
const SEEN_THROUGH = 0.35;  // of the two bodies, where their contact is looked at

/** Rows of [r, r, r, t] as a matrix of three.js. */
function matrixOf(rows) {
  const m = new THREE.Matrix4();
  m.set(...rows[0], ...rows[1], ...rows[2], 0, 0, 0, 1);
  return m;
}

/** The motion of one joint: along its direction, or about the line through its pivot. */
function jointMotion(body, axes, positions) {
  const direction = new THREE.Vector3(...body.direction), m = new THREE.Matrix4();
  const at = positions[body.axis];
  if (axes[body.axis].unit === "mm") {
    return m.makeTranslation(direction.x * at, direction.y * at, direction.z * at);
  }
  m.makeRotationAxis(direction, at * Math.PI / 180);
  const pivot = new THREE.Vector3(...body.pivot_mm);
  return m.setPosition(pivot.clone().sub(pivot.clone().applyMatrix4(m)));
}

/** [bodies] the motion of each body away from its zero pose. */
function moveBodies(machine, positions) {
  const moved = [];
  for (const body of machine.bodies) {
    const m = body.parent === null ? new THREE.Matrix4() : moved[body.parent].clone();
    if (body.axis !== null) {
      m.multiply(jointMotion(body, machine.axes, positions));
    }
    moved.push(m);
  }
  return moved;
}

/** [bodies] from each body's mesh frame to machine coordinates. */
function placeBodies(machine, positions) {
  return moveBodies(machine, positions).map(
    (m, i) => m.multiply(matrixOf(machine.bodies[i].at)));
}

/** A name in front of all surfaces, as a picture of `height` units. */
function labelOf(text, colour, height) {
  const canvas = document.createElement("canvas"), context = canvas.getContext("2d");
  canvas.width = 256;
  canvas.height = 64;
  context.font = "bold 40px sans-serif";
  context.fillStyle = `#${colour.toString(16).padStart(6, "0")}`;
  context.fillText(text, 4, 48);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial(
    {map: new THREE.CanvasTexture(canvas), depthTest: false, transparent: true}));
  sprite.scale.set(height * canvas.width / canvas.height, height, 1);
  sprite.renderOrder = 5;
  return sprite;
}

/** The three corners of triangle `index`, in the mesh's own frame. */
function triangleOf(mesh, index) {
  return [0, 1, 2].map((i) => {
    const at = 3 * mesh.corners[3 * index + i];
    return new THREE.Vector3(mesh.points[at], mesh.points[at + 1], mesh.points[at + 2]);
  });
}

function flatGeometry(mesh) {
  const values = new Float32Array(3 * mesh.corners.length);
  mesh.corners.forEach((corner, i) => {
    for (let k = 0; k < 3; ++k) values[3 * i + k] = mesh.points[3 * corner + k];
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(values, 3));
  geometry.computeVertexNormals();
  return geometry;
}

class MachineView {
  /** Throws where the browser has no WebGL. */
  constructor(canvas, data) {
    this.data = data;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true,
                                             preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xdfe6ec);
    this.camera = new THREE.PerspectiveCamera(35, 1, 1, 1e5);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false;  // the arrows step through time
    this.controls.addEventListener("change", () => this.draw());
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x667788, 0.75));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    lamp.position.set(0.4, -1, 1.5);
    this.scene.add(lamp);
    this.bodies = data.machine.bodies.map((body, i) => this.addMesh(data.body_meshes[i], i));
    const toolBody = data.machine.bodies.findIndex((body) => body.is_tool);
    this.tools = data.tool_meshes.map((mesh) => this.addMesh(mesh, toolBody));
    this.marked = new THREE.Group();
    this.scene.add(this.marked);
    this.reach = new THREE.Group();
    this.scene.add(this.reach);
    this.axisLines = data.shows_axes ? this.addAxisLines() : [];
  }

  /** Each rotary axis as a line through its pivot, longer than the machine; a guess is marked. */
  addAxisLines() {
    const machine = this.data.machine, lines = [];
    const size = Math.max(100, ...this.bodies.map((object) => {
      object.geometry.computeBoundingSphere();
      return object.geometry.boundingSphere ? object.geometry.boundingSphere.radius || 0 : 0;
    }));
    for (const body of machine.bodies) {
      if (body.axis === null || machine.axes[body.axis].unit !== "deg") continue;
      const direction = new THREE.Vector3(...body.direction);
      const pivot = new THREE.Vector3(...body.pivot_mm);
      const ends = [-1, 1].map((sign) => pivot.clone().addScaledVector(direction, sign * size));
      const colour = body.is_guess ? GUESS_COLOUR : AXIS_COLOUR;
      const group = new THREE.Group();
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(ends),
                                  new THREE.LineBasicMaterial({color: colour, depthTest: false,
                                                               transparent: true}));
      line.renderOrder = 4;
      const name = machine.axes[body.axis].name + (body.is_guess ? "+ GUESS" : "+");
      const label = labelOf(name, colour, 0.12 * size);
      label.position.copy(ends[1]);
      group.add(line, label);
      group.matrixAutoUpdate = false;
      this.scene.add(group);
      lines.push({group, parent: body.parent});
    }
    return lines;
  }

  addMesh(mesh, bodyIndex) {
    const material = new THREE.MeshPhongMaterial({
      color: this.colourOf(bodyIndex), flatShading: true, side: THREE.DoubleSide, shininess: 12});
    const object = new THREE.Mesh(flatGeometry(mesh), material);
    object.matrixAutoUpdate = false;
    object.frustumCulled = false;
    this.scene.add(object);
    return object;
  }

  colourOf(bodyIndex) {
    return BODY_COLOURS[Math.max(0, bodyIndex) % BODY_COLOURS.length];
  }

  setBodyVisible(bodyIndex, isVisible) {
    this.bodies[bodyIndex].userData.isHidden = !isVisible;
    this.draw();
  }

  /** A check box for each body that has a surface, in `box`; `changed()` follows a click. */
  addBodyBoxes(box, changed) {
    this.data.machine.bodies.forEach((body, i) => {
      if (this.data.body_meshes[i].corners.length === 0 && !body.is_tool) return;
      const label = document.createElement("label"), input = document.createElement("input");
      const colour = document.createElement("i");
      input.type = "checkbox";
      input.checked = true;
      colour.style.background = `#${this.colourOf(i).toString(16).padStart(6, "0")}`;
      input.addEventListener("change", () => {
        this.setBodyVisible(i, input.checked);
        changed();
      });
      label.append(input, colour, body.name);
      box.append(label);
    });
  }

  /** The slot of a tool number; 0: what is in the spindle when nothing says otherwise. */
  toolSlot(number) {
    const wanted = number === 0 ? this.data.machine.first_tool : number;
    return this.data.machine.tools.findIndex((tool) => tool.number === wanted);
  }

  /**
   * @param positions  [axes] mm or degrees
   * @param nearest  {pair, a, b} or null: the triangles of least clearance
   * @param touching  [{pair, triangles: [[a, b]]}] at a stop
   */
  show(positions, toolNumber, nearest, touching) {
    const machine = this.data.machine, slot = this.toolSlot(toolNumber);
    this.placed = placeBodies(machine, positions);
    this.bodies.forEach((object, i) => {
      object.matrix.copy(this.placed[i]);
      object.visible = !object.userData.isHidden;
    });
    this.tools.forEach((object, i) => {
      const body = machine.bodies.findIndex((one) => one.is_tool);
      object.visible = i === slot && body >= 0 && !this.bodies[body].userData.isHidden;
      if (body >= 0) {
        object.matrix.multiplyMatrices(this.placed[body], matrixOf(machine.tools[i].at));
      }
    });
    const moved = this.axisLines.length === 0 ? [] : moveBodies(machine, positions);
    for (const {group, parent} of this.axisLines) {
      group.matrix.copy(parent === null ? new THREE.Matrix4() : moved[parent]);
    }
    this.slot = slot;
    this.mark(nearest, touching);
    this.draw();
  }

  /** Mesh and placement of one side of a pair. */
  surfaceOf(bodyIndex) {
    const machine = this.data.machine;
    if (!machine.bodies[bodyIndex].is_tool) {
      return [this.data.body_meshes[bodyIndex], this.placed[bodyIndex]];
    }
    if (this.slot < 0) return null;
    return [this.data.tool_meshes[this.slot],
            this.placed[bodyIndex].clone().multiply(matrixOf(machine.tools[this.slot].at))];
  }

  /** Corners in machine coordinates, null where there is no such surface. */
  cornersOf(bodyIndex, triangle) {
    const surface = this.surfaceOf(bodyIndex);
    if (surface === null || 3 * triangle + 2 >= surface[0].corners.length) return null;
    return triangleOf(surface[0], triangle).map((corner) => corner.applyMatrix4(surface[1]));
  }

  mark(nearest, touching) {
    for (const old of this.marked.children) old.geometry.dispose();
    this.marked.remove(...this.marked.children);
    this.line = null;
    this.markedPairs = [...touching.map((one) => one.pair), ...(nearest ? [nearest.pair] : [])];
    const isMarked = new Set();  // a large triangle may touch many
    const markOnce = (body, triangle, colour) => {
      const name = `${body}/${triangle}`;
      if (!isMarked.has(name)) this.markTriangle(this.cornersOf(body, triangle), colour);
      isMarked.add(name);
    };
    for (const {pair, triangles} of touching) {
      const {a, b} = this.data.machine.pairs[pair];
      for (const [one, other] of triangles) {
        markOnce(a, one, TOUCH_COLOUR);
        markOnce(b, other, TOUCH_COLOUR);
      }
    }
    if (nearest === null) return;
    const {a, b} = this.data.machine.pairs[nearest.pair];
    const first = this.cornersOf(a, nearest.a), second = this.cornersOf(b, nearest.b);
    if (first === null || second === null) return;
    markOnce(a, nearest.a, NEAR_COLOUR);
    markOnce(b, nearest.b, NEAR_COLOUR);
    this.line = closestPoints(first, second);
    const shape = new THREE.BufferGeometry().setFromPoints(this.line);
    const drawn = new THREE.Line(shape, new THREE.LineBasicMaterial(
      {color: 0x000000, depthTest: false}));
    drawn.renderOrder = 3;
    this.marked.add(drawn);
    const points = new THREE.Points(shape.clone(), new THREE.PointsMaterial(
      {color: POINT_COLOUR, size: 7, sizeAttenuation: false, depthTest: false, transparent: true}));
    points.renderOrder = 3;
    this.marked.add(points);
  }

  /**
   * Boxes that bodies do not leave, drawn by the next `show`: [{low_mm, high_mm, placed}], each in
   * its body's mesh frame.
   */
  setReach(boxes) {
    for (const old of this.reach.children) old.geometry.dispose();
    this.reach.remove(...this.reach.children);
    for (const {low_mm, high_mm, placed} of boxes) {
      const low = new THREE.Vector3(...low_mm), size = new THREE.Vector3(...high_mm).sub(low);
      const geometry = new THREE.BoxGeometry(size.x, size.y, size.z);
      geometry.translate(low.x + size.x / 2, low.y + size.y / 2, low.z + size.z / 2);
      const parts = [
        new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(
          {color: REACH_COLOUR, transparent: true, opacity: REACH_OPACITY, depthWrite: false,
           side: THREE.DoubleSide})),
        new THREE.LineSegments(new THREE.EdgesGeometry(geometry),
                               new THREE.LineBasicMaterial({color: REACH_COLOUR}))];
      for (const part of parts) {
        part.matrixAutoUpdate = false;
        part.matrix.copy(matrixOf(placed));
        this.reach.add(part);
      }
    }
  }

  markTriangle(corners, colour) {
    if (corners === null) return;
    const material = new THREE.MeshBasicMaterial(
      {color: colour, side: THREE.DoubleSide, depthTest: false, transparent: true, opacity: 0.45});
    const object = new THREE.Mesh(new THREE.BufferGeometry().setFromPoints(corners), material);
    object.renderOrder = 1;
    this.marked.add(object);
    // Its edges: a thin triangle seen from its side has no area.
    const edges = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(corners),
                                     new THREE.LineBasicMaterial({color: colour, depthTest: false,
                                                                  transparent: true}));
    edges.renderOrder = 2;
    this.marked.add(edges);
  }

  /** The surfaces of these bodies can be seen through; those of all others cannot. */
  seeThrough(bodyIndices) {
    const toolBody = this.data.machine.bodies.findIndex((body) => body.is_tool);
    const set = (object, isThrough) => {
      object.material.transparent = isThrough;
      object.material.opacity = isThrough ? SEEN_THROUGH : 1;
      object.material.depthWrite = !isThrough;
      object.material.needsUpdate = true;
    };
    this.bodies.forEach((object, i) => set(object, bodyIndices.includes(i)));
    this.tools.forEach((object) => set(object, bodyIndices.includes(toolBody)));
  }

  /** The camera close to what is marked, both bodies of the pair seen through. False: nothing is. */
  frameContact() {
    const box = new THREE.Box3();
    if (this.line) this.line.forEach((point) => box.expandByPoint(point));
    if (box.isEmpty()) this.marked.children.forEach((object) => box.expandByObject(object));
    if (box.isEmpty()) return false;
    const pairs = this.markedPairs.map((pair) => this.data.machine.pairs[pair]);
    this.seeThrough(pairs.flatMap(({a, b}) => [a, b]));
    const centre = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
    const away = CONTACT_VIEW * Math.max(CONTACT_MM, size.length());
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.camera.near = away / 100;
    this.camera.position.copy(centre).addScaledVector(direction, away);
    this.controls.target.copy(centre);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
    return true;
  }

  /** The camera far enough for all that is shown. */
  frameAll() {
    const box = new THREE.Box3();
    for (const object of [...this.bodies, ...this.tools]) {
      if (!object.visible || object.geometry.attributes.position.count === 0) continue;
      object.geometry.computeBoundingBox();
      box.union(object.geometry.boundingBox.clone().applyMatrix4(object.matrix));
    }
    if (box.isEmpty()) return;
    this.seeThrough([]);
    const centre = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
    const away = 0.5 * size.length() / Math.sin(0.5 * this.camera.fov * Math.PI / 180);
    this.camera.near = away / 100;
    this.camera.far = away * 20;
    this.camera.position.copy(centre).add(
      new THREE.Vector3(0.75, -1, 0.6).normalize().multiplyScalar(1.05 * away));
    this.controls.target.copy(centre);
    this.controls.update();
    this.draw();
  }

  draw() {
    const canvas = this.renderer.domElement;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    const ratio = window.devicePixelRatio || 1;
    const isSame = (have, wanted) => have === Math.floor(wanted * ratio);
    if (!isSame(canvas.width, width) || !isSame(canvas.height, height)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(1, height);
      this.camera.updateProjectionMatrix();
    }
    this.renderer.render(this.scene, this.camera);
  }
}
