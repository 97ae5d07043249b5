/* Bodies in space, drawn by three.js: what the animation and the live page share.

   createViewer(canvas, description) returns an object with the methods at the end of this file; nothing
   is drawn before render(). createViewer.colours: colours by name; createViewer.triad(letter): names of three axes. Lengths are in metres, vectors in the space frame a1, a2, a3.
   A quaternion is [q0, q1, q2, q3], the scalar first as everywhere in eom: it takes components in the
   body frame to the space frame, which is the transpose of C_BA of the same quaternion.

   description: {
     radius, centre: [x, y, z],   a ball that holds the motion: the camera and all sizes follow it
     up: [0, 0, 1],               what points up on the screen
     view: [azimuth, elevation],  in degrees, where the camera starts
     ground: height | null,       a grid at this height along up, with shadows
     bodies: [{name, colour, frame, axes, shapes: [shape]}],   frame: length of b1, b2, b3, or 0; axes: their names
     stand: [shape],              what does not move
     theme: "light" | "dark",
     dark: {colour: "#rrggbb"},   colours that are others in the dark theme
     paper: true,                 whether the background is that of a page of figures
     fit: [x, y, z, ...],         points that the camera sees all of at first, in place of the ball
     names: {space: ["a1", "a2", "a3"], body: ["b1", "b2", "b3"]}
   }
   shape: {kind, ...sizes, position, quaternion, colour, opacity, plain} in the body frame; an axis of
   symmetry is b3. The kinds and their sizes are the rows of SHAPES below. Round shapes have octants in
   two tones, so that one sees them turn, unless they are plain; meshes and boxes have edges unless they are
   smooth.
   text: a string, or runs: lists of [text, style, level], style "", "i", "b", level "", "sub", "sup". */
"use strict";

