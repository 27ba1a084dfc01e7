// From where all panels are seen: turned, moved and enlarged together, by parallel projection.
nodegraph.define("mocap/player/camera", [], () => {
  const STEEPEST = Math.PI / 2;

  // `over` is -1 where all is upside down: some files have y or z pointing down.
  const frontal = (camera) => ({ yaw: 0, pitch: 0, zoom: 1, x: 0, y: 0, over: camera?.over ?? 1 });

  const turnedOver = (camera) => ({ ...camera, over: -camera.over });

  const within = (low, value, high) => Math.min(high, Math.max(low, value));

  const turned = (camera, yaw, pitch) => ({
    ...camera,
    yaw: camera.yaw + camera.over * yaw,
    pitch: within(-STEEPEST, camera.pitch + camera.over * pitch, STEEPEST),
  });

  const zoomed = (camera, factor) => ({ ...camera, zoom: within(0.2, camera.zoom * factor, 40) });

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

  const mixed = (a, share, b, rest) => a.map((value, place) => share * value + rest * b[place]);

  // How a panel's millimetres lie on a picture of `size` dots: (x, y, depth) of a point is
  // (at - centre) times the three axes; y goes down, and depth towards the viewer. `radius` is that
  // of all panels of one kind, so that what stands side by side has one scale.
  const projectionOf = (panel, camera, size, radius) => {
    const towards = cross(panel.right, panel.up);
    const right = mixed(panel.right, Math.cos(camera.yaw), towards, Math.sin(camera.yaw));
    const front = mixed(panel.right, -Math.sin(camera.yaw), towards, Math.cos(camera.yaw));
    const up = mixed(panel.up, Math.cos(camera.pitch), front, -Math.sin(camera.pitch));
    const near = mixed(panel.up, Math.sin(camera.pitch), front, Math.cos(camera.pitch));
    const scale = (camera.zoom * size) / (2 * radius);
    const flat = camera.over * scale;
    const axes = [mixed(right, flat, right, 0), mixed(up, -flat, up, 0), mixed(near, scale, near, 0)];
    const shift = [size * (0.5 + camera.x), size * (0.5 + camera.y), 0];
    return Float64Array.from(axes.flatMap((axis, row) => [...axis, shift[row] - dot(axis, panel.centre)]));
  };

  // Adds the projection of one point to `dots` at a place: three numbers.
  const project = (by, x, y, z, dots, place) => {
    for (let row = 0; row < 3; row += 1) {
      dots[place + row] = by[4 * row] * x + by[4 * row + 1] * y + by[4 * row + 2] * z + by[4 * row + 3];
    }
  };

  return { frontal, within, turned, turnedOver, zoomed, projectionOf, project };
});
