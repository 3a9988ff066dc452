// The interactive view inside the page of packmpi report: spheres as impostors, one quad each, drawn to the pixel by the fragment shader.
// Reads its data from the page (scripts/python/packmpi/view.py says what they are). scripts/dev/viewer.sh makes one file of it and three.js.
import { BufferGeometry, Float32BufferAttribute, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, LineBasicMaterial, LineSegments,
  Mesh, OrthographicCamera, RawShaderMaterial, Scene, Sphere, Vector3, WebGLRenderer } from 'three'
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js'

const VERTEX = `precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform vec3 right, up, low, extent;
in vec2 position;
in vec4 sphere;
in float value;
out vec2 at;
out vec3 centre;
out float r, shade;
void main() {
  r = sphere.w;
  centre = sphere.xyz;
  at = position;
  shade = value;
  gl_Position = projectionMatrix * viewMatrix * vec4(centre + r * (position.x * right + position.y * up), 1.0);
}`

// Along the line of sight: where the sphere begins, or, where that is cut away, the plane inside the sphere.
const FRAGMENT = `precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform vec3 right, up, toViewer, normal;
uniform float cut;
in vec2 at;
in vec3 centre;
in float r, shade;
out vec4 colour;
vec3 viridis(float t) {
  const vec3 c0 = vec3(0.2777, 0.0054, 0.3341), c1 = vec3(0.1051, 1.4046, 1.3846), c2 = vec3(-0.3309, 0.2148, 0.0951),
    c3 = vec3(-4.6342, -5.7991, -19.3324), c4 = vec3(6.2283, 14.1799, 56.6906), c5 = vec3(4.7764, -13.7451, -65.3530), c6 = vec3(-5.4355, 4.6459, 26.3124);
  return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}
void main() {
  float d2 = dot(at, at);
  if (d2 > 1.0) discard;
  vec3 n = at.x * right + at.y * up + sqrt(1.0 - d2) * toViewer;
  vec3 p = centre + r * n;
  float over = dot(p, normal) - cut, slope = dot(toViewer, normal);
  bool flatCut = false;
  if (over > 0.0) {
    if (slope <= 1e-4) discard;
    p -= toViewer * (over / slope);
    vec3 inside = p - centre;
    if (dot(inside, inside) > r * r) discard;
    n = normal;
    flatCut = true;
  }
  vec4 clip = projectionMatrix * viewMatrix * vec4(p, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  vec3 light = normalize(toViewer + 0.5 * up + 0.35 * right);
  float lit = flatCut ? 0.95 : 0.35 + 0.65 * max(0.0, dot(n, light));
  colour = vec4(clamp(viridis(shade), 0.0, 1.0) * lit, 1.0);
}`

const VIRIDIS = ['#440154', '#3b528b', '#21918c', '#5ec962', '#fde725']

function bytesOf (id) {
  return Uint8Array.from(atob(document.getElementById(id).textContent.trim()), c => c.charCodeAt(0)).buffer
}

function short (value) {
  return value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5) ? value.toExponential(2) : String(+value.toPrecision(3))
}