const createViewer = (() => {
  const COLOURS = {
    black: "#000000", grey: "#666666", orange: "#e69f00", sky: "#56b4e9", green: "#009e73",
    yellow: "#ebdc20", blue: "#0072b2", red: "#d55e00", purple: "#cc79a7",
  };
  const THEMES = {
    light: {background: "#fafaf7", text: "#1c1c1c", grid: "#d4d4ce", strong: "#b4b4ac", shadow: 0.16,
            sky: "#ffffff", earth: "#b9b6ae", edge: 0.55, axis: "#5a5a5a", hemisphere: 1.9, sun: 1.7},
    dark: {background: "#15171b", text: "#ececec", grid: "#2c3037", strong: "#434851", shadow: 0.45,
           sky: "#dfe8ff", earth: "#30333a", edge: 0.45, axis: "#b8b8b8", hemisphere: 1.3, sun: 1.9},
  };
  const AXES = ["#d1495b", "#2b9348", "#3a7bd5"];
  const FIELD = 32;
  const LABEL = 17;
  const ROUND = 48;

  /* Labels: room between boxes, ways and distances that are tried round a point (pixels), how far a box is from its
     point where a line leads to it; what a half turn costs, and what it is worth to stay, against one distance. A label
     goes back to where it stands by itself when there is more room. */
  const GAP = 2, WAYS = 24, RINGS = 40, RING = 7, LEADING = 12, TURNED = 0.8, STAY = 0.9, MORE = 8;
  const NAME = 0, NUMBER = 1, AT_TIP = 2, AT_AXIS = 3, AT_PLACE = 4;

  const PAPERS = {light: "#ffffff", dark: "#14171c"};
  const colourOf = (given) => new THREE.Color(COLOURS[given] || given || COLOURS.sky);
  const triad = (letter) => ["1", "2", "3"].map((k) => [[letter, "b", ""], [k, "", "sub"]]);
  const runsOf = (text) => (Array.isArray(text) ? text : [[text, "", ""]]);
  const vectorOf = (v) => new THREE.Vector3(v[0], v[1], v[2]);
  const turnOf = (q) => new THREE.Quaternion(q[1], q[2], q[3], q[0]).normalize();

  // -- shapes: unit geometries and their sizes ------------------------------------------------------

  const alongThird = (geometry) => geometry.rotateX(Math.PI / 2);
  const unit = {
    box: () => new THREE.BoxGeometry(1, 1, 1),
    ball: () => alongThird(new THREE.SphereGeometry(1, ROUND, ROUND / 2)),
    cylinder: () => alongThird(new THREE.CylinderGeometry(1, 1, 1, ROUND, 2)),
    cone: () => alongThird(new THREE.ConeGeometry(1, 1, ROUND, 2)).rotateX(Math.PI).translate(0, 0, 0.5),
  };
  const one = (geometry, scale) => [{geometry, scale}];

  /* Each row returns parts: geometry, scale, and what differs from the body's colour and place. */
  const SHAPES = {
    box: (s) => one(unit.box(), s.size),
    ellipsoid: (s) => one(unit.ball(), s.size),
    sphere: (s) => one(unit.ball(), [s.radius, s.radius, s.radius]),
    cylinder: (s) => one(unit.cylinder(), [s.radius, s.radius, s.length]),
    rod: (s) => one(unit.cylinder(), [s.radius || 0.02 * s.length, s.radius || 0.02 * s.length, s.length]),
    cone: (s) => one(unit.cone(), [s.radius, s.radius, s.height]),
    wheel,
    mesh: (s) => one(meshGeometry(s), [1, 1, 1]),
  };
  const ROUNDED = new Set(["ellipsoid", "sphere", "cylinder", "cone"]);

  /* A rim, spokes, one of them in another colour, and an axle: a body of revolution whose turns are seen. */
  function wheel(s) {
    const tube = s.tube || 0.06 * s.radius;
    const parts = one(new THREE.TorusGeometry(s.radius, tube, 16, 2 * ROUND), [1, 1, 1]);
    const axle = s.axle === undefined ? 0.5 * s.radius : s.axle;
    for (let k = 0; k < 6; k += 1) {
      const spoke = new THREE.CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0).rotateZ((k * Math.PI) / 3);
      const thick = k === 0 ? 0.45 * tube : 0.25 * tube;
      parts.push({geometry: scaledAcross(spoke, thick, s.radius, (k * Math.PI) / 3), scale: [1, 1, 1],
                  colour: k === 0 ? "#d55e00" : "#9a9a96", plain: true});
    }
    const hub = Math.max(0.6 * tube, 0.02 * s.radius);
    parts.push({geometry: unit.cylinder(), scale: [2 * hub, 2 * hub, 3 * hub], colour: "#9a9a96", plain: true});
    if (axle) {
      parts.push({geometry: unit.cylinder(), scale: [hub, hub, 2 * axle], colour: "#9a9a96", plain: true});
    }
    return parts;
  }

  function scaledAcross(geometry, thick, length, angle) {
    return geometry.rotateZ(-angle).scale(thick, length, thick).rotateZ(angle);
  }

  function meshGeometry(s) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(s.vertices, 3));
    geometry.setIndex(Array.from(s.faces));
    const made = s.flat ? geometry.toNonIndexed() : geometry;
    if (s.flat) {
      made.setIndex([...Array(made.getAttribute("position").count).keys()]);
    }
    made.computeVertexNormals();
    return made;
  }

  /* Faces in two groups, by the octant that their centre lies in. */
  function inOctants(geometry) {
    const place = geometry.getAttribute("position");
    const index = geometry.getIndex() ? geometry.getIndex().array : [...Array(place.count).keys()];
    const groups = [[], []];
    for (let k = 0; k < index.length; k += 3) {
      const face = [index[k], index[k + 1], index[k + 2]];
      const centre = ["getX", "getY", "getZ"].map((get) => face.reduce((sum, n) => sum + place[get](n), 0));
      groups[centre.filter((x) => x < 0).length % 2].push(...face);
    }
    geometry.setIndex([...groups[0], ...groups[1]]);
    geometry.clearGroups();
    geometry.addGroup(0, groups[0].length, 0);
    geometry.addGroup(groups[0].length, groups[1].length, 1);
  }

  function surfaceOf(colour, opacity, tint) {
    const shade = colour.clone();
    if (tint) {
      shade.lerp(new THREE.Color("#ffffff"), tint);
    }
    const clear = opacity !== undefined && opacity < 1;
    return new THREE.MeshStandardMaterial({
      color: shade, roughness: 0.6, metalness: 0.05, side: THREE.DoubleSide, transparent: clear,
      opacity: clear ? opacity : 1, depthWrite: !clear,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
  }

  function drawn(part, shape, bodyColour) {
    const colour = colourOf(part.colour || shape.colour || bodyColour);
    const marked = !part.plain && !shape.plain && (ROUNDED.has(shape.kind) || shape.marked);
    const materials = [surfaceOf(colour, shape.opacity, 0)];
    if (marked) {
      inOctants(part.geometry);
      materials.push(surfaceOf(colour, shape.opacity, 0.62));
    }
    const mesh = new THREE.Mesh(part.geometry, marked ? materials : materials[0]);
    mesh.scale.set(...part.scale);
    mesh.castShadow = mesh.receiveShadow = shape.opacity === undefined || shape.opacity === 1;
    if (["box", "mesh", "cylinder"].includes(shape.kind) && !shape.smooth) {
      const dark = colour.clone().multiplyScalar(0.45);
      const edges = new THREE.EdgesGeometry(part.geometry, 30);
      mesh.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({color: dark, transparent: true, opacity: 0.7})));
    }
    return mesh;
  }

  function shapeGroup(shape, bodyColour) {
    if (!SHAPES[shape.kind]) {
      throw new Error("unknown kind of shape " + shape.kind);
    }
    const group = new THREE.Group();
    SHAPES[shape.kind](shape).forEach((part) => group.add(drawn(part, shape, bodyColour)));
    group.position.set(...(shape.position || [0, 0, 0]));
    group.quaternion.copy(turnOf(shape.quaternion || [1, 0, 0, 0]));
    return group;
  }

  function freed(object) {
    object.traverse((node) => {
      if (node.geometry) {
        node.geometry.dispose();
      }
      [].concat(node.material || []).forEach((m) => {
        if (m.map) {
          m.map.dispose();
        }
        m.dispose();
      });
    });
    object.removeFromParent();
  }

  // -- words and arrows -----------------------------------------------------------------------------

  const SCALE = 2;
  const LEVELS = {"": [1, 0], sub: [0.72, 0.28], sup: [0.72, -0.38]};
  const STYLES = {"": "", i: "italic ", b: "bold "};
  const fontOf = (style, level, size, weight) => (STYLES[style] || "") + (style === "b" ? "" : weight + " ")
    + LEVELS[level][0] * size * SCALE + "px system-ui, 'Segoe UI', 'Noto Sans', 'DejaVu Sans', sans-serif";

  /* Words that face the camera; look: size in pixels and weight. */
  function label(text, colour, halo, {size = LABEL, weight = 600} = {}) {
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d");
    let wide = 0;
    const parts = runsOf(text).map(([part, style, level]) => {
      const font = fontOf(style, level, size, weight);
      pen.font = font;
      const left = wide;
      wide += pen.measureText(part).width + (style === "i" ? 0.06 * size * SCALE : 0);
      return {part, font, left, down: LEVELS[level][1] * size * SCALE};
    });
    canvas.width = Math.ceil(wide) + 8 * SCALE;
    canvas.height = Math.ceil(1.7 * size * SCALE);
    pen.textBaseline = "middle";
    pen.lineJoin = "round";
    pen.lineWidth = 4 * SCALE;
    pen.strokeStyle = halo;
    pen.fillStyle = colour;
    ["strokeText", "fillText"].forEach((paint) => parts.forEach(({part, font, left, down}) => {
      pen.font = font;
      pen[paint](part, left + 4 * SCALE, canvas.height / 2 + down);
    }));
    const map = new THREE.CanvasTexture(canvas);
    map.colorSpace = THREE.SRGBColorSpace;
    map.generateMipmaps = false;
    map.minFilter = map.magFilter;
    const sprite = new THREE.Sprite(new THREE.SpriteMaterial({map, sizeAttenuation: false, depthTest: false}));
    sprite.renderOrder = 10;
    sprite.userData.pixels = [canvas.width / SCALE, canvas.height / SCALE];
    return sprite;
  }

  /* An arrow along its own axis 2: the shaft and head are set by stretch(). What is inside of a body
     shines through it. */
  function arrowObject(colour, thickness) {
    const group = new THREE.Group();
    const material = new THREE.MeshStandardMaterial({color: colour, roughness: 0.7, emissive: colour, emissiveIntensity: 0.25});
    const within = new THREE.MeshBasicMaterial({color: colour, transparent: true, opacity: 0.4, depthFunc: THREE.GreaterDepth, depthWrite: false});
    const shaft = new THREE.Group();
    const head = new THREE.Group();
    [material, within].forEach((m) => {
      shaft.add(new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 16).translate(0, 0.5, 0), m));
      head.add(new THREE.Mesh(new THREE.ConeGeometry(1, 1, 24).translate(0, -0.5, 0), m));
    });
    group.add(shaft, head);
    group.userData = {shaft, head, thickness};
    return group;
  }

  function stretch(arrow, origin, vector) {
    const {shaft, head, thickness} = arrow.userData;
    const length = vector.length();
    const point = Math.min(7 * thickness, 0.5 * length);
    const wide = thickness * Math.min(1, (3 * length) / (7 * thickness));
    arrow.position.copy(origin);
    arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector.clone().divideScalar(length || 1));
    shaft.scale.set(wide, Math.max(length - point, 1e-12), wide);
    head.scale.set(2.6 * wide, Math.max(point, 1e-12), 2.6 * wide);
    head.position.set(0, length, 0);
  }

  // -- the viewer -----------------------------------------------------------------------------------

  const make = (canvas, description) => {
    const radius = description.radius || 1;
    const centre = vectorOf(description.centre || [0, 0, 0]);
    const focus = centre.clone();
    const up = vectorOf(description.up || [0, 0, 1]).normalize();
    const names = Object.assign(
      {space: triad("a"), body: triad("b")}, description.names);
    const renderer = new THREE.WebGLRenderer({canvas, antialias: true});
    const scene = new THREE.Scene();
    const camera = new THREE.PerspectiveCamera(FIELD, 1, radius / 100, radius * 200);
    camera.up.copy(up);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.minDistance = radius / 10;
    controls.maxDistance = radius * 40;
    const layers = {};
    const named = {arrows: new Map(), trails: new Map(), surfaces: new Map()};
    const bodies = [];
    const labels = new Set();
    let made = 0;
    let theme = THEMES.light;
    let colours = {};
    let asked = false;
    let grid = null;

    const layer = (name) => {
      if (!layers[name]) {
        layers[name] = new THREE.Group();
        scene.add(layers[name]);
      }
      return layers[name];
    };

    // lights, ground
    const sky = new THREE.HemisphereLight("#ffffff", "#bbbbbb", 1.8);
    const sun = new THREE.DirectionalLight("#ffffff", 1.8);
    const fill = new THREE.DirectionalLight("#ffffff", 0.5);
    scene.add(sky, sun, sun.target, fill);
    const across = new THREE.Vector3(1, 0, 0).addScaledVector(up, -up.x);
    if (across.lengthSq() < 0.1) {
      across.set(0, 1, 0).addScaledVector(up, -up.y);
    }
    across.normalize();
    const along = new THREE.Vector3().crossVectors(up, across);
    const from = (a, b, c) => new THREE.Vector3().addScaledVector(across, a).addScaledVector(along, b).addScaledVector(up, c);
    sky.position.copy(up);
    sun.position.copy(centre).addScaledVector(from(0.9, -1.3, 2.6), 2 * radius);
    sun.target.position.copy(centre);
    fill.position.copy(centre).addScaledVector(from(-1, 1, 0.6), 2 * radius);
    let shadows = null;
    if (description.ground !== null && description.ground !== undefined) {
      lay(description.ground);
    }

    function lay(height) {
      const cell = gridCell(radius);
      const count = 2 * Math.ceil((2.2 * radius) / cell);
      const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), up);
      const grid = new THREE.GridHelper(count * cell, count, "#b4b4ac", "#d4d4ce");
      const sheet = new THREE.Mesh(new THREE.PlaneGeometry(count * cell, count * cell).rotateX(-Math.PI / 2),
                                   new THREE.ShadowMaterial({opacity: 0.2}));
      sheet.receiveShadow = true;
      [grid, sheet].forEach((object) => {
        object.quaternion.copy(turn);
        layer("ground").add(object);
      });
      shadows = {grid, sheet, height, cell};
      under();
      renderer.shadowMap.enabled = true;
      renderer.shadowMap.type = THREE.PCFShadowMap;
      sun.castShadow = true;
      sun.shadow.mapSize.set(2048, 2048);
      Object.assign(sun.shadow.camera, {left: -2.2 * radius, right: 2.2 * radius, top: 2.2 * radius,
                                        bottom: -2.2 * radius, near: 0.1 * radius, far: 14 * radius});
      sun.shadow.normalBias = 0.01 * radius;
    }

    /* The ground below what is looked at: whole cells, so that its lines stay where they are. */
    function under() {
      const {grid, sheet, height, cell} = shadows;
      const foot = focus.clone().addScaledVector(up, height - focus.dot(up));
      [across, along].forEach((axis) => {
        const at = foot.dot(axis);
        foot.addScaledVector(axis, Math.round(at / cell) * cell - at);
      });
      [grid, sheet].forEach((object, k) => object.position.copy(foot).addScaledVector(up, -k * 1e-3 * radius));
    }

    /* Look at a point from where it is looked at now, the lights and the ground with it. */
    function follow(point) {
      const step = vectorOf(point).sub(focus);
      if (step.lengthSq() === 0) {
        return;
      }
      [focus, camera.position, controls.target, sun.position, sun.target.position, fill.position].forEach((p) => p.add(step));
      sun.target.updateMatrixWorld();
      if (shadows) {
        under();
      }
      controls.update();
    }

    function gridCell(size) {
      const raw = size / 4;
      const power = Math.pow(10, Math.floor(Math.log10(raw)));
      return power * [1, 2, 5, 10].find((n) => n * power >= raw * 0.999);
    }

    // frames
    /* Words in the space of a parent; rank: those of lower ranks stay where they are, others make room for them.
       userData.tip: what they are the name of, if they do not stand on it. */
    function tag(text, colour, parent, size, rank = AT_PLACE) {
      const sprite = label(text, inked(colour), theme.background, size);
      sprite.userData.words = {text, colour, size};
      Object.assign(sprite.userData, {rank, serial: made += 1});
      sized(sprite);
      parent.add(sprite);
      labels.add(sprite);
      return sprite;
    }

    /* The colour that a name has in this theme, as a style. */
    function inked(name) {
      return colours[name] || COLOURS[name] || theme[name] || name;
    }

    function sized(sprite) {
      const height = Math.max(canvas.clientHeight, 1);
      const perPixel = (2 * Math.tan((FIELD * Math.PI) / 360)) / height;
      const [wide, high] = sprite.userData.pixels;
      sprite.scale.set(wide * perPixel, high * perPixel, 1);
    }

    function frame(parent, length, texts, thickness, colours) {
      [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => {
        const arrow = arrowObject(new THREE.Color(colours[k]), thickness);
        stretch(arrow, new THREE.Vector3(), vectorOf(axis).multiplyScalar(length));
        parent.add(arrow);
        const words = tag(texts[k], colours[k], parent, undefined, AT_AXIS);
        words.userData.tip = vectorOf(axis).multiplyScalar(length);
        words.position.copy(vectorOf(axis).multiplyScalar(1.12 * length));
      });
    }

    function spaceFrame() {
      const group = layer("space frame");
      group.clear();
      frame(group, 0.62 * radius, names.space, 0.005 * radius, [theme.axis, theme.axis, theme.axis]);
    }

    // bodies
    (description.bodies || []).forEach((body) => {
      const group = new THREE.Group();
      const skin = new THREE.Group();
      group.add(skin);
      scene.add(group);
      const axes = new THREE.Group();
      group.add(axes);
      if (body.frame) {
        frame(axes, body.frame, body.axes || names.body, 0.006 * radius, AXES);
      }
      bodies.push({group, skin, axes, colour: body.colour});
      dress(bodies.length - 1, body.shapes || []);
    });

    (description.stand || []).forEach((shape) => layer("stand").add(shapeGroup(shape, "grey")));

    function dress(k, shapes) {
      const {skin, colour} = bodies[k];
      [...skin.children].forEach(freed);
      shapes.forEach((shape) => skin.add(shapeGroup(shape, colour)));
    }

    // look
    function look(name) {
      theme = Object.assign({}, THEMES[name] || THEMES.light);
      if (description.paper) {
        theme.background = PAPERS[name] || PAPERS.light;
      }
      colours = name === "dark" ? description.dark || {} : {};
      Object.keys(description.dark || {}).forEach(reinked);
      renderer.setClearColor(theme.background);
      sky.color.set(theme.sky);
      sky.groundColor.set(theme.earth);
      sky.intensity = theme.hemisphere;
      sun.intensity = theme.sun;
      if (shadows) {
        shadows.sheet.material.opacity = theme.shadow;
        recolour(shadows.grid, theme);
      }
      leaders.material.color.set(theme.axis);
      layer("space frame").children.filter((c) => c.isSprite).forEach((c) => labels.delete(c));
      spaceFrame();
      labels.forEach(repainted);
      ask();
    }

    function reinked(name) {
      scene.traverse((node) => [].concat(node.material || []).filter((m) => m.userData.colour === name)
        .forEach((m) => [m.color, m.emissive].filter(Boolean).forEach((c) => c.set(inked(name)))));
    }

    /* Write down which colour the parts of an object have, so that they follow the theme. */
    function dyed(object, name) {
      object.traverse((node) => [].concat(node.material || []).forEach((m) => {
        m.userData.colour = name;
        [m.color, m.emissive].filter((c) => c && colours[name]).forEach((c) => c.set(inked(name)));
      }));
      return object;
    }

    function recolour(grid, colours) {
      const array = grid.geometry.getAttribute("color");
      const count = array.count / 4;
      for (let k = 0; k < array.count; k += 1) {
        const middle = Math.floor(k / 4) === Math.floor((count - 1) / 2);
        const colour = new THREE.Color(middle ? colours.strong : colours.grid);
        array.setXYZ(k, colour.r, colour.g, colour.b);
      }
      array.needsUpdate = true;
    }

    function repainted(sprite) {
      const {text, colour, size} = sprite.userData.words;
      const fresh = label(text, inked(colour), theme.background, size);
      sprite.material.map.dispose();
      sprite.material.map = fresh.material.map;
      sprite.userData.pixels = fresh.userData.pixels;
      sized(sprite);
    }

    // camera
    const sight = (() => {
      const [azimuth, elevation] = (description.view || [35, 22]).map((a) => (a * Math.PI) / 180);
      const [c, s] = [Math.cos(elevation), Math.sin(elevation)];
      return from(c * Math.cos(azimuth), c * Math.sin(azimuth), s);
    })();

    /* The least distance from which all points to fit are seen, with a margin for words, or the whole ball. */
    function distance() {
      if (!description.fit) {
        return (1.14 * radius) / Math.sin((FIELD * Math.PI) / 360) / Math.min(1, camera.aspect);
      }
      const right = new THREE.Vector3().crossVectors(up, sight).normalize();
      const top = new THREE.Vector3().crossVectors(sight, right);
      const margin = (pixels, least) => Math.max(0.4, 1 - (2 * least) / Math.max(pixels, 1));
      const [beside, above] = description.margins || [28, 28];
      const high = Math.tan((FIELD * Math.PI) / 360) * margin(canvas.clientHeight, above);
      const wide = Math.tan((FIELD * Math.PI) / 360) * camera.aspect * margin(canvas.clientWidth, beside);
      let found = 0.2 * radius;
      for (let k = 0; k < description.fit.length; k += 3) {
        const p = vectorOf(description.fit.slice(k, k + 3)).sub(centre);
        const [a, b, c] = [p.dot(right), p.dot(top), p.dot(sight)];
        found = Math.max(found, c + Math.abs(a) / wide, c + Math.abs(b) / high);
      }
      return found;
    }

    function home() {
      controls.target.copy(focus);
      camera.position.copy(focus).addScaledVector(sight, distance());
      controls.update();
      ask();
    }

    function orbit(azimuth, elevation) {
      const offset = camera.position.clone().sub(controls.target);
      const turn = new THREE.Quaternion().setFromUnitVectors(up, new THREE.Vector3(0, 1, 0));
      const polar = new THREE.Spherical().setFromVector3(offset.applyQuaternion(turn));
      polar.theta += azimuth;
      polar.phi = Math.min(Math.PI - 0.02, Math.max(0.02, polar.phi - elevation));
      offset.setFromSpherical(polar).applyQuaternion(turn.invert());
      camera.position.copy(controls.target).add(offset);
      controls.update();
      ask();
    }

    function zoom(factor) {
      const offset = camera.position.clone().sub(controls.target).multiplyScalar(factor);
      if (offset.length() > controls.minDistance && offset.length() < controls.maxDistance) {
        camera.position.copy(controls.target).add(offset);
        controls.update();
        ask();
      }
    }

    const STEP = Math.PI / 36;
    const KEYS = {
      ArrowLeft: () => orbit(-STEP, 0), ArrowRight: () => orbit(STEP, 0),
      ArrowUp: () => orbit(0, STEP), ArrowDown: () => orbit(0, -STEP),
      "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9), Home: home, "0": home,
    };
    function pressed(event) {
      if (KEYS[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
        KEYS[event.key]();
        event.preventDefault();
        event.stopPropagation();
      }
    }
    canvas.addEventListener("keydown", pressed);
    controls.addEventListener("change", () => ask());

    // drawing
    function ask() {
      if (!asked) {
        asked = true;
        requestAnimationFrame(() => {
          asked = false;
          render();
        });
      }
    }

    function render() {
      camera.updateMatrixWorld();
      if (grid) {
        turnedBox();
      }
      settle();
      renderer.render(scene, camera);
    }

    // labels where they cover no others
    const leaders = (() => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(new Float32Array(6 * 400), 3));
      const object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({depthTest: false, transparent: true}));
      object.frustumCulled = false;
      object.renderOrder = 9;
      scene.add(object);
      return object;
    })();

    const pixelOf = (v) => {
      const p = v.clone().project(camera);
      return [((p.x + 1) / 2) * canvas.clientWidth, ((1 - p.y) / 2) * canvas.clientHeight, p.z];
    };
    const apart = (a, b, gap) => Math.abs(a.x - b.x) >= a.wide + b.wide + gap || Math.abs(a.y - b.y) >= a.high + b.high + gap;
    const within = (a) => a.x - a.wide >= 0 && a.x + a.wide <= canvas.clientWidth
      && a.y - a.high >= 0 && a.y + a.high <= canvas.clientHeight;

    /* The best free box round a point: the nearest, the one that the label has now if it is little farther. */
    function freeBox(home, tip, taken, before) {
      const free = (box, gap = GAP) => within(box) && taken.every((other) => apart(box, other, gap));
      let [best, least] = [null, Infinity];
      if (free(home, before ? MORE : GAP)) {
        [best, least] = [home, 0];
      }
      const [dx, dy] = [home.x - tip[0], home.y - tip[1]];
      const start = Math.hypot(dx, dy) < 1 ? -Math.PI / 2 : Math.atan2(dy, dx);
      for (let ring = 1; ring < RINGS && ring - STAY < least; ring += 1) {
        for (let k = 0; k < WAYS; k += 1) {
          const turn = (2 * Math.PI * k) / WAYS;
          const [c, s] = [Math.cos(start + turn), Math.sin(start + turn)];
          const place = {...home, x: tip[0] + c * (RING * ring + home.wide), y: tip[1] + s * (RING * ring + home.high), ring, k};
          const stays = before && before.ring === ring && before.k === k;
          const cost = ring + (TURNED * (1 - Math.cos(turn))) / 2 - (stays ? STAY : 0);
          if (cost < least && free(place)) {
            [best, least] = [place, cost];
          }
        }
      }
      return best || (free(home) ? home : null);
    }

    /* Move labels that would cover others to where they do not, with a line to what they name; leave out numbers of
       ticks that overlap, and what there is no room for. */
    function settle() {
      const seen = (node) => node.visible && (!node.parent || seen(node.parent));
      const shown = [...labels].filter((sprite) => seen(sprite) && sprite.userData.words.text.length)
        .sort((a, b) => a.userData.rank - b.userData.rank || a.userData.serial - b.userData.serial);
      const taken = [];
      const array = leaders.geometry.getAttribute("position").array;
      let count = 0;
      shown.forEach((sprite) => {
        const data = sprite.userData;
        const at = sprite.getWorldPosition(new THREE.Vector3());
        const [x, y] = pixelOf(at);
        const home = {x, y, wide: (data.pixels[0] - 8) / 2, high: (0.6 * data.pixels[1]) / 1.7};
        const tip = data.tip ? sprite.parent.localToWorld(data.tip.clone()) : at;
        const point = pixelOf(tip);
        let box = home;
        if (data.rank <= NUMBER) {
          box = taken.every((other) => apart(home, other, 0)) ? home : null;
        } else {
          const inside = Math.abs(point[2]) <= 1 && within({x: point[0], y: point[1], wide: 0, high: 0});
          box = inside ? freeBox(home, point, taken, data.box && data.box.ring ? data.box : null) : null;
        }
        data.box = box;
        sprite.material.visible = Boolean(box);
        if (!box) {
          return;
        }
        taken.push(box);
        sprite.center.set(0.5 - (box.x - x) / data.pixels[0], 0.5 + (box.y - y) / data.pixels[1]);
        const end = [[point[0], box.x, box.wide], [point[1], box.y, box.high]]
          .map(([p, middle, half]) => Math.min(middle + half, Math.max(middle - half, p)));
        if (box.ring && Math.hypot(end[0] - point[0], end[1] - point[1]) > LEADING && 6 * count < array.length) {
          const foot = new THREE.Vector3((2 * end[0]) / canvas.clientWidth - 1, 1 - (2 * end[1]) / canvas.clientHeight, point[2])
            .unproject(camera);
          array.set([...tip.toArray(), ...foot.toArray()], 6 * count);
          count += 1;
        }
      });
      leaders.geometry.setDrawRange(0, 2 * count);
      leaders.geometry.getAttribute("position").needsUpdate = true;
    }

    let far = distance();
    function resize() {
      const [wide, high] = [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
      renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
      renderer.setSize(wide, high, false);
      const before = far;
      camera.aspect = wide / high;
      camera.updateProjectionMatrix();
      far = distance();
      if (before !== far) {
        const offset = camera.position.clone().sub(controls.target).multiplyScalar(far / before);
        camera.position.copy(controls.target).add(offset);
      }
      labels.forEach(sized);
      controls.update();
      render();
    }

    // vectors, trails, surfaces
    function arrow(name, origin, vector, options) {
      let found = named.arrows.get(name);
      if (!found) {
        const {colour = "red", text = name, layer: where = "vectors", thickness = 0.009} = options || {};
        const object = dyed(arrowObject(colourOf(colour), thickness * radius), colour);
        const group = new THREE.Group();
        group.add(object);
        layer(where).add(group);
        const gap = (options && options.gap) || 0.07;
        found = {group, object, gap, words: tag(text, colour, group, options && options.size, AT_TIP)};
        named.arrows.set(name, found);
      }
      const v = vector && vectorOf(vector);
      const seen = Boolean(v) && v.length() > 1e-3 * radius;
      found.object.visible = found.words.visible = seen;
      if (seen) {
        const start = vectorOf(origin);
        stretch(found.object, start, v);
        found.words.userData.tip = start.clone().add(v);
        found.words.position.copy(start).add(v).addScaledVector(v.normalize(), found.gap * radius);
      }
    }

    function newTrail(options, segments) {
      const {colour = "orange", width = 2.5, opacity = 0.9, layer: where = "trails", body, dash} = options;
      const geometry = new THREE.LineSegmentsGeometry();
      geometry.setPositions(segments);
      const material = new THREE.LineMaterial({color: colourOf(colour), linewidth: width, transparent: opacity < 1, opacity});
      const object = new THREE.LineSegments2(geometry, material);
      dyed(object, colour);
      if (dash) {
        Object.assign(material, {dashed: true, dashSize: dash[0], gapSize: dash[1]});
        object.computeLineDistances();
      }
      object.frustumCulled = false;
      (body === undefined ? layer(where) : bodies[body].group).add(object);
      return {object, geometry, buffer: geometry.getAttribute("instanceStart").data, next: 0, filled: 0, last: null};
    }

    function trail(name, points, options) {
      const flat = Float32Array.from(Array.isArray(points[0]) ? points.flat() : points);
      const segments = new Float32Array(6 * Math.max(flat.length / 3 - 1, 1));
      let count = 0;
      for (let k = 0; k + 3 < flat.length; k += 3) {
        const piece = flat.subarray(k, k + 6);
        if (piece.every(Number.isFinite)) {
          segments.set(piece, 6 * count);
          count += 1;
        }
      }
      if (named.trails.has(name)) {
        freed(named.trails.get(name).object);
      }
      const made = newTrail(options || {}, segments);
      made.geometry.instanceCount = count;
      named.trails.set(name, made);
    }

    function trailTo(name, count) {
      const found = named.trails.get(name);
      found.geometry.instanceCount = Math.max(0, Math.min(count - 1, found.buffer.array.length / 6));
      found.object.visible = found.geometry.instanceCount > 0;
    }

    function trailAdd(name, point, options) {
      const most = (options && options.most) || 2000;
      let found = named.trails.get(name);
      if (!found) {
        found = newTrail(options || {}, new Float32Array(6 * most));
        found.geometry.instanceCount = 0;
        named.trails.set(name, found);
      }
      if (found.last) {
        found.buffer.array.set([...found.last, ...point], 6 * found.next);
        found.buffer.needsUpdate = true;
        found.next = (found.next + 1) % most;
        found.filled = Math.min(found.filled + 1, most);
        found.geometry.instanceCount = found.filled;
      }
      found.last = Array.from(point);
      found.object.visible = found.filled > 0;
    }

    function trailClear(name) {
      const found = named.trails.get(name);
      if (found) {
        Object.assign(found, {next: 0, filled: 0, last: null});
        found.geometry.instanceCount = 0;
        found.object.visible = false;
      }
    }

    function line(name, a, b, options) {
      let found = named.trails.get(name);
      if (!found) {
        found = newTrail(Object.assign({layer: "lines"}, options), new Float32Array(6));
        named.trails.set(name, found);
      }
      found.buffer.array.set([...a, ...b]);
      found.buffer.needsUpdate = true;
    }

    function surface(name, shape, options) {
      const {colour = "grey", layer: where = "surfaces"} = options || {};
      if (named.surfaces.has(name)) {
        freed(named.surfaces.get(name));
      }
      const group = new THREE.Group();
      group.add(shape.kind === "mesh" && shape.smooth ? dyed(shapeGroup(shape, colour), colour) : shapeGroup(shape, colour));
      layer(where).add(group);
      named.surfaces.set(name, group);
    }

    // dots, words, a box with ticks
    function dots(points, options) {
      const {colour = "black", size = 6, layer: where = "dots"} = options;
      const canvas = document.createElement("canvas");
      canvas.width = canvas.height = 64;
      const pen = canvas.getContext("2d");
      pen.fillStyle = "#ffffff";
      pen.arc(32, 32, 31, 0, 2 * Math.PI);
      pen.fill();
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
      const material = new THREE.PointsMaterial({color: colourOf(colour), size, sizeAttenuation: false,
                                                 map: new THREE.CanvasTexture(canvas), alphaTest: 0.5});
      Object.assign(material, {polygonOffset: true, polygonOffsetUnits: -8});
      const object = dyed(new THREE.Points(geometry, material), colour);
      object.frustumCulled = false;
      layer(where).add(object);
    }

    function text(place, runs, options) {
      const {colour = "black", layer: where = "words", size} = options;
      tag(runs, colour, layer(where), size).position.copy(vectorOf(place));
    }

    const SIGNS = [-1, 1];
    const others = (k) => [(k + 1) % 3, (k + 2) % 3];

    /* The three sides of a box that are turned away have a grid, its outline has the words of the ticks.
       low, high: [x, y, z]; ticks: of each axis, [{at, runs}]; names: of the axes, runs. */
    function box({low, high, ticks, names: axes}) {
      const sides = [];
      [0, 1, 2].forEach((k) => SIGNS.forEach((sign) => {
        const [i, j] = others(k);
        const lines = [];
        [[i, j], [j, i]].forEach(([a, b]) => [low[a], ...ticks[a].map((t) => t.at), high[a]].forEach((at) => {
          [low[b], high[b]].forEach((end) => {
            const p = [0, 0, 0];
            [p[k], p[a], p[b]] = [sign < 0 ? low[k] : high[k], at, end];
            lines.push(...p);
          });
        }));
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.Float32BufferAttribute(lines, 3));
        const side = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: theme.grid}));
        layer("box").add(side);
        sides.push({side, k, sign});
      }));
      const marks = ticks.map((list) => list.filter((t) => t.runs).map((t) => (
        {at: t.at, sprite: tag(t.runs, "axis", layer("box"), {size: 12, weight: 400}, NUMBER)})));
      const heads = axes.map((runs) => tag(runs, "text", layer("box"), {size: 14, weight: 400}, NAME));
      grid = {low, high, sides, marks, heads};
    }

    function turnedBox() {
      camera.updateMatrixWorld();
      const {low, high, sides, marks, heads} = grid;
      const ends = (k, sign) => (sign < 0 ? low[k] : high[k]);
      const faces = (k, sign) => sign * (camera.position.getComponent(k) - ends(k, sign)) > 0;
      sides.forEach(({side, k, sign}) => {
        side.visible = !faces(k, sign);
        side.material.color.set(theme.grid);
      });
      [0, 1, 2].forEach((k) => {
        const edge = outline(k, ends, faces);
        heads[k].visible = Boolean(edge);
        marks[k].forEach(({sprite}) => { sprite.visible = Boolean(edge); });
        if (edge) {
          const depths = marks[k].map(({at, sprite}) => edge.put(sprite, at, 4));
          edge.name(heads[k], Math.max(4, ...depths) + 3);
        }
      });
    }

    /* Of the edges along axis k that bound the box on the screen the lowest, or of the upright ones the one to the left:
       put(sprite, place, gap) lays words beside a place of it, off the box, and returns how far they reach (pixels);
       name(sprite, gap) lays them beside its middle, or on top of an upright one. */
    function outline(k, ends, faces) {
      const [i, j] = others(k);
      const upright = Math.abs(up.getComponent(k)) > 0.9;
      const found = [];
      SIGNS.forEach((a) => SIGNS.forEach((b) => {
        if (faces(i, a) === faces(j, b)) {
          return;
        }
        const at = (place) => new THREE.Vector3().setComponent(k, place).setComponent(i, ends(i, a)).setComponent(j, ends(j, b));
        const seen = at((ends(k, -1) + ends(k, 1)) / 2).project(camera);
        found.push({at, worth: upright ? seen.x : seen.y});
      }));
      if (!found.length) {
        return null;
      }
      const {at} = found.sort((p, q) => p.worth - q.worth)[0];
      const pixel = [canvas.clientWidth / 2, canvas.clientHeight / 2];
      const onScreen = (p) => new THREE.Vector3(p.x * pixel[0], p.y * pixel[1], 0);
      const [first, last] = [-1, 1].map((sign) => onScreen(at(ends(k, sign)).project(camera)));
      const middle = onScreen(new THREE.Vector3(...[0, 1, 2].map((n) => (ends(n, -1) + ends(n, 1)) / 2)).project(camera));
      const ahead = last.clone().sub(first).normalize();
      const off = new THREE.Vector3(-ahead.y, ahead.x, 0);
      off.multiplyScalar(off.dot(middle.sub(first)) > 0 ? -1 : 1);
      const lay = (sprite, place, way, gap) => {
        const [wide, high] = sprite.userData.pixels;
        const half = (Math.abs(way.x) * (wide - 8) + Math.abs(way.y) * high / 1.7) / 2;
        const p = at(place).project(camera);
        p.x += (way.x * (gap + half)) / pixel[0];
        p.y += (way.y * (gap + half)) / pixel[1];
        sprite.position.copy(p.unproject(camera));
        return gap + 2 * half;
      };
      return {
        put(sprite, place, gap) { return lay(sprite, place, off, gap); },
        name(sprite, gap) { return upright ? lay(sprite, ends(k, 1), ahead, 4) : lay(sprite, (ends(k, -1) + ends(k, 1)) / 2, off, gap); },
      };
    }

    /* Where a point is on the canvas, in pixels, and how deep. */
    function seenAt(place) {
      camera.updateMatrixWorld();
      return pixelOf(vectorOf(place));
    }

    /* All words that are seen: text, place of their middle and size in pixels, whether a line leads to them. */
    function allWords() {
      render();
      const shown = (node) => node.visible && (!node.parent || shown(node.parent));
      return [...labels].filter((sprite) => shown(sprite) && sprite.material.visible && sprite.userData.words.text.length)
        .map(({userData}) => ({text: runsOf(userData.words.text).map((run) => run[0]).join(""), x: userData.box.x,
                               y: userData.box.y, size: userData.pixels, rank: userData.rank, moved: Boolean(userData.box.ring)}));
    }

    function placed(object, position, quaternion) {
      object.position.set(position[0], position[1], position[2]);
      object.quaternion.set(quaternion[1], quaternion[2], quaternion[3], quaternion[0]).normalize();
    }

    const watcher = new ResizeObserver(resize);
    watcher.observe(canvas);
    look(description.theme || "light");
    resize();
    home();

    return {
      /* The side of a cell of the ground's grid (m). */
      cell: gridCell(radius),
      /* Put body k: position of its origin (m), quaternion with the scalar first. */
      pose(k, position, quaternion) { placed(bodies[k].group, position, quaternion); },
      /* Give body k other shapes. */
      dress,
      /* Show an arrow from a point; a vector of null or (almost) zero hides it. options: colour, text, layer,
         size of the text, thickness and gap (of the text from the tip) as shares of the radius. */
      arrow,
      /* The names of all arrows. */
      arrows: () => [...named.arrows.keys()],
      /* A line through points (flat or in triples), broken where one is no number. options: colour, width, opacity,
         dash: lengths of dashes and gaps, layer, or the number of a body that it is fixed to, with points in its frame. */
      trail,
      /* Draw the first points of a trail alone. */
      trailTo,
      /* Append a point to a trail that keeps the last `most` (2000) of them; take all points away. */
      trailAdd, trailClear,
      /* A line between two points, by name; it may be given other points at any time. */
      line,
      /* A shape in space, by name; options: colour, layer. It is moved by place(). */
      surface,
      place(name, position, quaternion) { placed(named.surfaces.get(name), position, quaternion); },
      /* Show or hide a layer: space frame, body frames, bodies, vectors, trails, ground, surfaces, or
         of an arrow or trail by its name. */
      show(name, seen) {
        const parts = {"body frames": "axes", bodies: "skin"}[name];
        if (parts) {
          bodies.forEach((body) => { body[parts].visible = seen; });
        } else if (named.arrows.has(name)) {
          named.arrows.get(name).group.visible = seen;
        } else {
          layer(name).visible = seen;
        }
        ask();
      },
      /* light or dark. */
      theme: look,
      /* Dots at points (flat); options: colour, size in pixels, layer. Words at a place; options: colour, layer,
         size: {size, weight}. A box with a grid and ticks (see above). */
      dots, text, box,
      /* Where a point is seen, in pixels; all words that are seen, with their places. */
      seenAt, words: allWords,
      /* Draw now; draw with the next frame. */
      render, ask,
      /* Go with a point: the camera, the lights, the ground. Put the ground at another height. */
      follow,
      ground(height) {
        if (shadows && shadows.height !== height) {
          shadows.height = height;
          under();
        }
      },
      /* Turn the camera (radians), move it nearer (factor below 1) or farther, put it back. */
      orbit, zoom, home,
      resize, camera, controls, scene, canvas,
      dispose() {
        watcher.disconnect();
        controls.dispose();
        canvas.removeEventListener("keydown", pressed);
        freed(scene);
        renderer.dispose();
      },
    };
  };
  return Object.assign(make, {colours: COLOURS, triad});
})();
