// Heads as shaded meshes. A few thousand triangles are drawn here dot by dot, with a depth for
// each dot: that is fast enough without a graphics card, is the same everywhere, prints, and is
// not bound to the few graphics contexts that a browser allows a page.
nodegraph.define("mocap/player/mesh", ["mocap/player/camera"], ({ project }) => {
  const LIGHT = [-0.32, 0.45, 0.83];
  const AMBIENT = 0.3;
  const INSIDE = 0.45; // of the light falls on a triangle seen from behind: the mouth, the neck
  const SKIN = [214, 196, 182];

  // The vertices of a frame in millimetres; null where a weight is missing.
  const posed = (panel, frame) => {
    if (!panel.known[frame]) return null;
    const { vertices, morphs } = panel.head;
    const at = vertices.slice();
    morphs.forEach(({ places, offsets }, k) => {
      const weight = panel.weights[k * panel.frames + frame];
      if (weight) for (let i = 0; i < places.length; i += 1) at[places[i]] += weight * offsets[i];
    });
    if (!panel.motion) return at;
    const m = panel.motion.subarray(12 * frame, 12 * frame + 12); // scaled rotation, translation
    for (let i = 0; i < at.length; i += 3) {
      const [x, y, z] = [at[i], at[i + 1], at[i + 2]];
      for (let k = 0; k < 3; k += 1) at[i + k] = m[3 * k] * x + m[3 * k + 1] * y + m[3 * k + 2] * z + m[9 + k];
    }
    return at;
  };

  const addNormal = (normals, vertex, x, y, z) => {
    normals[3 * vertex] += x;
    normals[3 * vertex + 1] += y;
    normals[3 * vertex + 2] += z;
  };

  // How bright each vertex is, from the mean normal of its triangles, larger ones counting more.
  const brightness = (head, dots) => {
    const { faces } = head;
    const normals = new Float32Array(dots.length);
    for (let i = 0; i < faces.length; i += 3) {
      const [a, b, c] = [3 * faces[i], 3 * faces[i + 1], 3 * faces[i + 2]];
      // y goes down in the picture, and up where the light is
      const [ux, uy, uz] = [dots[b] - dots[a], dots[a + 1] - dots[b + 1], dots[b + 2] - dots[a + 2]];
      const [vx, vy, vz] = [dots[c] - dots[a], dots[a + 1] - dots[c + 1], dots[c + 2] - dots[a + 2]];
      const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (let k = 0; k < 3; k += 1) addNormal(normals, faces[i + k], x, y, z);
    }
    return Float32Array.from({ length: head.count }, (_, vertex) => {
      const [x, y, z] = [normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]];
      const lit = (x * LIGHT[0] + y * LIGHT[1] + z * LIGHT[2]) / (Math.hypot(x, y, z) || 1);
      return AMBIENT + (1 - AMBIENT) * Math.max(0, lit);
    });
  };

  // One dot's colour as the four bytes of a picture: opaque, blue, green, red.
  const skin = (bright) => {
    const part = (colour) => Math.min(255, colour * bright * 1.12) | 0;
    return (255 << 24) | (part(SKIN[2]) << 16) | (part(SKIN[1]) << 8) | part(SKIN[0]);
  };

  const PALETTE = Int32Array.from({ length: 256 }, (_, bright) => skin(bright / 255));

  // Fills one triangle: each dot whose centre is inside it and nothing nearer covers. A dot lies at
  // u a + v b + w c with u + v + w = 1, and inside where none is negative; all change by the same
  // from each dot to the next, and so do depth and brightness.
  const fillTriangle = (picture, depths, size, dots, bright, a, b, c) => {
    const ax = dots[3 * a], ay = dots[3 * a + 1], az = dots[3 * a + 2];
    const bx = dots[3 * b], by = dots[3 * b + 1], bz = dots[3 * b + 2];
    const cx = dots[3 * c], cy = dots[3 * c + 1], cz = dots[3 * c + 2];
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (area === 0) return;
    const full = area < 0 ? 255 : 255 * INSIDE; // y goes down: what faces us turns the other way
    const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
    const right = Math.min(size - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
    const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
    const bottom = Math.min(size - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
    const uStep = (by - cy) / area, vStep = (cy - ay) / area;
    const la = full * bright[a], lb = full * bright[b], lc = full * bright[c];
    const depthStep = uStep * (az - cz) + vStep * (bz - cz);
    const lightStep = uStep * (la - lc) + vStep * (lb - lc);
    for (let y = top; y <= bottom; y += 1) {
      const px = left + 0.5 - cx, py = y + 0.5 - cy;
      let u = ((by - cy) * px + (cx - bx) * py) / area;
      let v = ((cy - ay) * px + (ax - cx) * py) / area;
      let depth = cz + u * (az - cz) + v * (bz - cz);
      let light = lc + u * (la - lc) + v * (lb - lc);
      for (let place = y * size + left, last = y * size + right; place <= last; place += 1) {
        if (u >= 0 && v >= 0 && u + v <= 1 && depth > depths[place]) {
          depths[place] = depth;
          picture[place] = PALETTE[light & 255];
        }
        u += uStep;
        v += vStep;
        depth += depthStep;
        light += lightStep;
      }
    }
  };

  // All heads are drawn one after the other into one picture, made anew only for another size.
  let sheet = { size: 0 };
  const emptySheet = (pen, size) => {
    if (sheet.size !== size) {
      const image = pen.createImageData(size, size);
      sheet = { size, image, picture: new Int32Array(image.data.buffer), depths: new Float32Array(size * size) };
    }
    sheet.picture.fill(0);
    sheet.depths.fill(-Infinity);
    return sheet;
  };

  // Draws a frame of an animation; returns where its vertices lie, or null where it has no pose.
  const drawMesh = (pen, panel, by, frame, { size }) => {
    const at = posed(panel, frame);
    if (!at) return null;
    const dots = new Float32Array(at.length);
    for (let i = 0; i < at.length; i += 3) project(by, at[i], at[i + 1], at[i + 2], dots, i);
    const bright = brightness(panel.head, dots);
    const { image, picture, depths } = emptySheet(pen, size);
    const { faces } = panel.head;
    for (let i = 0; i < faces.length; i += 3) {
      fillTriangle(picture, depths, size, dots, bright, faces[i], faces[i + 1], faces[i + 2]);
    }
    pen.putImageData(image, 0, 0);
    return dots;
  };

  return { drawMesh };
});
