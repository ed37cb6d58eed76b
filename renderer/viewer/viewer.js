/* Plays the motion of each figure.motion-viewer of a page, in 3D.

   Its data-scene is JSON, or the address of JSON: the clips and the speech in base64, as "data:"
   addresses or as "#id" of an element. The avatar is such an "#id", too, or its address is in
   data-avatar. If nothing can be played, JSON has only a "problem"; "notes" name missing parts.
   renderer/viewer writes the data. All clips of a figure share a clock, which is the speech if there
   is any. */
"use strict";
(() => {
const SKELETON = 0x0072b2;
const NARROW = 500;  // pixels below which two figures are side by side, otherwise three
const LARGEST_ANGLE = 0.56 * Math.PI;  // from straight above to a little below the ground
let running = null;

/* Reading packed data */

async function fetched(address) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(`the server answered with ${answer.status}`);
  return answer;
}

function lettersOf(source) {
  if (source.startsWith("#")) return document.getElementById(source.slice(1)).textContent.trim();
  return source.slice(source.indexOf(",") + 1);
}

async function bytesOf(source) {
  if (source.startsWith("/")) return new Uint8Array(await (await fetched(source)).arrayBuffer());
  return Uint8Array.from(atob(lettersOf(source)), letter => letter.charCodeAt(0));
}

async function unpacked(source) {
  const inflated = new Blob([await bytesOf(source)]).stream()
    .pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(inflated).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const content = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  let offset = 4 + length;
  for (const [name, rows, columns] of content.arrays) {
    const count = rows * columns, values = new Int32Array(count);
    for (let column = 0, at = offset; column < columns; column++) {
      let value = 0;
      for (let row = 0; row < rows; row++, at++) {
        const folded = bytes[at] | (bytes[at + count] << 8);
        value = (value + ((folded >>> 1) ^ -(folded & 1))) << 16 >> 16;
        values[row * columns + column] = value;
      }
    }
    content[name] = { values, rows, columns };
    offset += 2 * count;
  }
  return content;
}

const inSteps = (numbers, step) => Float32Array.from(numbers.values, value => value * step);

/* The body */

function bodyOf(avatar) {
  const geometry = new THREE.BufferGeometry(), vertices = inSteps(avatar.vertices, avatar.steps.vertices);
  const colour = new THREE.Color(), colours = new Float32Array(avatar.colours.values.length);
  for (let at = 0; at < colours.length; at += 3) {
    const [red, green, blue] = avatar.colours.values.subarray(at, at + 3);
    colour.setRGB(red / 255, green / 255, blue / 255, "srgb").toArray(colours, at);
  }
  const attributes = {
    position: [vertices, 3],
    normal: [inSteps(avatar.normals, avatar.steps.normals), 3],
    color: [colours, 3],
    skinIndex: [Uint8Array.from(avatar.skinJoints.values), 4],
    skinWeight: [inSteps(avatar.skinWeights, 1 / 255), 4],
  };
  for (const [name, [values, size]] of Object.entries(attributes)) {
    geometry.setAttribute(name, new THREE.BufferAttribute(values, size));
  }
  geometry.setIndex(new THREE.BufferAttribute(Uint16Array.from(avatar.faces.values), 1));
  const moves = inSteps(avatar.moves, avatar.steps.moves);
  const targets = Array.from({ length: avatar.expressions }, () => new Float32Array(vertices.length));
  for (let row = 0; row < avatar.movedVertices.rows; row++) {
    const [slot, vertex] = avatar.movedVertices.values.subarray(2 * row, 2 * row + 2);
    targets[slot].set(moves.subarray(3 * row, 3 * row + 3), 3 * vertex);
  }
  if (targets.length) {
    geometry.morphTargetsRelative = true;
    geometry.morphAttributes.position = targets.map(values => new THREE.BufferAttribute(values, 3));
  }
  return geometry;
}

/* Extra joints turn about a bone by shares of the twists of the joints at its two ends. */
function twistsOf(avatar) {
  return avatar.bones.map(([start, end], number) => {
    const place = joint => new THREE.Vector3(...avatar.joints[joint]);
    return { start, end, shares: avatar.shares[number], axis: place(end).sub(place(start)).normalize() };
  });
}

function twistAngle(turn, axis) {
  const along = turn.x * axis.x + turn.y * axis.y + turn.z * axis.z;
  return 2 * Math.atan2(turn.w < 0 ? -along : along, Math.abs(turn.w));
}

class Performer {
  constructor(avatar, geometry, clip, background) {
    this.avatar = avatar;
    this.clip = clip;
    this.twists = twistsOf(avatar);
    const places = [...avatar.joints, ...this.twists.map(twist => avatar.joints[twist.start])];
    const parents = [...avatar.parents, ...this.twists.map(twist => twist.start)];
    this.bones = places.map(() => new THREE.Bone());
    places.forEach((place, index) => {
      const parent = parents[index], start = parent < 0 ? [0, 0, 0] : places[parent];
      this.bones[index].position.set(...place.map((value, axis) => value - start[axis]));
      if (parent >= 0) this.bones[parent].add(this.bones[index]);
    });
    this.material = new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.85 });
    this.mesh = new THREE.SkinnedMesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.add(this.bones[0]);
    this.mesh.bind(new THREE.Skeleton(this.bones));
    this.lines = this.skeletonLines();
    const floor = new THREE.Mesh(
      new THREE.CircleGeometry(0.7, 48),
      new THREE.MeshBasicMaterial({ color: 0, transparent: true, opacity: 0.08 }));
    floor.rotation.x = -Math.PI / 2;
    floor.position.y = avatar.ground - 0.002;
    this.scene = litScene(background);
    this.scene.add(this.mesh, this.lines, floor);
    this.frame = -1;
  }

  skeletonLines() {
    const count = this.avatar.joints.length - 1, geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6 * count), 3));
    const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial(
      { color: SKELETON, depthTest: false, transparent: true }));
    lines.frustumCulled = false;
    lines.renderOrder = 1;
    lines.visible = false;
    return lines;
  }

  get frames() { return this.clip.turns.rows; }
  get seconds() { return this.frames / this.clip.rate; }

  showSkeleton(shown) {
    this.lines.visible = shown;
    Object.assign(this.material, { transparent: shown, opacity: shown ? 0.35 : 1, needsUpdate: true });
  }

  /* Pose the body as in the frame that a video shows at this time. */
  pose(seconds) {
    const frame = Math.min(Math.floor(seconds * this.clip.rate + 1e-6), this.frames - 1);
    if (frame === this.frame) return;
    this.frame = frame;
    const { turns, shifts, weights, steps } = this.clip, axis = new THREE.Vector3();
    for (let joint = 0; joint < this.avatar.joints.length; joint++) {
      axis.fromArray(turns.values, 3 * (55 * frame + joint)).multiplyScalar(steps.turns);
      const angle = axis.length();
      this.bones[joint].quaternion.setFromAxisAngle(axis.normalize(), angle);
    }
    this.twists.forEach(({ start, end, shares, axis: bone }, number) => {
      const [first, second] = [start, end].map(joint => twistAngle(this.bones[joint].quaternion, bone));
      this.bones[this.avatar.joints.length + number].quaternion
        .setFromAxisAngle(bone, shares[0] * first + shares[1] * second);
    });
    this.bones[0].position.fromArray(shifts.values, 3 * frame).multiplyScalar(steps.shifts)
      .add(axis.set(...this.avatar.joints[0]));
    for (let slot = 0; slot < weights.columns; slot++) {
      this.mesh.morphTargetInfluences[slot] = weights.values[weights.columns * frame + slot] * steps.weights;
    }
    this.mesh.updateMatrixWorld(true);
    const ends = this.lines.geometry.attributes.position;
    for (let joint = 1; joint < this.avatar.joints.length; joint++) {
      for (const [end, bone] of [this.avatar.parents[joint], joint].entries()) {
        axis.setFromMatrixPosition(this.bones[bone].matrixWorld).toArray(ends.array, 6 * (joint - 1) + 3 * end);
      }
    }
    ends.needsUpdate = true;
  }
}

