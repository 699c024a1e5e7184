/** The code that the page adds to the shaders of three.js arrives there: a chunk that has another name would leave it out. */
import { MeshStandardMaterial, ShaderLib, Texture, type WebGLProgramParametersWithUniforms } from "three";
import { expect, test } from "vitest";
import { groundMaterial } from "../../../web/src/scene/ground/groundMaterial";
import { aerialPerspective } from "../../../web/src/scene/sky/air";
import type { Pictures } from "../../../web/src/scene/textures/pictures";
import { patchColour } from "../../../web/src/scene/treeSurface/treeLight";
import { materialsOf } from "../../../web/src/scene/treeSurface/treeMaterial";

const shaderOf = ({ vertexShader, fragmentShader }: { vertexShader: string; fragmentShader: string }) =>
  ({ vertexShader, fragmentShader, uniforms: {} }) as unknown as WebGLProgramParametersWithUniforms;
/** How often a name stands in a text. */
const times = (text: string, name: string) => text.split(name).length - 1;

test("the snow on the ground has a surface, declared once and used after the colour of the ground", () => {
  const shader = shaderOf(ShaderLib.lambert);
  groundMaterial({} as Pictures).onBeforeCompile(shader, null as never);
  const { fragmentShader: code } = shader;
  expect(times(code, "vec2 snowSlope(")).toBe(1);
  expect(code.indexOf("* snowSlope(")).toBeGreaterThan(code.indexOf("drift = drifted(g);"));
  expect(code.indexOf("#include <normal_fragment_begin>")).toBeLessThan(code.indexOf("* snowSlope("));
});

test("leaves that move show their undersides in strong wind; still ones and wood have none", () => {
  const shows = (part: "leaves" | "wood", moves: boolean) => {
    const shader = shaderOf(ShaderLib.standard);
    patchColour(shader, part, moves, aerialPerspective);
    return times(shader.fragmentShader, "vec3 underside =");
  };
  expect([shows("leaves", true), shows("leaves", false), shows("wood", true)]).toEqual([1, 0, 0]);
  const shader = shaderOf(ShaderLib.standard);
  patchColour(shader, "leaves", true, aerialPerspective);
  expect(times(shader.fragmentShader, "uniform vec2 uFlutter;")).toBe(1); // with sprays and without
});

test("the ground reads six pictures at most, and the snow's only where snow lies", () => {
  const shader = shaderOf(ShaderLib.lambert);
  groundMaterial({} as Pictures).onBeforeCompile(shader, null as never);
  const { fragmentShader: code } = shader;
  const colour = code.slice(code.indexOf("vec2 g = vGround.xz;"), code.indexOf("float shaded ="));
  expect(times(colour, "texture2D(")).toBe(6);
  expect(colour.indexOf("drift = drifted(g);")).toBeGreaterThan(colour.indexOf("if (uSnow > 0.0)"));
  expect(times(code, "uniform float uBias;")).toBe(1);
});

const make = materialsOf({
  anisotropy: 1,
  smoothEdges: false,
  relief: false,
  gloss: false,
  surface: {} as never,
  atmosphere: aerialPerspective,
});

test("leaves of evergreens, and nothing else, show no undersides", () => {
  const shader = shaderOf(ShaderLib.standard);
  patchColour(shader, "leaves", true, aerialPerspective);
  const { fragmentShader: code } = shader;
  const underside = code.indexOf("vec3 underside =");
  expect(code.lastIndexOf("#ifndef EVERGREEN", underside)).toBeGreaterThan(code.lastIndexOf("#endif", underside));
  const defined = (part: "leaves" | "wood", evergreen: boolean) => {
    const from = new MeshStandardMaterial();
    from.userData.evergreen = evergreen;
    return "EVERGREEN" in (make(from, part, {} as never, true).colour.defines ?? {});
  };
  expect([defined("leaves", true), defined("leaves", false), defined("wood", true)]).toEqual([true, false, false]);
});

test("only leaves whose picture is known to have tiles of shoots repeat them where they are enlarged", () => {
  const tiled = (part: "leaves" | "wood", shoots: boolean) => {
    const from = new MeshStandardMaterial({ map: new Texture(), alphaTest: 0.4 });
    from.userData.shoots = shoots;
    return "SHOOT_TILES" in (make(from, part, {} as never, true).colour.defines ?? {});
  };
  expect([tiled("leaves", true), tiled("leaves", false), tiled("wood", true)]).toEqual([true, false, false]);
});