function begin (place) {
  const told = JSON.parse(document.getElementById('view-about').textContent)
  const spheres = new Float32Array(bytesOf('view-spheres'))   // x y z r, in units of the largest extent, about the middle
  const fields = told.fields.map((field, k) => new Float32Array(bytesOf('view-field-' + k)))
  const canvas = place.querySelector('canvas')
  const renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true })
  const size = told.size.map(Number)

  const geometry = new InstancedBufferGeometry()
  geometry.setAttribute('position', new Float32BufferAttribute([-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1], 2))
  geometry.setAttribute('sphere', new InstancedBufferAttribute(spheres, 4))
  const value = new InstancedBufferAttribute(new Float32Array(spheres.length / 4), 1)
  geometry.setAttribute('value', value)
  geometry.boundingSphere = new Sphere(new Vector3(), 4)
  const count = spheres.length / 4
  geometry.instanceCount = count
  const uniforms = { right: { value: new Vector3() }, up: { value: new Vector3() }, toViewer: { value: new Vector3() },
    normal: { value: new Vector3(1, 0, 0) }, cut: { value: 1e9 } }
  const material = new RawShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, glslVersion: GLSL3 })
  const mesh = new Mesh(geometry, material)
  mesh.frustumCulled = false

  const scene = new Scene()
  scene.add(mesh)
  const corner = k => [0, 1, 2].map(axis => ((k >> axis & 1) - 0.5) * size[axis])
  const edges = []
  for (let k = 0; k < 8; k++) for (const bit of [1, 2, 4]) if (!(k & bit)) edges.push(...corner(k), ...corner(k | bit))
  const frame = new LineSegments(new BufferGeometry().setAttribute('position', new Float32BufferAttribute(edges, 3)), new LineBasicMaterial())
  scene.add(frame)

  const camera = new OrthographicCamera(-1, 1, 1, -1, 0.01, 20)
  camera.up.set(0, 0, 1)
  const reach = 0.5 * Math.hypot(...size)
  camera.position.set(1.5, -3.0, 1.4).setLength(5.0)
  const controls = new OrbitControls(camera, canvas)
  controls.minZoom = 0.5
  controls.maxZoom = 60

  let waiting = false, turned = false
  function draw () {
    waiting = false
    camera.updateMatrixWorld()
    camera.matrixWorld.extractBasis(uniforms.right.value, uniforms.up.value, uniforms.toViewer.value)
    frame.material.color.set(getComputedStyle(canvas).color)
    renderer.render(scene, camera)
    if (!turned) return
    turned = false   // the pause counts from when the frame can be seen, however long it takes
    requestAnimationFrame(() => requestAnimationFrame(() => { clearTimeout(rest); rest = setTimeout(settle, 250) }))
  }
  function later () {
    if (!waiting) requestAnimationFrame(draw)
    waiting = true
  }
  // Where frames come slowly, a part of the spheres is drawn while the pack is turned (their order is one by chance), and all at its end.
  let part = 1, before = -1e9, rest = 0
  function turning () {
    const now = performance.now(), gap = now - before
    before = now
    if (gap < 9000) part = Math.min(1, Math.max(0.02, part * (gap > 70 ? Math.max(0.1, 50 / gap) : gap < 25 ? 1.25 : 1)))
    geometry.instanceCount = Math.ceil(part * count)
    clearTimeout(rest)
    turned = true
    later()
  }
  function settle () {
    geometry.instanceCount = count
    before = -1e9
    later()
  }
  function fit () {
    const wide = canvas.clientWidth, high = canvas.clientHeight
    if (!wide || !high) return
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2))
    renderer.setSize(wide, high, false)
    const aspect = wide / high, half = 1.06 * reach / Math.min(1, aspect)
    Object.assign(camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half })
    camera.updateProjectionMatrix()
    later()
  }

  const [choose, axis, cut] = ['select.field', 'select.axis', 'input'].map(which => place.querySelector(which))
  const legend = place.querySelector('.legend')
  function colour () {
    const field = told.fields[choose.value], values = fields[choose.value], span = field.high - field.low || 1
    for (let k = 0; k < values.length; k++) value.array[k] = (values[k] - field.low) / span
    value.needsUpdate = true
    legend.style.background = `linear-gradient(to right, ${VIRIDIS.join(',')})`
    place.querySelector('.low').textContent = short(field.low)
    place.querySelector('.high').textContent = short(field.high) + (field.unit ? ' ' + field.unit : '')
    later()
  }
  function slice () {
    const [way, along] = axis.value.split(' ')
    const k = 'xyz'.indexOf(along), sign = way === '+' ? 1 : -1
    uniforms.normal.value.set(0, 0, 0).setComponent(k, sign)
    const share = +cut.value / 1000
    uniforms.cut.value = share >= 1 ? 1e9 : (share - 0.5) * size[k]   // kept: sign * coordinate up to here
    later()
  }
  told.fields.forEach((field, k) => choose.add(new Option(field.name, k)))
  choose.addEventListener('change', colour)
  axis.addEventListener('change', slice)
  cut.addEventListener('input', slice)
  place.querySelector('button').addEventListener('click', () => { controls.reset(); cut.value = 1000; slice() })
  controls.addEventListener('change', turning)
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', later)
  new ResizeObserver(fit).observe(canvas)
  colour()
  slice()
  fit()
  draw()
  // For tests: how long a frame takes, drawn and waited for.
  window.packmpiView = {
    spheres: count,
    shown: () => geometry.instanceCount,
    frame () {
      const pixel = new Uint8Array(4), gl = renderer.getContext(), begun = performance.now()
      geometry.instanceCount = count
      draw()
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel)
      return performance.now() - begun
    },
    colours () {
      geometry.instanceCount = count
      draw()
      const gl = renderer.getContext(), [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight], all = new Uint8Array(4 * w * h)
      gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, all)
      const seen = new Set()
      let covered = 0
      for (let k = 0; k < all.length; k += 4) if (all[k + 3] > 250) { covered++; seen.add(all[k] >> 4 << 8 | all[k + 1] >> 4 << 4 | all[k + 2] >> 4) }
      return { covered: covered / (w * h), seen: seen.size }
    }
  }
}

const place = document.getElementById('view')
try {
  begin(place)
} catch (error) {
  place.classList.add('without')
  place.querySelector('.sorry').textContent = 'No interactive view: this browser offers no WebGL 2 (' + error.message + ').'
}