function litScene(background) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(background);
  scene.add(new THREE.AmbientLight(0xeceff7, 1.2));
  for (const [x, y, z, strength] of [[-0.55, 0.75, 0.95, 2.0], [0.95, 0.15, 0.55, 0.7], [0.35, 0.65, -0.9, 1.0]]) {
    const light = new THREE.DirectionalLight(0xffffff, strength);
    light.position.set(x, y, z);
    scene.add(light);
  }
  return scene;
}

/* Clocks: the speech, or the time if there is none */

class Clock {
  constructor(seconds) {
    this.seconds = seconds;
    this.passed = 0;
    this.began = null;
    this.speed = 1;
  }
  get now() {
    const since = this.began === null ? 0 : (performance.now() - this.began) / 1000 * this.speed;
    return Math.min(this.passed + since, this.seconds);
  }
  set now(seconds) {
    this.passed = seconds;
    if (this.began !== null) this.began = performance.now();
  }
  get rate() { return this.speed; }
  set rate(speed) {
    this.now = this.now;
    this.speed = speed;
  }
  get paused() { return this.began === null || this.now >= this.seconds; }
  play() {
    if (this.now >= this.seconds) this.passed = 0;
    this.began = performance.now();
  }
  pause() {
    this.passed = this.now;
    this.began = null;
  }
}

class SpeechClock {
  constructor(seconds, address) {
    this.seconds = seconds;
    this.audio = element("audio", { src: address, preload: "auto" });
  }
  get now() { return Math.min(this.audio.currentTime, this.seconds); }
  set now(seconds) { this.audio.currentTime = seconds; }
  get rate() { return this.audio.playbackRate; }
  set rate(speed) { this.audio.playbackRate = speed; }
  get paused() { return this.audio.paused || this.audio.ended; }
  /* A browser that wants another press for sound stays paused. */
  play() { this.audio.play().catch(() => {}); }
  pause() { this.audio.pause(); }
}

/* One figure of the page */

function element(name, properties = {}, ...children) {
  const node = Object.assign(document.createElement(name), properties);
  node.append(...children);
  return node;
}

class Player {
  constructor(figure, scene, avatar, clips, speech) {
    this.figure = figure;
    const geometry = bodyOf(avatar);
    this.performers = clips.map(
      clip => new Performer(avatar, geometry, clip, scene.background));
    const seconds = Math.max(...this.performers.map(performer => performer.seconds));
    this.clock = speech ? new SpeechClock(seconds, speech) : new Clock(seconds);
    this.rows = Math.ceil(clips.length / (figure.clientWidth < NARROW ? 2 : 3));
    this.columns = Math.ceil(clips.length / this.rows);
    this.view = scene.camera;
    const farthest = Math.max(20, new THREE.Vector3(...this.view.eye).distanceTo(new THREE.Vector3(...this.view.target)));
    this.camera = new THREE.PerspectiveCamera(scene.camera.field_of_view, 1, 0.1, 3 * farthest);
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.domElement.addEventListener("webglcontextrestored", () => { this.drawn = ""; });
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.maxPolarAngle = LARGEST_ANGLE;
    this.controls.minDistance = 0.4;
    this.controls.maxDistance = farthest;
    this.build(scene);
    this.front();
    this.resized = new ResizeObserver(() => this.resize());
    this.resized.observe(this.stage);
    this.resize();
    this.draw = this.draw.bind(this);
    this.request = requestAnimationFrame(this.draw);
  }

  build(scene) {
    const labels = element("div", { className: "labels" }, ...scene.clips.map(
      clip => element("span", {}, element("b", { textContent: clip.name }))));
    this.stage = element("div", { className: "stage" }, this.renderer.domElement, labels);
    this.figure.dataset.columns = this.columns;
    this.figure.dataset.rows = this.rows;
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.setAttribute("aria-label",
      `Moving figures: ${scene.clips.map(clip => clip.name).join(", ")}. Drag to turn them.`);
    this.button = element("button", { type: "button", className: "play", onclick: () => this.toggle() });
    this.scrubber = element("input", {
      type: "range", min: 0, max: this.clock.seconds, step: 1 / this.performers[0].clip.rate, value: 0,
      ariaLabel: "Time", oninput: () => { this.clock.now = Number(this.scrubber.value); },
    });
    this.time = element("output", { className: "time" });
    const speeds = [[1, "full speed"], [0.5, "half speed"], [0.25, "quarter speed"]];
    const speed = element("select", { ariaLabel: "Speed", onchange: () => { this.clock.rate = Number(speed.value); } },
      ...speeds.map(([value, textContent]) => element("option", { value, textContent })));
    this.turn = element("input", {
      type: "range", min: -180, max: 180, step: 1, value: 0,
      oninput: () => this.turnTo(Number(this.turn.value)),
    });
    const skeleton = element("input", { type: "checkbox", onchange: () => {
      this.performers.forEach(performer => performer.showSkeleton(skeleton.checked));
      this.drawn = "";
    } });
    const front = element("button", { type: "button", textContent: "From the front", onclick: () => this.front() });
    this.figure.replaceChildren(
      this.stage,
      element("div", { className: "controls" }, this.button, this.scrubber, this.time, speed),
      element("div", { className: "controls" },
        element("label", {}, "Turn ", this.turn), front, element("label", {}, skeleton, " Skeleton")),
      ...(scene.notes ?? []).map(note => element("p", { textContent: note })),
      ...this.figure.querySelectorAll("figcaption"),
    );
    if (this.clock.audio) this.figure.append(this.clock.audio);
  }

  toggle() {
    if (this.clock.paused) this.clock.play(); else this.clock.pause();
  }

  front() {
    this.camera.position.set(...this.view.eye);
    this.controls.target.set(...this.view.target);
    this.controls.update();
  }

  /* Move the camera by an angle to the figures' left, at the same height and distance. */
  turnTo(degrees) {
    const { position } = this.camera, { target } = this.controls, angle = degrees * Math.PI / 180;
    const distance = Math.hypot(position.x - target.x, position.z - target.z);
    position.set(target.x + distance * Math.sin(angle), position.y, target.z + distance * Math.cos(angle));
    this.controls.update();
  }

  resize() {
    const width = this.stage.clientWidth, height = this.stage.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    const aspect = width / this.columns / (height / this.rows), half = this.view.field_of_view / 360 * Math.PI;
    this.camera.aspect = aspect;
    this.camera.fov = 360 / Math.PI * Math.atan(Math.tan(half) / Math.min(aspect, 1));
    this.camera.updateProjectionMatrix();
    this.drawn = "";
  }

  /* Draw only if something has changed: motion has fewer frames per second than a screen. */
  draw() {
    this.request = requestAnimationFrame(this.draw);
    const { now, paused, seconds } = this.clock;
    this.button.textContent = paused ? "Play" : "Pause";
    if (document.activeElement !== this.scrubber || !paused) this.scrubber.value = now;
    this.time.textContent = `${now.toFixed(2)} of ${seconds.toFixed(2)} s`;
    if (document.activeElement !== this.turn) {
      this.turn.value = this.controls.getAzimuthalAngle() * 180 / Math.PI;
    }
    this.performers.forEach(performer => performer.pose(now));
    const frames = this.performers.map(performer => performer.frame);
    const view = [...frames, ...this.camera.position, ...this.controls.target].join();
    if (view !== this.drawn) this.render();
    this.drawn = view;
    this.figure.dataset.seconds = now.toFixed(3);
  }

  render() {
    this.renderer.setScissorTest(true);  // a restored context has lost it
    const width = this.stage.clientWidth / this.columns, height = this.stage.clientHeight / this.rows;
    this.performers.forEach((performer, number) => {
      const column = number % this.columns, row = Math.floor(number / this.columns);
      const place = [column * width, (this.rows - 1 - row) * height, width, height];
      this.renderer.setViewport(...place);
      this.renderer.setScissor(...place);
      this.renderer.render(performer.scene, this.camera);
    });
  }

  stop() {
    cancelAnimationFrame(this.request);
    this.clock.pause();
    this.resized.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

function showsGraphics() {
  return Boolean(document.createElement("canvas").getContext("webgl2"));
}

/* Only one figure plays at a time: browsers keep few drawing surfaces. */
async function start(figure, { plays = false } = {}) {
  if (!showsGraphics()) {
    tell(figure, "This browser cannot draw in three dimensions (WebGL 2 is off or missing), so the motion cannot be shown here. Another browser, or another computer, can show it.");
    return;
  }
  const before = figure.cloneNode(true), { scene: source, avatar: address } = figure.dataset;
  const button = figure.querySelector(".start");
  Object.assign(button, { textContent: "Loading …", disabled: true });
  try {
    const scene = source.startsWith("{") ? JSON.parse(source) : await (await fetched(source)).json();
    if (scene.problem) return tell(figure, scene.problem);
    const sources = [scene.avatar ?? address, ...scene.clips.map(clip => clip.source)];
    const [avatar, ...clips] = await Promise.all(sources.map(unpacked));
    const speech = scene.speech && `data:audio/mpeg;base64,${lettersOf(scene.speech)}`;
    if (running) running.end();
    const player = new Player(figure, scene, avatar, clips, speech);
    running = { player, end: () => { player.stop(); figure.replaceWith(before); prepare(before); } };
    player.button.focus();
    if (plays) player.clock.play();
  } catch (error) {
    tell(figure, `The motion cannot be shown: ${error.message}. Load the page again to try once more.`);
    throw error;
  }
}

function tell(figure, words) {
  figure.querySelector(".start")?.replaceWith(element("p", { className: "problem", textContent: words }));
}

function prepare(figure) {
  figure.querySelector(".start").addEventListener("click", () => start(figure, { plays: true }));
}

const figures = [...document.querySelectorAll("figure.motion-viewer")];
figures.forEach(prepare);
if (figures.length && figures[0].hasAttribute("data-at-once")) start(figures[0]);
})();
